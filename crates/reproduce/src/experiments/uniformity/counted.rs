//! The counts of one run: samples by place in the domain, by distance from borders, and by where in gaps they are
//! inserted. Tests of these counts are in `offsets`.

use serde::{Deserialize, Serialize};
use tilescope_analysis::measures::{DistanceClasses, PositionClasses};
use tilescope_core::{
    Domain, Fate, Insertion, Order, Origin, Parameters, Point, R, Rect, Run, reference_sample,
};
use tilescope_sets::region;

use super::gaps::Gaps;
use crate::control::Control;
use crate::error::Result;
use crate::experiments::common::seeded;
use crate::sets::{Set, exact, sequential};

/// Where classes of distances from a border begin, in radii.
pub const EDGES: [f64; 14] = [
    0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.5, 10.0,
];
/// How much denser the moved set is at its densest place: a bias that must be seen.
pub const MOVED: f64 = 0.05;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SetCounts {
    pub count: u64,
    /// By cell of the domain.
    pub cells: Vec<u64>,
    /// By distance from the nearest border of a block.
    pub blocks: Vec<u64>,
    /// By distance from the domain's border.
    pub domain: Vec<u64>,
    /// Coordinates of samples, of both axes, within 1 r after the domain's border, within 1 r before it, and elsewhere.
    pub sides: Vec<u64>,
    /// Inserted samples by distance from the nearest border of a block.
    pub inserted: Vec<u64>,
    /// Inserted samples by rank in their gap.
    pub ranks: Vec<u64>,
    /// Inserted samples without a rank: they lie in no gap of the survivors, or too little of their gap was left.
    pub skipped: u64,
}

/// Counts of the sets of one seed, in the sequence of `offsets::NAMES`, and each class's share of the area.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SeedCounts {
    pub sets: [SetCounts; 6],
    pub block_shares: Vec<f64>,
    pub domain_shares: Vec<f64>,
    pub side_shares: Vec<f64>,
}

impl SeedCounts {
    /// Makes and counts the sets of one seed, by a grid with `cells` cells along each side of the domain, and by
    /// distances from borders. The reference set, which is made without blocks, is counted by the blocks of the other
    /// sets.
    pub fn of(
        parameters: &Parameters,
        cells: usize,
        seed: u64,
        control: &Control<'_>,
    ) -> Result<Self> {
        let base = seeded(*parameters, seed);
        let run = |insertion, order| {
            let mut parameters = base;
            (parameters.insertion, parameters.order) = (insertion, order);
            sequential(&parameters, control)
        };

        // The first two differ in insertion alone, so that they have the same gaps.
        let circumcentre = run(Insertion::Circumcentre, base.order)?;
        let uniform = run(Insertion::Uniform, base.order)?;
        let random = run(Insertion::Circumcentre, Order::Random)?;
        // Blocks follow from the seed alone: exact tiling has those of the runs above.
        let tiled = exact(&base, control)?;

        let domain = circumcentre.domain;
        // A high bit sets the reference set's seed apart, so that it shares no draw with the runs.
        let own = seed ^ (1 << 40);
        let reference = reference_sample(domain, own, &mut control.observer())?;

        let rects = circumcentre
            .blocks
            .leaves
            .iter()
            .map(|block| block.rect)
            .collect();
        let counter = Counter {
            domain,
            cells,
            rects,
        };

        // Samples are ranked in the gaps that elimination leaves.
        let survivors = survivors_of(&circumcentre);
        let gaps = Gaps::of(&survivors, region(&domain), domain.radius())?;

        Ok(Self {
            // In the order in which results list the ways to make sets. The moved set is a control that need not be
            // valid, and is only counted. Samples are ranked only in the sets of the two runs that leave these gaps.
            sets: [
                counter.verified(&reference, "reference", control)?,
                counter.count(&moved(&domain, &reference))?,
                counter.run(&circumcentre, &gaps, control)?,
                counter.run(&uniform, &gaps, control)?,
                counter.verified(&random.points(), "random order", control)?,
                counter.verified(&tiled.points(), "exact tiling", control)?,
            ],
            block_shares: shares(&counter.rects),
            domain_shares: shares(&[domain.rect()]),
            side_shares: side_shares(&domain),
        })
    }
}

