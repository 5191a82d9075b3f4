//! The gaps of each set as the verifier lists them, the holes that they belong to, and which detectors could have
//! seen them.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tilescope_analysis::measures::poisson_interval;
use tilescope_analysis::{Gap, Report, Tessellation, VerifyOptions};
use tilescope_figures::chart::{Bar, BarGroup};

use crate::control::Control;
use crate::error::{ReproduceError, Result};
use crate::experiments::common::{MISSED, bar_picture, largest};
use crate::numbers::drawn;
use crate::outcome::{Picture, Table};
use crate::rates::distinct;
use crate::sets::{Set, shortest};
use crate::texts::{table, text};

/// Centres of gaps that are examined in each set, at most. This number and the next two are chosen, not measured.
const MAX_CENTERS: usize = 100_000;
/// Witnesses that are kept of each set.
const KEPT: usize = 4;
/// Centres between two looks at whether the caller stopped the work.
const ASK: usize = 1024;

/// The largest distance of sites from the circle that they define, in radii.
const HAIR: f64 = 1e-6;

/// A position without a sample within r, and three samples that are nearest to it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Witness {
    pub center: [f64; 2],
    pub distance: f64,
    /// The samples, relative to the centre.
    pub sites: [[f64; 2]; 3],
}

impl Witness {
    /// Returns the centre of a gap with three sites. Sites are those of the `samples`, given by their indices, that lie
    /// on the empty circle about the centre. If there are more than three sites, the first three by angle are taken. If
    /// there are fewer, the missing ones are NaN, which counts as in sight.
    pub fn of(gap: &Gap, set: &Set, samples: &[usize]) -> Self {
        let [x, y] = gap.center;
        let away = |index: &usize| {
            let at = set.points[*index];
            shortest([at[0] - x, at[1] - y], &set.region)
        };
        // The sites are the samples on the circle, and rounding may have moved them a hair beyond it.
        let reach = gap.distance + HAIR * set.radius;
        let mut near: Vec<[f64; 2]> = (samples.iter().map(away))
            .filter(|[x, y]| x.hypot(*y) <= reach)
            .collect();
        // By angle, so that the sequence of the samples does not matter.
        near.sort_by(|a, b| a[1].atan2(a[0]).total_cmp(&b[1].atan2(b[0])));
        Self {
            center: gap.center,
            distance: gap.distance,
            sites: [0, 1, 2].map(|k| near.get(k).copied().unwrap_or([f64::NAN; 2])),
        }
    }

    /// Returns the distances between the sites: of the second and third, first and third, first and second.
    pub fn sides(&self) -> [f64; 3] {
        let [a, b, c] = self.sites;
        [(b, c), (a, c), (a, b)].map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]))
    }

    /// Returns whether no site has both others within 2r: two of the three sides are longer.
    pub fn out_of_sight(&self, radius: f64) -> bool {
        let long = |side: &&f64| **side > 2.0 * radius;
        self.sides().iter().filter(long).count() >= 2
    }
}

/// The gaps of one set: the verifier's counts, and which detectors could see them.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct GapCounts {
    /// How many samples the set has.
    pub count: usize,
    /// How many of them were inserted.
    pub inserted: usize,
    /// Centres of empty circles that are too large.
    pub centers: u64,
    /// How many connected gaps there are.
    pub holes: usize,
    /// Area of the gaps, in squared radii.
    pub area: f64,
    /// Centres that no detector could find, among those that are examined.
    pub out_of_sight: usize,
    pub covering_radius: f64,
    /// The largest empty circles of different holes.
    pub worst: Vec<Witness>,
}

impl GapCounts {
    /// Counts the gaps of a set, and measures their shapes.
    pub fn of(set: &Set, inserted: usize, control: &Control<'_>) -> Result<Self> {
        let options = VerifyOptions {
            witnesses: MAX_CENTERS,
            ..VerifyOptions::default()
        };
        let report = set.judged(&options, control)?;
        // Gaps are counted here, but conflicts are faults.
        if report.conflicts > 0 {
            return Err(ReproduceError::invalid("a set with gaps", &report));
        }
        let mut found = Self {
            count: report.count,
            inserted,
            centers: report.gaps,
            covering_radius: report.covering_radius / set.radius,
            ..Self::default()
        };
        // A set without gaps need not be triangulated.
        if report.gaps > 0 {
            found.take_apart(set, &report, control)?;
        }
        Ok(found)
    }

    /// Counts the holes, and the centres that are out of sight.
    fn take_apart(&mut self, set: &Set, report: &Report, control: &Control<'_>) -> Result<()> {
        // The verifier's tolerance decides here, too: a hole whose deepest place is not beyond it is no gap to the verifier.
        let covered = (1.0 + report.covering_tolerance) * set.radius;
        let parts = Tessellation::of(&set.points, set.region, set.radius)?;
        let is_open = |(_place, distance): (_, f64)| distance > covered;
        for hole in parts.gaps.iter().filter(|gap| is_open(gap.deepest)) {
            self.holes += 1;
            self.area += hole.area / set.radius.powi(2);
        }

        let mut seen = Vec::new();
        for (index, gap) in report.worst_gaps.iter().enumerate() {
            // There may be a hundred thousand centres: the caller can stop the work between them.
            if index % ASK == 0 {
                control.go_on()?;
            }

            // A centre that lies in no hole of the tessellation has no samples, and so no sites.
            let hole_index = parts.gap_at(gap.center);
            let samples = hole_index.map_or(&[][..], |hole| &parts.gaps[hole].sites);
            let witness = Witness::of(gap, set, samples);
            self.out_of_sight += usize::from(witness.out_of_sight(set.radius));

            // The verifier lists the largest circles first: the first one in a hole is the largest of the hole. All
            // centres outside of holes count as one hole here.
            if self.worst.len() < KEPT && !seen.contains(&hole_index) {
                seen.push(hole_index);
                self.worst.push(witness);
            }
        }

        Ok(())
    }
}

