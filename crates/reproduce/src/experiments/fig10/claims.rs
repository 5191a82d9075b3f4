//! What the paper says about quality, and the verdicts that follow from the errors.

use serde_json::{Value, json};
use tilescope_analysis::measures::Summary;

use super::looks::LOW;
use super::results::{DENSE, Ratio, SamplerResults};
use super::samplers::Sampler;
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};
use crate::rule::Rule;
use crate::texts::{claim, text};

/// Low frequencies are suppressed if they have at most this part of the power of independent samples.
pub const SUPPRESSED: f64 = 0.2;
/// Two samplers are alike if the ratio of their errors is 1 to within this part.
const ALIKE: f64 = 0.05;
/// One is clearly better than another if the other's error is larger by this factor at least, the root of 3/2. The error of independent
/// samples goes with the inverse root of their number: they would have to be half as many again.
const CLEARLY: f64 = 1.224_744_871_391_589;

/// Returns the claims about zone plates and the scene; none if random samples, the reference sampler or KDRT were not
/// measured.
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
        // BNOT (blue noise through optimal transport) is a sampler of the paper of which no set is made here.
        claim("fig10/bnot", Verdict::NotComparable, &json!({})),
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

/// Returns mean and deviation of errors.
fn spread(errors: Vec<f64>) -> Value {
    let both = |summary: Summary| [summary.mean, summary.deviation];
    let [mean, deviation] = Summary::of(errors).map_or([f64::NAN; 2], both);
    json!({ "mean": mean, "deviation": deviation })
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
fn undecided(verdict: Verdict, ratios: &[Option<Ratio>]) -> String {
    if verdict != Verdict::NotComparable {
        return String::new();
    }

    // If there are intervals and no verdict, one of them contains a limit. There is no interval where there was one
    // set.
    let has_interval = |ratio: &Option<Ratio>| ratio.is_some_and(|ratio| ratio.interval.is_some());
    let all_have = ratios.iter().all(has_interval);
    text(
        if all_have {
            "fig10/holds-limit"
        } else {
            "fig10/single"
        },
        &json!({}),
    )
}

fn suppressed(random: &SamplerResults, reference: &SamplerResults, kdrt: &SamplerResults) -> Claim {
    let lows = [random, reference, kdrt].map(|one| one.spectrum.low);
    let [low_random, low_reference, low_kdrt] = lows;
    // The worse of the two samplers decides.
    let verdict = Verdict::of(low_reference.max(low_kdrt) <= SUPPRESSED * low_random);
    let values = json!({
        "low": LOW, "kdrt": low_kdrt, "reference": low_reference, "random": low_random, "suppressed": SUPPRESSED,
    });
    claim("fig10/suppressed", verdict, &values)
}

fn plate_alike(reference: &SamplerResults, kdrt: &SamplerResults) -> Claim {
    let (ours, theirs) = (kdrt.plate_errors(), reference.plate_errors());
    let ratio = Ratio::of(&ours, &theirs);
    let verdict = alike(ratio);
    let values = json!({
        "sets": ours.len().min(theirs.len()), "kdrt": spread(ours), "reference": spread(theirs),
        "ratio": words(ratio), "alike": ALIKE, "undecided": undecided(verdict, &[ratio]),
    });
    claim("fig10/plate-alike", verdict, &values)
}

fn plate_better(
    random: &SamplerResults,
    reference: &SamplerResults,
    kdrt: &SamplerResults,
) -> Claim {
    let worse = random.plate_errors();
    let ratios = [kdrt, reference].map(|one| Ratio::of(&worse, &one.plate_errors()));
    let verdict = clearly(&ratios);
    let values = json!({
        "random": spread(worse)["mean"], "ratios": ratios.map(words), "clearly": CLEARLY,
        "undecided": undecided(verdict, &ratios),
    });
    claim("fig10/plate-better", verdict, &values)
}

/// Judges whether the errors of horizons by KDRT are like those by the reference sampler, neither larger nor smaller,
/// and whether both samplers are clearly better than random samples.
fn horizon_alike(
    random: &SamplerResults,
    reference: &SamplerResults,
    kdrt: &SamplerResults,
) -> Claim {
    // Likeness has to hold at all numbers of samples per pixel together. Superiority is judged at the largest number
    // alone: chosen, not measured.
    let ratio = Ratio::of(&kdrt.overall(), &reference.overall());
    let better = [kdrt, reference].map(|one| Ratio::of(&random.densest(), &one.densest()));
    let most_per_pixel = kdrt
        .horizons
        .last()
        .and_then(|sets| sets.first())
        .map_or(0, |one| one.per_pixel);
    // A claim of two parts: the two samplers are alike, and each is better than random samples.
    let verdict = Verdict::of_all([alike(ratio), clearly(&better)]);

    let values = json!({
        "ratio": words(ratio), "better": better.map(words), "alike": ALIKE, "clearly": CLEARLY,
        "per_pixel": most_per_pixel,
        "undecided": undecided(verdict, &[ratio, better[0], better[1]]),
    });
    claim("fig10/horizon-alike", verdict, &values)
}

/// Returns the claim about the paper's scene, which is not rendered. Instead it states the exponents by which the
/// errors of the horizon fall with the samples per pixel from [`DENSE`] on, where these exponents are known.
fn scene(all: &[SamplerResults]) -> Claim {
    let slope = |one: &SamplerResults| {
        Some(format!(
            "{} {}",
            one.sampler.name(),
            number(one.slope()?, 3)
        ))
    };
    let slopes: Vec<String> = all.iter().filter_map(slope).collect();

    let values = json!({ "dense": DENSE, "slopes": slopes.join(", ") });
    let exponents = if slopes.is_empty() {
        String::new()
    } else {
        text("fig10/exponents", &values)
    };
    claim(
        "fig10/scene",
        Verdict::NotComparable,
        &json!({ "exponents": exponents }),
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
