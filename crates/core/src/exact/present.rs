//! The samples that are present while darts arrive, with what covers a place and what covers a cell.

use std::cmp::Ordering;

use glam::IVec2;

use crate::exact::cells::NumberCells;
use crate::exact::darts::{Arrival, PlacedDart};
use crate::exact::ground::Ground;
use crate::exact::history::PatternHistory;
use crate::exact::lists::{CoverLists, Covering};
use crate::lattice::{Point, R, Rect, covers_offset};
use crate::stages::disks::farthest;

/// A sample that is or was present.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrivedSample {
    /// Its place on the ground.
    pub(crate) place: Point,
    /// The index of its tile.
    pub(crate) tile: u32,
    /// Its index in the pattern; from [`FIRST_INSERTED`] on, that among the darts that are samples here and not in the
    /// pattern.
    number: u32,
    /// Whether an earlier sample covers it, so that it is none.
    pub(crate) is_lost: bool,
}

/// No pattern has so many samples.
pub(super) const FIRST_INSERTED: u32 = 1 << 31;

impl ArrivedSample {
    /// Returns whether it is one of the pattern's and present.
    pub(crate) const fn is_own(&self) -> bool {
        self.number < FIRST_INSERTED && !self.is_lost
    }

    /// Returns its index in the pattern; none of a dart that is a sample here and not in the pattern.
    pub(crate) const fn pattern(&self) -> Option<u32> {
        if self.number < FIRST_INSERTED {
            Some(self.number)
        } else {
            None
        }
    }
}

/// Samples by place. An id is the number of a sample in the sequence in which they were added.
pub(crate) struct PresentSamples<'a> {
    history: &'a PatternHistory,
    ground: Ground,
    /// How far each tile is moved from where the domain has it to where the ground has it.
    moves: Vec<IVec2>,
    samples: Vec<ArrivedSample>,
    /// The darts that are samples here and not in the pattern.
    inserted: Vec<PlacedDart>,
    /// The ids of those that are not lost.
    cells: NumberCells,
    /// Of the cells that were asked about, the samples that cover places of them.
    lists: CoverLists,
}

impl<'a> PresentSamples<'a> {
    /// Returns an empty set, for tilings with the pattern of a history.
    pub(crate) fn new(history: &'a PatternHistory) -> Self {
        Self {
            history,
            ground: Ground::default(),
            moves: Vec::new(),
            samples: Vec::new(),
            inserted: Vec::new(),
            cells: NumberCells::default(),
            lists: CoverLists::default(),
        }
    }

    /// Removes all samples and tiles, and sets the ground.
    pub(crate) fn reset(&mut self, ground: Ground) {
        let end = ground.rect().max;
        self.cells.reset(end);
        self.lists.reset(self.cells.count());
        self.ground = ground;
        self.moves.clear();
        self.samples.clear();
        self.inserted.clear();
    }

    pub(crate) const fn ground(&self) -> &Ground {
        &self.ground
    }

    /// Adds a tile that the ground has moved by `moved` from where the domain has it.
    pub(crate) fn add_tile(&mut self, moved: IVec2) {
        self.moves.push(moved);
    }

    /// Returns where the ground has a place that the domain has in a tile.
    pub(crate) fn on_ground(&self, tile: u32, place: Point) -> Point {
        let IVec2 { x, y } = self.moves[tile as usize];
        // The move may be too large for 32 bits, and wraps around. The sum fits.
        Point::new(place.x.wrapping_add(x), place.y.wrapping_add(y))
    }

    /// Returns where the domain has a rectangle of the ground in a tile.
    pub(crate) fn rect_in_domain(&self, tile: u32, rect: &Rect) -> Rect {
        let min = self.in_domain(tile, rect.min);
        Rect {
            min,
            max: Point::new(min.x + rect.width(), min.y + rect.height()),
        }
    }

    /// Returns where the domain has a place of the ground.
    pub(crate) fn in_domain(&self, tile: u32, place: Point) -> Point {
        let IVec2 { x, y } = self.moves[tile as usize];
        Point::new(place.x.wrapping_sub(x), place.y.wrapping_sub(y))
    }

    /// Returns all samples, also lost ones.
    pub(crate) fn samples(&self) -> &[ArrivedSample] {
        &self.samples
    }

    /// Calls `visit` with the ids of a cell's samples that are not lost, and with their places.
    #[inline]
    pub(crate) fn in_cell(&self, column: i32, row: i32, visit: impl FnMut(u32, Point)) {
        self.cells.each_in(column, row, visit);
    }

    pub(crate) fn get(&self, id: u32) -> &ArrivedSample {
        &self.samples[id as usize]
    }