/// The gaps of the sets of one seed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GapStatistics {
    pub leaf: f64,
    /// Whether the sets are made by Algorithm 4 as printed in the paper, and not in stages.
    pub printed: bool,
    pub seed: u64,
    /// The gaps that are left where detectors look for them within 2r.
    pub two: GapCounts,
    /// Those where they look within 4r.
    pub four: GapCounts,
}

/// Returns the staged set with the largest gap.
pub fn worst(found: &[GapStatistics]) -> Option<&GapStatistics> {
    let gaps = found
        .iter()
        .filter(|one| !one.printed && !one.two.worst.is_empty());
    gaps.max_by(|a, b| a.two.covering_radius.total_cmp(&b.two.covering_radius))
}

/// Returns how many there are in a million samples, if there are `part` in `whole` samples.
pub fn a_million(part: f64, whole: usize) -> f64 {
    1e6 * part / whole.max(1) as f64
}

/// Returns the sets of a leaf and a variant.
fn of(found: &[GapStatistics], leaf: f64, printed: bool) -> Vec<&GapStatistics> {
    let fits =
        |one: &&GapStatistics| one.leaf.to_bits() == leaf.to_bits() && one.printed == printed;
    found.iter().filter(fits).collect()
}

fn leaves_of(found: &[GapStatistics]) -> Vec<f64> {
    distinct(found.iter().map(|one| one.leaf))
}

/// A bar of each leaf: the radius of the search for gaps, and the variant of the method.
struct BarKind {
    name: &'static str,
    is_printed: bool,
    counts: fn(&GapStatistics) -> &GapCounts,
}

const KINDS: [BarKind; 4] = [
    BarKind {
        name: "2 r, as printed",
        is_printed: true,
        counts: |one| &one.two,
    },
    BarKind {
        name: "4 r, as printed",
        is_printed: true,
        counts: |one| &one.four,
    },
    BarKind {
        name: "2 r, in stages",
        is_printed: false,
        counts: |one| &one.two,
    },
    BarKind {
        name: "4 r, in stages",
        is_printed: false,
        counts: |one| &one.four,
    },
];

/// Returns bars of the gaps in a million samples, by leaf.
pub fn bars(found: &[GapStatistics]) -> Result<Picture> {
    let group = |leaf: &f64| {
        let bar = |(index, kind): (usize, &BarKind)| {
            let sets = of(found, *leaf, kind.is_printed);
            let counts: Vec<&GapCounts> = sets.iter().map(|one| (kind.counts)(one)).collect();
            let holes: usize = counts.iter().map(|one| one.holes).sum();
            let samples: usize = counts.iter().map(|one| one.count).sum();

            // The whisker is the interval of the mean number of holes, by Poisson's law, that follows from the number
            // counted.
            let ends = poisson_interval(holes, MISSED).map(|gaps| a_million(gaps, samples));
            let values = json!({ "holes": holes, "samples": samples, "ends": ends });

            Bar {
                name: kind.name.to_owned(),
                value: a_million(holes as f64, samples),
                whisker: Some(ends),
                // Fonts of pictures lack some of the characters of reports.
                text: drawn(&text("search/bar", &values)),
                color: index,
            }
        };
        BarGroup {
            heading: format!("leaf {leaf} r"),
            bars: KINDS.iter().enumerate().map(bar).collect(),
        }
    };

    let groups = leaves_of(found).iter().map(group).collect();
    bar_picture("search/gaps", &json!({}), groups)
}

/// Returns a row of a table: the sums over `sets`, which must not be empty.
fn sums(sets: &[&GapStatistics]) -> Value {
    let total =
        |count: fn(&GapCounts) -> usize| sets.iter().map(|one| count(&one.two)).sum::<usize>();
    let holes = total(|two| two.holes);

    // All sets of a row have one variant and one leaf.
    json!({
        "variant": if sets[0].printed { "as printed" } else { "in stages" }, "leaf_r": sets[0].leaf,
        "samples": total(|two| two.count), "inserted": total(|two| two.inserted), "gaps_2r": holes,
        "gaps_2r_per_million": a_million(holes as f64, total(|two| two.count)),
        "places_2r": sets.iter().map(|one| one.two.centers).sum::<u64>(),
        "out_of_sight": total(|two| two.out_of_sight),
        "area_2r": sets.iter().map(|one| one.two.area).sum::<f64>(),
        "covering_2r": largest(sets.iter().map(|one| one.two.covering_radius)),
        "gaps_4r": sets.iter().map(|one| one.four.holes).sum::<usize>(),
        "covering_4r": largest(sets.iter().map(|one| one.four.covering_radius)),
    })
}

/// Returns the numbers of each leaf, over its sets.
pub fn by_leaf(found: &[GapStatistics]) -> Table {
    let leaves = leaves_of(found);
    let variants = [true, false].into_iter();
    let rows =
        variants.flat_map(|printed| leaves.iter().map(move |leaf| of(found, *leaf, printed)));
    table("search/leaves", rows, |sets| {
        let mut row = sums(&sets);
        row["sets"] = json!(sets.len());
        row
    })
}

pub fn by_set(found: &[GapStatistics]) -> Table {
    table("search/sets", found, |one| {
        let mut row = sums(&[one]);
        row["seed"] = json!(one.seed);
        row
    })
}
