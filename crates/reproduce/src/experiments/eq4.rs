//! Equation 4: which share of the plane and of the samples elimination and insertion touch, by the shortest edge of a
//! block. The sequential engine makes the sets, because it records what became of every sample.

mod shares;

use rayon::prelude::*;
use tilescope_core::{Domain, Fate, Origin, R, Run, SampleGrid, Sequential, covers_offset};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{ends, seed, seeded, slope, square};
use crate::numbers::number;
use crate::outcome::{Claim, Outcome, Verdict};
use crate::sets::{Set, pattern};
use crate::study::{Settings, Study};
use shares::LeafShares;

/// Shortest edges of blocks, in radii.
const LEAVES: [f64; 9] = [6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 80.0];
/// Measured and predicted may differ by this share of what is predicted.
const CLOSE: f64 = 0.2;
/// The paper's bound for leaves from `FROM` on.
const PAPER: f64 = 0.1;
const FROM: f64 = 20.0;
/// The largest distance of an exponent from that of an inverse.
const EXPONENT: f64 = 0.15;

/// Sets of each leaf, and the samples of each.
fn amounts(settings: &Settings) -> (usize, f64) {
    settings.pick((8, 200_000.0), (2, 50_000.0))
}

pub const fn units() -> usize {
    LEAVES.len()
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let settings = study.settings;
    let mut found = Vec::new();
    for leaf in LEAVES {
        let (key, what) = (format!("leaf-{leaf}"), format!("leaf {leaf} r"));
        let sets: Vec<LeafShares> = study.unit(&key, &what, |control| {
            (0..amounts(settings).0)
                .into_par_iter()
                .map(|index| measure(leaf, index, settings, control))
                .collect()
        })?;
        found.push(LeafShares::sum(&sets));
    }
    Ok(Outcome {
        claims: claims(&found),
        pictures: vec![shares::curves(&found)?],
        tables: vec![shares::shares(&found)],
        notes: vec![NOTE.to_owned()],
    })
}

const NOTE: &str = "Equation 4 is a share of a clip, and is compared with the share of the clips that lies beyond their blocks. Beside it \
stands the share of the plane where the clips of several blocks overlap: there, and nowhere else, samples can be in conflict. The \
other shares say what becomes of it: tiled samples that have another one within r, tiled \
samples that lie in the margin of their own clip, samples lost and samples inserted. A block's edges lie between N and 2 N, so that \
the mean edge is longer than N; and a clip reaches r beyond its block on each side, which the proof of theorem 3.1 needs, where \
equation 4 adds r to an edge, not 2 r. Every set has a seed and a pattern of its own.";

