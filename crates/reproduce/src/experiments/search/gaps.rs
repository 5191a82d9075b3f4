//! The gaps of each set as the verifier lists them, the holes that they belong to, and which detectors could have
//! seen them.

use serde::{Deserialize, Serialize};
use tilescope_analysis::{Report, Tessellation, VerifyOptions};
use tilescope_figures::chart::{Bar, BarGroup};

use super::witness::{CellIndex, HAIR, Witness};
use crate::control::Control;
use crate::error::ReproduceError;
use crate::experiments::common::{bar_picture, poisson_interval};
use crate::numbers::{drawn_count, drawn_number};
use crate::outcome::{Picture, Table};
use crate::sets::Set;
use crate::table::{TypedTable, table};

/// Centres of gaps that are examined in each set, at most.
const MAX_CENTERS: usize = 100_000;
/// Witnesses that are kept of each set.
const KEPT: usize = 4;
/// Centres between two looks at whether the caller stopped the work.
const ASK: usize = 1024;

/// The gaps of one set: the verifier's counts, and which detectors could see them.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct GapCounts {
    pub count: usize,
    pub inserted: usize,
    /// Centres of empty circles that are too large.
    pub centers: u64,
    /// Connected gaps.
    pub holes: usize,
    /// Area of the gaps, in squared radii.
    pub area: f64,
    /// Centres that no detector could find.
    pub out_of_sight: usize,
    pub covering_radius: f64,
    /// The largest empty circles of different holes.
    pub worst: Vec<Witness>,
}

impl GapCounts {
    pub fn of(set: &Set, inserted: usize, control: &Control<'_>) -> Result<Self, ReproduceError> {
        let options = VerifyOptions {
            witnesses: MAX_CENTERS,
            ..VerifyOptions::default()
        };
        let (points, region, radius) = (&set.points, set.region, set.radius);
        let report =
            tilescope_analysis::verify(points, region, radius, &options, &control.analysis())?;
        if report.conflicts > 0 {
            return Err(ReproduceError::Invalid {
                what: "a set with gaps".to_owned(),
                conflicts: report.conflicts,
                gaps: report.gaps,
            });
        }
        let base = Self {
            count: report.count,
            inserted,
            centers: report.gaps,
            covering_radius: report.covering_radius / radius,
            ..Self::default()
        };
        if report.gaps == 0 {
            return Ok(base);
        }
        base.apart(set, &report, control)
    }

    /// Takes the gaps apart.
    fn apart(
        self,
        set: &Set,
        report: &Report,
        control: &Control<'_>,
    ) -> Result<Self, ReproduceError> {
        let limit = (1.0 + report.covering_tolerance) * set.radius;
        let parts = Tessellation::of(&set.points, set.region, set.radius)?;
        let holes = || parts.gaps.iter().filter(|gap| gap.deepest.1 > limit);
        let mut worst = Vec::new();
        let mut out_of_sight = 0;
        let mut seen = Vec::new();
        let near = CellIndex::of(set, report.covering_radius + HAIR * set.radius);
        for (index, gap) in report.worst_gaps.iter().enumerate() {
            if index % ASK == 0 {
                control.go_on()?;
            }
            let witness = near.witness(gap.center, gap.distance);
            out_of_sight += usize::from(witness.out_of_sight(set.radius));
            let hole = parts.gap_at(gap.center);
            if worst.len() < KEPT && !seen.contains(&hole) {
                seen.push(hole);
                worst.push(witness);
            }
        }
        Ok(Self {
            holes: holes().count(),
            area: holes().map(|gap| gap.area).sum::<f64>() / set.radius.powi(2),
            out_of_sight,
            worst,
            ..self
        })
    }
}

/// The gaps of the sets of one seed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GapStatistics {
    pub leaf: f64,
    pub printed: bool,
    pub index: usize,
    pub seed: u64,
    pub two: GapCounts,
    pub four: GapCounts,
}

/// Returns the staged set with the largest gap.
pub fn worst(found: &[GapStatistics]) -> Option<&GapStatistics> {
    let gaps = found
        .iter()
        .filter(|one| !one.printed && !one.two.worst.is_empty());
    gaps.max_by(|a, b| a.two.covering_radius.total_cmp(&b.two.covering_radius))
}

/// Returns how many gaps no detector could have seen.
pub fn sight(found: &[GapStatistics]) -> String {
    let staged = || found.iter().filter(|one| !one.printed);
    let centers: u64 = staged().map(|one| one.two.centers).sum();
    let out: usize = staged().map(|one| one.two.out_of_sight).sum();
    format!(
        "Of {centers} centres of empty circles {out} were out of every sample's sight: none of their three sites has both others \
         within 2 r. The rest had such a site, but it was no detector."
    )
}

fn share(part: f64, whole: usize) -> f64 {
    1e6 * part / whole.max(1) as f64
}

/// Returns the sets of a leaf and a variant.
fn of(found: &[GapStatistics], leaf: f64, printed: bool) -> Vec<&GapStatistics> {
    let fits =
        |one: &&GapStatistics| one.leaf.to_bits() == leaf.to_bits() && one.printed == printed;
    found.iter().filter(fits).collect()
}

fn leaves(found: &[GapStatistics]) -> Vec<f64> {
    let mut leaves: Vec<f64> = found.iter().map(|one| one.leaf).collect();
    leaves.sort_by(f64::total_cmp);
    leaves.dedup();
    leaves
}

