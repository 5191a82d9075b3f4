//! What the paper says about quality, and what was found of it. The rules of verdicts by intervals are in [`super::rules`].

use tilescope_analysis::measures::Summary;

use super::found::{DENSE, Found, Ratio, errors_of};
use super::looks::LOW;
use super::rules::{ALIKE, CLEARLY, alike, both, clearly, undecided};
use super::samplers::Sampler;
use crate::numbers::{count, number};
use crate::outcome::{Claim, Verdict};

/// Low frequencies are suppressed if they have at most this part of the power of independent samples.
pub const SUPPRESSED: f64 = 0.2;

/// Returns the claims.
pub fn claims(all: &[Found]) -> Vec<Claim> {
    let find = |sampler: Sampler| all.iter().find(|one| one.sampler == sampler);
    let (Some(random), Some(reference), Some(kdrt)) = (
        find(Sampler::Random),
        find(Sampler::Reference),
        find(Sampler::Kdrt),
    ) else {
        return Vec::new();
    };
    let mut claims = vec![
        suppressed(random, reference, kdrt),
        plate_alike(reference, kdrt),
        plate_better(random, reference, kdrt),
    ];
    let given: Vec<&Found> = (all.iter())
        .filter(|one| matches!(one.sampler, Sampler::Given(_)))
        .collect();
    claims.push(others(&given, kdrt));
    claims.push(horizon_alike(random, reference, kdrt));
    claims.push(scene(all));
    claims
}

