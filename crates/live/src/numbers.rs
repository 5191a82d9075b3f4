//! Numbers of the catalogue, read from the measures of a moment. The catalogue reads them from the same fields as those of a
//! set that was measured from nothing, so that no number has a second name or a second formula.

use tilescope_analysis::live::LiveSpectrum;
use tilescope_analysis::measures::{
    CATALOGUE, MeasuredSet, Part, SPACE_CATALOGUE, SetNumber, SolidMoment, SolidMomentPairs,
    largest_min_distance, number, space_number,
};
use tilescope_analysis::{COVERING_TOLERANCE, MAX_CONFLICTS, Report};

use crate::moment::{LiveMoment, Wanted};
use crate::setting::{Setting, is_live};

/// Why numbers cannot be had at every moment.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// No number has this key.
    #[error("there is no number \"{key}\"; those that can be had at every moment are {known}")]
    Unknown {
        /// The key as it was given.
        key: String,
        /// The keys that can be used, in the catalogue's sequence.
        known: String,
    },
    /// It is measured of whole sets alone.
    #[error(
        "the number \"{key}\" is measured of whole sets alone; those that can be had at every moment are {known}"
    )]
    NotLive {
        /// The key as it was given.
        key: String,
        /// The keys that can be used, in the catalogue's sequence.
        known: String,
    },
    /// It means nothing in what the samples lie in, as a planar number in space.
    #[error(
        "the number \"{key}\" is not followed {place}; those that can be had at every moment there are {known}"
    )]
    NotHere {
        /// The key as it was given.
        key: String,
        /// Where it is not followed, as [`Setting::place`] names it.
        place: &'static str,
        /// The keys that can be used, in the catalogue's sequence.
        known: String,
    },
    /// It is named twice, and columns need different names.
    #[error("the number \"{key}\" is named twice; name it once")]
    Twice {
        /// The key as it was given.
        key: String,
    },
    /// No number is named.
    #[error("no number is named; those that can be had at every moment are {known}")]
    None {
        /// The keys that can be used, in the catalogue's sequence.
        known: String,
    },
}

/// Returns the numbers of the catalogue that can be had at every moment of planar sets of one radius in a rectangle.
pub fn live_numbers() -> impl Iterator<Item = &'static SetNumber> {
    CATALOGUE.iter().filter(|number| is_live(number))
}

/// Returns the numbers that can be had at every moment of sets in space. Most have the key of a planar one, and are defined by
/// distances in space and by the volume.
pub fn space_numbers() -> impl Iterator<Item = &'static SetNumber> {
    SPACE_CATALOGUE.iter()
}

/// Returns a number for each key that planar sets or sets in space have at every moment: the planar one where there is one.
pub fn all_live_numbers() -> impl Iterator<Item = &'static SetNumber> {
    let is_planar = |key| live_numbers().any(|number| number.key == key);
    live_numbers().chain(space_numbers().filter(move |number| !is_planar(number.key)))
}

/// Returns the numbers with these keys of a planar run of one radius in a rectangle. Fails without any key, and for one that is not
/// known, that not every moment has, or that is there twice.
pub fn numbers_named<K: AsRef<str>>(keys: &[K]) -> Result<Vec<&'static SetNumber>, NumberError> {
    numbers_named_in(keys, Setting::Rectangle)
}

/// Returns the numbers with these keys of a run in space. Fails as [`numbers_named`].
pub fn space_numbers_named<K: AsRef<str>>(
    keys: &[K],
) -> Result<Vec<&'static SetNumber>, NumberError> {
    numbers_named_in(keys, Setting::Space)
}

/// Returns the numbers with these keys of a run whose samples lie in `setting`. Fails as [`numbers_named`].
pub fn numbers_named_in<K: AsRef<str>>(
    keys: &[K],
    setting: Setting,
) -> Result<Vec<&'static SetNumber>, NumberError> {
    let known = || {
        let known_keys = setting.numbers().map(|number| number.key);
        known_keys.collect::<Vec<&str>>().join(", ")
    };
    if keys.is_empty() {
        return Err(NumberError::None { known: known() });
    }

    let mut numbers: Vec<&SetNumber> = Vec::with_capacity(keys.len());
    for key in keys.iter().map(AsRef::as_ref) {
        let Some(found) = setting.number(key) else {
            return Err(not_found(key, setting, known()));
        };
        // Readers of a table find a column by its name, so that no two columns may have the same.
        if numbers.iter().any(|number| number.key == key) {
            let key = key.to_owned();
            return Err(NumberError::Twice { key });
        }
        numbers.push(found);
    }
    Ok(numbers)
}

/// Returns why a run has no number with a key at every moment.
fn not_found(key: &str, setting: Setting, known: String) -> NumberError {
    let (planar, in_space) = (number(key), space_number(key));
    let key = key.to_owned();
    match (planar, in_space) {
        (None, None) => NumberError::Unknown { key, known },
        (Some(planar), _) if setting != Setting::Space && !is_live(planar) => {
            NumberError::NotLive { key, known }
        }
        _ => NumberError::NotHere {
            key,
            place: setting.place(),
            known,
        },
    }
}