/// Returns the tiled samples that are in the result, in user units.
fn survivors_of(run: &Run) -> Vec<[f64; 2]> {
    let all = &run.samples;
    let samples = all.origins.iter().zip(&all.fates).zip(&all.points);
    let survived = samples.filter(|((origin, fate), _)| {
        matches!(origin, Origin::Tiled { .. }) && **fate == Fate::Kept
    });
    let user = |(_, point): (_, &Point)| run.domain.user_from_lattice(*point);
    survived.map(user).collect()
}

/// Returns a set that is denser towards the middle of the domain's width.
fn moved(domain: &Domain, points: &[Point]) -> Vec<Point> {
    let width = f64::from(domain.width());
    let turn = std::f64::consts::TAU / width;
    let place = |p: &Point| {
        let x = f64::from(p.x) + MOVED / turn * (turn * f64::from(p.x)).sin();
        // The remainder of a number a hair below 0 may be rounded to the width itself, which is no place of the domain.
        Point::new((x.rem_euclid(width) as i32).min(domain.width() - 1), p.y)
    };
    points.iter().map(place).collect()
}

/// Counts samples by place.
struct Counter {
    domain: Domain,
    /// Cells along each side of the domain.
    cells: usize,
    rects: Vec<Rect>,
}

impl Counter {
    /// Counts samples by their place in the domain and by their distance from borders.
    fn count(&self, points: &[Point]) -> Result<SetCounts> {
        let classes = PositionClasses {
            region: region(&self.domain),
            columns: self.cells,
            rows: self.cells,
        };

        let positions = self.domain.users_from_lattice(points);
        Ok(SetCounts {
            count: points.len() as u64,
            cells: classes.counts(&positions)?,
            blocks: depths(points, &self.rects)?,
            domain: depths(points, &[self.domain.rect()])?,
            sides: sides(&self.domain, points),
            ..SetCounts::default()
        })
    }

    fn verified(&self, points: &[Point], what: &str, control: &Control<'_>) -> Result<SetCounts> {
        Set::of(&self.domain, points).verified(what, control)?;
        self.count(points)
    }

    /// Counts the samples of a run, and the inserted ones also by their distance from borders of blocks and by their
    /// rank in the gap.
    fn run(&self, run: &Run, gaps: &Gaps<'_>, control: &Control<'_>) -> Result<SetCounts> {
        let seed = run.parameters.seed;
        let what = format!("{:?}, seed {seed}", run.parameters.insertion);
        let counted = self.verified(&run.points(), &what, control)?;

        let samples = run.samples.origins.iter().zip(&run.samples.points);
        // In the sequence of their insertion, on which ranks depend.
        let inserted: Vec<Point> = samples
            .filter(|(origin, _)| matches!(origin, Origin::Inserted { .. }))
            .map(|(_, point)| *point)
            .collect();
        // A rank is estimated at places of the gap that are drawn from the seed.
        let ranked = gaps.ranked(&self.domain.users_from_lattice(&inserted), seed);

        Ok(SetCounts {
            inserted: depths(&inserted, &self.rects)?,
            ranks: ranked.classes,
            skipped: ranked.skipped,
            ..counted
        })
    }
}

/// Counts points by how far inside their rectangle they are; rectangles tile the domain.
fn depths(points: &[Point], rects: &[Rect]) -> Result<Vec<u64>> {
    let depth = |p: &Point| {
        let inside = rects.iter().find(|rect| rect.contains(*p));
        inside.map(|rect| f64::from(rect.depth(*p)) / f64::from(R))
    };
    let depths: Vec<f64> = points.iter().filter_map(depth).collect();
    Ok(DistanceClasses::new(EDGES.to_vec())?.counts(&depths)?)
}

