//! Equation 4: which share of the plane and of the samples elimination and insertion touch, by the shortest edge of a
//! block. The sequential engine makes the sets, because it records what became of every sample.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_core::{Fate, Origin, R, Run, SampleGrid, covers_offset};
use tilescope_figures::chart::{Panel, Series};

use crate::control::Control;
use crate::error::Result;
use crate::experiments::common::{curve, ends, largest, picture, reference, seeded, slope, square};
use crate::outcome::{Claim, Outcome, Picture, Table, Verdict};
use crate::sets::{Set, sequential};
use crate::study::{Settings, Study};
use crate::texts::{chart, claim, table, text};

/// Shortest edges of blocks, in radii.
const LEAVES: [f64; 9] = [6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 80.0];
/// Measured and predicted shares may differ by this part of the predicted one.
const CLOSE: f64 = 0.2;
/// The paper's bound for leaves from `FROM` on.
const PAPER: f64 = 0.1;
const FROM: f64 = 20.0;
/// The largest distance of an exponent from that of an inverse. Chosen, not measured.
const EXPONENT: f64 = 0.15;

/// Sets of each leaf, and the samples of each.
fn amounts(settings: &Settings) -> (usize, f64) {
    settings.pick((8, 200_000.0), (2, 30_000.0))
}

/// A unit for each leaf.
pub const UNITS: usize = LEAVES.len();

/// Measures the sets of each leaf size, and compares them with the formula.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let (sets, samples) = amounts(study.settings);
    let mut found = Vec::new();
    for leaf in LEAVES {
        let (key, what) = (format!("leaf-{leaf}"), format!("leaf {leaf} r"));
        let measured = study.sets(&key, &what, 0..sets, |seed, control| {
            measure(leaf, seed, samples, control)
        })?;
        found.push(LeafShares::sum(&measured));
    }

    Ok(Outcome {
        claims: claims(&found),
        pictures: vec![curves(&found)?],
        tables: vec![shares(&found)],
        notes: vec![text("eq4/how", &json!({}))],
    })
}

fn measure(leaf: f64, seed: u64, samples: f64, control: &Control<'_>) -> Result<LeafShares> {
    let run = sequential(&seeded(square(samples, leaf), seed), control)?;
    Set::of_run(&run).verified(&format!("leaf {leaf}, seed {seed}"), control)?;
    Ok(counts(leaf, &run))
}

/// Returns the counts of a set that equation 4 is about, and its lengths and areas, in r and r^2.
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
        // A clip reaches r beyond its block on each side, as the proof of theorem 3.1 needs.
        found.clipped += (width + 2.0) * (height + 2.0);
        // The clips of neighbours reach r into the block from each side; only the rest belongs to one clip alone.
        found.alone += (width - 2.0) * (height - 2.0);
    }

    // There is a value for each tiled sample. Tiled samples come first, so that the loop ends with the last of them.
    let are_in_conflict = conflicts(run);
    let samples = run.samples.origins.iter().zip(&run.samples.fates);
    for ((origin, fate), in_conflict) in samples.zip(are_in_conflict) {
        if let Origin::Tiled { own, .. } = origin {
            found.tiled += 1;
            found.margin += usize::from(!own);
            found.in_conflict += usize::from(in_conflict);
            let lost = matches!(fate, Fate::Eliminated { .. });
            found.eliminated += usize::from(lost);
            // A sample eliminated in the margin of its clip is no loss there, as the place belongs to another block.
            found.lost += usize::from(lost && *own);
        }
    }

    found
}

