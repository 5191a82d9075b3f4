//! How a pattern came about: when each sample arrived, and which darts it refused first. The *first blocker* of a dart is the
//! earliest sample that covers it; the dart *waits* behind it, since it may become a sample where that one is missing.

use std::sync::Arc;

use glam::IVec2;

use crate::error::SampleError;
use crate::exact::arrivals::PatternArrivals;
use crate::exact::bare::MARK_SIDE;
use crate::exact::darts::{Arrival, PatternDarts, PlacedDart};
use crate::exact::filter::SampleFilter;
use crate::exact::packed::{COVERING_UNIT, CoveringSample, OffsetBounds, Refused, SecondBlocker};
use crate::grid::SampleGrid;
use crate::lattice::{Point, R, Rect, covers_offset};
use crate::parameters::PatternSpec;
use crate::pattern::{Pattern, Symmetry};
use crate::progress::{Meter, Observer};
use crate::stage::Stage;
use crate::stages::disks::{farthest, tiling_cells};

/// The refused darts of levels below this one are kept. More levels would make fewer cells active at seams, but two darts
/// in five of level 2 lie in cells that one sample covers, and the table would be twice as large with it.
pub(crate) const LATE_LEVEL: u32 = 2;

/// A pattern with the arrivals of its samples, and with the darts of levels 0 and 1 that each of them refused first.
///
/// It takes 12 bytes a refused dart, 12 a sample and 4 a cell of half a radius, 101 bytes a squared r: 1.0 MB of a pattern of
/// 100 r, 16.2 MB of one of 400 r, 404 MB of the largest.
pub struct PatternHistory {
    arrived: PatternArrivals,
    /// Where the refused darts of each sample begin, and where the last ones end.
    starts: Vec<u32>,
    refused: Vec<Refused>,
    /// Of each cell of [`MARK_SIDE`], row by row, an early sample that covers all of it, if there is one.
    covering: Vec<CoveringSample>,
    /// How many of these cells a row has.
    mark_columns: usize,
}

impl PatternHistory {
    /// Returns the history of the pattern that `spec` describes, and makes the pattern if it is not among the last few
    /// that were used ([`Pattern::of_spec`]).
    ///
    /// The observer is called for [`Stage::Pattern`], and may stop it.
    pub fn of_spec(spec: &PatternSpec, observer: &mut dyn Observer) -> Result<Self, SampleError> {
        Self::of_arrivals(PatternArrivals::of_spec(spec, observer)?, observer)
    }

    /// Returns the history of a pattern of which the arrivals are there.
    ///
    /// The observer is called for [`Stage::Pattern`], and may stop it.
    pub fn of_arrivals(
        arrived: PatternArrivals,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let (pattern, darts) = (arrived.pattern(), arrived.darts());
        let samples = pattern.samples();

        let mut grid = SampleGrid::with_capacity(*pattern.domain(), samples.len());
        for (id, &place) in (0..).zip(samples) {
            grid.insert(id, place);
        }

        let arrivals = arrived.arrivals();
        let mut refusals = blocked(pattern, darts, arrivals, &grid, observer)?;
        // Darts that wait behind one sample follow each other, so that two indices name them.
        refusals.sort_unstable_by_key(|(blocker, _)| *blocker);
        let begins = |id: u32| refusals.partition_point(|(blocker, _)| *blocker < id) as u32;

        Ok(Self {
            starts: (0..=samples.len() as u32).map(begins).collect(),
            refused: refusals.iter().map(|(_, refused)| *refused).collect(),
            covering: covering(darts, arrivals, &grid),
            mark_columns: mark_columns(darts.rect()),
            arrived,
        })
    }

    /// Returns the pattern whose history it is, with the arrivals of its samples.
    #[must_use]
    pub const fn arrived(&self) -> &PatternArrivals {
        &self.arrived
    }

    /// Returns the pattern whose history it is.
    #[must_use]
    pub const fn pattern(&self) -> &Arc<Pattern> {
        self.arrived.pattern()
    }

    /// Returns all darts of the pattern.
    #[must_use]
    pub const fn darts(&self) -> &PatternDarts {
        self.arrived.darts()
    }

    /// Returns the arrival of a sample of the pattern, by its index.
    #[must_use]
    pub fn arrival(&self, sample: u32) -> Arrival {
        self.arrived.arrivals()[sample as usize]
    }