    /// Returns when a sample arrived.
    pub(crate) fn arrival(&self, sample: &ArrivedSample) -> Arrival {
        match sample.pattern() {
            Some(pattern) => self.history.arrival(pattern),
            None => self.inserted[(sample.number - FIRST_INSERTED) as usize].arrival,
        }
    }

    /// Returns the dart that a sample is.
    pub(crate) fn dart(&self, sample: &ArrivedSample) -> PlacedDart {
        match sample.pattern() {
            Some(pattern) => {
                let place = self.in_domain(sample.tile, sample.place);
                self.history.dart(pattern, place)
            }
            None => self.inserted[(sample.number - FIRST_INSERTED) as usize],
        }
    }

    /// Compares a sample's dart with another.
    fn order(&self, sample: &ArrivedSample, dart: &PlacedDart) -> Ordering {
        // Nearly always the arrivals differ.
        let by_arrival = self.arrival(sample).cmp(&dart.arrival);
        by_arrival.then_with(|| self.dart(sample).cmp(dart))
    }

    /// Adds a sample of the pattern, and returns its id.
    #[inline]
    pub(crate) fn add(&mut self, place: Point, tile: u32, pattern: u32) -> u32 {
        self.push(ArrivedSample {
            place,
            tile,
            number: pattern,
            is_lost: false,
        })
    }

    /// Adds a dart that is a sample here and not in the pattern, and returns its id.
    pub(crate) fn insert(&mut self, dart: PlacedDart, tile: u32) -> u32 {
        let number = FIRST_INSERTED + self.inserted.len() as u32;
        self.inserted.push(dart);
        let place = self.on_ground(tile, dart.place);
        let id = self.push(ArrivedSample {
            place,
            tile,
            number,
            is_lost: false,
        });

        // The lists have the first bits of an arrival, which nearly always decide.
        let when = dart.arrival.when();
        self.visit_lists(place, |lists, cell, at| {
            lists.add(cell, Covering { at, when, id });
        });
        id
    }

    #[inline]
    fn push(&mut self, sample: ArrivedSample) -> u32 {
        let id = self.samples.len() as u32;
        self.cells.add(sample.place, id);
        self.samples.push(sample);
        id
    }

    /// Makes a sample a lost one.
    pub(crate) fn lose(&mut self, id: u32) {
        let sample = &mut self.samples[id as usize];
        sample.is_lost = true;
        let place = sample.place;
        self.cells.remove(place, id);
        self.visit_lists(place, |lists, cell, _| lists.remove(cell, id));
    }

    /// Calls `visit` with each cell that has a list and is touched by the disk around `place`, and with the offset of the
    /// place from the cell's lowest one.
    fn visit_lists(&mut self, place: Point, mut visit: impl FnMut(&mut CoverLists, usize, IVec2)) {
        let Self {
            ground,
            lists,
            cells,
            ..
        } = self;
        ground.any_part(&around(&single(place)), |part, moved| {
            for row in part.min.y / R..=(part.max.y - 1) / R {
                for column in part.min.x / R..=(part.max.x - 1) / R {
                    let cell = cells.index(Point::new(column * R, row * R));
                    // Where ends are joined, it is the cell moved by `moved` that lies beside the place.
                    let at = IVec2::new(place.x - column * R, place.y - row * R) - moved;
                    if lists.has(cell) && touches_cell(at) {
                        visit(lists, cell, at);
                    }
                }
            }
            // All parts are visited.
            false
        });
    }

    /// Returns the cell of a place, which has a list from now on, and the place's offset from the cell's lowest one.
    #[inline]
    fn listed(&mut self, place: Point) -> (usize, IVec2) {
        let cell = self.cells.index(place);
        if !self.lists.has(cell) {
            self.list(cell, place);
        }
        (cell, IVec2::new(place.x & (R - 1), place.y & (R - 1)))
    }

    /// Makes the list of the cell of a place.
    #[inline(never)]
    fn list(&mut self, cell: usize, place: Point) {
        let min = Point::new(place.x & -R, place.y & -R);
        let max = Point::new(min.x + R, min.y + R);
        let mut found = self.lists.begin();
        self.any_near(&Rect { min, max }, |id, at| {
            if touches_cell(at) {
                let when = self.arrival(self.get(id)).when();
                found.push(Covering { at, when, id });
            }
            false
        });
        self.lists.put(cell, found);
    }

    /// Returns those that arrived before `end`.
    pub(crate) const fn before(&mut self, end: Arrival) -> SamplesBefore<'_, 'a> {
        SamplesBefore { all: self, end }
    }

