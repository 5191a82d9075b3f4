//! Figure 12 and section 4.2: nine sets that were made independently of each other become one, with small losses near
//! the seams, so that a serial sampler becomes a parallel one. The pieces are reference sets;
//! `tilescope_core::combine` glues them.

mod picture;

use serde::{Deserialize, Serialize};
use tilescope_analysis::Report;
use tilescope_core::combine::{CombineOptions, Combined, combine};
use tilescope_core::{Boundary, Domain, R, reference_sample};

use crate::control::Control;
use crate::engines::{nine, nine_rects};
use crate::error::ReproduceError;
use crate::numbers::{count, number, percent};
use crate::outcome::{Claim, Outcome, Table, Verdict};
use crate::rates::timed;
use crate::sets::Set;
use crate::study::{Settings, Study};
use crate::table::table;

/// Losses up to this share of all samples count as minor.
const MINOR: f64 = 0.02;
/// Gluing may take this share of all the work, to be small.
const SMALL: f64 = 0.1;
/// Layouts of this side in radii and more say something about the cost.
const LARGE: f64 = 600.0;
/// Sides in radii of the layout that is drawn, whatever the settings.
const DRAWN: f64 = 150.0;

/// Sides in radii of the layouts.
fn sides(settings: &Settings) -> Vec<f64> {
    settings.pick(vec![DRAWN, 600.0, 1800.0], vec![DRAWN])
}

/// The results of one layout.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct LayoutResult {
    side: f64,
    /// Samples of the nine sets.
    before: usize,
    after: usize,
    /// Samples of the nine sets that are gone, and how far from the seam the deepest of them was, in radii.
    lost: usize,
    deepest: f64,
    inserted: usize,
    iterations: usize,
    /// Seconds to make a set of the whole domain on one thread, the nine sets on all, and to glue them.
    alone: f64,
    making: f64,
    gluing: f64,
    /// Threads that made and glued the nine.
    threads: usize,
    report: Report,
}

impl LayoutResult {
    fn lost_share(&self) -> f64 {
        self.lost as f64 / self.before as f64
    }

    fn overhead(&self) -> f64 {
        self.gluing / (self.making + self.gluing)
    }

    fn speedup(&self) -> f64 {
        self.alone / (self.making + self.gluing)
    }
}

pub fn units(settings: &Settings) -> usize {
    sides(settings).len()
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let seed = study.settings.seed;
    let found: Result<Vec<LayoutResult>, _> = sides(study.settings)
        .into_iter()
        .map(|side| {
            let what = format!("nine sets on {side} r");
            study.unit(&format!("side-{side}"), &what, |control| {
                measure(side, seed, control)
            })
        })
        .collect();
    let found = found?;
    let control = study.control("the picture");
    let domain = domain(DRAWN)?;
    let (glued, _) = glue(domain, seed, &control)?;
    Ok(Outcome {
        claims: claims(&found),
        pictures: picture::pictures(&glued, &nine_rects(&domain)),
        tables: vec![layouts(&found)],
        notes: vec![NOTE.to_owned()],
    })
}

const NOTE: &str = "Each of the nine sets is a periodic maximal set of a ninth of the domain, made by the reference \
sampler with a seed of its own; none of them knows its neighbours. Along the seams conflicts are eliminated and gaps are \
filled by the stages that KDRT uses between its blocks. The domain is periodic, so that its border is a seam as well.";

fn domain(side: f64) -> Result<Domain, ReproduceError> {
    Ok(Domain::from_size([side; 2], 1.0, Boundary::Periodic)?)
}

/// Makes and glues nine sets; returns the seconds that each took.
fn glue(
    domain: Domain,
    seed: u64,
    control: &Control<'_>,
) -> Result<(Glued, [f64; 2]), ReproduceError> {
    let (pieces, making) = timed(|| nine(domain, seed, control));
    let (pieces, options) = (pieces?, CombineOptions::default());
    let (combined, gluing) = timed(|| combine(domain, &pieces, &options, &mut control.observer()));
    let before = pieces.iter().map(|piece| piece.set.samples().len()).sum();
    let combined = combined?;
    Ok((Glued { combined, before }, [making, gluing]))
}

