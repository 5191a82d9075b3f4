//! The measures at rest of a set in space: the power by shells of frequency and g(r) of the samples that have arrived. They take
//! seconds in a large set, so that a moment is measured in the background once the cursor rests there. Begin with
//! [`SolidMeasuring::want`]; the numbers that move with the run are in `crate::live`.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_analysis::measures::MeasuredSet;
use tilescope_analysis::{SolidCorrelation, SolidError, SolidRegion, SolidSpectrum};
use tilescope_live::{Course, LiveMoment, Wanted};
use tilescope_session::geometry::{Key, key_of};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::{Moment, ShownMoment};
use tilescope_session::session::Session;
use tilescope_session::solid::MadeSolid;
use tilescope_session::task::{self, SessionRef, Task};
use tilescope_session::words::{counted, grouped, sentence};

/// Width of a bin of g(r), in radii, as `tilescope analyze` has it.
const BIN: f64 = 0.05;

/// The longest distance of g(r), in radii, as there: g is 1 to within a hundredth from then on.
pub const REACH: f64 = 4.0;

/// The fewest samples that are measured, as in the plane.
const MIN_SAMPLES: usize = 3;

/// The numbers, the spectrum and g(r) of a set in space. Lengths of the latter are in radii.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidMeasures {
    /// The numbers of a set without events, which has no run that they could move with.
    pub numbers: Option<MeasuredSet>,
    /// The power by shells of frequency.
    pub spectrum: SolidSpectrum,
    /// g(r), up to 4 r or half the shortest side.
    pub correlation: SolidCorrelation,
}

impl SolidMeasures {
    /// Returns the power over the frequency, in the cube root of the samples to the volume.
    #[must_use]
    pub fn power(&self) -> Vec<[f64; 2]> {
        let shells = self.spectrum.shells.iter();
        shells.map(|shell| [shell.nu, shell.power]).collect()
    }

    /// Returns g over the distance in radii, at the middles of its bins.
    #[must_use]
    pub fn pairs(&self) -> Vec<[f64; 2]> {
        let (found, half) = (&self.correlation, 0.5);
        let bins = (0_u32..).zip(&found.g);
        bins.map(|(bin, g)| [(f64::from(bin) + half) * found.bin_width, *g])
            .collect()
    }
}

/// The measures of a moment of a set in space.
#[derive(Clone)]
pub struct SolidKnown {
    /// The moment that was measured, with the generation of its session.
    pub key: Key,
    /// The moment's name: the number of its event, if the run has events.
    pub name: String,
    /// The measures.
    pub measures: Arc<SolidMeasures>,
}

/// An error without text means that it was stopped.
type SolidOutcome = Result<SolidMeasures, Option<String>>;

struct SolidWork {
    key: Key,
    name: String,
    job: Job<SolidOutcome>,
}

/// The measuring of the moments of a run in space.
#[derive(Default)]
pub struct SolidMeasuring {
    /// The moment of the frame before.
    at: Option<Key>,
    work: Option<SolidWork>,
    /// The moment that was measured last.
    known: Option<SolidKnown>,
    /// The moment at which the user stopped measuring.
    stopped: Option<Key>,
    /// The last moment that could not be measured, and why.
    failed: Option<(Key, String)>,
}

impl SolidMeasuring {
    /// Returns the measures of the moment of this session that was measured last, and whether it is the one shown.
    #[must_use]
    pub fn last(&self, shown: &ShownMoment<'_>) -> Option<(&SolidKnown, bool)> {
        let known = self.known.as_ref()?;
        let key = key_of(shown);
        (known.key.0 == key.0).then(|| (known, known.key == key))
    }

    /// Returns the numbers of a set without events, once they are measured.
    #[must_use]
    pub fn numbers(&self, shown: &ShownMoment<'_>) -> Option<&MeasuredSet> {
        let (known, is_shown) = self.last(shown)?;
        known.measures.numbers.as_ref().filter(|_| is_shown)
    }

    /// Returns whether a moment is measured.
    #[must_use]
    pub fn is_measured(&self, shown: &ShownMoment<'_>) -> bool {
        self.last(shown).is_some_and(|(_, is_shown)| is_shown)
    }

    /// Returns the fraction done, from 0 to 1, while a moment is being measured.
    #[must_use]
    pub fn progress(&self) -> Option<f32> {
        Some(self.work.as_ref()?.job.fraction())
    }

    /// Returns whether the user stopped measuring this moment.
    #[must_use]
    pub fn is_stopped(&self, shown: &ShownMoment<'_>) -> bool {
        self.stopped == Some(key_of(shown))
    }

    /// Returns why a moment cannot be measured.
    #[must_use]
    pub fn failure(&self, shown: &ShownMoment<'_>) -> Option<&str> {
        let (key, why) = self.failed.as_ref()?;
        (*key == key_of(shown)).then_some(why)
    }

    /// Stops measuring a moment.
    pub fn stop(&mut self, shown: &ShownMoment<'_>) {
        self.work = None;
        self.stopped = Some(key_of(shown));
    }

    /// Measures on, also a moment that could not be measured before.
    pub fn resume(&mut self) {
        (self.stopped, self.failed) = (None, None);
    }

    /// Stops the work, since nothing shows it. The measures of the last moment stay.
    pub fn rest(&mut self) {
        (self.at, self.work) = (None, None);
    }

