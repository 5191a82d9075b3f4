//! What the paper says about quality, and the verdicts that follow from the errors.

use tilescope_analysis::measures::Summary;

use super::looks::LOW;
use super::results::{DENSE, Ratio, SamplerResults};
use super::samplers::Sampler;
use crate::numbers::{number, percent};
use crate::outcome::{Claim, Verdict};
use crate::rule::Rule;

/// Low frequencies are suppressed if they have at most this part of the power of independent samples.
pub const SUPPRESSED: f64 = 0.2;
/// Two samplers are alike if the ratio of their errors is 1 to within this part.
const ALIKE: f64 = 0.05;
/// One is clearly better than another if the other's error is larger by this factor at least, the root of 3/2. The error of independent
/// samples goes with the inverse root of their number: they would have to be half as many again.
const CLEARLY: f64 = 1.224_744_871_391_589;

/// Returns the claims.
pub fn claims(all: &[SamplerResults]) -> Vec<Claim> {
    let find = |sampler: Sampler| all.iter().find(|one| one.sampler == sampler);
    let (Some(random), Some(reference), Some(kdrt)) = (
        find(Sampler::Random),
        find(Sampler::Reference),
        find(Sampler::Kdrt),
    ) else {
        return Vec::new();
    };
    vec![
        suppressed(random, reference, kdrt),
        plate_alike(reference, kdrt),
        plate_better(random, reference, kdrt),
        bnot(),
        horizon_alike(random, reference, kdrt),
        scene(all),
    ]
}

fn words(ratio: Option<Ratio>) -> String {
    let Some(ratio) = ratio else {
        return "nothing".to_owned();
    };
    let value = number(ratio.value, 4);
    match ratio.interval {
        None => value,
        Some([low, high]) => format!("{value} ({} to {})", number(low, 4), number(high, 4)),
    }
}

fn mean(errors: &[f64]) -> String {
    number(errors.iter().sum::<f64>() / errors.len() as f64, 3)
}

fn deviation(errors: &[f64]) -> String {
    let summary = Summary::of(errors.iter().copied());
    summary.map_or_else(String::new, |summary| number(summary.deviation, 2))
}

fn alike(ratio: Option<Ratio>) -> Verdict {
    Rule::near(1.0, ALIKE).verdict(ratio.and_then(|ratio| ratio.interval))
}

fn clearly(ratios: &[Option<Ratio>]) -> Verdict {
    let interval = |ratio: &Option<Ratio>| ratio.and_then(|ratio| ratio.interval);
    let each = ratios.iter().map(interval);
    Verdict::of_all(each.map(|interval| Rule::Above(CLEARLY).verdict(interval)))
}

/// Returns why there is no verdict; empty if there is one.
fn undecided(verdict: Verdict, ratios: &[Option<Ratio>]) -> &'static str {
    let known = |ratio: &Option<Ratio>| ratio.is_some_and(|ratio| ratio.interval.is_some());
    match verdict {
        Verdict::NotComparable if ratios.iter().all(known) => {
            " Not comparable: the interval holds the limit."
        }
        Verdict::NotComparable => " Not comparable: a single set has no interval.",
        _ => "",
    }
}

fn suppressed(random: &SamplerResults, reference: &SamplerResults, kdrt: &SamplerResults) -> Claim {
    let [random, reference, kdrt] = [random, reference, kdrt].map(|one| one.spectrum.low);
    Claim::new(
        [
            "Low frequencies of KDRT and of MPS are suppressed against uniform random samples",
            "section 4.1.3, figure 10, row 2",
            "suppressed power at low frequencies explains the advantage",
        ],
        format!(
            "mean power at \u{3bd} \u{2264} {LOW}: KDRT {}, reference {}, uniform random {}",
            number(kdrt, 3),
            number(reference, 3),
            number(random, 3)
        ),
        Verdict::of(reference.max(kdrt) <= SUPPRESSED * random),
        format!(
            "Reproduced if the mean power of both at relative frequencies up to {LOW} is at most {} of that of uniform random \
             samples.",
            percent(SUPPRESSED, 2)
        ),
    )
}

