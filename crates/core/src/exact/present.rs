//! The samples that are present while darts arrive, with what covers a place and what covers a cell.

use std::cmp::Ordering;

use glam::IVec2;

use crate::exact::cells::NumberCells;
use crate::exact::darts::{Arrival, PlacedDart};
use crate::exact::ground::Ground;
use crate::exact::history::{LATE_LEVEL, PatternHistory};
use crate::exact::lists::{CoverLists, Covering};
use crate::lattice::{Point, R, Rect, Rect64, covers_offset};
use crate::stages::disks::farthest;

/// How much is known about a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Presence {
    /// It is present, and will be unless an earlier sample turns out to cover it.
    Certain,
    /// Whether it is one depends on the plane beyond the ground.
    Doubtful,
    /// An earlier sample covers it, so that it is none.
    Lost,
}

/// A sample that is, may be or was present.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrivedSample {
    /// Its place on the ground.
    pub(crate) place: Point,
    /// The index of its tile.
    pub(crate) tile: u32,
    /// Its index in the pattern; from [`FIRST_INSERTED`] on, that among the darts that are samples here alone.
    number: u32,
    pub(crate) presence: Presence,
}

/// No pattern has so many samples.
const FIRST_INSERTED: u32 = 1 << 31;

impl ArrivedSample {
    /// Returns whether it is one of the pattern's and present.
    pub(crate) const fn is_own(&self) -> bool {
        self.number < FIRST_INSERTED && matches!(self.presence, Presence::Certain)
    }

    /// Returns its index in the pattern; none of a dart that is a sample here alone.
    pub(crate) const fn pattern(&self) -> Option<u32> {
        if self.number < FIRST_INSERTED {
            Some(self.number)
        } else {
            None
        }
    }
}

/// Places in which darts that were not thrown may have become samples.
#[derive(Clone, Copy, Debug)]
struct Zone {
    rect: Rect,
    /// The arrival of the first that may.
    from: Arrival,
}