    /// Returns the bytes that the tables take, beside the pattern's samples.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.arrived.arrivals())
            + size_of_val(&*self.starts)
            + size_of_val(&*self.refused)
            + size_of_val(&*self.covering)
    }

    /// Returns whether a sample of a level that is kept covers all of a cell of [`MARK_SIDE`], given by its column and
    /// row in the pattern, and lies in a rectangle of the pattern, and is not `missing`. In doubt it returns `false`:
    /// of the sample's place only the square of side [`COVERING_UNIT`] around it is known, and of its number only the
    /// last eight bits, which are all that `missing` reads.
    #[inline]
    pub(super) fn is_covered(
        &self,
        column: i32,
        row: i32,
        inside: &Rect,
        missing: &SampleFilter,
    ) -> bool {
        let sample = self.covering[row as usize * self.mark_columns + column as usize];
        if sample == CoveringSample::NONE {
            return false;
        }
        let IVec2 { x, y } = sample.lowest();
        // All places that the sample may have must lie inside. A negative offset becomes an unsigned number that is
        // larger than any width.
        let right = (column * MARK_SIDE + x - inside.min.x) as u32;
        let up = (row * MARK_SIDE + y - inside.min.y) as u32;
        let within = |extent: i32| (extent - COVERING_UNIT + 1).max(0) as u32;
        right < within(inside.width())
            && up < within(inside.height())
            && !missing.may_have(sample.number())
    }

    /// Returns the dart that a sample of the pattern is, where a domain has it.
    #[inline]
    pub(crate) fn dart(&self, sample: u32, place: Point) -> PlacedDart {
        PlacedDart {
            arrival: self.arrival(sample),
            source: self.pattern().samples()[sample as usize],
            place,
        }
    }

    /// Calls `visit` with the darts of levels 0 and 1 whose first blocker is a sample of the pattern, and which lie in
    /// a rectangle. `place` is where a copy of the pattern, turned by `symmetry`, has the sample. The rectangle is one
    /// of the copy, and the darts have their places in it. The offset of a dart's second blocker, however, is that in
    /// the pattern, not turned.
    #[inline]
    pub(crate) fn each_waiting_in(
        &self,
        rect: &Rect,
        sample: u32,
        place: Point,
        symmetry: Symmetry,
        mut visit: impl FnMut(PlacedDart, SecondBlocker),
    ) {
        // Most of these darts lie beside the rectangle. They are left out by their offsets in the pattern, before they are turned.
        // Differences saturate: no dart is so far away.
        let offset = |x: i32, y: i32| {
            let offset = IVec2::new(x.saturating_sub(place.x), y.saturating_sub(place.y));
            // The lowest integer has no negative, which a mirror image would need.
            symmetry.turn_back(offset.max(IVec2::splat(-i32::MAX)))
        };
        let low = offset(rect.min.x, rect.min.y);
        let high = offset(rect.max.x - 1, rect.max.y - 1);
        let bounds = OffsetBounds::new(low.min(high), low.max(high));

        for refused in self.refused_by(sample) {
            if refused.lies_in(&bounds) {
                let offset = refused.offset();
                let IVec2 { x, y } = symmetry.turn(offset);
                let dart = PlacedDart {
                    arrival: refused.arrival(),
                    source: self.source(sample, offset),
                    place: Point::new(place.x + x, place.y + y),
                };
                visit(dart, refused.second());
            }
        }
    }

    /// Returns the refused darts of levels 0 and 1 whose first blocker is a sample of the pattern, in no order.
    fn refused_by(&self, sample: u32) -> &[Refused] {
        let [first, end] = [sample, sample + 1].map(|id| self.starts[id as usize] as usize);
        &self.refused[first..end]
    }

    /// Returns the place in the pattern at an offset, of at most R, from one of its samples.
    #[inline]
    pub(crate) fn source(&self, sample: u32, offset: IVec2) -> Point {
        let domain = self.pattern().domain();
        // A dart lies in the pattern. Its offset leads beyond an end only in a periodic pattern, whose opposite ends
        // are joined, and by less than a side.
        let wrapped = |at: i32, side: i32| {
            if at < 0 {
                at + side
            } else if at >= side {
                at - side
            } else {
                at
            }
        };
        let from = self.pattern().samples()[sample as usize];
        Point::new(
            wrapped(from.x + offset.x, domain.width()),
            wrapped(from.y + offset.y, domain.height()),
        )
    }

    /// Returns the history as if no dart had been refused.
    #[cfg(test)]
    pub(crate) fn without_waiting(&self) -> Self {
        Self {
            arrived: self.arrived.clone(),
            starts: vec![0; self.starts.len()],
            refused: Vec::new(),
            covering: self.covering.clone(),
            mark_columns: self.mark_columns,
        }
    }
}