fn percent(part: f64) -> String {
    format!("{} %", number(100.0 * part, 2))
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

fn suppressed(random: &Found, reference: &Found, kdrt: &Found) -> Claim {
    let lows = [random, reference, kdrt].map(|one| one.look.as_ref().map(|look| look.low));
    let (verdict, ours) = match lows {
        [Some(random), Some(reference), Some(kdrt)] => (
            Verdict::of(reference.max(kdrt) <= SUPPRESSED * random),
            format!(
                "mean power at \u{3bd} \u{2264} {LOW}: KDRT {}, reference {}, uniform random {}",
                number(kdrt, 3),
                number(reference, 3),
                number(random, 3)
            ),
        ),
        _ => (Verdict::NotComparable, "nothing".to_owned()),
    };
    Claim {
        claim: "Low frequencies of KDRT and of MPS are suppressed against uniform random samples"
            .to_owned(),
        place: "section 4.1.3, figure 10, row 2".to_owned(),
        paper: "suppressed power at low frequencies explains the advantage".to_owned(),
        ours,
        verdict,
        reason: format!(
            "Reproduced if the mean power of both at relative frequencies up to {LOW} is at most {} of that of uniform random \
             samples.",
            percent(SUPPRESSED)
        ),
    }
}

fn plate_alike(reference: &Found, kdrt: &Found) -> Claim {
    let (ours, theirs) = (kdrt.plate_errors(), reference.plate_errors());
    let ratio = Ratio::of(&ours, &theirs);
    let verdict = alike(ratio);
    Claim {
        claim: "KDRT renders the zone plate as well as MPS does".to_owned(),
        place: "section 4.1.3, figure 10, row 3".to_owned(),
        paper: "similar quality".to_owned(),
        ours: format!(
            "RMSE {} with KDRT, {} with the reference sampler: ratio {}; deviations between sets {} and {}",
            mean(&ours),
            mean(&theirs),
            words(ratio),
            deviation(&ours),
            deviation(&theirs)
        ),
        verdict,
        reason: format!(
            "Reproduced if the 95 % interval of the ratio of errors, from {} sets each, lies within {} of 1, not reproduced if it lies \
             beyond.{} The reference sampler is that of Ebeida et al. 2012.",
            ours.len().min(theirs.len()),
            percent(ALIKE),
            undecided(verdict, &[ratio])
        ),
    }
}

fn plate_better(random: &Found, reference: &Found, kdrt: &Found) -> Claim {
    let worse = random.plate_errors();
    let ratios = [kdrt, reference].map(|one| Ratio::of(&worse, &one.plate_errors()));
    let verdict = clearly(&ratios);
    Claim {
        claim: "Both render the zone plate clearly better than uniform random samples".to_owned(),
        place: "section 4.1.3, figure 10, row 3".to_owned(),
        paper: "visibly less noise".to_owned(),
        ours: format!(
            "RMSE {} with uniform random samples: {} times that of KDRT, {} times that of the reference sampler",
            mean(&worse),
            words(ratios[0]),
            words(ratios[1])
        ),
        verdict,
        reason: format!(
            "Reproduced if the 95 % intervals of both ratios lie above {}: independent samples would have to be half as many again; not \
             reproduced if one lies below.{} The paper shows pictures and gives no number.",
            number(CLEARLY, 3),
            undecided(verdict, &ratios)
        ),
    }
}

fn others(given: &[&Found], kdrt: &Found) -> Claim {
    let theirs = (given.iter())
        .filter(|one| !one.plates.is_empty() && is_bnot(&one.name))
        .filter_map(|one| Some(beside(one, kdrt)?.value));
    let worst = theirs.reduce(f64::max);
    let each: Vec<String> = given.iter().map(|one| other(one, kdrt)).collect();
    Claim {
        claim: "KDRT renders the zone plate about as well as BNOT does".to_owned(),
        place: "section 4.1.3, figure 10, row 3".to_owned(),
        paper: "similar quality".to_owned(),
        ours: if each.is_empty() {
            "no set of another method was given".to_owned()
        } else {
            each.join("; ")
        },
        verdict: worst.map_or(Verdict::NotComparable, no_worse),
        reason: format!(
            "BNOT (de Goes et al. 2012) is not part of this program; sets of it can be given as files with \"bnot\" in their names. \
             Reproduced if KDRT's error is at most {} larger than that of each, with as many samples. What a file holds only its maker \
             knows, and one set has no interval. Other files are compared without a verdict.",
            percent(ALIKE)
        ),
    }
}

/// Returns KDRT's error over that of a file, with as many samples.
fn beside(one: &Found, kdrt: &Found) -> Option<Ratio> {
    let beside = Some(&one.beside).filter(|plates| !plates.is_empty());
    let ours = errors_of(beside.unwrap_or(&kdrt.plates));
    Ratio::of(&ours, &one.plate_errors())
}

fn other(one: &Found, kdrt: &Found) -> String {
    let Some(first) = one.plates.first() else {
        return format!("{} has too few samples to render", one.name);
    };
    format!(
        "{}: RMSE {} with {} samples, KDRT's with as many is {} times that",
        one.name,
        mean(&one.plate_errors()),
        count(first.count as u64),
        words(beside(one, kdrt))
    )
}

fn no_worse(ratio: f64) -> Verdict {
    Verdict::of(ratio <= 1.0 + ALIKE)
}

/// Whether a file says that it holds samples of BNOT.
fn is_bnot(name: &str) -> bool {
    name.to_ascii_lowercase().contains("bnot")
}

fn horizon_alike(random: &Found, reference: &Found, kdrt: &Found) -> Claim {
    let ratio = Ratio::of(&kdrt.overall(), &reference.overall());
    let better = [kdrt, reference].map(|one| Ratio::of(&random.densest(), &one.densest()));
    let densest = kdrt.horizons.last().and_then(|sets| sets.first());
    let per_pixel = densest.map_or(0, |one| one.per_pixel);
    let verdict = both([alike(ratio), clearly(&better)]);
    Claim {
        claim: "A rendered scene is as free of aliasing and noise with KDRT as with MPS, and more so than with uniform random samples"
            .to_owned(),
        place: "section 4.1.3, figure 10, row 4".to_owned(),
        paper: "similar quality; uniform random samples are noisier".to_owned(),
        ours: format!(
            "horizon: KDRT's RMSE is {} times the reference sampler's; at {per_pixel} samples per pixel that of uniform random samples \
             is {} times KDRT's and {} times the reference sampler's",
            words(ratio),
            words(better[0]),
            words(better[1])
        ),
        verdict,
        reason: format!(
            "A checkerboard up to its horizon with a known integral over each pixel stands in for the paper's scene. Reproduced if the \
             95 % interval of the first ratio, a geometric mean over all numbers of samples, lies within {} of 1 and those of the \
             others above {}; not reproduced if one lies beyond its limit.{}",
            percent(ALIKE),
            number(CLEARLY, 3),
            undecided(verdict, &[ratio, better[0], better[1]])
        ),
    }
}

fn scene(all: &[Found]) -> Claim {
    let slope = |one: &Found| Some(format!("{} {}", one.name, number(one.slope()?, 3)));
    let slopes: Vec<String> = all.iter().filter_map(slope).collect();
    let exponents = if slopes.is_empty() {
        String::new()
    } else {
        let slopes = slopes.join(", ");
        format!("; exponents of the horizon's RMSE by samples per pixel, from {DENSE} on: {slopes}")
    };
    Claim {
        claim: "San Miguel, path traced with 200 million camera rays, looks alike with BNOT, MPS and KDRT".to_owned(),
        place: "figure 10, row 4".to_owned(),
        paper: "similar anti-aliasing and noise".to_owned(),
        ours: format!("not rendered{exponents}"),
        verdict: Verdict::NotComparable,
        reason: "The scene and its path tracer are not part of this program; the horizon stands in for them.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::found::tests::{found, plated};
    use super::*;

    fn made() -> Vec<Found> {
        vec![
            found(Sampler::Random, 0.2, 0.4, 1.0),
            found(Sampler::Reference, 0.08, 0.2, 0.06),
            found(Sampler::Kdrt, 0.081, 0.201, 0.07),
        ]
    }

    fn verdicts(all: &[Found]) -> Vec<Verdict> {
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
        let turned = |change: &dyn Fn(&mut [Found]), claim: usize| {
            let mut all = made();
            change(&mut all);
            assert_eq!(verdicts(&all)[claim], Verdict::NotReproduced, "{claim}");
        };
        turned(&|all| all[2].look.as_mut().unwrap().low = 0.3, 0);
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
        let undecided = |all: &[Found], claim: usize| {
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

    #[test]
    fn a_file_without_an_image_is_named() {
        let mut all = made();
        let mut file = found(Sampler::Given(0), 0.08, 0.2, 0.06);
        file.plates.clear();
        "few-bnot.csv".clone_into(&mut file.name);
        all.push(file);
        let claim = &claims(&all)[3];
        assert_eq!(claim.verdict, Verdict::NotComparable);
        assert_eq!(claim.ours, "few-bnot.csv has too few samples to render");
    }

    #[test]
    fn a_file_makes_the_comparison_with_others_and_can_fail_it() {
        let mut all = made();
        let mut file = found(Sampler::Given(0), 0.08, 0.2, 0.06);
        file.plates.truncate(1);
        all.push(file);
        assert_eq!(verdicts(&all)[3], Verdict::NotComparable);
        all[3].name = "a/BNOT-1.txt".to_owned();
        assert_eq!(verdicts(&all)[3], Verdict::Reproduced);
        assert!(
            claims(&all)[3]
                .ours
                .contains("a/BNOT-1.txt: RMSE 0.0800 with 1000 samples")
        );
        all[3].plates[0].rmse = 0.07;
        assert_eq!(verdicts(&all)[3], Verdict::NotReproduced);
        // As many samples of KDRT as the file has are what counts.
        all[3].beside = vec![plated(0.07, 0)];
        assert_eq!(verdicts(&all)[3], Verdict::Reproduced);
    }
}