/// Counts coordinates by side of the domain's border.
fn sides(domain: &Domain, points: &[Point]) -> Vec<u64> {
    let mut counts = vec![0; 3];
    for point in points {
        for (at, length) in [(point.x, domain.width()), (point.y, domain.height())] {
            let side = match at {
                _ if at < R => 0,
                _ if at >= length - R => 1,
                _ => 2,
            };
            counts[side] += 1;
        }
    }
    counts
}

/// Returns the shares of the classes of [`sides`].
fn side_shares(domain: &Domain) -> Vec<f64> {
    // Each axis has half of the coordinates that are counted.
    let strip = |length: i32| 0.5 * f64::from(R) / f64::from(length);
    let side = strip(domain.width()) + strip(domain.height());
    vec![side, side, 1.0 - 2.0 * side]
}

/// Returns the share of each class of distances in the area of rectangles.
fn shares(rects: &[Rect]) -> Vec<f64> {
    let side = |side: i32, depth: f64| (f64::from(side) / f64::from(R) - 2.0 * depth).max(0.0);
    let deeper = |depth: f64| -> f64 {
        let area = |rect: &Rect| side(rect.width(), depth) * side(rect.height(), depth);
        rects.iter().map(area).sum()
    };
    let whole = deeper(0.0);
    let share = |class: usize| {
        let end = EDGES.get(class + 1).map_or(0.0, |edge| deeper(*edge));
        (deeper(EDGES[class]) - end) / whole
    };
    (0..EDGES.len()).map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiments::common::square;

    #[test]
    fn shares_are_areas_and_a_place_counts_by_its_nearest_border() {
        let unit = |x: f64| (x * f64::from(R)) as i32;
        let rect = Rect {
            min: Point::new(0, 0),
            max: Point::new(unit(20.0), unit(30.0)),
        };
        let shares = shares(&[rect]);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let nearest = 1.0 - 19.5 * 29.5 / 600.0;
        assert!((shares[0] - nearest).abs() < 1e-9);
        let points = [
            Point::new(unit(0.1), unit(9.0)),
            Point::new(unit(8.0), unit(28.5)),
        ];
        let counts = depths(&points, &[rect]).unwrap();
        assert_eq!((counts[0], counts[6]), (1, 1));
        assert_eq!(counts.iter().sum::<u64>(), 2);
    }

    #[test]
    fn sides_are_strips_of_one_radius_after_and_before_the_border() {
        let domain = square(2000.0, 20.0).validate().unwrap();
        let (high, middle) = (domain.width() - 1, domain.width() / 2);
        let points = [
            Point::new(0, middle),
            Point::new(R, high),
            Point::new(middle, high),
        ];
        assert_eq!(sides(&domain, &points), [1, 2, 3]);
        let shares = side_shares(&domain);
        let strip = f64::from(R) / f64::from(domain.width());
        assert!(
            (shares[0] - strip).abs() < 1e-12 && (shares.iter().sum::<f64>() - 1.0).abs() < 1e-12
        );
    }

    #[test]
    fn a_moved_set_stays_in_the_domain_and_gathers_in_the_middle() {
        let domain = square(2000.0, 20.0).validate().unwrap();
        let side = domain.width();
        let points: Vec<Point> = (0..1000)
            .map(|k| Point::new(k * (side / 1000), 5))
            .collect();
        let moved = moved(&domain, &points);
        assert!(moved.iter().all(|p| domain.rect().contains(*p)));
        let middle = |points: &[Point]| {
            points
                .iter()
                .filter(|p| (p.x - side / 2).abs() < side / 10)
                .count()
        };
        assert!(middle(&moved) as f64 > 1.02 * middle(&points) as f64);
    }
}
