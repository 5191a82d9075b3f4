//! Checks a lesson before learners see it: its questions are asked of the runs of many seeds, and answered by a learner who
//! knows everything, by one who guesses, and by one with the known misconceptions. Begin with [`check`].
//!
//! A *gate* is a step's question as its file states it; it is *practised* in runs of further seeds. A *claim* is a
//! statement of a step about the runs of all seeds.

mod asked;
mod claims;
mod findings;
mod leaks;
mod rules;

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::sync::Arc;

use tilescope_core::{Observer, Pattern, PatternHistory, PatternSpec, SampleError, TilingMethod};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_sets::VaryingError;

use self::asked::ask;
use self::claims::{broken_claims, mean, test_claims};
use self::findings::Findings;
pub use self::leaks::leak;
use crate::error::LessonError;
use crate::lesson::{Lesson, Step};
use crate::step_run::StepRun;

/// The largest mean score of a learner who guesses. It is a coarse bound, as a wrong answer may have a part of the score; the
/// chance of a right guess has its own limit in `rules.rs`.
const MAX_GUESSED: f64 = 0.75;
/// The most faults that are listed of one question.
const MAX_FAULTS: usize = 3;

/// The result of checking a lesson.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checked {
    /// The faults, by line.
    pub faults: Vec<LessonError>,
    /// The keys of all questions and seeds, as they are kept in a file.
    pub keys: String,
    /// How many questions were asked, counting each run.
    pub questions: usize,
    /// The mean score of the learner who knows everything.
    pub perfect: f64,
    /// Of the one who guesses.
    pub guessing: f64,
    /// Of the one with the known misconceptions, where there are any.
    pub misconceived: f64,
}

/// Makes the runs of lessons. A pattern of KDRT is made once, and one of exact tiling once for each seed.
#[derive(Default)]
pub struct Runs {
    patterns: HashMap<String, Arc<Pattern>>,
    /// The last pattern of exact tiling: the runs of a seed follow each other.
    history: Option<(PatternSpec, PatternHistory)>,
    recordings: HashMap<String, Arc<Recording>>,
}

impl Runs {
    /// Returns the recorded run of a step.
    ///
    /// # Errors
    ///
    /// Those of [`StepRun::make`].
    pub fn of(
        &mut self,
        run: &StepRun,
        observer: &mut dyn Observer,
    ) -> Result<Arc<Recording>, VaryingError> {
        // Parameters hold floats, which have no hash: their text is the key.
        let name = format!("{run:?}");
        if let Some(recording) = self.recordings.get(&name) {
            return Ok(Arc::clone(recording));
        }

        let is_planar = run.levels.is_none() && run.radius.is_none() && run.depth.is_none();
        let (parameters, budget) = (&run.parameters, DEFAULT_BUDGET);
        let recording = match parameters.method {
            // Levels have a nested pattern, and a field or a box has none.
            _ if !is_planar => run.make(observer)?,
            TilingMethod::Kdrt => {
                // The runs of several seeds have the same pattern, which is made once.
                let pattern = self.pattern(&parameters.pattern, observer)?;
                let made = Recording::with_pattern(parameters, pattern, budget, observer)?;
                Arc::new(made)
            }
            TilingMethod::Exact => {
                let history = self.history(&parameters.pattern, observer)?;
                let made = Recording::with_history(parameters, history, budget, observer)?;
                Arc::new(made)
            }
        };
        self.recordings.insert(name, Arc::clone(&recording));
        Ok(recording)
    }

    fn pattern(
        &mut self,
        spec: &PatternSpec,
        observer: &mut dyn Observer,
    ) -> Result<Arc<Pattern>, SampleError> {
        // Its side is a float, which has no hash.
        let name = format!("{spec:?}");
        if let Some(pattern) = self.patterns.get(&name) {
            return Ok(Arc::clone(pattern));
        }
        let made = Pattern::of_spec(spec, observer)?;
        self.patterns.insert(name, Arc::clone(&made));
        Ok(made)
    }

    fn history(
        &mut self,
        spec: &PatternSpec,
        observer: &mut dyn Observer,
    ) -> Result<&PatternHistory, SampleError> {
        let last = match self.history.take() {
            Some((of, history)) if of == *spec => history,
            _ => PatternHistory::of_spec(spec, observer)?,
        };
        Ok(&self.history.insert((*spec, last)).1)
    }

    /// Drops the recordings; patterns stay.
    pub fn clear(&mut self) {
        self.recordings.clear();
    }
}

impl Checked {
    /// Adds the findings about a step, and the keys of its gate if it has one. `is_test` is whether the lesson is a form.
    fn add(&mut self, step: &Step, mut found: Findings, is_test: bool) {
        let Some(gate) = &step.gate else {
            // A step without a gate asks no question in many runs, so that all of its faults are listed.
            self.faults.append(&mut found.faults);
            return;
        };

        self.faults
            .extend(rules::of_gate(step, gate, &found, is_test));

        // A wrong expression is a fault in each run: a few of these faults are enough to find it.
        let more = found.faults.len().saturating_sub(MAX_FAULTS);
        found.faults.truncate(MAX_FAULTS);
        if let (Some(last), true) = (found.faults.last_mut(), more > 0) {
            let _ = write!(last.message, "; and {more} more like it");
        }
        self.faults.append(&mut found.faults);

        // A line for each run, named by its seed; the step's own run has no seed of practice.
        let _ = writeln!(self.keys, "{}", gate.name);
        for ((practised, seed), key) in found.keys {
            let name = if practised {
                seed.to_string()
            } else {
                "own".to_owned()
            };
            let _ = writeln!(self.keys, "  {name}: {key}");
        }
    }