    /// Takes finished work, and starts measuring a moment at which the cursor stayed from one call to the next. Work for another
    /// moment is stopped.
    pub fn want(&mut self, session: &Arc<Session>, shown: &ShownMoment<'_>, wake: &Wake) {
        if let Some(outcome) = self.work.as_ref().and_then(|work| work.job.poll()) {
            self.take(outcome);
        }
        let key = key_of(shown);
        // In play each frame would start work that the next one drops. `wake` asks for one more frame, in which the
        // cursor may rest.
        if self.at != Some(key) {
            (self.at, self.work) = (Some(key), None);
            wake();
            return;
        }

        let is_refused = self.stopped == Some(key) || self.failure(shown).is_some();
        if self.work.is_none() && !is_refused && !self.is_measured(shown) {
            let name = match shown.debugger {
                Some(_) => format!("event {}", grouped(shown.cursor())),
                None => "the end".to_owned(),
            };
            let task = MeasureSolidTask {
                session: SessionRef(Arc::clone(session)),
                moment: shown.moment(),
            };
            self.work = Some(SolidWork {
                key,
                name,
                job: task::start(wake, task),
            });
        }
    }

    fn take(&mut self, outcome: Result<SolidOutcome, String>) {
        let Some(SolidWork { key, name, .. }) = self.work.take() else {
            return;
        };
        match outcome {
            Ok(Ok(measures)) => {
                self.known = Some(SolidKnown {
                    key,
                    name,
                    measures: Arc::new(measures),
                });
            }
            // The user stopped the work, so that there is nothing to report.
            Ok(Err(None)) => {}
            Ok(Err(Some(why))) => self.failed = Some((key, why)),
            Err(panic) => self.failed = Some((key, sentence(&panic))),
        }
    }

    /// Waits for the running work; returns whether there was any.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) -> bool {
        let outcome = self.work.as_ref().map(|work| work.job.wait());
        let is_working = outcome.is_some();
        if let Some(outcome) = outcome {
            self.take(outcome);
        }
        is_working
    }
}

/// The task of measuring the samples that have arrived at a moment of a set in space.
#[derive(Serialize, Deserialize)]
pub struct MeasureSolidTask {
    session: SessionRef,
    moment: Moment,
}

impl Task for MeasureSolidTask {
    type Outcome = SolidOutcome;
    const NAME: &'static str = "measure in space";

    fn run(self, monitor: &Monitor) -> SolidOutcome {
        let session = &*self.session;
        let Some(solid) = &session.solid else {
            return Err(Some("This set is planar.".to_owned()));
        };
        let points = arrived(session, solid, self.moment);
        if points.len() < MIN_SAMPLES {
            let count = counted(points.len(), "sample stands", "samples stand");
            return Err(Some(format!(
                "{count}; at least {MIN_SAMPLES} are needed to be measured."
            )));
        }

        let measured = measured(&points, region_in_radii(solid), monitor);
        let measures = measured.map_err(|error| match error {
            SolidError::Cancelled => None,
            error => Some(sentence(&error.to_string())),
        })?;
        // A run with events has these numbers at every moment already: `crate::live` moves them with the run.
        let numbers = match session.recording() {
            Some(_) => None,
            None => Some(numbers(session, solid)?),
        };
        Ok(SolidMeasures {
            numbers,
            ..measures
        })
    }
}

/// Returns the numbers of a whole set.
fn numbers(session: &Session, solid: &MadeSolid) -> Result<MeasuredSet, String> {
    let run = session.run();
    let ids = 0..run.samples.len() as u32;
    let heights = ids.map(|id| solid.height(id)).collect();
    let course = Course::of_arrivals(solid.domain, run.domain, &run.samples.points, heights);

    let wanted = Wanted {
        pairs: true,
        ..Wanted::default()
    };
    let events = course.events();
    let mut moment = LiveMoment::new(Arc::new(course));
    let no_limit_of_steps = u64::MAX;
    let moved = moment.seek(events, wanted, no_limit_of_steps);
    moved.map_err(|error| sentence(&error.to_string()))?;
    Ok(moment.measured())
}

/// Returns the places of the samples that have arrived, in radii.
fn arrived(session: &Session, solid: &MadeSolid, moment: Moment) -> Vec<[f64; 3]> {
    let radius = solid.domain.radius();
    let places = solid.positions(session.run()).into_iter().zip(0..);
    let there = places.filter(|&(_, id)| moment.covers(session, id));
    there
        .map(|(place, _)| place.map(|along| along / radius))
        .collect()
}

/// Returns the box of a set, in radii.
fn region_in_radii(solid: &MadeSolid) -> SolidRegion {
    let (region, radius) = (solid.region(), solid.domain.radius());
    SolidRegion {
        width: region.width / radius,
        height: region.height / radius,
        depth: region.depth / radius,
        boundary: region.boundary,
    }
}

/// Measures samples in a box whose unit is r.
fn measured(
    points: &[[f64; 3]],
    region: SolidRegion,
    monitor: &Monitor,
) -> Result<SolidMeasures, SolidError> {
    monitor.set_activity("g(r)");
    let control = |progress| monitor.follow(progress);
    // A hair less than half the side, since rounding may lift a whole number of bins above it.
    let shortest = region.size().into_iter().fold(f64::INFINITY, f64::min);
    let bins = (REACH.min(0.499 * shortest) / BIN) as usize;
    let correlation = SolidCorrelation::of(points, region, BIN * bins as f64, bins, &control)?;

    monitor.set_activity("spectrum");
    let spectrum = SolidSpectrum::of(points, region, SolidSpectrum::USUAL, &control)?;
    Ok(SolidMeasures {
        numbers: None,
        spectrum,
        correlation,
    })
}
