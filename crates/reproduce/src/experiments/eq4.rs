//! Equation 4: which share of the plane and of the samples elimination and insertion touch, by the shortest edge of a
//! block. The sequential engine makes the sets, because it records what became of every sample.

mod shares;

use serde_json::json;
use tilescope_core::{Fate, Origin, R, Run, SampleGrid, covers_offset};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{ends, largest, seeded, slope, square};
use crate::outcome::{Claim, Outcome, Verdict};
use crate::sets::{Set, sequential};
use crate::study::{Settings, Study};
use crate::texts::{claim, text};
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
    let (sets, samples) = amounts(study.settings);
    let leaf = |leaf: f64| {
        let sets = study.sets(
            &format!("leaf-{leaf}"),
            &format!("leaf {leaf} r"),
            0..sets,
            |seed, control| measure(leaf, seed, samples, control),
        )?;
        Ok(LeafShares::sum(&sets))
    };
    let found: Vec<LeafShares> = LEAVES
        .into_iter()
        .map(leaf)
        .collect::<Result<_, ReproduceError>>()?;
    Ok(Outcome {
        claims: claims(&found),
        pictures: vec![shares::curves(&found)?],
        tables: vec![shares::shares(&found)],
        notes: vec![text("eq4/how", &json!({}))],
    })
}

fn measure(
    leaf: f64,
    seed: u64,
    samples: f64,
    control: &Control<'_>,
) -> Result<LeafShares, ReproduceError> {
    let run = sequential(&seeded(square(samples, leaf), seed), control)?;
    Set::of_run(&run).verified(&format!("leaf {leaf}, seed {seed}"), control)?;
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
    let near = conflicts(run);
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
fn conflicts(run: &Run) -> Vec<bool> {
    let tiled = |origin: &&Origin| matches!(origin, Origin::Tiled { .. });
    let points = &run.samples.points[..run.samples.origins.iter().take_while(tiled).count()];
    let mut grid = SampleGrid::with_capacity(run.domain, points.len());
    for (id, point) in (0..).zip(points) {
        grid.insert(id, *point);
    }
    let near = |(id, point): (u32, _)| {
        grid.any_near(point, R, |other| {
            other.id != id && covers_offset(other.offset.0, other.offset.1)
        })
    };
    (0..).zip(points.iter().copied()).map(near).collect()
}

/// Returns the exponent of the power law that fits values over leaves best, or NaN.
fn exponent(found: &[LeafShares], value: fn(&LeafShares) -> f64) -> f64 {
    slope(found.iter().map(|one| [one.leaf.ln(), value(one).ln()]))
}

fn claims(found: &[LeafShares]) -> Vec<Claim> {
    let Some(first) = found.iter().find(|one| one.leaf >= FROM) else {
        return Vec::new();
    };
    let bounded = found
        .iter()
        .all(|one| one.inserted_share() < one.predicted());
    vec![
        area(found, first),
        below(found),
        claim(
            "eq4/bounded",
            Verdict::of(bounded),
            &json!({
                "predicted": first.predicted(), "leaf": first.leaf, "inserted": first.inserted_share(),
            }),
        ),
        inverse(found),
    ]
}

/// The equation itself.
fn area(found: &[LeafShares], first: &LeafShares) -> Claim {
    let ratios =
        |share: fn(&LeafShares) -> f64| ends(found.iter().map(|one| share(one) / one.predicted()));
    let [least, most] = ratios(LeafShares::margin_share);
    let off = |one: &LeafShares| (one.margin_share() / one.mended() - 1.0).abs();
    let verdict = Verdict::of((1.0 - least).max(most - 1.0) <= CLOSE);
    claim(
        "eq4/area",
        verdict,
        &json!({
            "predicted": first.predicted(), "leaf": first.leaf, "margin": first.margin_share(),
            "ratios": [least, most], "overlap": first.overlap(), "plane": ratios(LeafShares::overlap),
            "close": CLOSE, "mended": largest(found.iter().map(off)),
        }),
    )
}

fn below(found: &[LeafShares]) -> Claim {
    let large = || found.iter().filter(|one| one.leaf >= FROM);
    let most = |share: fn(&LeafShares) -> f64| largest(large().map(share));
    let from = |share: fn(&LeafShares) -> f64| {
        let from = large().find(|one| share(one) < PAPER);
        from.map_or_else(|| "no N".to_owned(), |one| format!("N = {}", one.leaf))
    };
    let margin = most(LeafShares::margin_share);
    claim(
        "eq4/below",
        Verdict::of(margin < PAPER),
        &json!({
            "margin": margin, "margin_from": from(LeafShares::margin_share),
            "overlap": most(LeafShares::overlap), "overlap_from": from(LeafShares::overlap),
            "from": FROM, "limit": PAPER,
        }),
    )
}

fn inverse(found: &[LeafShares]) -> Claim {
    let [margin, inserted] =
        [LeafShares::margin_share, LeafShares::inserted_share].map(|share| exponent(found, share));
    let holds = |exponent: f64| (exponent + 1.0).abs() <= EXPONENT;
    claim(
        "eq4/inverse",
        Verdict::of(holds(margin) && holds(inserted)),
        &json!({
            "margin": margin, "inserted": inserted, "overlap": exponent(found, LeafShares::overlap),
            "predicted": exponent(found, LeafShares::predicted), "limit": EXPONENT,
            "leaves": [LEAVES[0], LEAVES[LEAVES.len() - 1]],
        }),
    )
}

#[cfg(test)]
mod tests;
