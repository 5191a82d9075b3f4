//! What expressions ask of a field of radii. Where the radius is the same everywhere, it is r. Places of a set in space lie in its
//! plane.

use tilescope_core::{Locality, Point, R};

use super::{Found, Now, SET, wrong};
use crate::sets::radii;

/// The places of a row and of a column of those that stand for the domain. Chosen, not measured.
const PLACES: u32 = 128;

impl Now {
    fn locality(&self) -> Option<&Locality> {
        self.recording.run().locality.as_deref()
    }

    /// Returns the lattice point of a place in r, inside the domain.
    pub(super) fn lattice(&self, place: [f64; 2]) -> Point {
        let domain = self.recording.domain();
        let units = |axis: usize, side: i32| {
            let at = (place[axis] * f64::from(R)).round();
            (at.max(0.0) as i32).min(side - 1)
        };
        Point::new(units(0, domain.width()), units(1, domain.height()))
    }

    /// Returns the radius at a place, in r.
    pub(super) fn radius_at(&self, place: [f64; 2]) -> f64 {
        let at = self.lattice(place);
        self.locality()
            .map_or(1.0, |locality| radii(locality.radius_at(at)))
    }

    /// Returns the side of the cell in which darts around a place begin to fall, in r.
    pub(super) fn cell_side(&self, place: [f64; 2]) -> f64 {
        let at = self.lattice(place);
        self.locality()
            .map_or(1.0, |locality| radii(locality.base_side(at)))
    }

    /// Returns whether a sample refuses a dart at a place: whether the two are near each other.
    pub(super) fn refuses(&self, sample: u32, at: Point) -> bool {
        let Some(point) = self.recording.point(sample) else {
            return false;
        };
        // A place of a set in space lies in the plane.
        if let Some(above) = self.recording.above(sample, self.plane()) {
            let planar = self.recording.domain().distance_squared(point, at);
            return planar + i64::from(above) * i64::from(above) <= i64::from(R) * i64::from(R);
        }
        if let Some(locality) = self.locality() {
            return locality.is_near(point, at);
        }
        self.recording.domain().covers(point, at)
    }

    /// Returns how many valid samples refuse a dart at a place.
    pub(super) fn refusers(&self, place: [f64; 2]) -> Found<i64> {
        let at = self.lattice(place);
        let set = self.set()?;
        let refusing = set.ids.iter().filter(|&&sample| self.refuses(sample, at));
        Ok(refusing.count() as i64)
    }

    /// Returns the places that stand for the domain: the middles of equal parts of it.
    pub(super) fn places(&self) -> impl Iterator<Item = Point> {
        let domain = self.recording.domain();
        let size = [domain.width(), domain.height()].map(radii);
        let middle =
            move |axis: usize, at: u32| size[axis] * (f64::from(at) + 0.5) / f64::from(PLACES);
        let all = (0..PLACES).flat_map(|row| (0..PLACES).map(move |column| [column, row]));
        all.map(move |[column, row]| self.lattice([middle(0, column), middle(1, row)]))
    }

    /// Returns the sum of the squared radii of the valid samples where the radius is from `low` to below `high`,
    /// divided by the area of these places.
    pub(super) fn packed(&self, low: f64, high: f64) -> Found<f64> {
        let set = self.set()?;
        self.spend(SET)?;
        let is_meant = |radius: f64| (low..high).contains(&radius);

        let sample_radii = set.points.iter().map(|&at| self.radius_at(at));
        let squares: f64 = sample_radii
            .filter(|&radius| is_meant(radius))
            .map(|radius| radius * radius)
            .sum();
        let radius = |at: Point| {
            self.locality()
                .map_or(1.0, |locality| radii(locality.radius_at(at)))
        };
        let meant = self.places().filter(|&at| is_meant(radius(at))).count();
        if meant == 0 {
            return Err(wrong(format!(
                "no place has a radius from {low} to {high} r"
            )));
        }
        let share = meant as f64 / f64::from(PLACES * PLACES);
        Ok(squares / (share * set.region.area()))
    }

    /// Returns how many of the places that stand for the domain, 128 x 128, are near no valid sample.
    pub(super) fn open_places(&self) -> Found<i64> {
        self.spend(SET)?;
        let cursor = self.cursor();
        let is_open = |at: &Point| {
            if self.recording.is_in_space() {
                return !self.covers_in_space(*at);
            }
            self.recording.covering(*at, cursor).is_none()
        };
        Ok(self.places().filter(is_open).count() as i64)
    }
}
