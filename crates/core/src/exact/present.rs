//! The samples that are present while darts arrive, with what covers a place and what covers a cell.

use std::cmp::Ordering;

use glam::IVec2;

use crate::exact::cells::NumberCells;
use crate::exact::darts::{Arrival, PlacedDart};
use crate::exact::ground::Ground;
use crate::exact::history::{LATE_LEVEL, PatternHistory};
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
            zones: Vec::new(),
            zone_cells: NumberCells::default(),
        }
    }

    /// Removes all samples and tiles, and sets the ground.
    pub(crate) fn reset(&mut self, ground: Ground) {
        let end = ground.rect().max;
        self.cells.reset(end);
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

    /// Calls `visit` with the samples of a cell that are not lost.
    pub(crate) fn in_cell(&self, column: i32, row: i32, mut visit: impl FnMut(&ArrivedSample)) {
        self.cells
            .any_in(&single(Point::new(column * R, row * R)), |id, _| {
                visit(self.get(id));
                false
            });
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
        self.push(ArrivedSample {
            place: self.on_ground(tile, dart.place),
            tile,
            number,
            presence,
        })
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
        self.cells.remove(sample.place, id);
    }

    /// Makes a sample a doubtful one.
    pub(crate) fn doubt(&mut self, id: u32) {
        self.samples[id as usize].presence = Presence::Doubtful;
    }

    /// Returns those that arrived before `end`.
    pub(crate) const fn before(&self, end: Arrival) -> SamplesBefore<'_, 'a> {
        SamplesBefore { all: self, end }
    }

    /// Returns the presence of a dart once everything earlier is decided. It is lost if an earlier sample covers it.
    pub(crate) fn presence(&self, dart: &PlacedDart, tile: u32) -> Presence {
        let place = self.on_ground(tile, dart.place);
        let mut is_doubtful = false;

        let is_lost = self.any_near(&single(place), |id, offset| {
            covers_offset(offset) && {
                let sample = self.get(id);
                // A later sample covers the dart in vain.
                let is_met = self.order(sample, dart).is_lt();
                is_doubtful |= is_met && sample.presence == Presence::Doubtful;
                is_met && sample.presence == Presence::Certain
            }
        });

        if is_lost {
            Presence::Lost
        } else if is_doubtful || self.is_in_doubt(place, dart.arrival) {
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
    pub(crate) fn has(&self, dart: &PlacedDart, tile: u32) -> bool {
        let place = self.on_ground(tile, dart.place);
        self.cells.any_in(&single(place), |id, at| {
            at == place && self.order(self.get(id), dart).is_eq()
        })
    }

    /// Calls `visit` with the ids of the samples that are present, later than `dart`, and covered by it.
    pub(crate) fn later(&self, dart: &PlacedDart, tile: u32, mut visit: impl FnMut(u32)) {
        let place = self.on_ground(tile, dart.place);
        self.any_near(&single(place), |id, offset| {
            if covers_offset(offset) && self.order(self.get(id), dart).is_gt() {
                visit(id);
            }
            false
        });
    }

    /// Calls `visit` with the ids of samples in cells within R of a rectangle, and their offsets from its lowest place, until it returns `true`; returns whether it did. Lost ones are left out.
    #[inline]
    fn any_near(&self, rect: &Rect, mut visit: impl FnMut(u32, IVec2) -> bool) -> bool {
        let around = Rect {
            min: Point::new(rect.min.x - R, rect.min.y - R),
            max: Point::new(rect.max.x + R, rect.max.y + R),
        };
        self.ground.any_part(&around, |part, moved| {
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

/// Returns the place of a rectangle that is nearest to another one; both are offsets from the rectangle's lowest place.
fn nearest(offset: IVec2, rect: &Rect) -> IVec2 {
    offset.clamp(IVec2::ZERO, IVec2::new(rect.width() - 1, rect.height() - 1))
}

/// The present samples that arrived before some arrival. Once all darts before it are decided, they stay.
#[derive(Clone, Copy)]
pub(crate) struct SamplesBefore<'a, 'h> {
    all: &'a PresentSamples<'h>,
    end: Arrival,
}

/// The samples that may cover a part of a rectangle, by their offsets from its lowest place.
#[derive(Default)]
pub(crate) struct SamplesNear {
    pub(crate) certain: Vec<IVec2>,
    pub(crate) doubtful: Vec<IVec2>,
}

impl SamplesBefore<'_, '_> {
    /// Returns whether one of them that is certain covers a place of a tile in the domain.
    pub(crate) fn covers(&self, tile: u32, place: Point) -> bool {
        let place = self.all.on_ground(tile, place);
        self.all.any_near(&single(place), |id, offset| {
            covers_offset(offset) && {
                let sample = self.all.get(id);
                sample.presence == Presence::Certain && self.all.arrival(sample) < self.end
            }
        })
    }

    /// Returns whether one that is certain covers a tile's rectangle of the domain. If not, those that may cover a part of it
    /// are put into `near`.
    pub(crate) fn near_rect(&self, tile: u32, rect: &Rect, near: &mut SamplesNear) -> bool {
        near.certain.clear();
        near.doubtful.clear();

        let rect = self.all.rect_on_ground(tile, rect);
        let extent = IVec2::new(rect.width() - 1, rect.height() - 1);
        self.all.any_near(&rect, |id, offset| {
            // Not even its nearest place is covered.
            if !covers_offset(offset - nearest(offset, &rect)) {
                return false;
            }

            let sample = self.all.get(id);
            // Such a sample may yet be lost.
            if self.all.arrival(sample) >= self.end {
                return false;
            }

            match sample.presence {
                Presence::Certain => {
                    near.certain.push(offset);
                    covers_offset(farthest(offset, extent))
                }
                Presence::Doubtful => {
                    near.doubtful.push(offset);
                    false
                }
                Presence::Lost => false,
            }
        })
    }
}
