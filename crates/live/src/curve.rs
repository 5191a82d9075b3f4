//! The run as a curve: numbers of the catalogue over its events. It is made in slices, so that a window can show how far it
//! is and stop it. A slice ends after so many *counted steps*, units of work that are the same on every machine.

use std::fmt::Write;
use std::sync::Arc;

use tilescope_analysis::measures::{MeasureError, SetNumber};
use tilescope_core::Stage;

use crate::course::Course;
use crate::moment::{LiveMoment, Wanted};
use crate::numbers::{is_of_spectrum, wanted_for};

/// The moments of a curve of the spectrum, if no number of them is stated: reading a spectrum of a quarter of a million
/// frequencies takes as long as ten changes of the samples do, and a curve is drawn a thousand points wide.
pub const MOMENTS_OF_SPECTRUM: usize = 1_000;

/// The most samples of a curve of the spectrum. Both the frequencies and the changes grow with the samples, so that the time
/// grows with their square: 20,000 samples take some seconds.
pub const MAX_SAMPLES_OF_SPECTRUM: usize = 20_000;

/// The fewest moments of a curve: its two ends.
pub const MIN_MOMENTS: usize = 2;

/// The steps that reading the numbers of a moment counts for, beside those of the spectrum. Chosen, not measured.
const READING: u64 = 100;

/// Numbers of a run over its events.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The numbers, one for each column.
    pub numbers: Vec<&'static SetNumber>,
    /// How many events have happened at each moment, from 0 to all.
    pub events: Vec<usize>,
    /// The stage of each moment.
    pub stages: Vec<Stage>,
    /// Whether iterations are levels, as in exact tilings ([`Course::has_levels`]).
    pub has_levels: bool,
    /// The value of each number at each moment; NaN where it is not defined.
    pub columns: Vec<Vec<f64>>,
}

impl Curve {
    /// Returns the name of the stage of each moment, such as `iterate 1`, or of an exact tiling `levels 0 and 1`.
    pub fn stage_names(&self) -> impl Iterator<Item = String> {
        self.stages.iter().map(|stage| match stage {
            Stage::Iterate(1) if self.has_levels => "levels 0 and 1".to_owned(),
            Stage::Iterate(level) if self.has_levels => format!("level {level}"),
            stage => stage.to_string(),
        })
    }

    /// Returns the curve as CSV: a header, and a row for each moment. A number that is not defined is an empty cell.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = String::from("event,stage");
        for number in &self.numbers {
            out.push(',');
            out.push_str(number.key);
        }
        out.push('\n');

        for (row, (event, stage)) in self.events.iter().zip(self.stage_names()).enumerate() {
            let _ = write!(out, "{event},{stage}");
            for column in &self.columns {
                let value = column[row];
                out.push(',');
                // NaN stands for a number that is not defined there; an infinite one counts as not defined, too.
                if value.is_finite() {
                    let _ = write!(out, "{value}");
                }
            }
            out.push('\n');
        }
        out
    }
}

/// Why a curve cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// There are too many samples for the spectrum.
    #[error(
        "the run has up to {count} samples at once; the curve of {key} takes at most {MAX_SAMPLES_OF_SPECTRUM}: leave it out, or take a larger radius"
    )]
    TooMany {
        /// A number that needs the spectrum.
        key: &'static str,
        /// The most samples at once.
        count: usize,
    },
    /// The number means nothing in what the samples lie in, as a planar number in space.
    #[error("the number \"{key}\" is not followed {place}")]
    NotHere {
        /// The key of the number.
        key: &'static str,
        /// Where it is not followed.
        place: &'static str,
    },
    /// There are too few moments.
    #[error(
        "a curve of {moments} moments has not both of its ends; at least {MIN_MOMENTS} are needed"
    )]
    TooFewMoments {
        /// The number asked for.
        moments: usize,
    },
    /// A measure is not defined in the domain of the run.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// A curve that is being made.
pub struct CurveMaker {
    moment: LiveMoment,
    wanted: Wanted,
    /// The moments of the curve, each by how many events have happened there.
    cursors: Vec<usize>,
    curve: Curve,
}

