//! Checks a lesson before learners see it: its questions are asked of the runs of many seeds, and answered by a learner who
//! knows everything, by one who guesses, and by one with the known misconceptions. Begin with [`check`].

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::sync::Arc;

use tilescope_core::{Key as DrawKey, Observer, Parameters, Pattern, SampleError, Stream, below};
use tilescope_debugger::Recording;

use crate::answer::{Answer, Change, CutAxis, Key, letter};
use crate::error::LessonError;
use crate::learner::{Arrival, Learner};
use crate::lesson::{Claim, Gate, GateKind, Lesson, SceneSpec, Text};
use crate::prose;
use crate::question::{Form, Question};
use crate::scene::{Scene, record};
use crate::translation::Translation;

/// The most words of a step's text, before and after its question.
pub const MAX_WORDS: usize = 60;
/// The most words of a question.
pub const MAX_ASK_WORDS: usize = 60;
/// The largest share of seeds in which one option is right.
pub const MAX_SHARE: f64 = 0.6;
/// The smallest share of seeds that have the moment of a question.
const MIN_FITTING: f64 = 0.5;
/// The number of seeds from which on the shares of options are checked.
const MIN_SEEDS_FOR_SHARES: usize = 10;
/// The largest mean score of a learner who guesses.
const MAX_GUESSED: f64 = 0.75;
/// By how many standard errors a claimed mean must be beyond its bound: chance alone gets there once in 740 times.
const ERRORS_BEYOND: f64 = 3.0;
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

/// Makes the runs of lessons. A pattern is made once.
#[derive(Default)]
pub struct Runs {
    patterns: HashMap<String, Arc<Pattern>>,
    recordings: HashMap<String, Arc<Recording>>,
}

impl Runs {
    /// Returns the recorded run of parameters.
    ///
    /// # Errors
    ///
    /// Those of [`record`].
    pub fn of(
        &mut self,
        parameters: &Parameters,
        observer: &mut dyn Observer,
    ) -> Result<Arc<Recording>, SampleError> {
        let name = format!("{parameters:?}");
        if let Some(recording) = self.recordings.get(&name) {
            return Ok(Arc::clone(recording));
        }
        let spec = format!("{:?}", parameters.pattern);
        let pattern = if let Some(pattern) = self.patterns.get(&spec) {
            Arc::clone(pattern)
        } else {
            let made = Pattern::of_spec(&parameters.pattern, observer)?;
            self.patterns.insert(spec, Arc::clone(&made));
            made
        };
        let recording = record(parameters, &pattern, observer)?;
        self.recordings.insert(name, Arc::clone(&recording));
        Ok(recording)
    }

    /// Drops the recordings; patterns stay.
    pub fn clear(&mut self) {
        self.recordings.clear();
    }
}

/// The scores of the three learners: perfect, guessing, misconceived.
type Scores = [Vec<f64>; 3];

fn mean(scores: &[f64]) -> f64 {
    scores.iter().sum::<f64>() / scores.len().max(1) as f64
}

/// The values of each claim in the runs that have its moment, 1 or 0 for one that must hold in each run; or its fault there.
type Claimed = Vec<Vec<Result<f64, LessonError>>>;

/// The findings about one gate.
#[derive(Default)]
struct OfGate {
    keys: BTreeMap<(bool, u64), String>,
    options: HashMap<usize, usize>,
    asked: usize,
    fitting: usize,
    claimed: Claimed,
    faults: Vec<LessonError>,
}

impl OfGate {
    /// Adds what asking the question in the run of a seed gave: the question, none where the run lacks its moment, or a
    /// fault.
    fn add(&mut self, asked: Result<Option<Question>, LessonError>, is_practised: bool, seed: u64) {
        self.asked += usize::from(is_practised);
        match asked {
            Ok(Some(question)) => {
                self.fitting += usize::from(is_practised);
                // The step's own run is one that the author chose, so it does not count among the shares of options.
                if let (Key::Choice(option), true) = (question.key(), is_practised) {
                    *self.options.entry(*option).or_default() += 1;
                }
                let key = question.key().to_string();
                self.keys.insert((is_practised, seed), key);
            }
            Ok(None) => {}
            Err(mut error) => {
                let _ = write!(error.message, " (seed {seed})");
                self.faults.push(error);
            }
        }
    }
}

