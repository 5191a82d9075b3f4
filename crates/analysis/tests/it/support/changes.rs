//! Samples on whole places that come and go, and what the judges say about them.

use tilescope_analysis::live::{LiveCover, LivePairs, LiveVerdict, Plane};
use tilescope_analysis::{Boundary, Report, VerifyOptions, exposed_arcs, verify};

use super::{Random, distance, go_on};

/// The largest relative difference between a covering radius that is kept and the judges': theirs come from rounded places.
const SAME_LENGTH: f64 = 1e-11;

pub fn plane(width: u32, height: u32, radius: u32, boundary: Boundary) -> Plane {
    Plane {
        size: [width, height],
        radius,
        boundary,
    }
}

/// Samples with the measures that saw them come and go.
#[derive(Clone)]
pub struct Changing {
    pub plane: Plane,
    pub samples: Vec<(u32, [i32; 2])>,
    pub pairs: LivePairs,
    pub cover: LiveCover,
    next: u32,
}

impl Changing {
    pub fn new(plane: Plane) -> Self {
        Self {
            plane,
            samples: Vec::new(),
            pairs: LivePairs::new(plane).expect("a plane"),
            cover: LiveCover::new(plane).expect("a plane"),
            next: 0,
        }
    }

    /// A set that was there from the beginning.
    pub fn of(plane: Plane, places: &[[i32; 2]]) -> Self {
        let mut changing = Self::new(plane);
        changing.samples = (0..).zip(places.iter().copied()).collect();
        changing.next = changing.samples.len() as u32;
        changing.pairs.rebuild(&changing.samples);
        changing.cover.rebuild(&changing.samples);
        changing
    }

    pub fn insert(&mut self, place: [i32; 2]) {
        let id = self.next;
        self.next += 1;
        self.samples.push((id, place));
        self.pairs.insert(id, place);
        self.cover.insert(id, place);
    }

    pub fn remove(&mut self, index: usize) {
        let (id, place) = self.samples.swap_remove(index);
        self.pairs.remove(id, place);
        self.cover.remove(id, place);
    }

    /// A random place whose coordinates are multiples of `step`.
    pub fn random_place(&self, random: &mut Random, step: u32) -> [i32; 2] {
        let closed = u32::from(self.plane.boundary == Boundary::Bounded);
        self.plane.size.map(|side| {
            let places = side.div_ceil(step).max(1) + closed * u32::from(side % step == 0);
            (((random.uniform() * f64::from(places)) as u32) * step) as i32
        })
    }

    pub fn points(&self) -> Vec<[f64; 2]> {
        let radius = f64::from(self.plane.radius);
        let places = self.samples.iter().map(|(_, place)| place);
        places
            .map(|place| place.map(|value| f64::from(value) / radius))
            .collect()
    }

    pub fn report(&self) -> Report {
        let options = VerifyOptions {
            witnesses: 100_000,
            ..VerifyOptions::default()
        };
        let region = self.plane.region_in_radii();
        verify(&self.points(), region, 1.0, &options, &go_on).expect("a report")
    }

    /// How the measures differ from what both judges say, from nothing, about the same samples.
    pub fn difference(&self) -> Option<String> {
        let verdict = LiveVerdict::of(&self.pairs, &self.cover);
        if self.samples.is_empty() {
            let is_nothing = verdict.closest.is_none() && verdict.largest.is_none();
            let is_empty = verdict.count == 0 && verdict.conflicts == 0 && verdict.gaps == 0;
            return (!is_nothing || !is_empty || verdict.maximal())
                .then(|| format!("not nothing: {verdict:?}"));
        }

        let report = self.report();
        let differs = [
            (verdict.count != report.count, "count"),
            (verdict.conflicts != report.conflicts, "conflicts"),
            (
                verdict.min_distance.to_bits() != report.min_distance.to_bits(),
                "smallest distance",
            ),
            (verdict.gaps != report.gaps, "gaps"),
            (
                (verdict.covering_radius / report.covering_radius - 1.0).abs() > SAME_LENGTH,
                "covering radius",
            ),
            (verdict.maximal() != report.maximal(), "maximality"),
            (verdict.valid() != report.valid(), "validity"),
        ];
        let which: Vec<&str> = (differs.iter().filter(|(is, _)| *is))
            .map(|(_, name)| *name)
            .collect();
        (!which.is_empty()).then(|| format!("{which:?}: {verdict:?} {report:?}"))
    }