impl CurveMaker {
    /// Begins the curve of `numbers`. It is read at both ends of the run and after every change of its samples, or, if
    /// there are more such moments than `moments`, at so many that are evenly spread among them. If a number is of the
    /// spectrum and `moments` is not given, there are at most [`MOMENTS_OF_SPECTRUM`].
    ///
    /// Each number must be one that every moment has: [`crate::numbers_named_in`] returns such numbers. Of a run in space, the
    /// number with the same key is taken that is defined there.
    ///
    /// # Errors
    ///
    /// [`CurveError`]. Nothing is computed before.
    pub fn new(
        course: Arc<Course>,
        numbers: &[&'static SetNumber],
        moments: Option<usize>,
    ) -> Result<Self, CurveError> {
        let setting = course.setting();
        let own = numbers.iter().map(|number| {
            let (key, place) = (number.key, setting.place());
            setting
                .number(key)
                .ok_or(CurveError::NotHere { key, place })
        });
        let numbers: Vec<&'static SetNumber> = own.collect::<Result<_, _>>()?;

        // Too many samples are refused before anything is computed, as the time grows with the square of their number.
        let of_spectrum = numbers.iter().find(|number| is_of_spectrum(number));
        let count = course.most_samples();
        if let Some(number) = of_spectrum.filter(|_| count > MAX_SAMPLES_OF_SPECTRUM) {
            let key = number.key;
            return Err(CurveError::TooMany { key, count });
        }
        if let Some(moments) = moments.filter(|moments| *moments < MIN_MOMENTS) {
            return Err(CurveError::TooFewMoments { moments });
        }

        // Reading a spectrum costs more than the changes between two moments, so that a curve of the spectrum does not read every
        // moment. Other curves read all of them unless `moments` says less.
        let moments = moments.or(of_spectrum.map(|_| MOMENTS_OF_SPECTRUM));
        let cursors = spread_cursors(&course, moments.unwrap_or(usize::MAX));
        let curve = Curve {
            numbers: numbers.clone(),
            events: Vec::with_capacity(cursors.len()),
            stages: Vec::with_capacity(cursors.len()),
            has_levels: course.has_levels(),
            columns: vec![Vec::with_capacity(cursors.len()); numbers.len()],
        };
        let wanted = wanted_for(&numbers);
        Ok(Self {
            moment: LiveMoment::new(course),
            wanted,
            cursors,
            curve,
        })
    }

    /// Goes on for about `budget` counted steps, and returns whether all moments are there.
    ///
    /// # Errors
    ///
    /// A measure is not defined in this domain.
    pub fn proceed(&mut self, budget: u64) -> Result<bool, CurveError> {
        let mut steps = 0;
        while let Some(&cursor) = self.cursors.get(self.curve.events.len()) {
            if steps >= budget {
                return Ok(false);
            }

            let moved = self.moment.seek(cursor, self.wanted, budget - steps)?;
            steps += moved.steps;
            // The measures keep the way that they have come: the next call goes on from there.
            if !moved.arrived {
                return Ok(false);
            }
            steps += self.read(cursor);
        }
        Ok(true)
    }

    /// Adds the numbers of the moment, which must be at `cursor` already, and returns the steps that it took.
    fn read(&mut self, cursor: usize) -> u64 {
        let set = self.moment.measured();
        let Curve {
            numbers,
            events,
            stages,
            columns,
            has_levels: _,
        } = &mut self.curve;

        for (number, column) in numbers.iter().zip(columns) {
            column.push(number.of(&set).unwrap_or(f64::NAN));
        }
        events.push(cursor);
        stages.push(self.moment.course().stage(cursor));

        // Reading is counted, too, so that a slice of many moments without changes ends.
        READING + self.moment.cost_of_reading(self.wanted)
    }

    /// Returns how many moments are there, and how many there will be.
    #[must_use]
    pub fn progress(&self) -> [usize; 2] {
        [self.curve.events.len(), self.cursors.len()]
    }

    /// Returns the moments that are there: the curve, once [`Self::proceed`] has returned true.
    #[must_use]
    pub fn finish(self) -> Curve {
        self.curve
    }
}

/// Returns the cursors of a curve: both ends of the run, those after its changes, and in space those where throws
/// begin. If there are more than `most`, which is at least two, `most` of them are taken, evenly spread from the first
/// to the last.
fn spread_cursors(course: &Course, most: usize) -> Vec<usize> {
    let changes = course.changes().iter();
    let after = changes.map(|change| change.event as usize + 1);
    let mut all: Vec<usize> = [0].into_iter().chain(after).collect();
    // The number of active cubes changes where a throw begins, even one that finds no room for a sample.
    if course.is_in_space() {
        all.extend(course.beginnings());
        all.sort_unstable();
    }
    all.push(course.events());
    // The end is listed twice if the last event is a change, as in an order of samples and in a recording that was cut
    // off, or if there are no events.
    all.dedup();
    if all.len() <= most {
        return all;
    }

    let last = all.len() - 1;
    // In 128 bits no product of two numbers of moments overflows.
    let index = |moment: usize| (moment as u128 * last as u128 / (most - 1) as u128) as usize;
    (0..most).map(|moment| all[index(moment)]).collect()
}
