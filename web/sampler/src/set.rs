//! Makes sets as a whole, and windows of planes that stay between requests.

use tilescope_core::{
    Boundary, Domain, ExactPlane, Parameters, Pattern, PatternHistory, PlaceBuffers, Plane, Point,
    SampleError, Sweep, TilingMethod, Unobserved, WindowMaker, exact_points, radius_for_count,
    reference_sample,
};

use crate::request::{Method, Settings};

/// A plane by either method.
enum Windows {
    Kdrt(Box<Plane>),
    Exact(Box<ExactPlane<'static>>),
}

impl Windows {
    fn new(parameters: &Parameters) -> Result<Self, SampleError> {
        let pattern = &parameters.pattern;
        if parameters.method == TilingMethod::Kdrt {
            let pattern = Pattern::of_spec(pattern, &mut Unobserved)?;
            return Ok(Self::Kdrt(Box::new(Plane::new(parameters, &pattern)?)));
        }

        // A plane of exact tiling borrows its history, which therefore stays in memory until the module goes: hosts keep planes
        // for as long, and an own allocation for each would need unsafe code.
        let history = Box::leak(Box::new(PatternHistory::of_spec(pattern, &mut Unobserved)?));
        let plane = ExactPlane::new(parameters, history)?;
        Ok(Self::Exact(Box::new(plane)))
    }

    fn domain(&self) -> &Domain {
        match self {
            Self::Kdrt(plane) => plane.domain(),
            Self::Exact(plane) => plane.domain(),
        }
    }

    /// Returns the positions of the samples in a rectangle or, with an earlier one, of those that it did not have.
    fn positions(
        &self,
        [low, high]: [[f64; 2]; 2],
        from: Option<[[f64; 2]; 2]>,
    ) -> Result<Vec<f64>, SampleError> {
        let domain = self.domain();
        let window = domain.window(low, high)?;
        let from = from
            .map(|[low, high]| domain.window(low, high))
            .transpose()?;

        // As the library for C does: places of the plane rather than of the domain, so that a window beyond the square that repeats
        // has positions beyond it.
        let mut buffers = PlaceBuffers::default();
        let places = match (self, from) {
            (Self::Kdrt(plane), None) => plane.places(&window, &mut buffers),
            (Self::Kdrt(plane), Some(from)) => plane.gained(&from, &window, &mut buffers),
            (Self::Exact(plane), None) => plane.places(&window, &mut buffers),
            (Self::Exact(plane), Some(from)) => plane.gained(&from, &window, &mut buffers),
        }?;
        Ok(domain.users_from_plane(places).flatten().collect())
    }
}

/// The planes that a host has made, by number.
#[derive(Default)]
pub struct Planes {
    planes: Vec<Option<Windows>>,
}

impl Planes {
    /// No planes, as the module begins.
    pub const NONE: Self = Self { planes: Vec::new() };

    /// Returns the positions of a plane's samples in a rectangle, given by two corners, or of those alone that another rectangle
    /// does not have.
    ///
    /// # Errors
    ///
    /// A sentence that names the value and the limit.
    pub fn window(
        &self,
        number: usize,
        window: [[f64; 2]; 2],
        from: Option<[[f64; 2]; 2]>,
    ) -> Result<Vec<f64>, String> {
        let plane = self.plane(number)?;
        plane.positions(window, from).map_err(in_words)
    }

    /// Frees a plane.
    ///
    /// # Errors
    ///
    /// There is no such plane.
    pub fn free(&mut self, number: usize) -> Result<(), String> {
        self.plane(number)?;
        // The numbers of the others stay, so that its place stays too.
        self.planes[number] = None;
        Ok(())
    }

    fn plane(&self, number: usize) -> Result<&Windows, String> {
        let plane = self.planes.get(number).and_then(Option::as_ref);
        plane.ok_or_else(|| format!("there is no plane {number}; it was freed"))
    }

