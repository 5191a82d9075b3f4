//! Rules by which a verdict follows from the interval of a measurement.

use crate::outcome::Verdict;

/// A rule on the position of an interval. An interval that holds a limit decides nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Between two limits; contradicted where it lies wholly outside.
    Within([f64; 2]),
    /// At a limit or above; contradicted where it lies wholly below.
    Above(f64),
    /// Not around zero; contradicted where it contains zero and reaches no further than this from its middle.
    NotZero(f64),
}

impl Rule {
    /// Returns the rule that an interval reaches no further than `limit` from `center`.
    pub const fn near(center: f64, limit: f64) -> Self {
        Self::Within([center - limit, center + limit])
    }

    /// Returns the verdict that follows from an interval, which is `None` if nothing was measured.
    pub fn verdict(self, interval: Option<[f64; 2]>) -> Verdict {
        let Some([low, high]) = interval else {
            return Verdict::NotComparable;
        };

        let (holds, contradicted) = match self {
            // The claim holds if the whole interval lies within the limits, and is contradicted if all of it lies outside.
            Self::Within([least, most]) => {
                (low >= least && high <= most, high < least || low > most)
            }
            Self::Above(least) => (low >= least, high < least),
            Self::NotZero(reach) => {
                // An interval around zero contradicts the claim only if it is narrow: a wide one may hold another value.
                let zero = (low..=high).contains(&0.0);
                (!zero, zero && 0.5 * (high - low) <= reach)
            }
        };

        match (holds, contradicted) {
            (true, _) => Verdict::Reproduced,
            (_, true) => Verdict::NotReproduced,
            // A limit lies inside the interval, or the interval is too wide to contradict anything.
            _ => Verdict::NotComparable,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_inside_and_outside_decide_and_those_around_a_limit_do_not() {
        let of = |rule: Rule, ends| rule.verdict(Some(ends));
        let near = Rule::near(1.0, 0.05);
        assert_eq!(of(near, [0.96, 1.04]), Verdict::Reproduced);
        assert_eq!(of(near, [0.5, 0.9]), Verdict::NotReproduced);
        assert_eq!(of(near, [1.06, 9.0]), Verdict::NotReproduced);
        assert_eq!(of(near, [0.5, 9.0]), Verdict::NotComparable);
        assert_eq!(near.verdict(None), Verdict::NotComparable);
        assert_eq!(of(Rule::Above(1.2), [1.2, 3.0]), Verdict::Reproduced);
        assert_eq!(of(Rule::Above(1.2), [1.0, 1.1]), Verdict::NotReproduced);
        assert_eq!(of(Rule::Above(1.2), [1.0, 1.3]), Verdict::NotComparable);
        assert_eq!(of(Rule::NotZero(0.02), [0.01, 0.05]), Verdict::Reproduced);
        assert_eq!(
            of(Rule::NotZero(0.02), [-0.01, 0.01]),
            Verdict::NotReproduced
        );
        assert_eq!(of(Rule::NotZero(0.02), [-0.1, 0.1]), Verdict::NotComparable);
    }
}