/// Nine sets in one.
struct Glued {
    combined: Combined,
    /// Samples of the nine.
    before: usize,
}

fn measure(side: f64, seed: u64, control: &Control<'_>) -> Result<LayoutResult, ReproduceError> {
    let domain = domain(side)?;
    control.go_on()?;
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.map_err(|error| ReproduceError::Engine(error.to_string()))?;
    let (whole, alone) =
        timed(|| one.install(|| reference_sample(domain, seed, &mut control.observer())));
    drop(whole?);
    let (Glued { combined, before }, [making, gluing]) = glue(domain, seed, control)?;
    let set = Set::of(&domain, &combined.points);
    let report = set.judge(control)?;
    let rects = nine_rects(&domain);
    let lost = combined.eliminated.iter().filter(|lost| lost.own);
    let depths = lost
        .clone()
        .map(|lost| rects[lost.piece as usize].depth(lost.point));
    let summary = combined.summary();
    Ok(LayoutResult {
        side,
        before,
        after: combined.points.len(),
        lost: lost.count(),
        deepest: f64::from(depths.max().unwrap_or(0)) / f64::from(R),
        inserted: summary.inserted.iter().sum(),
        iterations: summary.inserted.len(),
        alone,
        making,
        gluing,
        threads: rayon::current_num_threads(),
        report,
    })
}

fn claims(found: &[LayoutResult]) -> Vec<Claim> {
    let Some(largest) = found.last() else {
        return Vec::new();
    };
    vec![
        maximal(found, largest),
        losses(found, largest),
        cost(largest),
    ]
}

fn maximal(found: &[LayoutResult], largest: &LayoutResult) -> Claim {
    let faults = found
        .iter()
        .map(|one| one.report.conflicts + one.report.gaps)
        .sum();
    Claim::new(
        [
            "Independent maximal sets combine into one maximal set",
            "section 4.2, figure 12",
            "nine sets become one",
        ],
        format!(
            "nine sets become one of {} samples; {} in {}",
            count(largest.after as u64),
            match faults {
                0 => "neither conflict nor gap".to_owned(),
                1 => "1 conflict or gap".to_owned(),
                _ => format!("{} conflicts and gaps", count(faults)),
            },
            match found.len() {
                1 => "it".to_owned(),
                layouts => format!("{layouts} layouts"),
            }
        ),
        Verdict::of(faults == 0),
        "Reproduced if the verifier finds neither a conflict nor a gap in any layout.",
    )
}

fn losses(found: &[LayoutResult], largest: &LayoutResult) -> Claim {
    let worst = found
        .iter()
        .map(LayoutResult::lost_share)
        .fold(0.0, f64::max);
    let deepest = found.iter().map(|one| one.deepest).fold(0.0, f64::max);
    Claim::new(
        [
            "Only few samples are lost, near the seams",
            "figure 12, caption",
            "minor loss in the margins",
        ],
        format!(
            "{} of {} samples lost ({}; at most {} of any layout), none deeper than {} r",
            count(largest.lost as u64),
            count(largest.before as u64),
            percent(largest.lost_share(), 2),
            percent(worst, 2),
            number(deepest, 3),
        ),
        Verdict::of(largest.lost_share() <= MINOR && deepest <= 3.0),
        format!(
            "Reproduced if the largest layout loses at most {} % and nothing deeper than 3 r. The share falls with the \
             size of the sets, as their border does against their area.",
            100.0 * MINOR
        ),
    )
}