/// Returns for each tiled sample whether another one is within r.
fn conflicts(run: &Run) -> Vec<bool> {
    // Tiled samples come first, in the order of their ids.
    let tiled = |origin: &&Origin| matches!(origin, Origin::Tiled { .. });
    let points = &run.samples.points[..run.samples.origins.iter().take_while(tiled).count()];
    let mut grid = SampleGrid::with_capacity(run.domain, points.len());
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

/// Returns the claims about the shares; none if no leaf of the paper's bound was measured.
fn claims(found: &[LeafShares]) -> Vec<Claim> {
    // The smallest leaf of the paper's bound is the one that the claims name.
    let Some(first) = found.iter().find(|one| one.leaf >= FROM) else {
        return Vec::new();
    };

    // The formula is held against every leaf, the smaller ones included; the text has the numbers of `first`.
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

/// Returns the claim of the equation itself.
fn area(found: &[LeafShares], first: &LeafShares) -> Claim {
    let ratios =
        |share: fn(&LeafShares) -> f64| ends(found.iter().map(|one| share(one) / one.predicted()));
    let [least, most] = ratios(LeafShares::margin_share);
    let off = |one: &LeafShares| (one.margin_share() / one.mended() - 1.0).abs();
    let verdict = Verdict::of((1.0 - least).max(most - 1.0) <= CLOSE);
    let values = json!({
        "predicted": first.predicted(), "leaf": first.leaf, "margin": first.margin_share(),
        "ratios": [least, most], "overlap": first.overlap(), "plane": ratios(LeafShares::overlap),
        "close": CLOSE, "mended": largest(found.iter().map(off)),
    });
    claim("eq4/area", verdict, &values)
}

/// Judges whether the share of the margin is below the paper's bound. The share of the overlap is only reported.
fn below(found: &[LeafShares]) -> Claim {
    // The paper's bound is for leaves from `FROM` on alone.
    let large = || found.iter().filter(|one| one.leaf >= FROM);
    let most = |share: fn(&LeafShares) -> f64| largest(large().map(share));

    let first_below = |share: fn(&LeafShares) -> f64| {
        let first = large().find(|one| share(one) < PAPER);
        first.map_or_else(|| "no N".to_owned(), |one| format!("N = {}", one.leaf))
    };

    let margin = most(LeafShares::margin_share);
    let values = json!({
        "margin": margin, "margin_from": first_below(LeafShares::margin_share),
        "overlap": most(LeafShares::overlap), "overlap_from": first_below(LeafShares::overlap),
        "from": FROM, "limit": PAPER,
    });
    claim("eq4/below", Verdict::of(margin < PAPER), &values)
}

/// Judges whether the shares of the margin and of inserted samples go as the inverse of the leaf. The exponents of the overlap
/// and of the formula are only reported.
fn inverse(found: &[LeafShares]) -> Claim {
    let [margin, inserted] =
        [LeafShares::margin_share, LeafShares::inserted_share].map(|share| exponent(found, share));
    // An inverse is a power law with the exponent -1.
    let holds = |exponent: f64| (exponent + 1.0).abs() <= EXPONENT;

    let values = json!({
        "margin": margin, "inserted": inserted, "overlap": exponent(found, LeafShares::overlap),
        "predicted": exponent(found, LeafShares::predicted), "limit": EXPONENT,
        "leaves": [LEAVES[0], LEAVES[LEAVES.len() - 1]],
    });
    claim(
        "eq4/inverse",
        Verdict::of(holds(margin) && holds(inserted)),
        &values,
    )
}

/// Counts and areas (in squared radii) of one set or of several.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct LeafShares {
    leaf: f64,
    count: usize,
    inserted: usize,
    /// Area of the domain.
    area: f64,
    blocks: usize,
    /// Sum of the widths and heights of all blocks, in radii.
    edges: f64,
    /// Area of all clips.
    clipped: f64,
    /// Area that a single clip reaches.
    alone: f64,
    tiled: usize,
    /// Tiled samples outside their own block.
    margin: usize,
    in_conflict: usize,
    eliminated: usize,
    /// Eliminated samples of their own block.
    lost: usize,
}

impl LeafShares {
    /// Returns the sum over sets of one leaf.
    fn sum(sets: &[Self]) -> Self {
        let sum = |mut all: Self, one: &Self| {
            // Counts are added up, so that every sample weighs the same in the shares.
            all.leaf = one.leaf;
            all.count += one.count;
            all.inserted += one.inserted;
            all.area += one.area;
            all.blocks += one.blocks;
            all.edges += one.edges;
            all.clipped += one.clipped;
            all.alone += one.alone;
            all.tiled += one.tiled;
            all.margin += one.margin;
            all.in_conflict += one.in_conflict;
            all.eliminated += one.eliminated;
            all.lost += one.lost;
            all
        };
        sets.iter().fold(Self::default(), sum)
    }

    /// Returns the share by equation 4.
    fn predicted(&self) -> f64 {
        (2.0 * self.leaf + 1.0) / (self.leaf + 1.0).powi(2)
    }

    fn mean_edge(&self) -> f64 {
        self.edges / (2.0 * self.blocks as f64)
    }

    /// Equation 4 with the mean edge, and r on each side of it.
    fn mended(&self) -> f64 {
        let edge = self.mean_edge();
        1.0 - (edge / (edge + 2.0)).powi(2)
    }

    /// The share of the plane that several clips reach.
    fn overlap(&self) -> f64 {
        1.0 - self.alone / self.area
    }

    /// The share of clips that lies beyond their blocks.
    fn margin_share(&self) -> f64 {
        1.0 - self.area / self.clipped
    }

    /// The share of tiled samples that lie in the margin of their own clip.
    fn margin_samples(&self) -> f64 {
        self.margin as f64 / self.tiled as f64
    }

    fn conflict_share(&self) -> f64 {
        self.in_conflict as f64 / self.tiled as f64
    }

    /// The share of the result that was inserted.
    fn inserted_share(&self) -> f64 {
        self.inserted as f64 / self.count as f64
    }

    /// The share of all samples that ever were that were eliminated or inserted.
    fn touched(&self) -> f64 {
        (self.eliminated + self.inserted) as f64 / (self.tiled + self.inserted) as f64
    }

    /// The share of samples of their own block that were lost.
    fn lost_share(&self) -> f64 {
        self.lost as f64 / (self.tiled - self.margin) as f64
    }
}

/// A measured share: its name in the chart, and the function that returns it.
type Share = (&'static str, fn(&LeafShares) -> f64);

const SHARES: [Share; 6] = [
    ("clips beyond their blocks", LeafShares::margin_share),
    ("plane where clips overlap", LeafShares::overlap),
    ("tiled samples in conflict", LeafShares::conflict_share),
    ("samples eliminated or inserted", LeafShares::touched),
    ("samples lost of their own block", LeafShares::lost_share),
    ("result that was inserted", LeafShares::inserted_share),
];

/// Returns two charts by leaf: all shares, and each share times the leaf.
fn curves(found: &[LeafShares]) -> Result<Picture> {
    let points_of = |value: &dyn Fn(&LeafShares) -> f64| {
        found.iter().map(|one| [one.leaf, value(one)]).collect()
    };

    let all_series = |scale: &dyn Fn(&LeafShares) -> f64| -> Vec<Series> {
        let predicted = |one: &LeafShares| one.predicted() * scale(one);
        let mut series = vec![reference("equation 4", points_of(&predicted))];
        for (number, (name, share)) in SHARES.iter().enumerate() {
            series.push(curve(
                name,
                number,
                points_of(&|one| share(one) * scale(one)),
            ));
        }
        series
    };

    let percent = 100.0;
    let shares = chart("eq4/shares", all_series(&|_| percent));
    // A share that is inversely proportional to the leaf is a level line in this chart.
    let products = chart("eq4/products", all_series(&|one| one.leaf));
    let rows = vec![vec![Panel::Lines(shares)], vec![Panel::Lines(products)]];
    picture("eq4/shares", &json!({}), rows)
}

fn shares(found: &[LeafShares]) -> Table {
    table("eq4/shares", found, |one| {
        json!({
            "leaf_r": one.leaf, "mean_edge_r": one.mean_edge(), "samples": one.count,
            "predicted_percent": 100.0 * one.predicted(), "mended_percent": 100.0 * one.mended(),
            "margin_samples_percent": 100.0 * one.margin_samples(),
            "clip_margin_percent": 100.0 * one.margin_share(), "overlap_percent": 100.0 * one.overlap(),
            "in_conflict_percent": 100.0 * one.conflict_share(), "touched_percent": 100.0 * one.touched(),
            "lost_percent": 100.0 * one.lost_share(), "inserted_percent": 100.0 * one.inserted_share(),
        })
    })
}

#[cfg(test)]
mod tests;