fn plate_alike(reference: &SamplerResults, kdrt: &SamplerResults) -> Claim {
    let (ours, theirs) = (kdrt.plate_errors(), reference.plate_errors());
    let ratio = Ratio::of(&ours, &theirs);
    let verdict = alike(ratio);
    Claim::new(
        [
            "KDRT renders the zone plate as well as MPS does",
            "section 4.1.3, figure 10, row 3",
            "similar quality",
        ],
        format!(
            "RMSE {} with KDRT, {} with the reference sampler: ratio {}; deviations between sets {} and {}",
            mean(&ours),
            mean(&theirs),
            words(ratio),
            deviation(&ours),
            deviation(&theirs)
        ),
        verdict,
        format!(
            "Reproduced if the 95 % interval of the ratio of errors, from {} sets each, lies within {} of 1, not reproduced if it lies \
             beyond.{} The reference sampler is that of Ebeida et al. 2012.",
            ours.len().min(theirs.len()),
            percent(ALIKE, 2),
            undecided(verdict, &[ratio])
        ),
    )
}

fn plate_better(
    random: &SamplerResults,
    reference: &SamplerResults,
    kdrt: &SamplerResults,
) -> Claim {
    let worse = random.plate_errors();
    let ratios = [kdrt, reference].map(|one| Ratio::of(&worse, &one.plate_errors()));
    let verdict = clearly(&ratios);
    Claim::new(
        [
            "Both render the zone plate clearly better than uniform random samples",
            "section 4.1.3, figure 10, row 3",
            "visibly less noise",
        ],
        format!(
            "RMSE {} with uniform random samples: {} times that of KDRT, {} times that of the reference sampler",
            mean(&worse),
            words(ratios[0]),
            words(ratios[1])
        ),
        verdict,
        format!(
            "Reproduced if the 95 % intervals of both ratios lie above {}: independent samples would have to be half as many again; not \
             reproduced if one lies below.{} The paper shows pictures and gives no number.",
            number(CLEARLY, 3),
            undecided(verdict, &ratios)
        ),
    )
}

fn bnot() -> Claim {
    Claim::new(
        [
            "KDRT renders the zone plate about as well as BNOT does",
            "section 4.1.3, figure 10, row 3",
            "similar quality",
        ],
        "not rendered: no set of BNOT is made here".to_owned(),
        Verdict::NotComparable,
        "BNOT (de Goes et al. 2012) is not part of this program. tilescope analyze compares the spectrum and the distances of a file \
         with those of other sets: tilescope analyze bnot.txt --against kdrt-*.npy.",
    )
}

fn horizon_alike(
    random: &SamplerResults,
    reference: &SamplerResults,
    kdrt: &SamplerResults,
) -> Claim {
    let ratio = Ratio::of(&kdrt.overall(), &reference.overall());
    let better = [kdrt, reference].map(|one| Ratio::of(&random.densest(), &one.densest()));
    let densest = kdrt.horizons.last().and_then(|sets| sets.first());
    let per_pixel = densest.map_or(0, |one| one.per_pixel);
    let verdict = Verdict::of_all([alike(ratio), clearly(&better)]);
    Claim::new(
        [
            "A rendered scene is as free of aliasing and noise with KDRT as with MPS, and more so than with uniform random samples",
            "section 4.1.3, figure 10, row 4",
            "similar quality; uniform random samples are noisier",
        ],
        format!(
            "horizon: KDRT's RMSE is {} times the reference sampler's; at {per_pixel} samples per pixel that of uniform random samples \
             is {} times KDRT's and {} times the reference sampler's",
            words(ratio),
            words(better[0]),
            words(better[1])
        ),
        verdict,
        format!(
            "A checkerboard up to its horizon with a known integral over each pixel stands in for the paper's scene. Reproduced if the \
             95 % interval of the first ratio, a geometric mean over all numbers of samples, lies within {} of 1 and those of the \
             others above {}; not reproduced if one lies beyond its limit.{}",
            percent(ALIKE, 2),
            number(CLEARLY, 3),
            undecided(verdict, &[ratio, better[0], better[1]])
        ),
    )
}

