//! The measures that move with a run: those of the moment that is shown, brought there in each frame by the samples
//! that came or went. Begin with [`Live::follow`]. `tilescope_live` computes them; this module decides for which run
//! and how much in a frame, and says why where there are none. Work is limited by *counted steps*, the same on every
//! machine, and not by time.

use std::sync::Arc;

use tilescope_analysis::live::{LiveCover, LivePairs, LiveSpectrum};
use tilescope_analysis::measures::MeasuredSet;
use tilescope_live::{Course, FRAME_STEPS, LiveMoment, MAX_SAMPLES, Wanted};
use tilescope_session::geometry::{Key, key_of};
use tilescope_session::jobs::{Job, Wake};
use tilescope_session::moment::ShownMoment;
use tilescope_session::session::Session;
use tilescope_session::words::{counted, grouped, sentence};

/// The counted steps that all watches have in a frame.
pub const WATCH_STEPS: u64 = FRAME_STEPS;

/// The time of the frame that has [`FRAME_STEPS`]: on a screen of 60 frames a second.
const FRAME_SECS: f32 = 1.0 / 60.0;

/// The most times [`FRAME_STEPS`] in a frame. Frames of more than about a quarter of a second have so many steps, which take about
/// 40 ms.
const MAX_LONGER: f32 = 8.0;

/// Returns the counted steps of a frame after one of `dt_secs`. Where drawing takes long, a frame of play brings more changes, and
/// with the steps of a short frame its measures would fall behind for good. They grow with half of the time: the steps of a
/// short frame take 5 of its 17 ms, so that with all of the time each frame would be longer than the one before on a machine of
/// less than a third of the speed.
#[must_use]
pub fn frame_steps(dt_secs: f32) -> u64 {
    let longer = (0.5 * dt_secs / FRAME_SECS).clamp(1.0, MAX_LONGER);
    (FRAME_STEPS as f64 * f64::from(longer)) as u64
}

/// Where the measures of a run are.
#[derive(Default)]
enum Followed {
    /// Nothing has asked for measures.
    #[default]
    Nothing,
    /// The run is being read in the background: which sample comes or goes when.
    Away(Job<Result<Box<LiveMoment>, String>>),
    /// At the moment of the frame before, or on their way from there.
    Here(Box<LiveMoment>),
    /// The run has none, and why.
    Refused(String),
}

/// The spectrum of another moment of the run: the one that has come nearest to the shown moment, while the run is played faster
/// than its spectrum can follow.
pub struct Behind {
    /// How many events lie before its moment.
    pub cursor: usize,
    /// The measures of its moment, of which there is the spectrum alone.
    pub measured: Arc<MeasuredSet>,
}

/// The measures of the shown moment of a run, as far as something asks for them.
#[derive(Default)]
pub struct Live {
    /// The generation of the session.
    generation: Option<u64>,
    followed: Followed,
    /// The last moment that was measured, at least in part.
    measured: Option<(Key, Arc<MeasuredSet>)>,
    /// The share of the frequencies that its spectrum has.
    share: Option<f64>,
    behind: Option<Behind>,
    steps: u64,
}

impl Live {
    /// Returns the measures of a moment, as far as they are that moment's, with lengths in user units.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>) -> Option<&Arc<MeasuredSet>> {
        let (key, measured) = self.measured.as_ref()?;
        (*key == key_of(shown)).then_some(measured)
    }

    /// Returns the share of the frequencies that the spectrum of a moment has; `None` while there is no spectrum of it.
    #[must_use]
    pub fn share(&self, shown: &ShownMoment<'_>) -> Option<f64> {
        self.of(shown).and(self.share)
    }

    /// Returns the spectrum of another moment, while that of this one is not there yet.
    #[must_use]
    pub fn behind(&self, shown: &ShownMoment<'_>) -> Option<&Behind> {
        self.of(shown).and(self.behind.as_ref())
    }

    /// Returns the covered circles of a moment, if they were followed to it.
    #[must_use]
    pub fn cover(&self, shown: &ShownMoment<'_>) -> Option<&LiveCover> {
        match &self.followed {
            Followed::Here(moment) if self.of(shown).is_some() => moment.cover(),
            Followed::Here(_) | Followed::Nothing | Followed::Away(_) | Followed::Refused(_) => {
                None
            }
        }
    }

    /// Returns why this run has no measures that move with it; `None` where it has, or nothing asked for any.
    #[must_use]
    pub fn refusal(&self) -> Option<&str> {
        match &self.followed {
            Followed::Refused(why) => Some(why),
            Followed::Nothing | Followed::Away(_) | Followed::Here(_) => None,
        }
    }

    /// Returns the counted steps of all frames so far.
    #[must_use]
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// Brings the wanted measures towards a moment, in at most about `steps` counted steps: no frame waits for more. A
    /// moment that is farther away is reached in later frames; `wake` asks for the next one.
    pub fn follow(
        &mut self,
        session: &Arc<Session>,
        shown: &ShownMoment<'_>,
        wanted: Wanted,
        steps: u64,
        wake: &Wake,
    ) {
        if wanted == Wanted::default() {
            // Nothing asks for measures. The course of the run is kept, in case something asks again.
            self.measured = None;
            return;
        }
        if self.generation != Some(session.generation) {
            self.begin(session, wake);
        }
        self.poll();

        let Followed::Here(moment) = &mut self.followed else {
            // The run is still being read, or it has no such measures.
            return;
        };
        let key = key_of(shown);
        let (_, cursor) = key;
        let moved = match moment.seek(cursor, wanted, steps) {
            Ok(moved) => moved,
            Err(error) => return self.refuse(sentence(&error.to_string())),
        };

        self.steps += moved.steps;
        // Without a step nothing has moved, so that the numbers read before for this moment are still right.
        let is_known = self.measured.as_ref().is_some_and(|(of, _)| *of == key);
        if !is_known || moved.steps > 0 {
            self.measured = Some((key, Arc::new(measured(moment))));
            self.share = moment.spectrum().map(LiveSpectrum::share);
            let behind = moment.measured_behind().filter(|_| wanted.spectrum);
            self.behind = behind.map(|(cursor, measured)| Behind {
                cursor,
                measured: Arc::new(measured),
            });
        }

        if !moved.arrived {
            // The next frame goes on from here.
            wake();
        }
    }

    /// Begins to follow another session.
    fn begin(&mut self, session: &Arc<Session>, wake: &Wake) {
        (self.generation, self.measured) = (Some(session.generation), None);
        if let Some(why) = refusal(session) {
            return self.refuse(why);
        }
        let session = Arc::clone(session);
        let job = Job::start(wake, move |_| {
            let course = Arc::new(course_of(&session)?);
            Ok(Box::new(LiveMoment::new(course)))
        });
        self.followed = Followed::Away(job);
    }

    fn poll(&mut self) {
        if let Followed::Away(job) = &self.followed
            && let Some(outcome) = job.poll()
        {
            self.take(outcome);
        }
    }

    fn take(&mut self, outcome: Result<Result<Box<LiveMoment>, String>, String>) {
        match outcome.and_then(|made| made) {
            Ok(moment) => self.followed = Followed::Here(moment),
            Err(why) => self.refuse(sentence(&why)),
        }
    }

    fn refuse(&mut self, why: String) {
        (self.measured, self.followed) = (None, Followed::Refused(why));
    }

    /// Waits until the run is read.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        if let Followed::Away(job) = &self.followed {
            let outcome = job.wait();
            self.take(outcome);
        }
    }
}