impl Checked {
    /// Adds the findings about a step, and the keys of its gate if it has one.
    fn add(&mut self, gate: Option<&Gate>, mut of_gate: OfGate) {
        let Some(gate) = gate else {
            self.faults.append(&mut of_gate.faults);
            return;
        };
        self.faults.extend(shares(gate, &of_gate));

        // A wrong expression is wrong in each run; a few of its faults are enough to find it.
        let more = of_gate.faults.len().saturating_sub(MAX_FAULTS);
        of_gate.faults.truncate(MAX_FAULTS);
        if let (Some(last), true) = (of_gate.faults.last_mut(), more > 0) {
            let _ = write!(last.message, "; and {more} more like it");
        }
        self.faults.append(&mut of_gate.faults);

        let _ = writeln!(self.keys, "{}", gate.name);
        for ((practised, seed), key) in of_gate.keys {
            let name = if practised {
                seed.to_string()
            } else {
                "own".to_owned()
            };
            let _ = writeln!(self.keys, "  {name}: {key}");
        }
    }
}

/// What a run is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Purpose {
    Question,
    Claims,
}

/// Returns the seeds and steps to ask, with no seed for the step's own run. They are sorted by seed, so that the steps of a
/// seed share its runs.
fn runs_asked(lesson: &Lesson, seeds: usize) -> Vec<(Option<u64>, usize, Purpose)> {
    let mut asked = Vec::new();
    for (index, step) in lesson.steps.iter().enumerate() {
        let practice = step.gate.as_ref().and_then(|gate| gate.practice.clone());
        let practice = practice.into_iter().flatten().take(seeds).map(Some);
        let questions = [None].into_iter().chain(practice);
        asked.extend(questions.map(|seed| (seed, index, Purpose::Question)));
        if !step.scene.claims.is_empty() {
            // A claim is about every run, so a gate's own seeds of practice do not limit it.
            let seeds = (1..=seeds as u64).map(Some);
            asked.extend(seeds.map(|seed| (seed, index, Purpose::Claims)));
        }
    }
    asked.sort_unstable();
    asked
}