    /// Makes a plane and returns its number.
    ///
    /// # Errors
    ///
    /// A sentence that names the value and the limit.
    pub fn make(&mut self, settings: &Settings) -> Result<usize, String> {
        if settings.radius.is_none() || settings.count.is_some() {
            return Err("a plane needs a radius, and takes no count".to_owned());
        }
        if settings.method == Some(Method::Reference) {
            return Err(
                "the reference sampler makes whole sets alone; a plane needs \"kdrt\" or \"exact\""
                    .to_owned(),
            );
        }
        // A border would be as far away as the plane repeats, where a bounded domain of the same sides has another set.
        if settings.boundary == Some(Boundary::Bounded) {
            return Err("a plane has no border; \"boundary\" is for sets".to_owned());
        }

        let made = Windows::new(&settings.as_plane().parameters()).map_err(in_words)?;
        self.planes.push(Some(made));
        Ok(self.planes.len() - 1)
    }
}

fn in_words(error: impl Into<SampleError>) -> String {
    error.into().to_string()
}

/// Returns the radius of a set and then its positions, in canonical order.
///
/// # Errors
///
/// A sentence that names the value and the limit.
pub fn sample(settings: &Settings) -> Result<Vec<f64>, String> {
    if settings.radius.is_some() == settings.count.is_some() {
        return Err("a set needs a radius or a count, and not both".to_owned());
    }
    // The search for a radius makes parts of sets by tiling, and would take whole sets by the others.
    if settings.count.is_some() && settings.method.is_some_and(|method| method != Method::Kdrt) {
        return Err("a count needs the method \"kdrt\"; the others take a radius".to_owned());
    }

    let mut parameters = settings.parameters();
    let points = points(settings, &mut parameters).map_err(in_words)?;
    let domain = parameters.validate().map_err(in_words)?;
    let positions = points.iter();
    let positions = positions.flat_map(|&point| domain.user_from_lattice(point));
    Ok(std::iter::once(parameters.radius)
        .chain(positions)
        .collect())
}

/// Returns the samples of a set on the lattice. Where a count is asked for, the parameters get the radius that was found.
fn points(settings: &Settings, parameters: &mut Parameters) -> Result<Vec<Point>, SampleError> {
    match settings.method.unwrap_or_default() {
        Method::Kdrt => {
            let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
            if let Some(count) = settings.count {
                parameters.radius = radius_for_count(parameters, count, &pattern, &mut Unobserved)?;
            }

            // The engine of windows, which has all but Algorithm 4 as printed: the sequential one would add 18 kB.
            let sweep = Sweep::new(parameters, &pattern, false)?;
            Ok(sweep.finish(&mut Unobserved)?.0.points)
        }
        Method::Exact => {
            // All darts of the pattern rather than its samples: which of them stay depends on those before them.
            let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
            exact_points(parameters, &history, &mut Unobserved)
        }
        Method::Reference => {
            // It throws its darts one after the other, so that its sets have the limit of sequential runs.
            let domain = parameters.validate_sequential()?;
            reference_sample(domain, parameters.seed, &mut Unobserved)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(radius: f64, seed: u64) -> Settings {
        Settings {
            radius: Some(radius),
            seed: Some(seed),
            ..Settings::default()
        }
    }

    fn pairs(positions: &[f64]) -> Vec<[f64; 2]> {
        let mut pairs = positions.as_chunks().0.to_vec();
        pairs.sort_by(|a, b| a.partial_cmp(b).unwrap());
        pairs
    }

    #[test]
    fn a_set_has_its_radius_and_its_positions() {
        let made = sample(&settings(0.05, 7)).unwrap();
        let run = tilescope_core::sample(&settings(0.05, 7).parameters(), &mut Unobserved);
        assert_eq!(made[0].to_bits(), 0.05_f64.to_bits());
        assert_eq!(made[1..], *run.unwrap().positions().as_flattened());
    }

    #[test]
    fn a_plane_has_the_samples_of_its_set_and_repeats_without_end() {
        let small = Settings {
            width: Some(1.0),
            ..settings(0.02, 3)
        };
        let mut planes = Planes::default();
        assert_eq!(planes.make(&small).unwrap(), 0);
        let found = planes.window(0, [[0.25, 0.5], [0.5, 0.75]], None).unwrap();

        let mut wanted = pairs(&sample(&settings(0.02, 3)).unwrap()[1..]);
        wanted.retain(|[x, y]| (0.25..0.5).contains(x) && (0.5..0.75).contains(y));
        assert_eq!(pairs(&found), wanted);

        let beyond = planes.window(0, [[1.25, 0.5], [1.5, 0.75]], None).unwrap();
        assert_eq!(beyond.len(), found.len());
        assert!(pairs(&beyond).iter().all(|[x, _]| *x >= 1.25));

        planes.free(0).unwrap();
        let error = planes
            .window(0, [[0.0, 0.0], [0.5, 0.5]], None)
            .unwrap_err();
        assert!(error.contains("freed"), "{error}");
    }

    #[test]
    fn a_move_gains_what_was_not_in_view() {
        let mut planes = Planes::default();
        planes.make(&settings(0.02, 3)).unwrap();
        let (from, to) = ([[0.75, 0.0], [1.25, 0.25]], [[1.0, 0.0], [1.5, 0.25]]);
        let before = pairs(&planes.window(0, from, None).unwrap());
        let mut after = pairs(&planes.window(0, to, None).unwrap());
        let gained = pairs(&planes.window(0, to, Some(from)).unwrap());

        assert!(!gained.is_empty() && gained.len() < after.len());
        after.retain(|place| !before.contains(place));
        assert_eq!(gained, after);
    }

    #[test]
    fn wrong_settings_are_refused() {
        let of = |method| Settings {
            method: Some(method),
            ..settings(1.0, 1)
        };
        let counted = Settings {
            count: Some(900),
            radius: None,
            ..of(Method::Exact)
        };
        for (error, part) in [
            (
                sample(&Settings::default()).unwrap_err(),
                "a radius or a count",
            ),
            (sample(&settings(-1.0, 1)).unwrap_err(), "-1"),
            (sample(&counted).unwrap_err(), "kdrt"),
        ] {
            assert!(error.contains(part), "{error}");
        }

        let mut planes = Planes::default();
        let bounded = Settings {
            boundary: Some(Boundary::Bounded),
            ..settings(1.0, 1)
        };
        for (settings, part) in [
            (counted, "needs a radius"),
            (of(Method::Reference), "whole sets"),
            (bounded, "no border"),
        ] {
            let error = planes.make(&settings).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
