//! The live analysis: what is measured of the samples that stand at the moment, what they are held against, and what is
//! brushed. It is measured in the background, one part after the other, and only while somebody looks.

pub mod brush;
pub mod held;
pub mod measured;
pub mod reference;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_core::Stage;

use brush::{Brush, Marks};
use held::Held;
use measured::{MeasurePart, MeasuredSet, Samples, refusal};
pub use reference::Reference;
use tilescope_session::geometry::{Key, key_of, region_of};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::{ShownMoment, Still};
use tilescope_session::sentence::name_in;
use tilescope_session::session::Session;
use tilescope_session::task::{self, Task};
use tilescope_session::units::radii;
use tilescope_session::words::grouped;

/// Moments whose measures are kept, so that going back to them takes no time.
pub const MAX_KEPT: usize = 48;

/// An action of the analysis.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AnalysisCommand {
    /// Stops measuring this moment.
    Stop,
    /// Measures this moment after all.
    Resume,
    /// Forgets the file.
    Clear,
    /// Chooses what to look for the causes of, or nothing.
    Brush(Option<Brush>),
}

/// A moment and what is known of it.
#[derive(Clone)]
pub struct Known {
    /// Which moment.
    pub key: Key,
    /// Its name.
    pub name: String,
    /// What is measured of it.
    pub measured: Arc<MeasuredSet>,
}

/// A set, and what is known of it after one more part.
pub type Step = Result<(Arc<Samples>, MeasuredSet), Option<String>>;

struct MeasureWork {
    key: Key,
    name: String,
    part: MeasurePart,
    job: Job<Step>,
}

/// What is known, and what is at work.
#[derive(Default)]
pub struct Analysis {
    /// The moment of the frame before.
    at: Option<Key>,
    work: Option<MeasureWork>,
    /// What is known of the moment at hand, and its samples, while not all is known.
    growing: Option<(Known, Arc<Samples>)>,
    /// All that is known of moments, the one looked at last at the end.
    kept: Vec<Known>,
    /// The moment that the user does not want measured.
    stopped: Option<Key>,
    /// The last moment that could not be measured, and why.
    failed: Option<(Key, String)>,
    /// What maximal sets are like.
    pub reference: Reference,
    /// The file that moments are held against.
    pub held: Option<Arc<Held>>,
    /// What is looked for.
    pub brush: Option<Brush>,
    /// What was found.
    pub marks: Marks,
}