    /// Returns whether a sample that arrived before a dart covers it, once everything earlier is decided.
    pub(crate) fn is_covered(&mut self, dart: &PlacedDart, tile: u32) -> bool {
        let (cell, offset) = self.listed(self.on_ground(tile, dart.place));
        let when = dart.arrival.when();
        let covers = |other: &Covering| {
            // `when` has the first bits of an arrival. They nearly always differ, and spare the comparison of the rest.
            other.when <= when
                && covers_offset(other.at - offset)
                && (other.when < when || self.order(self.get(other.id), dart).is_lt())
        };
        self.lists.of(cell).iter().any(covers)
    }

    /// Returns the id of the earliest sample that covers a dart and arrived before it.
    pub(crate) fn first_blocker(&self, dart: &PlacedDart, tile: u32) -> Option<u32> {
        let mut first: Option<(PlacedDart, u32)> = None;
        self.any_near(&single(self.on_ground(tile, dart.place)), |id, offset| {
            let other = self.dart(self.get(id));
            let is_first = other < *dart && first.is_none_or(|(earliest, _)| other < earliest);
            if covers_offset(offset) && is_first {
                first = Some((other, id));
            }
            false
        });
        first.map(|(_, id)| id)
    }

    /// Returns whether a dart is present already.
    pub(crate) fn has(&mut self, dart: &PlacedDart, tile: u32) -> bool {
        let (cell, offset) = self.listed(self.on_ground(tile, dart.place));
        let mut there = self.lists.of(cell).iter().filter(|held| held.at == offset);
        there.any(|held| self.order(self.get(held.id), dart).is_eq())
    }

    /// Appends to `out` the ids of the samples that are present, later than `dart`, and covered by it.
    pub(crate) fn later(&mut self, dart: &PlacedDart, tile: u32, out: &mut Vec<u32>) {
        let (cell, offset) = self.listed(self.on_ground(tile, dart.place));
        let when = dart.arrival.when();
        let covered = |other: &&Covering| {
            other.when >= when
                && covers_offset(other.at - offset)
                && self.order(self.get(other.id), dart).is_gt()
        };
        let later = self.lists.of(cell).iter().filter(covered);
        out.extend(later.map(|other| other.id));
    }

    /// Calls `visit` with the ids of samples in cells within R of a rectangle, and their offsets from its lowest place,
    /// until it returns `true`; returns whether it did. Lost ones are left out.
    #[inline]
    fn any_near(&self, rect: &Rect, mut visit: impl FnMut(u32, IVec2) -> bool) -> bool {
        self.ground.any_part(&around(rect), |part, moved| {
            let from = IVec2::new(rect.min.x, rect.min.y) - moved;
            self.cells.any_in(part, |id, place| {
                visit(id, IVec2::new(place.x, place.y) - from)
            })
        })
    }
}

/// Returns the rectangle of one place.
const fn single(place: Point) -> Rect {
    Rect {
        min: place,
        max: Point::new(place.x + 1, place.y + 1),
    }
}

/// Returns the places within R of a rectangle on both axes.
const fn around(rect: &Rect) -> Rect {
    Rect {
        min: Point::new(rect.min.x - R, rect.min.y - R),
        max: Point::new(rect.max.x + R, rect.max.y + R),
    }
}

/// Returns whether a sample so far from a cell's lowest place covers some place of the cell.
#[inline]
fn touches_cell(at: IVec2) -> bool {
    covers_offset(at - at.clamp(IVec2::ZERO, IVec2::splat(R - 1)))
}

/// The present samples that arrived before a throw. Once all darts before it are decided, they stay.
pub(crate) struct SamplesBefore<'a, 'h> {
    all: &'a mut PresentSamples<'h>,
    end: Arrival,
}

impl SamplesBefore<'_, '_> {
    /// Returns whether one of them covers a place of a tile in the domain.
    pub(crate) fn covers(&mut self, tile: u32, place: Point) -> bool {
        let place = self.all.on_ground(tile, place);
        let (cell, offset) = self.all.listed(place);
        self.any(cell, |at| covers_offset(at - offset))
    }

    /// Returns whether one of them covers all of a tile's rectangle of the domain, which is at most R / 2 wide and high.
    pub(crate) fn covers_rect(&mut self, tile: u32, rect: &Rect) -> bool {
        let extent = IVec2::new(rect.width() - 1, rect.height() - 1);
        // What covers the whole rectangle covers its lowest place, and so is listed there.
        let (cell, offset) = self.all.listed(self.all.on_ground(tile, rect.min));
        self.any(cell, |at| covers_offset(farthest(at - offset, extent)))
    }

    #[inline]
    fn any(&self, cell: usize, covers: impl Fn(IVec2) -> bool) -> bool {
        let end = self.end.when();
        // A throw's first arrival differs from those before in its first bits.
        let mut listed = self.all.lists.of(cell).iter();
        listed.any(|other| other.when < end && covers(other.at))
    }
}