/// Returns how many cells of [`MARK_SIDE`] a row of the pattern has.
const fn mark_columns(rect: &Rect) -> usize {
    ((rect.max.x - 1) / MARK_SIDE + 1) as usize
}

/// Returns of each cell of [`MARK_SIDE`] a sample that covers all of it and arrived with a level that is kept, or
/// [`CoveringSample::NONE`].
fn covering(darts: &PatternDarts, arrivals: &[Arrival], grid: &SampleGrid) -> Vec<CoveringSample> {
    // The pattern's end may cut its last cells. Taken as whole, they count as covered less often, which is never wrong.
    let extent = IVec2::splat(MARK_SIDE - 1);
    let cells = tiling_cells(darts.rect(), MARK_SIDE);
    let of_cell = |min: Point| {
        let mut found = CoveringSample::NONE;
        // What covers the whole cell covers its lowest place.
        grid.any_near(min, R, |near| {
            let is_early = arrivals[near.id as usize].level() < LATE_LEVEL;
            if is_early && covers_offset(farthest(near.offset, extent)) {
                found = CoveringSample::new(near.id, near.offset);
            }
            found != CoveringSample::NONE
        });
        found
    };
    cells.map(|cell| of_cell(cell.min)).collect()
}

/// Returns the refused darts of the levels that are kept, each with its first blocker.
fn blocked(
    pattern: &Pattern,
    darts: &PatternDarts,
    arrivals: &[Arrival],
    grid: &SampleGrid,
    observer: &mut dyn Observer,
) -> Result<Vec<(u32, Refused)>, SampleError> {
    let samples = pattern.samples();
    let cells = tiling_cells(darts.rect(), R).count();
    // Level 1 has four times the cells of level 0.
    let mut meter = Meter::begin(observer, Stage::Pattern, 5 * cells as u64)?;

    // A throw has 0.85 darts a cell. Level 0 has four throws, and level 1 one throw into four times the cells: 6.8 in all.
    let mut blocked = Vec::with_capacity(7 * cells);

    for level in 0..LATE_LEVEL {
        for cell in tiling_cells(darts.rect(), R >> level) {
            for (arrival, place) in darts.of_cell(level, cell.min) {
                // Samples of one arrival follow each other by place, as in [`crate::exact::PlacedDart`].
                let order = |id: u32| (arrivals[id as usize], samples[id as usize].row_major());

                let mut first: Option<u32> = None;
                let mut second: Option<u32> = None;
                grid.any_near(place, R, |near| {
                    let is_before =
                        |other: Option<u32>| other.is_none_or(|id| order(near.id) < order(id));
                    if covers_offset(near.offset) {
                        if is_before(first) {
                            (first, second) = (Some(near.id), first);
                        } else if is_before(second) {
                            second = Some(near.id);
                        }
                    }
                    // Nothing found ends the search: all samples near are compared.
                    false
                });

                // Every place is covered by a sample. If the dart became a sample, the first that covers it is itself.
                let blocker = first.expect("the pattern is maximal");
                let own = (arrival, place.row_major());
                if order(blocker) != own {
                    let domain = pattern.domain();
                    let offset = domain.difference(samples[blocker as usize], place);
                    // A later sample would not have refused it.
                    let second = second.filter(|&id| order(id) < own);
                    let second = second.map_or(SecondBlocker::NONE, |id| {
                        SecondBlocker::new(id, domain.difference(place, samples[id as usize]))
                    });
                    blocked.push((blocker, Refused::new(arrival, offset, second)));
                }
            }
            meter.tick()?;
        }
    }
    meter.end()?;
    Ok(blocked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::progress::Unobserved;

    fn history(side: f64, boundary: Boundary) -> PatternHistory {
        let spec = PatternSpec {
            side,
            boundary,
            seed: 8,
        };
        PatternHistory::of_spec(&spec, &mut Unobserved).unwrap()
    }

    /// Every early dart is a sample or waits behind exactly one, which covers it, and which none that covers it precedes.
    #[test]
    fn every_refused_dart_waits_behind_its_first_blocker() {
        for (side, boundary) in [(13.7, Boundary::Periodic), (12.0, Boundary::Bounded)] {
            let history = history(side, boundary);
            let domain = history.pattern().domain();
            let samples = history.pattern().samples();
            let (mut waiting, mut seconds) = (Vec::new(), 0);
            for (id, sample) in (0..).zip(samples) {
                for dart in history.refused_by(id) {
                    let source = history.source(id, dart.offset());
                    assert!(covers_offset(dart.offset()) && domain.covers(*sample, source));
                    assert!(history.arrival(id) < dart.arrival());
                    let covering = (0..)
                        .zip(samples)
                        .filter(|(_, p)| domain.covers(**p, source));
                    let first = covering
                        .clone()
                        .map(|(other, _)| history.arrival(other))
                        .min();
                    assert_eq!(first, Some(history.arrival(id)));

                    // The second one is about where it is said to be, and there is none only if it would lie R away.
                    let rest = covering.clone().filter(|(other, _)| *other != id);
                    let earlier =
                        rest.filter(|(other, _)| history.arrival(*other) < dart.arrival());
                    let second = earlier.min_by_key(|(other, _)| history.arrival(*other));
                    let far = second
                        .is_none_or(|(_, at)| domain.difference(source, *at).max_element() == R);
                    assert_eq!(!dart.second().is_some(), far);
                    if let (true, Some((other, at))) = (dart.second().is_some(), second) {
                        let away = domain.difference(source, *at) - dart.second().offset();
                        assert!(away.abs().max_element() <= SecondBlocker::REACH);
                        assert_eq!(dart.second().number(), other % 256);
                        seconds += 1;
                    }
                    waiting.push((dart.arrival(), source.row_major()));
                }
            }

            let mut thrown = Vec::new();
            for level in 0..LATE_LEVEL {
                for cell in tiling_cells(history.darts().rect(), R >> level) {
                    thrown.extend(history.darts().of_cell(level, cell.min));
                }
            }
            let is_sample = |(arrival, place): &(Arrival, Point)| {
                let id = samples.iter().position(|p| p == place);
                id.is_some_and(|id| history.arrived().arrivals()[id] == *arrival)
            };
            let refused = thrown.iter().filter(|dart| !is_sample(dart));
            let mut refused: Vec<_> = refused.map(|(a, p)| (*a, p.row_major())).collect();
            assert!(refused.len() > 500 && seconds * 3 > refused.len());
            refused.sort_unstable();
            waiting.sort_unstable();
            assert_eq!(waiting, refused);
        }
    }

    #[test]
    fn tables_take_the_bytes_that_are_said() {
        let history = history(100.0, Boundary::Periodic);
        let bytes = history.bytes() as f64 / 1e4;
        assert!((99.0..103.0).contains(&bytes), "{bytes} a squared r");
        // The longest offsets fit, too.
        for offset in [IVec2::new(R, 0), IVec2::new(-R, 0), IVec2::new(3, -R)] {
            for arrival in [Arrival::new(1, 0, u32::MAX), Arrival::new(0, 3, 7)] {
                for second in [SecondBlocker::NONE, SecondBlocker::new(700, offset / 2)] {
                    let packed = Refused::new(arrival, offset, second);
                    assert_eq!((packed.offset(), packed.arrival()), (offset, arrival));
                    assert_eq!(packed.second(), second);
                }
            }
        }
        // A sample that covers a cell of several rows is less than R left or right of its lowest place.
        for offset in [IVec2::new(R - 1, 0), IVec2::new(MARK_SIDE - 1 - R, 3)] {
            let covering = CoveringSample::new(515, offset);
            let beyond = offset - covering.lowest();
            assert!(beyond.min_element() >= 0 && beyond.max_element() < COVERING_UNIT);
            assert_eq!(covering.number() % 256, 515 % 256);
        }
    }
}