    /// Sets the mean scores of the three learners, and adds the faults of the first two: right answers that do not
    /// score fully, and guesses that score too much.
    fn add_scores(&mut self, scores: &[Vec<f64>; 3]) {
        let [perfect, guessing, misconceived] = scores.each_ref().map(|scores| mean(scores));
        // Scores are of the whole lesson, which line 1 stands for.
        let mut wrong = |message: String| self.faults.push(LessonError::new(1, message));

        // Scores are sums of fractions, which are rounded. A lesson without questions has no scores, and a mean of 0.
        if !scores[0].is_empty() && perfect < 0.999_999 {
            wrong(format!(
                "the key of some question scores less than 1: {perfect}"
            ));
        }

        if guessing > MAX_GUESSED {
            wrong(format!(
                "guessing scores {guessing:.2}; at most {MAX_GUESSED} is allowed"
            ));
        }

        (self.perfect, self.guessing, self.misconceived) = (perfect, guessing, misconceived);
    }
}

/// What a run is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Purpose {
    Question,
    Claims,
}

/// Returns the seeds and steps to ask, with no seed for the step's own run. A step without a gate is asked in its own
/// run, too: its texts may have faults. They are sorted by seed, so that the steps of a seed share its runs.
fn runs_asked(lesson: &Lesson, seeds: usize) -> Vec<(Option<u64>, usize, Purpose)> {
    let mut asked = Vec::new();
    for (index, step) in lesson.steps.iter().enumerate() {
        let gate = step.gate.as_ref();
        let practice = gate.and_then(|gate| gate.practice.clone()).into_iter();
        let practised = practice.flatten().take(seeds).map(Some);
        let questions = [None].into_iter().chain(practised);
        asked.extend(questions.map(|seed| (seed, index, Purpose::Question)));

        if !step.scene.claims.is_empty() {
            // A claim is about every run, so a gate's own seeds of practice do not limit it.
            let all = (1..=seeds as u64).map(Some);
            asked.extend(all.map(|seed| (seed, index, Purpose::Claims)));
        }
    }

    asked.sort_unstable();
    asked
}

/// Checks a lesson over at most `seeds` seeds of each question. `runs` makes the runs, which `observer` watches.
/// `go_on` is called before each run, with the share that is done; if it returns false the check ends.
///
/// # Errors
///
/// Those of [`StepRun::make`], and a cancelled check.
pub fn check(
    lesson: &Lesson,
    seeds: usize,
    runs: &mut Runs,
    observer: &mut dyn Observer,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Checked, VaryingError> {
    let lesson = Arc::new(lesson.clone());
    let mut checked = Checked::default();
    let mut scores: [Vec<f64>; 3] = Default::default();

    let asked = runs_asked(&lesson, seeds);
    let mut found: BTreeMap<usize, Findings> = BTreeMap::new();
    let mut last = None;

    for (done, &(seed, index, purpose)) in asked.iter().enumerate() {
        if !go_on(done as f64 / asked.len() as f64) {
            // The error names a stage of a run; before a run that is its first.
            let stage = tilescope_core::Stage::Pattern;
            return Err(SampleError::Cancelled { stage }.into());
        }

        // Only steps with the same seed share runs. To keep the runs of all seeds would fill the memory.
        if seed != last {
            runs.clear();
            last = seed;
        }

        // Without a seed of practice the step's own run is meant.
        let Step { scene, gate, .. } = &lesson.steps[index];
        let run = scene.run(seed);
        let recording = runs.of(&run, observer)?;
        let of_step = found.entry(index).or_default();

        match purpose {
            Purpose::Claims => {
                if let Err(error) = test_claims(scene, &recording, &mut of_step.claimed) {
                    of_step.faults.push(error);
                }
            }
            Purpose::Question => {
                let answered = ask(&lesson, index, &recording, seed.is_some());
                if let Ok(Some(answered)) = &answered {
                    checked.questions += 1;
                    for (all, score) in scores.iter_mut().zip(answered.scores) {
                        all.extend(score);
                    }
                }
                of_step.add(gate.as_ref(), answered, seed.is_some(), run.parameters.seed);
            }
        }
    }

    checked.faults.extend(rules::of_lesson(&lesson, &found));
    for (index, of_step) in found {
        let step = &lesson.steps[index];
        let broken = broken_claims(&step.scene.claims, &of_step.claimed, seeds);
        checked.faults.extend(broken);
        checked.add(step, of_step, lesson.form.is_some());
    }
    checked.add_scores(&scores);
    // Authors go through their file from its beginning.
    checked.faults.sort_by_key(|fault| fault.line);
    Ok(checked)
}