fn measure(
    leaf: f64,
    index: usize,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<LeafShares, ReproduceError> {
    let parameters = seeded(square(amounts(settings).1, leaf), seed(settings, index));
    let engine = Sequential::new(&parameters, pattern(&parameters.pattern, control)?)?;
    let run = engine.finish(&mut control.observer())?;
    let set = Set::of(&run.domain, &run.points());
    set.verified(&format!("leaf {leaf}, set {index}"), control)?;
    Ok(counts(leaf, &run))
}

/// Counts what equation 4 is about.
fn counts(leaf: f64, run: &Run) -> LeafShares {
    let mut found = LeafShares {
        leaf,
        count: run.result.len(),
        area: run.domain.area_radii(),
        inserted: run.summary().inserted.iter().sum(),
        ..LeafShares::default()
    };
    for block in &run.blocks.leaves {
        let [width, height] =
            [block.rect.width(), block.rect.height()].map(|x| f64::from(x) / f64::from(R));
        found.blocks += 1;
        found.edges += width + height;
        found.clipped += (width + 2.0) * (height + 2.0);
        found.alone += (width - 2.0) * (height - 2.0);
    }
    let near = conflicts(&run.domain, run);
    let samples = run.samples.origins.iter().zip(&run.samples.fates);
    for ((origin, fate), in_conflict) in samples.zip(near) {
        if let Origin::Tiled { own, .. } = origin {
            found.tiled += 1;
            found.margin += usize::from(!own);
            found.in_conflict += usize::from(in_conflict);
            let lost = matches!(fate, Fate::Eliminated { .. });
            found.eliminated += usize::from(lost);
            found.lost += usize::from(lost && *own);
        }
    }
    found
}

/// Returns for each tiled sample whether another one is within r.
fn conflicts(domain: &Domain, run: &Run) -> Vec<bool> {
    let tiled = run
        .samples
        .origins
        .iter()
        .take_while(|origin| matches!(origin, Origin::Tiled { .. }));
    let points = &run.samples.points[..tiled.count()];
    let mut grid = SampleGrid::with_capacity(*domain, points.len());
    for (id, point) in (0..).zip(points) {
        grid.insert(id, *point);
    }
    let near = |(id, point): (u32, _)| {
        grid.any_near(point, R, |other| {
            other.id != id && covers_offset(other.offset)
        })
    };
    (0..).zip(points.iter().copied()).map(near).collect()
}

/// Returns the exponent of the power law that fits values over leaves best, or NaN.
fn exponent(found: &[LeafShares], value: fn(&LeafShares) -> f64) -> f64 {
    slope(found.iter().map(|one| [one.leaf.ln(), value(one).ln()]))
}

fn percent(share: f64) -> String {
    crate::numbers::percent(share, 3)
}

fn claim(claim: &str, paper: &str, ours: String, holds: bool, reason: String) -> Claim {
    let names = [claim, "section 5.1, equation 4", paper];
    Claim::new(names, ours, Verdict::of(holds), reason)
}

fn claims(found: &[LeafShares]) -> Vec<Claim> {
    let Some(first) = found.iter().find(|one| one.leaf >= FROM) else {
        return Vec::new();
    };
    vec![
        area(found, first),
        below(found),
        bounded(found, first),
        inverse(found),
    ]
}

/// The equation itself.
fn area(found: &[LeafShares], first: &LeafShares) -> Claim {
    let ratios =
        |share: fn(&LeafShares) -> f64| ends(found.iter().map(|one| share(one) / one.predicted()));
    let [least, most] = ratios(LeafShares::margin_share);
    let plane = ratios(LeafShares::overlap);
    let mended = (found.iter())
        .map(|one| (one.margin_share() / one.mended() - 1.0).abs())
        .fold(0.0, f64::max);
    claim(
        "Elimination and insertion happen on (2N + 1) / (N + 1)^2 of a clip",
        &format!("{} at N = {}", percent(first.predicted()), first.leaf),
        format!(
            "{} of the clips lies beyond their blocks at N = {}, {} to {} times what is predicted for all N; beside it, clips \
             overlap on {} of the plane, {} to {} times",
            percent(first.margin_share()),
            first.leaf,
            number(least, 3),
            number(most, 3),
            percent(first.overlap()),
            number(plane[0], 3),
            number(plane[1], 3)
        ),
        (1.0 - least).max(most - 1.0) <= CLOSE,
        format!(
            "Reproduced if the share of the clips beyond their blocks, like for like, is within {} of the prediction at every N. \
             The equation adds r to an edge where clips need 2 r, and takes the shortest edge for all; with 2 r and the mean edge \
             that share is predicted to within {}.",
            percent(CLOSE),
            percent(mended)
        ),
    )
}

fn below(found: &[LeafShares]) -> Claim {
    let large = || found.iter().filter(|one| one.leaf >= FROM);
    let most = |share: fn(&LeafShares) -> f64| large().map(share).fold(0.0, f64::max);
    let from = |share: fn(&LeafShares) -> f64| {
        let from = large().find(|one| share(one) < PAPER);
        from.map_or_else(|| "no N".to_owned(), |one| format!("N = {}", one.leaf))
    };
    let [margin, overlap] = [most(LeafShares::margin_share), most(LeafShares::overlap)];
    claim(
        "The affected share is below 10 % for N above 19",
        "below 10 %",
        format!(
            "up to {} of the clips lies beyond their blocks from N = {FROM} on, below {limit} from {} on; beside it, clips overlap on \
             up to {} of the plane, below {limit} from {} on",
            percent(margin),
            from(LeafShares::margin_share),
            percent(overlap),
            from(LeafShares::overlap),
            limit = percent(PAPER)
        ),
        margin < PAPER,
        format!(
            "Reproduced if less than {} of the clips lies beyond their blocks at every measured N from {FROM} on.",
            percent(PAPER)
        ),
    )
}

fn bounded(found: &[LeafShares], first: &LeafShares) -> Claim {
    let bound = |one: &LeafShares| one.inserted_share() < one.predicted();
    claim(
        "The samples that introduce bias are bounded by equation 4",
        &format!("{} at N = {}", percent(first.predicted()), first.leaf),
        format!(
            "{} of the samples were inserted at N = {}",
            percent(first.inserted_share()),
            first.leaf
        ),
        found.iter().all(bound),
        "Reproduced if at every N the share of inserted samples is below the equation's."
            .to_owned(),
    )
}

fn inverse(found: &[LeafShares]) -> Claim {
    let exponents = [
        exponent(found, LeafShares::margin_share),
        exponent(found, LeafShares::inserted_share),
    ];
    let holds = |exponent: f64| (exponent + 1.0).abs() <= EXPONENT;
    claim(
        "The affected share is inversely proportional to N",
        "exponent \u{2212}1",
        format!(
            "exponents {} (share of the clips beyond their blocks) and {} (inserted samples); beside them {} (overlap of the \
             plane); the equation's own is {}",
            number(exponents[0], 3),
            number(exponents[1], 3),
            number(exponent(found, LeafShares::overlap), 3),
            number(exponent(found, LeafShares::predicted), 3)
        ),
        exponents.into_iter().all(holds),
        format!(
            "Reproduced if the first two exponents, of the best power laws over N = {} to {}, are within {EXPONENT} of \u{2212}1.",
            LEAVES[0],
            LEAVES[LEAVES.len() - 1]
        ),
    )
}

#[cfg(test)]
mod tests;
