//! What depends on the plane beyond a ground of which not everything is known.

use glam::IVec2;

use crate::engine::parallel::clip::Clipper;
use crate::exact::agenda::What;
use crate::exact::darts::Arrival;
use crate::exact::history::LATE_LEVEL;
use crate::exact::seams::{PatternFate, SeamTiling};
use crate::lattice::{Point, R, Rect, Rect64, covers_offset};

/// Places in which darts that are not thrown may have become samples: only a doubtful sample covers all of them.
#[derive(Clone, Copy)]
pub(super) struct Zone {
    rect: Rect,
    /// The arrival of the first that may.
    from: Arrival,
}

impl SeamTiling<'_> {
    /// Returns whether the samples of the window depend on the plane beyond the ground.
    pub(in crate::exact) fn is_doubtful(&self) -> bool {
        let window = &self.ground.frame.window;
        let meets = |zone: &Zone| Rect64::from(zone.rect).within(window).is_some();
        self.doubtful.iter().any(|place| window.contains(*place)) || self.zones.iter().any(meets)
    }

    /// Returns where doubtful samples are, and the lowest places of zones.
    #[cfg(test)]
    pub(in crate::exact) fn doubtful_places(&self) -> impl Iterator<Item = Point> {
        let zones = self.zones.iter().map(|zone| zone.rect.min);
        self.doubtful.iter().copied().chain(zones)
    }

    /// Returns whether a late dart that is not thrown may cover a sample of the pattern.
    pub(super) fn is_late_near_unknown(&self, place: Point, pattern: u32) -> bool {
        let is_late = true;
        self.ground.is_near_unknown(place, is_late)
            && self.history.arrival(pattern).level() >= LATE_LEVEL
    }

    /// Returns whether a dart that is no sample yet may be covered by one that was not thrown.
    #[inline]
    pub(super) fn is_in_doubt(&self, place: Point, arrival: Arrival) -> bool {
        let is_late = arrival.level() >= LATE_LEVEL;
        self.ground.is_near_unknown(place, is_late)
            || !self.zones.is_empty() && self.is_near_zone(place, arrival)
    }

    fn is_near_zone(&self, place: Point, arrival: Arrival) -> bool {
        // Zones are found by their lowest places, and are less than R wide and high.
        let around = Rect {
            min: Point::new(place.x - 2 * R, place.y - 2 * R),
            max: Point::new(place.x + R + 1, place.y + R + 1),
        };
        let on_ground = Rect64::from(around).within(&self.ground.rect());
        on_ground.is_some_and(|around| {
            self.zone_cells.any_in(&around, |index, _| {
                let Zone { rect, from } = self.zones[index as usize];
                from <= arrival && is_near(place, &rect)
            })
        })
    }

    /// Keeps account of a sample of the pattern that has become doubtful. Returns `true`.
    #[inline(never)]
    pub(super) fn doubt(&mut self, id: u32) -> bool {
        self.doubt_inserted(id);
        let sample = &self.samples[id as usize];
        let (place, tile, number) = (sample.place, sample.tile, sample.number);
        let is_lost = false;
        self.fates.add(tile, number, PatternFate { place, is_lost });
        self.release(tile, place, number);
        true
    }

    /// Keeps account of a dart that is doubtful.
    pub(super) fn doubt_inserted(&mut self, id: u32) {
        let sample = &mut self.samples[id as usize];
        sample.is_left_out = true;
        self.doubtful.push(sample.place);
    }

    /// Adds a zone, whose darts arrive at `from` or later. Samples of the pattern that arrive no earlier, and that such
    /// darts may cover, are decided when their turn comes.
    #[inline(never)]
    pub(super) fn add_zone(&mut self, clipper: &Clipper, tile: u32, rect: Rect, from: Arrival) {
        self.zone_cells.add(rect.min, self.zones.len() as u32);
        self.zones.push(Zone { rect, from });

        // What covers a place of the zone is in the list of the place's cell. A zone is less than R wide, so that its
        // corners lie in all cells that it touches: nearly always in one.
        let (low, high) = (rect.min, Point::new(rect.max.x - 1, rect.max.y - 1));
        let corners = [
            low,
            high,
            Point::new(high.x, low.y),
            Point::new(low.x, high.y),
        ];
        let count = if self.disks.cell(low) == self.disks.cell(high) {
            1
        } else {
            corners.len()
        };

        // Lists of several cells may name a sample several times. Asked again, it is not changed again.
        for &corner in &corners[..count] {
            let cell = self.whole_cell(clipper, corner, tile);
            let (samples, history) = (&self.samples, self.history);
            self.reached.clear();
            self.disks.each_from(cell, from.when(), |id| {
                let sample = &samples[id as usize];
                // Samples that arrived before `from` stay, whatever darts the zone has. `each_from` compares the first
                // bits of arrivals; here all bits are compared. Samples that the pattern lacks are inserted in their
                // turn, so that none of them is later than `from` yet.
                let is_later = |pattern| from <= history.arrival(pattern);
                if is_near(sample.place, &rect) && sample.pattern().is_some_and(is_later) {
                    self.reached.push(id);
                }
            });
            for index in 0..self.reached.len() {
                let id = self.reached[index];
                self.agenda.add(self.dart(id), What::Sample(id));
            }
        }
    }
}

/// Returns whether a place is at most R from a rectangle.
fn is_near(place: Point, rect: &Rect) -> bool {
    let offset = place - rect.min;
    let extent = IVec2::new(rect.width() - 1, rect.height() - 1);
    covers_offset(offset - offset.clamp(IVec2::ZERO, extent))
}