fn scene(all: &[SamplerResults]) -> Claim {
    let slope = |one: &SamplerResults| {
        Some(format!(
            "{} {}",
            one.sampler.name(),
            number(one.slope()?, 3)
        ))
    };
    let slopes: Vec<String> = all.iter().filter_map(slope).collect();
    let exponents = if slopes.is_empty() {
        String::new()
    } else {
        let slopes = slopes.join(", ");
        format!("; exponents of the horizon's RMSE by samples per pixel, from {DENSE} on: {slopes}")
    };
    Claim::new(
        [
            "San Miguel, path traced with 200 million camera rays, looks alike with BNOT, MPS and KDRT",
            "figure 10, row 4",
            "similar anti-aliasing and noise",
        ],
        format!("not rendered{exponents}"),
        Verdict::NotComparable,
        "The scene and its path tracer are not part of this program; the horizon stands in for them.",
    )
}

#[cfg(test)]
mod tests {
    use super::super::results::tests::found;
    use super::*;

    fn made() -> Vec<SamplerResults> {
        vec![
            found(Sampler::Random, 0.2, 0.4, 1.0),
            found(Sampler::Reference, 0.08, 0.2, 0.06),
            found(Sampler::Kdrt, 0.081, 0.201, 0.07),
        ]
    }

    fn verdicts(all: &[SamplerResults]) -> Vec<Verdict> {
        claims(all).iter().map(|claim| claim.verdict).collect()
    }

    #[test]
    fn what_the_paper_says_is_reproduced_by_numbers_like_these() {
        use Verdict::{NotComparable, Reproduced};
        let expected = [
            Reproduced,
            Reproduced,
            Reproduced,
            NotComparable,
            Reproduced,
            NotComparable,
        ];
        assert_eq!(verdicts(&made()), expected);
    }

    /// Each change contradicts one claim and leaves the verdicts of the others before it.
    #[test]
    fn each_verdict_turns_with_its_number() {
        let turned = |change: &dyn Fn(&mut [SamplerResults]), claim: usize| {
            let mut all = made();
            change(&mut all);
            assert_eq!(verdicts(&all)[claim], Verdict::NotReproduced, "{claim}");
        };
        turned(&|all| all[2].spectrum.low = 0.3, 0);
        turned(
            &|all| all[2].plates = found(Sampler::Kdrt, 0.09, 1.0, 1.0).plates,
            1,
        );
        turned(
            &|all| all[2].plates = found(Sampler::Kdrt, 0.07, 1.0, 1.0).plates,
            1,
        );
        turned(
            &|all| all[0].plates = found(Sampler::Kdrt, 0.09, 1.0, 1.0).plates,
            2,
        );
        turned(
            &|all| all[2].horizons = found(Sampler::Kdrt, 1.0, 0.22, 1.0).horizons,
            4,
        );
        turned(
            &|all| all[0].horizons = found(Sampler::Kdrt, 1.0, 0.24, 1.0).horizons,
            4,
        );
    }

    #[test]
    fn an_interval_that_holds_a_limit_decides_nothing() {
        let undecided = |all: &[SamplerResults], claim: usize| {
            let claim = &claims(all)[claim];
            assert_eq!(claim.verdict, Verdict::NotComparable, "{}", claim.ours);
            assert!(claim.reason.contains("the interval holds the limit"));
        };
        let mut all = made();
        all[2].plates[0].rmse = 0.05;
        all[2].plates[1].rmse = 0.12;
        undecided(&all, 1);
        let mut all = made();
        all[2].plates = found(Sampler::Kdrt, 0.08 * (1.0 + ALIKE), 1.0, 1.0).plates;
        undecided(&all, 1);
        all[2].plates = found(Sampler::Kdrt, 0.08 * (1.0 - ALIKE), 1.0, 1.0).plates;
        undecided(&all, 1);
        all[2].plates = found(Sampler::Kdrt, 0.2 / CLEARLY, 1.0, 1.0).plates;
        undecided(&all, 2);
        all[2].horizons = found(Sampler::Kdrt, 1.0, 0.2 * (1.0 + ALIKE), 1.0).horizons;
        undecided(&all, 4);
        // One part that is contradicted contradicts the whole.
        all[0].horizons = found(Sampler::Random, 1.0, 0.2, 1.0).horizons;
        assert_eq!(verdicts(&all)[4], Verdict::NotReproduced);
    }

    #[test]
    fn single_sets_are_not_comparable() {
        let mut all = made();
        all[2].plates.truncate(1);
        assert_eq!(verdicts(&all)[1], Verdict::NotComparable);
        assert_eq!(verdicts(&all)[2], Verdict::NotComparable);
        assert!(claims(&all)[1].reason.contains("has no interval"));
    }
}