impl Analysis {
    /// Returns what is known of a moment; in part, while it is being measured.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>) -> Option<&Known> {
        let key = key_of(shown);
        let growing = self.growing.as_ref().map(|(known, _)| known);
        growing
            .into_iter()
            .chain(self.kept.iter().rev())
            .find(|known| known.key == key)
    }

    /// Returns the moment of the session shown that was measured last as a whole: it is shown, faded, until another takes
    /// its place.
    #[must_use]
    pub fn last(&self, shown: &ShownMoment<'_>) -> Option<&Known> {
        let generation = shown.session.generation;
        let mut own = self.kept.iter().rev();
        own.find(|known| known.key.0 == generation)
    }

    /// Returns what is being measured and how much of it is done, from 0 to 1.
    #[must_use]
    pub fn progress(&self) -> Option<(MeasurePart, f32)> {
        let work = self.work.as_ref()?;
        Some((work.part, work.job.fraction()))
    }

    /// Returns whether the user does not want this moment measured.
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

    /// Returns whether a moment is known as a whole.
    #[must_use]
    pub fn is_whole(&self, shown: &ShownMoment<'_>) -> bool {
        self.of(shown)
            .is_some_and(|known| known.measured.missing().is_none())
    }

    /// Carries out a command while the moment `shown` is looked at.
    pub fn apply(&mut self, command: AnalysisCommand, shown: Option<&ShownMoment<'_>>) {
        match command {
            AnalysisCommand::Stop => {
                if let Some(shown) = shown {
                    self.work = None;
                    self.stopped = Some(key_of(shown));
                }
            }
            AnalysisCommand::Resume => (self.stopped, self.failed) = (None, None),
            AnalysisCommand::Clear => self.held = None,
            AnalysisCommand::Brush(brush) => self.brush = brush,
        }
    }

    /// Takes what is finished, and has the next part of the moment measured. Whatever is at work for another moment is
    /// stopped; a new one begins when the cursor has rested from one call to the next.
    pub fn want(&mut self, session: &Arc<Session>, shown: &ShownMoment<'_>, wake: &Wake) {
        self.poll();
        self.reference.want(wake);
        self.marks.want(session, shown, self.brush, wake);
        let key = key_of(shown);
        if self.at != Some(key) {
            self.at = Some(key);
            self.work = None;
            self.look_at(key);
            wake();
            return;
        }
        let refused = self
            .failed
            .as_ref()
            .is_some_and(|(failed, _)| *failed == key);
        if self.work.is_none() && self.stopped != Some(key) && !refused && !self.is_whole(shown) {
            self.begin(session, shown, wake);
        }
    }

    /// Stops what is at work and forgets what is half known: nobody looks. What is known as a whole stays.
    pub fn rest(&mut self) {
        (self.at, self.work, self.growing) = (None, None, None);
        self.marks.rest();
        self.reference.rest();
    }

    /// What is known of the moment goes to the end of the list; what was half known of another is forgotten.
    fn look_at(&mut self, key: Key) {
        if let Some(place) = self.kept.iter().position(|known| known.key == key) {
            let known = self.kept.remove(place);
            self.kept.push(known);
        }
        self.growing = self.growing.take().filter(|(known, _)| known.key == key);
    }

    fn begin(&mut self, session: &Arc<Session>, shown: &ShownMoment<'_>, wake: &Wake) {
        let key = key_of(shown);
        let growing = self.growing.clone().filter(|(known, _)| known.key == key);
        let name = name_of(shown);
        let (part, job) = if let Some((known, set)) = growing {
            let Some(part) = known.measured.missing() else {
                return;
            };
            let measured = MeasuredSet::clone(&known.measured);
            let going_on = ContinueMeasuringTask {
                measured,
                part,
                set,
            };
            (part, task::start(wake, going_on))
        } else {
            let beginning = StartMeasuringTask(Still::of(session, shown.moment()));
            (MeasurePart::Pairs, task::start(wake, beginning))
        };
        self.work = Some(MeasureWork {
            key,
            name,
            part,
            job,
        });
    }

    fn poll(&mut self) {
        if let Some(outcome) = self.work.as_ref().and_then(|work| work.job.poll())
            && let Some(work) = self.work.take()
        {
            self.take(work.key, work.name, outcome);
        }
    }

    fn take(&mut self, key: Key, name: String, outcome: Result<Step, String>) {
        match outcome {
            Ok(Ok((set, measured))) => {
                let whole = measured.missing().is_none();
                let known = Known {
                    key,
                    name,
                    measured: Arc::new(measured),
                };
                if whole {
                    self.growing = None;
                    self.kept.retain(|other| other.key != key);
                    self.kept.push(known);
                    let surplus = self.kept.len().saturating_sub(MAX_KEPT);
                    self.kept.drain(..surplus);
                } else {
                    self.growing = Some((known, set));
                }
            }
            Ok(Err(None)) => {}
            Ok(Err(Some(why))) => self.failed = Some((key, why)),
            Err(panic) => self.failed = Some((key, tilescope_session::words::sentence(&panic))),
        }
    }

    /// Waits for what is at work; returns whether anything was.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) -> bool {
        let found = self.marks.settle();
        let waited = self.reference.settle() || found;
        let Some(work) = self.work.take() else {
            return waited;
        };
        let outcome = work.job.wait();
        self.take(work.key, work.name, outcome);
        true
    }
}

/// Has the first part of a moment measured.
#[derive(Serialize, Deserialize)]
pub struct StartMeasuringTask(Still);

impl Task for StartMeasuringTask {
    type Outcome = Step;
    const NAME: &'static str = "begin to measure";

    fn run(self, monitor: &Monitor) -> Step {
        let set = Arc::new(samples(&self.0));
        let mut measured = MeasuredSet::nothing(&set);
        one_more(&mut measured, MeasurePart::Pairs, &set, monitor)?;
        Ok((set, measured))
    }
}

/// Has one more part of a moment measured.
#[derive(Serialize, Deserialize)]
pub struct ContinueMeasuringTask {
    measured: MeasuredSet,
    part: MeasurePart,
    set: Arc<Samples>,
}

impl Task for ContinueMeasuringTask {
    type Outcome = Step;
    const NAME: &'static str = "go on measuring";

    fn run(mut self, monitor: &Monitor) -> Step {
        one_more(&mut self.measured, self.part, &self.set, monitor)?;
        Ok((self.set, self.measured))
    }
}

fn one_more(
    measured: &mut MeasuredSet,
    part: MeasurePart,
    set: &Samples,
    monitor: &Monitor,
) -> Result<(), Option<String>> {
    monitor.set_activity(part.doing());
    let done = measured.measure(part, set, &|progress| monitor.follow(progress));
    done.map_err(|error| refusal(&error))
}

/// Returns the samples that stand at a moment, in r.
#[must_use]
pub fn samples(still: &Still) -> Samples {
    let covering = still.covering().into_iter();
    Samples {
        points: covering
            .map(|(point, _)| [radii(point.x), radii(point.y)])
            .collect(),
        region: region_of(still.session()),
        radius: 1.0,
    }
}

/// Returns what a moment is called.
#[must_use]
pub fn name_of(shown: &ShownMoment<'_>) -> String {
    let stage = match shown.stage {
        Stage::Iterate(k) => format!("iteration {k}"),
        stage => name_in(shown.session, stage).to_lowercase(),
    };
    match shown.debugger {
        Some(_) => format!("event {}, {stage}", grouped(shown.cursor())),
        None => format!("after {stage}"),
    }
}
