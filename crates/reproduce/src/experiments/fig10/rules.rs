//! The rules by which verdicts follow from ratios of errors and their intervals. It knows no claim.

use super::found::Ratio;
use crate::outcome::Verdict;

/// Two samplers are alike if the ratio of their errors is 1 to within this part.
pub const ALIKE: f64 = 0.05;
/// One is clearly better than another if the other's error is larger by this factor at least, the root of 3/2. The error of independent
/// samples goes with the inverse root of their number: they would have to be half as many again.
pub const CLEARLY: f64 = 1.224_744_871_391_589;

/// Whether an interval lies within [`ALIKE`] of one or beyond; one that holds a limit says nothing.
pub fn alike(ratio: Option<Ratio>) -> Verdict {
    match ratio.and_then(|ratio| ratio.interval) {
        Some([low, high]) if low >= 1.0 - ALIKE && high <= 1.0 + ALIKE => Verdict::Reproduced,
        Some([low, high]) if high < 1.0 - ALIKE || low > 1.0 + ALIKE => Verdict::NotReproduced,
        _ => Verdict::NotComparable,
    }
}

/// Whether the intervals of ratios all lie beyond [`CLEARLY`], or one of them below.
pub fn clearly(ratios: &[Option<Ratio>]) -> Verdict {
    let each = ratios
        .iter()
        .map(|ratio| match ratio.and_then(|ratio| ratio.interval) {
            Some([low, _]) if low >= CLEARLY => Verdict::Reproduced,
            Some([_, high]) if high < CLEARLY => Verdict::NotReproduced,
            _ => Verdict::NotComparable,
        });
    both(each)
}

/// The verdict of a claim of several parts: one that is contradicted contradicts it.
pub fn both(parts: impl IntoIterator<Item = Verdict>) -> Verdict {
    parts
        .into_iter()
        .fold(Verdict::Reproduced, |all, part| match (all, part) {
            (Verdict::NotReproduced, _) | (_, Verdict::NotReproduced) => Verdict::NotReproduced,
            (Verdict::NotComparable, _) | (_, Verdict::NotComparable) => Verdict::NotComparable,
            _ => Verdict::Reproduced,
        })
}

/// What is to be said where intervals give no verdict.
pub fn undecided(verdict: Verdict, ratios: &[Option<Ratio>]) -> &'static str {
    let known = |ratio: &Option<Ratio>| ratio.is_some_and(|ratio| ratio.interval.is_some());
    match verdict {
        Verdict::NotComparable if ratios.iter().all(known) => {
            " Not comparable: the interval holds the limit."
        }
        Verdict::NotComparable => " Not comparable: a single set has no interval.",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_within_and_beyond_decide() {
        let ratio = |low: f64, high: f64| {
            let value = f64::midpoint(low, high);
            let interval = Some([low, high]);
            Some(Ratio { value, interval })
        };
        assert_eq!(alike(ratio(0.96, 1.04)), Verdict::Reproduced);
        assert_eq!(alike(ratio(0.5, 0.9)), Verdict::NotReproduced);
        assert_eq!(alike(ratio(1.06, 9.0)), Verdict::NotReproduced);
        assert_eq!(alike(ratio(0.5, 9.0)), Verdict::NotComparable);
        let far = ratio(2.0, 3.0);
        assert_eq!(clearly(&[far, far]), Verdict::Reproduced);
        assert_eq!(clearly(&[far, ratio(1.2, 3.0)]), Verdict::NotComparable);
        let near = ratio(1.0, 1.2);
        assert_eq!(clearly(&[near, None]), Verdict::NotReproduced);
    }
}
