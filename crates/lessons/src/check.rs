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
use crate::lesson::{Gate, GateKind, Lesson, Text};
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

/// The findings about one gate.
#[derive(Default)]
struct OfGate {
    keys: BTreeMap<(bool, u64), String>,
    options: HashMap<usize, usize>,
    asked: usize,
    fitting: usize,
    faults: Vec<LessonError>,
}

/// Returns the seeds and steps to ask, with no seed for the step's own run. They are sorted by seed, so that the steps of a
/// seed share its runs.
fn runs_asked(lesson: &Lesson, seeds: usize) -> Vec<(Option<u64>, usize)> {
    let mut asked = Vec::new();
    for (index, step) in lesson.steps.iter().enumerate() {
        let practice = step.gate.as_ref().and_then(|gate| gate.practice.clone());
        let practice = practice.into_iter().flatten().take(seeds).map(Some);
        asked.extend([None].into_iter().chain(practice).map(|seed| (seed, index)));
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
    for (done, &(seed, index)) in asked.iter().enumerate() {
        if !go_on(done as f64 / asked.len() as f64) {
            return Err(SampleError::Cancelled {
                stage: tilescope_core::Stage::Pattern,
            });
        }
        if seed != last {
            runs.clear();
            last = seed;
        }
        let step = &lesson.steps[index];
        let parameters = step.scene.parameters;
        let parameters = Parameters {
            seed: seed.unwrap_or(parameters.seed),
            ..parameters
        };
        let recording = runs.of(&parameters, observer)?;
        let of_gate = found.entry(index).or_default();
        if seed.is_some() {
            of_gate.asked += 1;
        }
        match ask(lesson, index, &recording, seed.is_some(), &mut scores) {
            Ok(Some(question)) => {
                checked.questions += 1;
                of_gate.fitting += usize::from(seed.is_some());
                if let (Key::Choice(option), true) = (question.key(), seed.is_some()) {
                    *of_gate.options.entry(*option).or_default() += 1;
                }
                of_gate.keys.insert(
                    (seed.is_some(), parameters.seed),
                    question.key().to_string(),
                );
            }
            Ok(None) => {}
            Err(mut error) => {
                let _ = write!(error.message, " (seed {})", parameters.seed);
                of_gate.faults.push(error);
            }
        }
    }
    for (index, mut of_gate) in found {
        let Some(gate) = &lesson.steps[index].gate else {
            checked.faults.append(&mut of_gate.faults);
            continue;
        };
        checked.faults.extend(shares(gate, &of_gate));
        let more = of_gate.faults.len().saturating_sub(MAX_FAULTS);
        of_gate.faults.truncate(MAX_FAULTS);
        if let (Some(last), true) = (of_gate.faults.last_mut(), more > 0) {
            let _ = write!(last.message, "; and {more} more like it");
        }
        checked.faults.append(&mut of_gate.faults);
        let _ = writeln!(checked.keys, "{}", gate.name);
        for ((practised, seed), key) in of_gate.keys {
            let name = if practised {
                seed.to_string()
            } else {
                "own".to_owned()
            };
            let _ = writeln!(checked.keys, "  {name}: {key}");
        }
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
