//! The measuring of a run's moments, part by part in the background: begin with [`Measuring::want`].

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_analysis::measures::{MeasuredSet, Part};

use tilescope_session::geometry::{Key, key_of};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::{ShownMoment, Still};
use tilescope_session::session::Session;
use tilescope_session::task::{self, Task};

use super::measured::{Samples, missing, refusal};
use super::{name_of, samples};

/// The most moments whose measures are cached. Chosen, not measured.
pub const MAX_KEPT: usize = 48;

/// The measures of a moment.
#[derive(Clone)]
pub struct Known {
    /// The moment that was measured, with the generation of its session.
    pub key: Key,
    /// The moment's name, as [`name_of`] returns it.
    pub name: String,
    /// The measures, possibly in part.
    pub measured: Arc<MeasuredSet>,
}

/// The set and its measures after one more part; an error without text means that it was stopped.
pub type Step = Result<(Arc<Samples>, MeasuredSet), Option<String>>;

struct MeasureWork {
    key: Key,
    name: String,
    part: Part,
    job: Job<Step>,
}

/// The measures of the moments of a run.
#[derive(Default)]
pub struct Measuring {
    /// The moment of the frame before.
    at: Option<Key>,
    work: Option<MeasureWork>,
    /// The measures of the current moment and its samples, while they are incomplete.
    growing: Option<(Known, Arc<Samples>)>,
    /// The complete measures of moments, the one shown last at the end.
    kept: Vec<Known>,
    /// The moment at which the user stopped measuring.
    stopped: Option<Key>,
    /// The last moment that could not be measured, and why.
    failed: Option<(Key, String)>,
}

impl Measuring {
    /// Returns the measures of a moment, incomplete while it is being measured.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>) -> Option<&Known> {
        let key = key_of(shown);
        let growing = self.growing.as_ref().map(|(known, _)| known);
        growing
            .into_iter()
            .chain(self.kept.iter().rev())
            .find(|known| known.key == key)
    }

    /// Returns the moment of this session that was last measured completely. It is shown, faded, until a newer one
    /// replaces it.
    #[must_use]
    pub fn last(&self, shown: &ShownMoment<'_>) -> Option<&Known> {
        let generation = shown.session.generation;
        let mut own = self.kept.iter().rev();
        own.find(|known| known.key.0 == generation)
    }

    /// Returns the part being measured and the fraction of it done, from 0 to 1.
    #[must_use]
    pub fn progress(&self) -> Option<(Part, f32)> {
        let work = self.work.as_ref()?;
        Some((work.part, work.job.fraction()))
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

    /// Returns whether a moment is measured completely.
    #[must_use]
    pub fn is_whole(&self, shown: &ShownMoment<'_>) -> bool {
        self.of(shown)
            .is_some_and(|known| missing(&known.measured).is_none())
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

    /// Takes finished work and starts measuring the next part of the moment. Work for another moment is
    /// stopped; a new moment is started once the cursor stayed there from one call to the next.
    pub fn want(&mut self, session: &Arc<Session>, shown: &ShownMoment<'_>, wake: &Wake) {
        self.poll();
        let key = key_of(shown);
        // In play or while the cursor is dragged, each frame would start work that the next one drops. Another frame has to
        // show that the cursor stayed.
        if self.at != Some(key) {
            self.at = Some(key);
            self.work = None;
            self.show_last(key);
            wake();
            return;
        }

        let is_refused = self.stopped == Some(key) || self.failure(shown).is_some();
        if self.work.is_none() && !is_refused && !self.is_whole(shown) {
            self.begin(session, shown, wake);
        }
    }

    /// Stops the work and drops incomplete measures, since nothing shows them. Complete measures stay.
    pub fn rest(&mut self) {
        (self.at, self.work, self.growing) = (None, None, None);
    }

    /// Moves a moment's measures to the end of the list, as those shown last, and drops incomplete measures of other moments.
    fn show_last(&mut self, key: Key) {
        if let Some(index) = self.kept.iter().position(|known| known.key == key) {
            let known = self.kept.remove(index);
            self.kept.push(known);
        }
        self.growing = self.growing.take().filter(|(known, _)| known.key == key);
    }

    /// Starts measuring the next missing part of a moment.
    fn begin(&mut self, session: &Arc<Session>, shown: &ShownMoment<'_>, wake: &Wake) {
        let key = key_of(shown);
        let growing = self.growing.clone().filter(|(known, _)| known.key == key);

        // One part is measured at a time, so that its chart is shown while slower parts are still being measured.
        let (part, job) = if let Some((known, set)) = growing {
            let Some(part) = missing(&known.measured) else {
                return;
            };
            let measured = MeasuredSet::clone(&known.measured);
            let task = ContinueMeasuringTask {
                measured,
                part,
                set,
            };
            (part, task::start(wake, task))
        } else {
            // The first part is always that of the pairs. Its task also gathers the samples, and returns them for the other parts.
            let task = StartMeasuringTask(Still::of(session, shown.moment()));
            (Part::Pairs, task::start(wake, task))
        };

        let name = name_of(shown);
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

    /// Takes the measures after one more part, or why they could not be made.
    fn take(&mut self, key: Key, name: String, outcome: Result<Step, String>) {
        match outcome {
            Ok(Ok((set, measured))) => {
                let whole = missing(&measured).is_none();
                let measured = Arc::new(measured);
                let known = Known {
                    key,
                    name,
                    measured,
                };

                if whole {
                    self.growing = None;
                    // A moment that is measured anew may already be in the list. The list ends with the moment that was shown last, so that
                    // those that were not shown for the longest time are dropped.
                    self.kept.retain(|other| other.key != key);
                    self.kept.push(known);
                    let surplus = self.kept.len().saturating_sub(MAX_KEPT);
                    self.kept.drain(..surplus);
                } else {
                    self.growing = Some((known, set));
                }
            }
            // The user stopped the work, so that there is nothing to report.
            Ok(Err(None)) => {}
            Ok(Err(Some(why))) => self.failed = Some((key, why)),
            Err(panic) => self.failed = Some((key, tilescope_session::words::sentence(&panic))),
        }
    }

    /// Waits for the running work; returns whether there was any.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) -> bool {
        let work = self.work.take();
        let is_working = work.is_some();
        if let Some(work) = work {
            let outcome = work.job.wait();
            self.take(work.key, work.name, outcome);
        }
        is_working
    }
}

/// The task of measuring the first part of a moment.
#[derive(Serialize, Deserialize)]
pub struct StartMeasuringTask(Still);

impl Task for StartMeasuringTask {
    type Outcome = Step;
    const NAME: &'static str = "begin to measure";

    fn run(self, monitor: &Monitor) -> Step {
        let set = Arc::new(samples(&self.0));
        let mut measured = set.unmeasured();
        one_more(&mut measured, Part::Pairs, &set, monitor)?;
        Ok((set, measured))
    }
}

/// The task of measuring one more part of a moment.
#[derive(Serialize, Deserialize)]
pub struct ContinueMeasuringTask {
    measured: MeasuredSet,
    part: Part,
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
    part: Part,
    set: &Samples,
    monitor: &Monitor,
) -> Result<(), Option<String>> {
    monitor.set_activity(part.doing());
    let done = measured.measure(part, &set.points, &|progress| monitor.follow(progress));
    done.map_err(|error| refusal(&error))
}