fn cost(largest: &LayoutResult) -> Claim {
    let threads = largest.threads;
    Claim::new(
        [
            "A serial sampler becomes a parallel one at little cost",
            "section 4.2",
            "very small overhead",
        ],
        format!(
            "{} times as fast on {threads} {}; gluing takes {} of the time",
            number(largest.speedup(), 3),
            if threads == 1 { "thread" } else { "threads" },
            percent(largest.overhead(), 2)
        ),
        Verdict::if_known(
            threads >= 2 && largest.side >= LARGE,
            largest.overhead() <= SMALL && largest.speedup() > 1.0,
        ),
        format!(
            "Reproduced if the largest layout is made faster on all threads than a set of its size on one, and gluing \
             takes at most {} % of that. That needs two threads, and a side of {LARGE} r: the seams of small sets are most \
             of their work.",
            100.0 * SMALL
        ),
    )
}

fn layouts(found: &[LayoutResult]) -> Table {
    table("layouts", "Nine sets in one", found)
        .column("side_r", "side, r", 4, |one| one.side)
        .column("samples_before", "samples of the nine", 9, |one| one.before)
        .column("samples_after", "samples combined", 9, |one| one.after)
        .column("lost", "lost", 6, |one| one.lost)
        .column("lost_percent", "lost, %", 3, |one| 100.0 * one.lost_share())
        .column("deepest_r", "deepest loss, r", 3, |one| one.deepest)
        .column("inserted", "inserted", 6, |one| one.inserted)
        .column("iterations", "iterations", 2, |one| one.iterations)
        .column("seconds_alone", "whole on one thread, s", 3, |one| {
            one.alone
        })
        .column("seconds_making", "nine on all threads, s", 3, |one| {
            one.making
        })
        .column("seconds_gluing", "gluing, s", 3, |one| one.gluing)
        .column("threads", "threads", 3, |one| one.threads)
        .column("speedup", "speed-up", 3, |one| one.speedup())
        .column("conflicts", "conflicts", 3, |one| one.report.conflicts)
        .column("gaps", "gaps", 3, |one| one.report.gaps)
        .column("min_distance_r", "min. distance, r", 6, |one| {
            one.report.min_distance
        })
        .column("covering_radius_r", "covering radius, r", 6, |one| {
            one.report.covering_radius
        })
        .shown()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::study::tests::quick_run;

    fn found() -> LayoutResult {
        LayoutResult {
            side: 1800.0,
            before: 2_000_000,
            after: 1_990_000,
            lost: 20_000,
            deepest: 1.9,
            inserted: 9000,
            iterations: 4,
            alone: 4.0,
            making: 2.0,
            gluing: 0.1,
            threads: 2,
            report: crate::rates::tests::report(),
        }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let holds = claims(&[found()]);
        assert_eq!(holds[1].verdict, Verdict::Reproduced);
        assert!(holds[0].ours.ends_with("neither conflict nor gap in it"));
        let mut open = found();
        open.report.gaps = 1;
        let refuted = &claims(&[open, found()])[0];
        assert_eq!(refuted.verdict, Verdict::NotReproduced);
        assert!(refuted.ours.ends_with("1 conflict or gap in 2 layouts"));
        let lossy = LayoutResult {
            lost: 60_000,
            ..found()
        };
        assert_eq!(claims(&[lossy])[1].verdict, Verdict::NotReproduced);
        let deep = LayoutResult {
            deepest: 3.5,
            ..found()
        };
        assert_eq!(claims(&[deep])[1].verdict, Verdict::NotReproduced);
        let single = LayoutResult {
            threads: 1,
            ..found()
        };
        assert_eq!(claims(&[single])[2].verdict, Verdict::NotComparable);
        let slow = LayoutResult {
            gluing: 1.0,
            ..found()
        };
        assert_ne!(claims(&[slow])[2].verdict, Verdict::Reproduced);
    }

    #[test]
    fn a_quick_run_has_the_units_it_said_and_loses_what_it_counts() {
        let outcome = quick_run(Experiment::Fig12, &Settings::default());
        assert_eq!(outcome.claims.len(), 3);
        assert_eq!(outcome.claims[0].verdict, Verdict::Reproduced);
        assert_eq!(outcome.tables[0].rows.len(), 1);
        assert_eq!(outcome.pictures.len(), 2);
    }
}
