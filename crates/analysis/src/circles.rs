//! The second judge: conflicts and coverage by covered circles.
//! It shares no search with the first one, which triangulates; both answer the same question with the same numbers.
//! It declines sets that it would judge slowly: crowded or sparse ones, and those with holes of many radii.
//!
//! # The theorem
//!
//! Let the region `D` be connected (a torus, a rectangle), and let disks of one radius `rho` lie around the samples; on a torus
//! all copies of samples count. If every point of every circle that lies in `D` is inside the open disk of another sample, then
//! the disks cover `D`. For the union of the closed disks is closed; were it not all of `D`, it would have a boundary point in
//! `D`, since it is not empty and `D` is connected. That point is in no open disk, so it is on a circle and exposed.
//! Conversely an exposed point in `D` is `rho` away from its nearest sample: a witness.
//! Nothing here needs the disks to be equal or the border to be straight.
//!
//! # How a circle is judged
//!
//! 1. A table gives, for the offset of each neighbour within two radii, the bins of the circle that its disk certainly covers
//!    ([`table`]). A union that is full proves the circle covered. About nine of ten circles end here.
//! 2. The others are proven by the ends of their arcs ([`arcs`]), with a margin above all rounding.
//! 3. What is left is not certainly covered. Its Voronoi cell is cut out ([`cell`]): the circle is exposed exactly when a
//!    corner of the cell is `rho` or farther away. The corner's distance decides, by exact integers where the
//!    difference from the limit is within rounding ([`exact`]).
//!
//! Steps 1 and 2 use the largest distance of any such corner so far, at most the limit. A circle that they prove has no farther corner, so
//! the covering radius is the exact one although only few cells are ever cut out.
//!
//! # Errors
//!
//! Positions are binary fractions and most offsets are exact; copies across a seam are off by at most 2^-52 of the extent. The
//! table's arcs are shortened by 2^-16 of a turn's radian at both ends, the margin of the arcs' ends is 2^-40 and 2^-49 of
//! the extent in radii: both are far above the errors, so what is proven is so. Distances of conflicts are those of the samples,
//! rounded once; a distance that is equal to the radius is no conflict.

mod arcs;
mod cell;
mod exact;
mod gaps;
mod samples;
mod stream;
mod table;
mod tile;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::domain::Domain;
use crate::error::VerifyError;
use crate::monitor::Monitor;
use crate::witness::Conflict;
use crate::worst::Worst;
use arcs::Arc;
use cell::CellCutter;
use gaps::Gaps;
pub(crate) use samples::Sample;
use samples::{Cells, Samples};
pub(crate) use stream::CircleBands;
use tile::{Rectangle, Tile, Unfilled};

/// Columns and rows of a tile without its halo: its samples then fit the second-level cache.
const TILE: [usize; 2] = [256, 32];

/// Cells around a sample that are looked through for the rim of a hole, before the judge declines.
const HALOS: [usize; 4] = [4, 12, 32, 64];

/// Most exposed circles; a set with more is far from maximal.
const MAX_EXPOSED: usize = 1 << 20;

/// Sets of so few samples are searched pair by pair when no two samples are near.
const FEW: usize = 4096;

/// Why the judge leaves a set to the first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Declined {
    /// The radius is many times the period or a tiny fraction of the extent.
    Radius,
    /// There are many more cells than samples, or no two samples are near each other.
    Sparse,
    /// Many samples lie in few cells.
    Crowded,
    /// There is a hole of many radii, or there are very many.
    Holes,
}

/// Either a result, or why there is none.
pub(crate) type Judged<T> = Result<Result<T, Declined>, VerifyError>;

/// What the search found, in the domain's unit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Found {
    pub conflicts: u64,
    pub worst_conflicts: Worst<Conflict>,
    pub min_distance: f64,
    pub gaps: Gaps,
    /// Squared distances up to this are looked at closely.
    nearby: f64,
    /// Samples whose cell reaches farther than the cells around them show.
    exposed: Vec<Sample>,
}

impl Found {
    pub fn new(witnesses: usize) -> Self {
        Self {
            conflicts: 0,
            worst_conflicts: Worst::new(witnesses),
            min_distance: f64::INFINITY,
            gaps: Gaps::default(),
            nearby: f64::INFINITY,
            exposed: Vec::new(),
        }
    }