/// What the measures of a set in a field are of.
pub const GLOBAL: &str = "Global: spectrum and g(r) are of all samples together, whatever the radius at each place, in the rectangle around them. Conflicts and open places are those of the judge by subdivision, with the radius at each place, and so is the density.";

/// What the measures of a set of one radius in a shape are of.
pub const GLOBAL_IN_SHAPE: &str = "Global: spectrum and g(r) are of the rectangle around the shape, and its border changes both. Density and relative radius are by the area inside. Conflicts and open places are those of the judge by subdivision.";

/// Why a number of the table is not there of a set in a field.
pub const NO_MEANING: &str =
    "It is not measured in a field: it compares with one radius, which a field does not have.";

/// Why a number of the table is not there of a set in a shape.
pub const NO_MEANING_IN_SHAPE: &str =
    "It is not measured in a shape: it is defined in a rectangle, whose border is straight.";

/// Says which numbers of a set in space move with the run, and which do not.
pub const IN_SPACE: &str = "These numbers are of the whole box, by distances in space, and move with the run. Spectrum and g(r) are measured at rest, and open places are judged at the end, by cubes and by circles.";

/// Returns why a run has no measures that move with it.
pub(crate) fn refusal(session: &Session) -> Option<String> {
    // A set in a field or a shape without events is not measured at rest either, so that the reason does not offer
    // that.
    if session.ground.is_some() && session.recording().is_none() {
        let why = "This run has no events, so that its moments are not measured; its verdict is by subdivision, with the radius at each place.";
        return Some(why.to_owned());
    }
    // Nested levels have no events either, but their samples have an order, in which the measures can move.
    if session.recording().is_none() && session.nested.is_none() {
        let why = "This run has no events, so that its moments are measured at rest alone.";
        return Some(why.to_owned());
    }
    let count = session.run().samples.len();
    (count > MAX_SAMPLES).then(|| {
        let limit = grouped(MAX_SAMPLES);
        format!(
            "This run has {}; one of more than {limit} is measured at rest alone.",
            counted(count, "sample", "samples")
        )
    })
}

/// Returns the course of a run: which sample comes or goes at which event. Takes a tenth of a second for ten million events. Fails
/// where a field is too steep to be followed.
pub(crate) fn course_of(session: &Session) -> Result<Course, String> {
    let course = match session.recording() {
        Some(recording) => Course::of_recording(recording),
        // A moment of nested levels is a prefix of their samples in order.
        None => Course::of_order(session.run().domain, &session.run().samples.points),
    };
    match &session.ground {
        Some(made) => Ok(course.in_ground(made.live()?)),
        None => Ok(course),
    }
}

/// Returns the measures of a moment as the panel shows them.
fn measured(moment: &LiveMoment) -> MeasuredSet {
    let mut set = moment.measured();
    // Sets of fewer than three samples have no pair correlation.
    if let Some(Ok(mut pairs)) = moment.pairs().map(LivePairs::correlation) {
        // `pairs` has distances in radii of the lattice, and the panel shows user units.
        pairs.r_max *= moment.course().domain().radius();
        set.pairs = Some(Arc::new(pairs));
    }
    set
}