/// Checks a lesson over at most `seeds` seeds of each question. `go_on` is called before each run, with the share that is
/// done; if it returns false the check ends.
///
/// # Errors
///
/// Those of the sampler, and a cancelled check.
pub fn check(
    lesson: &Lesson,
    seeds: usize,
    runs: &mut Runs,
    observer: &mut dyn Observer,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Checked, SampleError> {
    let mut checked = Checked {
        faults: lengths(lesson),
        ..Checked::default()
    };
    let mut scores = Scores::default();
    let asked = runs_asked(lesson, seeds);
    let mut found: BTreeMap<usize, OfGate> = BTreeMap::new();
    let mut last = None;

    for (done, &(seed, index, purpose)) in asked.iter().enumerate() {
        if !go_on(done as f64 / asked.len() as f64) {
            return Err(SampleError::Cancelled {
                stage: tilescope_core::Stage::Pattern,
            });
        }
        // Only the steps of one seed share runs; those of all seeds would fill the memory.
        if seed != last {
            runs.clear();
            last = seed;
        }

        let scene = &lesson.steps[index].scene;
        let parameters = Parameters {
            seed: seed.unwrap_or(scene.parameters.seed),
            ..scene.parameters
        };
        let recording = runs.of(&parameters, observer)?;
        let of_gate = found.entry(index).or_default();
        match purpose {
            Purpose::Claims => {
                if let Err(error) = test_claims(scene, &recording, &mut of_gate.claimed) {
                    of_gate.faults.push(error);
                }
            }
            Purpose::Question => {
                let answered = ask(lesson, index, &recording, seed.is_some(), &mut scores);
                checked.questions += usize::from(matches!(answered, Ok(Some(_))));
                of_gate.add(answered, seed.is_some(), parameters.seed);
            }
        }
    }

    for (index, of_gate) in found {
        let step = &lesson.steps[index];
        let broken = broken_claims(&step.scene.claims, &of_gate.claimed, seeds);
        checked.faults.extend(broken);
        checked.add(step.gate.as_ref(), of_gate);
    }

    let [perfect, guessing, misconceived] = scores.each_ref().map(|scores| mean(scores));
    let mut wrong = |message: String| checked.faults.push(LessonError::new(1, message));
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
    (checked.perfect, checked.guessing, checked.misconceived) = (perfect, guessing, misconceived);
    checked.faults.sort_by_key(|fault| fault.line);
    Ok(checked)
}

/// Adds the values of a scene's claims in a run, by claim. A run that lacks the moment adds none.
fn test_claims(
    spec: &SceneSpec,
    recording: &Arc<Recording>,
    claimed: &mut Claimed,
) -> Result<(), LessonError> {
    claimed.resize(spec.claims.len(), Vec::new());
    let Some(scene) = Scene::find(recording, spec)? else {
        return Ok(());
    };

    for (claim, values) in spec.claims.iter().zip(claimed) {
        values.push(match claim {
            Claim::Each(text) => {
                let truth = scene.truth(text, |_| {});
                truth.map(|holds| f64::from(u8::from(holds)))
            }
            Claim::Mean { of, .. } => scene.number(of),
        });
    }
    Ok(())
}

/// Returns the fault of each claim that does not hold, that cannot be computed, or that too few of the runs test.
fn broken_claims(claims: &[Claim], claimed: &Claimed, runs: usize) -> Vec<LessonError> {
    let both = claims.iter().zip(claimed);
    let broken = both.filter_map(|(claim, values)| {
        let (Claim::Each(text) | Claim::Mean { of: text, .. }) = claim;
        let tested = values.len();
        if (tested as f64) < MIN_FITTING * runs as f64 {
            let message = format!(
                "only {tested} of {runs} runs have the moment of this claim; at least half must"
            );
            return Some(text.wrong(message));
        }

        let values: Result<Vec<f64>, LessonError> = values.iter().cloned().collect();
        let why = match values {
            Err(error) => return Some(error),
            Ok(values) => broken_claim(claim, &values)?,
        };
        Some(text.wrong(why))
    });
    broken.collect()
}

/// Returns why a claim does not hold, if it does not.
fn broken_claim(claim: &Claim, values: &[f64]) -> Option<String> {
    let tested = values.len();
    let Claim::Mean {
        is_above, bound, ..
    } = *claim
    else {
        let failed = values.iter().filter(|holds| **holds < 0.5).count();
        return (failed > 0).then(|| format!("the claim is false in {failed} of {tested} runs"));
    };

    let (mean, error) = mean_and_error(values);
    let beyond = if is_above { mean - bound } else { bound - mean };
    // One run has no error to compare with.
    if tested > 1 && beyond > ERRORS_BEYOND * error {
        return None;
    }
    let side = if is_above { "above" } else { "below" };
    Some(format!(
        "the mean is {mean:.4} with a standard error of {error:.4} over {tested} runs; \
         it must be {side} {bound} by more than {ERRORS_BEYOND} standard errors"
    ))
}

/// Returns the mean of values and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let (count, mean) = (values.len() as f64, mean(values));
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

/// Returns the faults of texts that are too long.
fn lengths(lesson: &Lesson) -> Vec<LessonError> {
    let mut faults = Vec::new();
    for step in &lesson.steps {
        for (what, part) in [
            ("text before the question", &step.text),
            ("text after the answer", &step.after),
        ] {
            let words: usize = part.iter().map(|paragraph| prose::words(paragraph)).sum();
            if words > MAX_WORDS {
                let message = format!(
                    "the {what} of \"{}\" has {words} words; at most {MAX_WORDS}",
                    step.title
                );
                faults.push(LessonError::new(step.line, message));
            }
        }
        if let Some(gate) = &step.gate {
            let words = prose::words(&gate.ask.text);
            if words > MAX_ASK_WORDS {
                let message = format!("the question has {words} words; at most {MAX_ASK_WORDS}");
                faults.push(LessonError::new(gate.ask.line, message));
            }
        }
    }
    faults
}

/// Returns the faults of a gate whose moment few seeds have, or of which one option is right too often.
fn shares(gate: &Gate, found: &OfGate) -> Vec<LessonError> {
    let mut faults = Vec::new();
    let wrong = |message: String| LessonError::new(gate.line, message);
    if (found.fitting as f64) < MIN_FITTING * found.asked as f64 && found.faults.is_empty() {
        faults.push(wrong(format!(
            "only {} of {} seeds have the moment; at least half must",
            found.fitting, found.asked
        )));
    }
    if found.fitting >= MIN_SEEDS_FOR_SHARES {
        for (option, times) in &found.options {
            let share = *times as f64 / found.fitting as f64;
            if share > MAX_SHARE {
                let letter = letter(*option);
                faults.push(wrong(format!(
                    "option {letter} is right in {:.0}% of the seeds; at most {:.0}%, or \"practice: none\"",
                    100.0 * share, 100.0 * MAX_SHARE
                )));
            }
        }
    }
    faults
}

/// Asks the question of a step in a run, and grades the answers of the three learners. Returns `None` if the run lacks the
/// moment, or the step a question.
fn ask(
    lesson: &Lesson,
    index: usize,
    recording: &Arc<Recording>,
    practised: bool,
    scores: &mut Scores,
) -> Result<Option<Question>, LessonError> {
    let step = &lesson.steps[index];
    let Some(scene) = Scene::find(recording, &step.scene)? else {
        let missing = LessonError::new(step.scene.line, "the run has no such moment");
        return if practised { Ok(None) } else { Err(missing) };
    };
    for text in step.text.iter().chain(&step.after) {
        scene.fill(&Text::new(text.as_str(), step.line))?;
    }
    scene.camera(&step.scene.camera)?;
    let Some(gate) = &step.gate else {
        return Ok(None);
    };
    let question = Question::of(gate, &scene)?;
    let mut learn = |who: usize, answers: &dyn Fn(usize, usize) -> Option<Answer>| {
        let mut learner = Learner::new(Arc::new(lesson.clone()), Arc::new(Translation::default()));
        learner.go(index);
        if practised {
            // Any draw stands for the seed of the recording; the run is given.
            learner.practise(recording.run().parameters.seed);
        }
        if learner.arrive(recording, 0.0)? != Arrival::Here {
            return Ok(());
        }
        for attempt in 0..100 {
            let (_, traced) = learner.tries();
            let Some(answer) = answers(traced, attempt) else {
                return Ok(());
            };
            let feedback = learner.answer(&answer, 1.0)?;
            // Only a trace takes several answers; of other questions the first answer counts.
            if feedback.is_done || !matches!(question.key(), Key::Trace(_)) {
                break;
            }
        }
        // A question that was answered wrongly ends when the learner gives up, which takes two calls.
        learner.give_up(1.0);
        learner.give_up(1.0);
        let entry = learner.take_entries().pop();
        scores[who].push(entry.map_or(0.0, |entry| entry.score));
        Ok(())
    };
    learn(0, &|traced, _| Some(question.right_answer(traced)))?;
    let key =
        DrawKey::from_seed(recording.run().parameters.seed).derive(Stream::Throw, index as u32);
    learn(1, &|_, attempt| Some(guess(&question, key, attempt as u32)))?;
    learn(2, &|_, attempt| {
        let believed = (attempt == 0).then(|| misconception(gate, &question));
        believed.flatten()
    })?;
    Ok(Some(question))
}

/// Returns the answer of a learner with the first known misconception, if there is one.
fn misconception(gate: &Gate, question: &Question) -> Option<Answer> {
    if let Some(wrong) = question.wrong.first() {
        return Some(match (&wrong.answer, &question.form) {
            (Answer::Pick(samples), Form::Pick { several: false, .. }) => {
                let Key::Pick(right) = question.key() else {
                    return None;
                };
                Answer::Pick(vec![*samples.iter().find(|s| !right.contains(s))?])
            }
            (answer, _) => answer.clone(),
        });
    }
    let (GateKind::Choice { options, .. }, Key::Choice(right)) = (&gate.kind, question.key())
    else {
        return None;
    };
    let wrong = options
        .iter()
        .enumerate()
        .find(|(index, option)| index != right && option.sentence.is_some());
    wrong.map(|(index, _)| Answer::Choice(index))
}

/// Returns a random answer.
fn guess(question: &Question, key: DrawKey, attempt: u32) -> Answer {
    let draw = |index: u32, n: usize| {
        below(
            key.draw(Stream::Order, 64 * attempt + index)[0],
            n.max(1) as u32,
        ) as usize
    };
    let share =
        |index: u32| f64::from(key.draw(Stream::Order, 64 * attempt + index)[1]) / 4_294_967_296.0;
    match &question.form {
        Form::Pick {
            candidates,
            several: false,
        } => Answer::Pick(vec![candidates[draw(0, candidates.len())]]),
        Form::Pick { candidates, .. } => {
            let mut some: Vec<u32> = (0..)
                .zip(candidates)
                .filter(|(k, _)| share(*k) < 0.5)
                .map(|(_, s)| *s)
                .collect();
            if some.is_empty() {
                some.push(candidates[draw(60, candidates.len())]);
            }
            Answer::Pick(some)
        }
        Form::Place { candidates } => Answer::Place(candidates[draw(0, candidates.len())]),
        Form::Number { .. } => Answer::Number((100.0 * share(0)).round()),
        Form::Choice { options, .. } | Form::Trace { options, .. } => {
            Answer::Choice(draw(0, options.len()))
        }
        Form::Order { items } => {
            let mut order: Vec<usize> = (0..items.len()).collect();
            for last in (1..order.len()).rev() {
                order.swap(last, draw(last as u32, last + 1));
            }
            Answer::Order(order)
        }
        Form::Cut { min, max, .. } => {
            let (axis, of) = if draw(0, 2) == 0 {
                (CutAxis::X, 0)
            } else {
                (CutAxis::Y, 1)
            };
            Answer::Cut {
                axis,
                at: min[of] + share(1) * (max[of] - min[of]),
            }
        }
        Form::Bands { bands, .. } => Answer::Bands(
            (0..bands.len())
                .map(|k| Change::ALL[draw(k as u32, 3)])
                .collect(),
        ),
    }
}