    fn merge(mut self, other: Self) -> Self {
        self.conflicts += other.conflicts;
        self.worst_conflicts.merge(other.worst_conflicts);
        self.min_distance = self.min_distance.min(other.min_distance);
        self.nearby = self.nearby.min(other.nearby);
        self.gaps.merge(other.gaps);
        self.exposed.extend(other.exposed);
        self
    }
}

/// The question.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question {
    pub domain: Domain,
    pub radius: f64,
    /// Circles larger than this are gaps.
    pub limit: f64,
    pub witnesses: usize,
}

/// Judges a whole set.
pub(crate) fn search(
    points: &[[f64; 2]],
    question: &Question,
    monitor: &Monitor<'_>,
) -> Judged<Found> {
    let samples = points.iter().enumerate().map(|(index, &point)| Sample {
        position: question.domain.scale_point(point),
        id: index as u32,
    });
    let samples = Cells::new(question.domain, question.limit)
        .and_then(|cells| Samples::new(cells, 0, cells.counts[1], samples));
    let samples = match samples {
        Ok(samples) => samples,
        Err(declined) => return Ok(Err(declined)),
    };
    let mut search = Search::new(question, &samples);
    let tiles = search.rectangles(0..samples.cells.counts[1] as i64);
    if let Err(declined) = search.begin(&tiles) {
        return Ok(Err(declined));
    }
    let found = match search.tiles(&tiles, monitor)? {
        Ok(found) => found,
        Err(declined) => return Ok(Err(declined)),
    };
    let found = search.holes(found, &HALOS, monitor)?;
    Ok(found.and_then(|found| search.finish(found, points.len())))
}

struct Search<'a> {
    question: &'a Question,
    samples: &'a Samples,
    /// The bits of the largest distance so far of a corner of a cell from its sample.
    farthest: AtomicU64,
    /// The radius of the first circles.
    least: f64,
}

/// What a thread needs to look at tiles.
#[derive(Default)]
struct Scratch {
    tile: Tile,
    cutter: CellCutter,
    arcs: Vec<Arc>,
}

impl<'a> Search<'a> {
    fn new(question: &'a Question, samples: &'a Samples) -> Self {
        Self::resumed(question, samples, 0.0, 0.0)
    }

    /// Goes on with what was known before.
    fn resumed(question: &'a Question, samples: &'a Samples, farthest: f64, least: f64) -> Self {
        Self {
            question,
            samples,
            farthest: AtomicU64::new(farthest.to_bits()),
            least,
        }
    }

    fn farthest(&self) -> f64 {
        f64::from_bits(self.farthest.load(Ordering::Relaxed))
    }

    /// The radius of the circles: the largest that is known to be needed, up to the limit.
    fn rho(&self) -> f64 {
        self.farthest().min(self.question.limit)
    }

    fn reaches(&self, farthest: f64) {
        // Bits of numbers that are not negative sort as they do.
        self.farthest
            .fetch_max(farthest.to_bits(), Ordering::Relaxed);
    }

    /// Cuts rows into tiles.
    fn rectangles(&self, rows: std::ops::Range<i64>) -> Vec<Rectangle> {
        let columns = self.samples.cells.counts[0] as i64;
        let step = TILE.map(|side| side as i64);
        let mut all = Vec::new();
        for row in rows.clone().step_by(TILE[1]) {
            for column in (0..columns).step_by(TILE[0]) {
                all.push(Rectangle {
                    columns: column..columns.min(column + step[0]),
                    rows: row..rows.end.min(row + step[1]),
                });
            }
        }
        all
    }

    /// Looks at all samples of some tiles.
    fn tiles(&self, tiles: &[Rectangle], monitor: &Monitor<'_>) -> Judged<Found> {
        let none = || Ok(Found::new(self.question.witnesses));
        tiles
            .par_iter()
            .map_init(Scratch::default, |scratch, rectangle| {
                let found = self.tile(scratch, rectangle);
                let count: usize = scratch.tile.own().map(|run| run.len()).sum();
                monitor.advance(count as u64)?;
                Ok(found)
            })
            .try_reduce(none, |left, right| {
                Ok(left.and_then(|left| Ok(left.merge(right?))))
            })
    }