type Kind = (&'static str, bool, fn(&GapStatistics) -> &GapCounts);

const KINDS: [Kind; 4] = [
    ("2 r, as printed", true, |one| &one.two),
    ("4 r, as printed", true, |one| &one.four),
    ("2 r, in stages", false, |one| &one.two),
    ("4 r, in stages", false, |one| &one.four),
];

/// Returns bars of the gaps in a million samples, by leaf.
pub fn bars(found: &[GapStatistics]) -> Result<Picture, ReproduceError> {
    let group = |leaf: &f64| {
        let bar = |(kind, (name, printed, pick)): (usize, &Kind)| {
            let sets = of(found, *leaf, *printed);
            let holes: usize = sets.iter().map(|one| pick(one).holes).sum();
            let samples: usize = sets.iter().map(|one| pick(one).count).sum();
            let spread = poisson_interval(holes).map(|gaps| share(gaps, samples));
            Bar {
                name: (*name).to_owned(),
                value: share(holes as f64, samples),
                whisker: Some(spread),
                text: format!(
                    "{} gaps in {} samples (99 %: {} to {} a million)",
                    drawn_count(holes),
                    drawn_count(samples),
                    drawn_number(spread[0], 2),
                    drawn_number(spread[1], 2)
                ),
                color: kind,
            }
        };
        BarGroup {
            heading: format!("leaf {leaf} r"),
            bars: KINDS.iter().enumerate().map(bar).collect(),
        }
    };
    let groups = leaves(found).iter().map(group).collect();
    let title = "Gaps left in a million samples (99 % intervals)";
    let caption = "Gaps in a million samples that runs leave when detectors look 2 r and 4 r far, by the shortest edge of a block, as \
                   printed and in stages. Whiskers: 99 % intervals of a Poisson variable; behind each bar what was counted.";
    let bars = ("gaps in a million samples", groups);
    bar_picture("gaps", title, caption.to_owned(), bars)
}

/// Sets that a row of a table sums up.
type Sets<'a> = Vec<&'a GapStatistics>;

fn total(sets: &Sets<'_>, count: fn(&GapCounts) -> usize) -> usize {
    sets.iter().map(|one| count(&one.two)).sum()
}

fn most(sets: &Sets<'_>, value: fn(&GapStatistics) -> f64) -> f64 {
    sets.iter().map(|one| value(one)).fold(0.0, f64::max)
}

/// Returns a table of sums over sets; `third` is its third column, a count of them or their seed.
fn sums<'a>(
    [name, title]: [&str; 2],
    rows: impl IntoIterator<Item = Sets<'a>>,
    (key, digits, third): (&str, usize, fn(&Sets<'_>) -> u64),
) -> TypedTable<Sets<'a>> {
    let variant = |printed: bool| if printed { "as printed" } else { "in stages" };
    table(name, title, rows)
        .column("variant", "variant", 3, |sets| variant(sets[0].printed))
        .column("leaf_r", "leaf, r", 3, |sets| sets[0].leaf)
        .column(key, key, digits, third)
        .column("samples", "samples", 9, |sets| total(sets, |two| two.count))
        .column("inserted", "inserted, 2 r", 7, |sets| {
            total(sets, |two| two.inserted)
        })
        .column("gaps_2r", "gaps, 2 r", 6, |sets| {
            total(sets, |two| two.holes)
        })
        .column("gaps_2r_per_million", "gaps a million, 2 r", 4, |sets| {
            share(
                total(sets, |two| two.holes) as f64,
                total(sets, |two| two.count),
            )
        })
        .column("places_2r", "centres, 2 r", 6, |sets| {
            sets.iter().map(|one| one.two.centers).sum::<u64>()
        })
        .column("out_of_sight", "out of sight", 6, |sets| {
            total(sets, |two| two.out_of_sight)
        })
        .column("area_2r", "area of gaps, r^2", 3, |sets| {
            sets.iter().map(|one| one.two.area).sum::<f64>()
        })
        .column("covering_2r", "covering radius, 2 r", 7, |sets| {
            most(sets, |one| one.two.covering_radius)
        })
        .column("gaps_4r", "gaps, 4 r", 6, |sets| {
            sets.iter().map(|one| one.four.holes).sum::<usize>()
        })
        .column("covering_4r", "covering radius, 4 r", 7, |sets| {
            most(sets, |one| one.four.covering_radius)
        })
}

/// Returns the numbers of each leaf, over its sets.
pub fn by_leaf(found: &[GapStatistics]) -> Table {
    let leaves = leaves(found);
    let leaves = |printed| leaves.iter().map(move |leaf| of(found, *leaf, printed));
    let names = ["leaves", "Gaps left by looking 2 r and 4 r far"];
    let rows = leaves(true).chain(leaves(false));
    sums(names, rows, ("sets", 3, |sets| sets.len() as u64)).shown()
}

/// Returns the numbers of every seed.
pub fn by_set(found: &[GapStatistics]) -> Table {
    let rows = found.iter().map(|one| vec![one]);
    sums(
        ["sets", "Every seed"],
        rows,
        ("seed", 6, |sets| sets[0].seed),
    )
    .hidden()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_counts_are_the_known_ones_and_none_seen_is_not_none() {
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-3);
        assert!(close(poisson_interval(0), [0.0, 5.298]));
        assert!(close(poisson_interval(1), [0.005, 7.430]));
        assert!(close(poisson_interval(10), [3.717, 21.398]));
    }
}