/// Returns whether a number is read from the spectrum, which takes the most time.
#[must_use]
pub fn is_of_spectrum(number: &SetNumber) -> bool {
    number.needs == Some(Part::Spectrum)
}

/// Returns the measures that numbers are read from.
pub fn wanted_for(numbers: &[&SetNumber]) -> Wanted {
    let is_of_report = |number: &&SetNumber| number.needs == Some(Part::Report);
    let any_of_report = numbers.iter().any(is_of_report);
    Wanted {
        spectrum: numbers.iter().any(|number| is_of_spectrum(number)),
        // Numbers of a part of the frequencies scatter more than the set's own.
        thinned: false,
        pairs: any_of_report,
        cover: any_of_report,
    }
}

impl LiveMoment {
    /// Returns the measures of the moment as those of a set, from which the numbers of the catalogue are read, or of
    /// [`SPACE_CATALOGUE`] for a set in space. A measure that is not the moment's is left out. Distances are those on
    /// the lattice, by which the sampler decides. The sides of the domain are rounded to units of the lattice, so that
    /// these distances differ from those in user units by up to 2 in a million.
    #[must_use]
    pub fn measured(&self) -> MeasuredSet {
        let course = self.course();
        let mut set = MeasuredSet::new(self.count(), course.region(), Some(course.radius()));
        if course.ground().is_some() {
            // The density alone needs no report, which would say the area.
            set = set.covering(course.area());
        }
        if let Some(solid) = course.solid_box() {
            set.space = Some(self.measured_in_space(solid.volume_in_radii()));
            return set;
        }
        if let Some(report) = self.report() {
            set.take_report(report);
        }
        // Of no samples there is no spectrum.
        if let Some(Ok(spectrum)) = self.spectrum().map(LiveSpectrum::spectrum) {
            set.take_spectrum(spectrum);
        }
        set
    }

    /// Returns the followed numbers of a set in space, in a box of a volume in cubed radii.
    fn measured_in_space(&self, volume: f64) -> SolidMoment {
        let pairs = self.balls().map(|balls| SolidMomentPairs {
            conflicts: balls.conflicts(),
            min_distance: balls.smallest_distance_in_radii(),
        });
        SolidMoment {
            volume,
            pairs,
            active_cubes: self.active(),
        }
    }

    /// Returns the cursor of another moment, whose spectrum has come nearest to this one, and the spectrum as part of the measures of
    /// that moment. A run that is played faster than its spectrum can follow has this to show, under the name of its own moment.
    /// `None` where the spectrum is this moment's, or that of no samples.
    #[must_use]
    pub fn measured_behind(&self) -> Option<(usize, MeasuredSet)> {
        if self.spectrum().is_some() {
            return None;
        }
        let (cursor, spectrum) = self.nearest_spectrum()?;
        let spectrum = spectrum.spectrum().ok()?;

        let course = self.course();
        let count = course.count_after(course.changes_before(cursor));
        let mut set = MeasuredSet::new(count, course.region(), Some(course.radius()));
        set.take_spectrum(spectrum);
        Some((cursor, set))
    }

    /// Returns the numbers of a verdict, without witnesses; `None` without samples, or while a measure is not the moment's.
    fn report(&self) -> Option<Report> {
        let pairs = self.pairs()?;
        // In a field or a shape both counts are those of its judge, with the radius at each place, and no covering radius is
        // measured.
        let (conflicts, gaps, covering) = if let Some(squares) = self.squares() {
            let not_measured = f64::INFINITY;
            (squares.conflicts(), squares.open_places(), not_measured)
        } else {
            let cover = self.cover()?;
            let covering = cover.covering_radius_in_radii();
            (pairs.conflicts(), cover.open_places(), covering)
        };
        let count = self.count();
        if count == 0 {
            return None;
        }

        let course = self.course();
        let (radius, area, of_lattice) = (course.radius(), course.area(), course.domain().radius());
        let min_distance = pairs.smallest_distance_in_radii() * of_lattice;
        // Where the radius varies, the distances of a packing are many.
        let relative_radius = if course.setting() == Setting::Field {
            f64::INFINITY
        } else {
            min_distance / largest_min_distance(count, area)
        };

        Some(Report {
            // No judge is asked: these are the numbers that measures keep.
            judges: Vec::new(),
            count,
            region: course.region(),
            radius,
            covering_tolerance: COVERING_TOLERANCE,
            // The verifier stops counting at this limit, and the two numbers must agree.
            conflicts: conflicts.min(MAX_CONFLICTS),
            worst_conflicts: Vec::new(),
            gaps,
            worst_gaps: Vec::new(),
            min_distance,
            covering_radius: covering * of_lattice,
            covering_factor: None,
            area,
            density: count as f64 * radius * radius / area,
            relative_radius,
        })
    }
}