    /// Cuts out cells until one gives the circles a radius to begin with: more than half that of a conflict, so that no
    /// conflict is beyond their neighbours.
    fn begin(&mut self, tiles: &[Rectangle]) -> Result<(), Declined> {
        let mut scratch = Scratch::default();
        let (reach, limit) = (self.samples.cells.reach, self.question.limit);
        let mut seen = 0;
        for rectangle in tiles {
            self.fill(&mut scratch.tile, rectangle, reach)?;
            for first in scratch.tile.own().flatten() {
                let cell = scratch
                    .cutter
                    .cut(self.samples, &scratch.tile, first, reach, limit);
                self.reaches(cell.map_or(limit, |cell| cell.farthest));
                self.least = self.rho();
                seen += 1;
                if self.least > 0.51 * self.question.radius {
                    return Ok(());
                }
                if seen > FEW {
                    return Err(Declined::Crowded);
                }
            }
        }
        Err(Declined::Crowded)
    }

    fn fill(
        &self,
        tile: &mut Tile,
        rectangle: &Rectangle,
        halo: [usize; 2],
    ) -> Result<(), Declined> {
        tile.fill(self.samples, rectangle, halo)
            .map_err(|unfilled| match unfilled {
                Unfilled::Declined(declined) => declined,
                Unfilled::Rows => Declined::Holes,
            })
    }

    fn tile(&self, scratch: &mut Scratch, rectangle: &Rectangle) -> Result<Found, Declined> {
        let Scratch { tile, cutter, arcs } = scratch;
        let reach = self.samples.cells.reach;
        self.fill(tile, rectangle, reach)?;
        let mut found = Found::new(self.question.witnesses);
        tile.scan(self.samples, self.rho(), self.question.radius, &mut found);
        let limit = self.question.limit;
        for index in tile.own().flatten() {
            if tile.mask(index) == table::FULL || self.arcs_prove(tile, index, arcs) {
                continue;
            }
            match cutter.cut(self.samples, tile, index, reach, limit) {
                Some(cell) => {
                    self.reaches(cell.farthest);
                    found.gaps.add(cell);
                }
                None => found
                    .exposed
                    .push(self.samples.all[tile.source[index] as usize]),
            }
        }
        Ok(found)
    }

    /// Whether the ends of arcs prove a sample's circle covered.
    fn arcs_prove(&self, tile: &Tile, index: usize, arcs: &mut Vec<Arc>) -> bool {
        let domain = &self.question.domain;
        let rho = self.rho();
        arcs.clear();
        let reach = self.samples.cells.reach;
        tile.around(index, reach, |_, offset| {
            let offset = offset / rho;
            if offset.length_squared() < 4.0 {
                arcs.push(Arc::of_disk(offset));
            }
        });
        if !domain.periodic {
            let position = tile.position(index);
            let sides = [
                (DVec2::NEG_X, position.x),
                (DVec2::X, domain.extent.x - position.x),
                (DVec2::NEG_Y, position.y),
                (DVec2::Y, domain.extent.y - position.y),
            ];
            arcs.extend(sides.map(|(toward, distance)| Arc {
                toward,
                least: distance / rho,
            }));
        }
        let extent = domain.extent.max_element() / rho;
        let margin = 2f64.powi(-40) + 2f64.powi(-49) * extent;
        let two_cover = |stretch| arcs::two_cover(arcs, stretch, margin);
        table::open_stretches(tile.mask(index)).all(two_cover)
            || arcs::certainly_cover(arcs, margin)
    }

    /// Cuts out the cells that reach into holes, seen with more and more cells around them.
    fn holes(&self, mut found: Found, halos: &[usize], monitor: &Monitor<'_>) -> Judged<Found> {
        let mut exposed = std::mem::take(&mut found.exposed);
        if exposed.len() > MAX_EXPOSED {
            return Ok(Err(Declined::Holes));
        }
        for &around in halos {
            if exposed.is_empty() {
                break;
            }
            monitor.advance(0)?;
            match self.holes_within(&mut found, exposed, around) {
                Ok(rest) => exposed = rest,
                Err(declined) => return Ok(Err(declined)),
            }
        }
        Ok(if exposed.is_empty() && found.gaps.len() <= MAX_EXPOSED {
            Ok(found)
        } else {
            Err(Declined::Holes)
        })
    }