/// Samples by place. An id is the number of a sample in the sequence in which they were added.
pub(crate) struct PresentSamples<'a> {
    history: &'a PatternHistory,
    ground: Ground,
    /// How far each tile is moved from where the domain has it to where the ground has it.
    moves: Vec<IVec2>,
    samples: Vec<ArrivedSample>,
    /// The darts that are samples here alone.
    inserted: Vec<PlacedDart>,
    /// The ids of those that are not lost.
    cells: NumberCells,
    /// Of the cells that were asked about, the samples that cover places of them.
    lists: CoverLists,
    zones: Vec<Zone>,
    /// The indices of the zones, at their lowest places.
    zone_cells: NumberCells,
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
            zones: Vec::new(),
            zone_cells: NumberCells::default(),
        }
    }

    /// Removes all samples and tiles, and sets the ground.
    pub(crate) fn reset(&mut self, ground: Ground) {
        let end = ground.rect().max;
        self.cells.reset(end);
        self.lists.reset(self.cells.count());
        if ground.has_unknown() {
            self.zone_cells.reset(end);
        }
        self.ground = ground;
        self.moves.clear();
        self.samples.clear();
        self.inserted.clear();
        self.zones.clear();
    }

    pub(crate) const fn ground(&self) -> &Ground {
        &self.ground
    }

    /// Adds a tile that is moved so far from where the domain has it.
    pub(crate) fn add_tile(&mut self, moved: IVec2) {
        self.moves.push(moved);
    }

    /// Returns where the ground has a place that the domain has in a tile.
    pub(crate) fn on_ground(&self, tile: u32, place: Point) -> Point {
        let IVec2 { x, y } = self.moves[tile as usize];
        // The domain may begin so far below the ground that only the sum fits into the integers.
        Point::new(place.x.wrapping_add(x), place.y.wrapping_add(y))
    }

    /// Returns where the ground has a rectangle of the domain in a tile.
    pub(crate) fn rect_on_ground(&self, tile: u32, rect: &Rect) -> Rect {
        let min = self.on_ground(tile, rect.min);
        Rect {
            min,
            max: Point::new(min.x + rect.width(), min.y + rect.height()),
        }
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
            Some(pattern) => PlacedDart {
                arrival: self.history.arrival(pattern),
                source: self.history.pattern().samples()[pattern as usize],
                place: self.in_domain(sample.tile, sample.place),
            },
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
            presence: Presence::Certain,
        })
    }

    /// Adds a dart that is, or may be, a sample here alone, and returns its id.
    pub(crate) fn insert(&mut self, dart: PlacedDart, tile: u32, presence: Presence) -> u32 {
        let number = FIRST_INSERTED + self.inserted.len() as u32;
        self.inserted.push(dart);
        let place = self.on_ground(tile, dart.place);
        let id = self.push(ArrivedSample {
            place,
            tile,
            number,
            presence,
        });

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
        sample.presence = Presence::Lost;
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
                    let at = IVec2::new(place.x - column * R, place.y - row * R) - moved;
                    if lists.has(cell) && touches_cell(at) {
                        visit(lists, cell, at);
                    }
                }
            }
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

    /// Makes a sample a doubtful one.
    pub(crate) fn doubt(&mut self, id: u32) {
        self.samples[id as usize].presence = Presence::Doubtful;
    }

    /// Returns those that arrived before `end`.
    pub(crate) const fn before(&mut self, end: Arrival) -> SamplesBefore<'_, 'a> {
        SamplesBefore { all: self, end }
    }

    /// Returns the presence of a dart once everything earlier is decided. It is lost if an earlier sample covers it.
    pub(crate) fn presence(&mut self, dart: &PlacedDart, tile: u32) -> Presence {
        let place = self.on_ground(tile, dart.place);
        let (cell, offset) = self.listed(place);
        let when = dart.arrival.when();
        let mut is_doubtful = false;
        for other in self.lists.of(cell) {
            if other.when > when || !covers_offset(other.at - offset) {
                continue;
            }

            let sample = self.get(other.id);
            // `when` has the first bits of an arrival. They nearly always differ, and spare the comparison of the rest.
            if other.when == when && self.order(sample, dart).is_ge() {
                continue;
            }
            match sample.presence {
                Presence::Certain => return Presence::Lost,
                Presence::Doubtful => is_doubtful = true,
                Presence::Lost => {}
            }
        }

        if is_doubtful || self.is_in_doubt(place, dart.arrival) {
            Presence::Doubtful
        } else {
            Presence::Certain
        }
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

    /// Returns whether a dart that is no sample yet may be covered by one that was not thrown.
    fn is_in_doubt(&self, place: Point, arrival: Arrival) -> bool {
        // Late darts are not thrown within R of the unknown: any place there may be a sample.
        let reach = if arrival.level() < LATE_LEVEL {
            R
        } else {
            2 * R
        };

        self.ground.is_near_unknown(place, reach) || self.is_near_zone(place, arrival)
    }

    fn is_near_zone(&self, place: Point, arrival: Arrival) -> bool {
        if self.zones.is_empty() {
            return false;
        }
        // Zones are found by their lowest places, and are at most R wide and high.
        let around = Rect {
            min: Point::new(place.x - 2 * R, place.y - 2 * R),
            max: Point::new(place.x + R + 1, place.y + R + 1),
        };
        self.ground.any_part(&around, |part, moved| {
            self.zone_cells.any_in(part, |index, _| {
                let Zone { rect, from } = self.zones[index as usize];
                let offset = place - rect.min - moved;
                from <= arrival && covers_offset(offset - nearest(offset, &rect))
            })
        })
    }

    /// Adds a zone, and calls `visit` with the ids of the samples that its darts may cover.
    pub(crate) fn add_zone(&mut self, rect: Rect, from: Arrival, mut visit: impl FnMut(u32)) {
        self.zone_cells.add(rect.min, self.zones.len() as u32);
        self.zones.push(Zone { rect, from });

        self.any_near(&rect, |id, offset| {
            let is_met = covers_offset(offset - nearest(offset, &rect));
            // Earlier samples stay, whatever darts the zone has.
            if is_met && from <= self.arrival(self.get(id)) {
                visit(id);
            }
            false
        });
    }

    /// Returns whether something in a rectangle of the ground is doubtful.
    pub(crate) fn is_doubtful(&self, rect: &Rect) -> bool {
        let is_doubtful = |sample: &ArrivedSample| sample.presence == Presence::Doubtful;
        let mut doubtful = self.samples.iter().filter(|sample| is_doubtful(sample));
        let meets = |zone: &Zone| Rect64::from(zone.rect).within(rect).is_some();

        doubtful.any(|sample| rect.contains(sample.place)) || self.zones.iter().any(meets)
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

    /// Calls `visit` with the ids of samples in cells within R of a rectangle, and their offsets from its lowest place, until it returns `true`; returns whether it did. Lost ones are left out.
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

/// Returns the place of a rectangle that is nearest to another one; both are offsets from the rectangle's lowest place.
fn nearest(offset: IVec2, rect: &Rect) -> IVec2 {
    offset.clamp(IVec2::ZERO, IVec2::new(rect.width() - 1, rect.height() - 1))
}

/// The present samples that arrived before a throw. Once all darts before it are decided, they stay.
pub(crate) struct SamplesBefore<'a, 'h> {
    all: &'a mut PresentSamples<'h>,
    end: Arrival,
}

impl SamplesBefore<'_, '_> {
    /// Returns whether one of them that is certain covers a place of a tile in the domain.
    pub(crate) fn covers(&mut self, tile: u32, place: Point) -> bool {
        let place = self.all.on_ground(tile, place);
        let (cell, offset) = self.all.listed(place);
        self.covering(cell, |at| covers_offset(at - offset)) == Some(Presence::Certain)
    }

    /// Returns whether one of them covers all of a tile's rectangle of the domain, which is at most R / 2 wide and high, and
    /// whether one that does is certain.
    pub(crate) fn covers_rect(&mut self, tile: u32, rect: &Rect) -> Option<Presence> {
        let extent = IVec2::new(rect.width() - 1, rect.height() - 1);
        // What covers the whole rectangle covers its lowest place, and so is listed there.
        let (cell, offset) = self.all.listed(self.all.on_ground(tile, rect.min));
        self.covering(cell, |at| covers_offset(farthest(at - offset, extent)))
    }

    #[inline]
    fn covering(&self, cell: usize, covers: impl Fn(IVec2) -> bool) -> Option<Presence> {
        let end = self.end.when();
        let mut found = None;
        for other in self.all.lists.of(cell) {
            // A throw's first arrival differs from those before in its first bits.
            if other.when < end && covers(other.at) {
                match self.all.get(other.id).presence {
                    Presence::Certain => return Some(Presence::Certain),
                    Presence::Doubtful => found = Some(Presence::Doubtful),
                    Presence::Lost => {}
                }
            }
        }
        found
    }
}