    pub fn check(&self, when: &str) {
        let difference = self.difference();
        assert!(
            difference.is_none(),
            "{when}: {}",
            difference.unwrap_or_default()
        );
    }

    /// Compares the witnesses, too.
    pub fn check_witnesses(&self, when: &str) {
        self.check(when);
        if self.samples.is_empty() {
            return;
        }
        let (report, region) = (self.report(), self.plane.region_in_radii());
        let points = self.points();
        let nearest = |place: [f64; 2]| {
            let distances = points.iter().map(|point| distance(*point, place, region));
            distances.fold(f64::INFINITY, f64::min)
        };

        let largest = self.cover.largest().expect("a circle");
        assert!(
            (nearest(largest.center) / report.covering_radius - 1.0).abs() < 1e-9,
            "{when}: {largest:?}"
        );
        let gaps = self.cover.gaps();
        assert_eq!(gaps.len(), report.worst_gaps.len(), "{when}");
        for gap in &gaps {
            let is_same = |other: &&tilescope_analysis::Gap| {
                distance(other.center, gap.center, region) < 1e-8 && other.kind == gap.kind
            };
            assert!(
                report.worst_gaps.iter().any(|other| is_same(&other)),
                "{when}: {gap:?}"
            );
            assert!(
                (nearest(gap.center) / gap.distance - 1.0).abs() < 1e-9,
                "{when}: {gap:?}"
            );
        }

        let index = |id: usize| {
            self.samples
                .iter()
                .position(|sample| sample.0 as usize == id)
        };
        let conflicts = self.pairs.conflict_pairs();
        assert_eq!(conflicts.len() as u64, report.conflicts, "{when}");
        let distances = |conflicts: &[tilescope_analysis::Conflict]| -> Vec<u64> {
            conflicts
                .iter()
                .map(|conflict| conflict.distance.to_bits())
                .collect()
        };
        assert_eq!(
            distances(&conflicts),
            distances(&report.worst_conflicts),
            "{when}"
        );
        let closest = self.pairs.closest();
        if let Some(closest) = closest {
            assert_eq!(
                closest.distance.to_bits(),
                report.min_distance.to_bits(),
                "{when}"
            );
            let [one, other] =
                [closest.first, closest.second].map(|id| points[index(id).expect("a sample")]);
            let apart = distance(one, other, region);
            let is_own_copy = closest.first == closest.second;
            assert!(
                is_own_copy || (apart - closest.distance).abs() < 1e-9,
                "{when}"
            );
        }
        self.check_arcs(when);
    }

    /// Compares the exposed arcs with those of the judge by circles.
    fn check_arcs(&self, when: &str) {
        let radius = 1.0 + tilescope_analysis::COVERING_TOLERANCE;
        let (points, region) = (self.points(), self.plane.region_in_radii());
        // It declines radii of many periods.
        let Ok(expected) = exposed_arcs(&points, region, radius, &go_on) else {
            return;
        };
        let mut degrees = vec![0.0; points.len()];
        for arc in expected {
            degrees[arc.sample] += arc.to - arc.from;
        }
        for ((_, place), expected) in self.samples.iter().zip(degrees) {
            let found: f64 = self
                .cover
                .exposed_arcs(*place)
                .iter()
                .map(|[from, to]| to - from)
                .sum();
            assert!(
                (found - expected).abs() < 1e-6,
                "{when}: {place:?} {found} {expected}"
            );
        }
    }
}