    fn holes_within(
        &self,
        found: &mut Found,
        mut exposed: Vec<Sample>,
        around: usize,
    ) -> Result<Vec<Sample>, Declined> {
        let cells = &self.samples.cells;
        // Cells are twice as high as wide.
        let halo = [cells.reach[0].max(2 * around), cells.reach[1].max(around)];
        // Samples of some cells of a row are looked at together.
        let group = |sample: &Sample| {
            let (column, row) = (
                cells.column(sample.position.x),
                cells.row(sample.position.y),
            );
            [row, column / around]
        };
        exposed.sort_unstable_by_key(|sample| (group(sample), sample.id));
        let groups: Vec<&[Sample]> = exposed.chunk_by(|a, b| group(a) == group(b)).collect();
        let looked: Vec<_> = groups
            .par_iter()
            .map_init(Scratch::default, |scratch, samples| {
                let [row, block] = group(&samples[0]);
                let columns = block * around..cells.counts[0].min((block + 1) * around);
                let rectangle = Rectangle {
                    columns: columns.start as i64..columns.end as i64,
                    rows: row as i64..row as i64 + 1,
                };
                self.fill(&mut scratch.tile, &rectangle, halo)?;
                Ok(self.cut_exposed(scratch, samples, halo))
            })
            .collect::<Result<_, _>>()?;
        let mut rest = Vec::new();
        for (gaps, left) in looked {
            found.gaps.merge(gaps);
            rest.extend(left);
        }
        Ok(rest)
    }

    /// Cuts out the cells of some samples of a tile; returns those whose cell still reaches farther.
    fn cut_exposed(
        &self,
        Scratch { tile, cutter, .. }: &mut Scratch,
        exposed: &[Sample],
        halo: [usize; 2],
    ) -> (Gaps, Vec<Sample>) {
        let (mut gaps, mut rest) = (Gaps::default(), Vec::new());
        for index in tile.own().flatten() {
            let sample = self.samples.all[tile.source[index] as usize];
            if exposed
                .binary_search_by_key(&sample.id, |sample| sample.id)
                .is_err()
            {
                continue;
            }
            match cutter.cut(self.samples, tile, index, halo, self.question.limit) {
                Some(cell) => {
                    self.reaches(cell.farthest);
                    gaps.add(cell);
                }
                None => rest.push(sample),
            }
        }
        (gaps, rest)
    }

    /// Completes the smallest distance and settles the gaps.
    fn finish(&self, mut found: Found, count: usize) -> Result<Found, Declined> {
        let Question {
            domain,
            radius,
            limit,
            ..
        } = *self.question;
        let samples = &self.samples.all;
        // Pairs are noted up to twice the radius of the first circles.
        if found.min_distance > 2.0 * self.least {
            if count > FEW || count > samples.len() {
                return Err(Declined::Sparse);
            }
            for (index, &one) in samples.iter().enumerate() {
                for &other in &samples[index + 1..] {
                    let distance = tile::distance(one, other, domain.periods());
                    found.min_distance = found.min_distance.min(distance);
                }
            }
        }
        if domain.periodic {
            found.add_own_copies(count, domain.extent.min_element(), radius);
        }
        let longer = domain.extent.max_element();
        let same = (limit * 2f64.powi(-30)).max(longer * 2f64.powi(-46));
        found.gaps.settle(&domain, same, limit);
        Ok(found)
    }
}

impl Found {
    /// On a torus each sample also neighbours its own copies.
    fn add_own_copies(&mut self, count: usize, period: f64, radius: f64) {
        self.min_distance = self.min_distance.min(period);
        if period < radius {
            self.conflicts += count as u64;
            for id in 0..count {
                self.worst_conflicts.push(Conflict {
                    first: id,
                    second: id,
                    distance: period,
                });
            }
        }
    }
}
