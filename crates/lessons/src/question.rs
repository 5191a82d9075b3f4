//! A question about a moment of a run: its form, which the learner sees, and its key, which is computed from the recording.
//! Begin with [`Question::of`]; [`Question::grade`] compares an answer with the key. `learner.rs` counts tries and hints.

use std::sync::Arc;

use tilescope_core::stages::blocks::Axis;
use tilescope_core::{Key as DrawKey, RunEvent, Stream, below};

use crate::answer::{Answer, Change, CutAxis, Key, letter, sorted};
use crate::error::LessonError;
use crate::lesson::{ChoiceOption, Gate, GateKind, Text};
use crate::scene::Scene;
use crate::sets::{self, PointSet, position};

/// The largest share by which the power of a band may change and still count as the same. The panel names it.
const SAME: f64 = 0.15;

/// How far from a right place an answer still scores, in r.
const PLACE_REACH: f64 = 0.5;
/// The most samples in the list of a question.
pub const MAX_CANDIDATES: usize = 24;

/// A curve beside an option: mean power by frequency in 1/r.
pub type Curve = Vec<[f64; 2]>;

/// The form of a question: what the learner chooses from or types.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// Samples to select, by id.
    Pick {
        /// The samples in the list.
        candidates: Vec<u32>,
        /// Whether several may be selected.
        several: bool,
    },
    /// A place of the domain.
    Place {
        /// Places to choose from without a pointer, in r.
        candidates: Vec<[f64; 2]>,
    },
    /// A number in a unit.
    Number {
        /// The unit; empty for counts.
        unit: String,
        /// A spectrum that is shown after the answer.
        curve: Option<Curve>,
    },
    /// One of several options.
    Choice {
        /// The options.
        options: Vec<String>,
        /// A curve beside each; empty if there are none.
        curves: Vec<Curve>,
    },
    /// Items to sort.
    Order {
        /// The items, shuffled.
        items: Vec<String>,
    },
    /// A cut of a rectangle.
    Cut {
        /// The lowest corner of the rectangle, in r.
        min: [f64; 2],
        /// The highest.
        max: [f64; 2],
        /// Cuts of the list.
        candidates: Vec<(CutAxis, f64)>,
    },
    /// Bands of a spectrum.
    Bands {
        /// The bands, in 1/r.
        bands: Vec<[f64; 2]>,
        /// The spectra before and after; the second is shown after the answer.
        curves: [Curve; 2],
    },
    /// The events that follow, one after another.
    Trace {
        /// What may happen.
        options: Vec<String>,
        /// How many events are asked for.
        steps: usize,
    },
}

/// A known wrong answer, computed from the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongAnswer {
    /// The answer.
    pub answer: Answer,
    /// The sentence that the learner then reads.
    pub sentence: String,
}

/// A question about a moment of a run.
#[derive(Clone, Debug)]
pub struct Question {
    /// Its text; of a trace, one text for each event.
    asks: Vec<String>,
    /// The samples that each text names.
    named: Vec<Vec<u32>>,
    /// The places that are marked, in r.
    pub marked: Vec<[f64; 2]>,
    /// The radius, in r, of the circles that appear after the answer.
    pub circle: Option<f64>,
    /// How far from the edges of blocks, in r, lines appear after the answer.
    pub strip: Option<f64>,
    /// What the learner chooses from or types.
    pub form: Form,
    /// A hint.
    pub hint: Option<String>,
    /// The moment, as the number of events that have happened.
    pub cursor: usize,
    /// The moment after the deciding event; the question's own moment if that decides.
    pub decided: usize,
    /// The moments at which the events of a trace are predicted.
    pub traced: Vec<usize>,
    pub(crate) key: Key,
    pub(crate) wrong: Vec<WrongAnswer>,
    /// The sentence for each wrong option, if it has one.
    sentences: Vec<Option<String>>,
    /// The index in the file of each option, in the order in which they are shown.
    in_file: Vec<usize>,
    /// The sentence for a wrong answer that has no other.
    otherwise: Option<String>,
    /// How far a number or a place may be from the right one.
    pub(crate) tolerance: f64,
    region: Option<Text>,
    line: usize,
}

/// The grade of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Grade {
    /// The score, from 0 to 1.
    pub score: f64,
    /// The sentence for a known wrong answer.
    pub sentence: Option<String>,
}

impl Grade {
    /// Returns whether the answer is right.
    pub(crate) fn is_right(&self) -> bool {
        self.score > 0.999
    }
}

impl Question {
    /// Returns the question of a gate about a scene.
    ///
    /// # Errors
    ///
    /// A fault of its expressions, with its line: none or several right options, no right sample or place, a known wrong
    /// answer that is right.
    pub fn of(gate: &Gate, scene: &Scene) -> Result<Self, LessonError> {
        let mut question = Self::unchecked(gate, scene)?;
        for wrong in &gate.wrong {
            let answer = question.wrong_answer(&gate.kind, &wrong.answer, scene)?;
            if question.score(&answer, 0, scene)? > 0.999 {
                let message = format!("the wrong answer {answer} is right here");
                return Err(wrong.answer.wrong(message));
            }
            let sentence = scene.fill(&wrong.sentence)?;
            question.wrong.push(WrongAnswer { answer, sentence });
        }
        Ok(question)
    }

    fn unchecked(gate: &Gate, scene: &Scene) -> Result<Self, LessonError> {
        let fill = |text: &Text| scene.fill(text);
        let cursor = scene.cursor();
        let places = |text: &Text| scene.places(text);
        let mut question = Self {
            asks: vec![fill(&gate.ask)?],
            named: vec![scene.samples_in(&gate.ask)?],
            circle: gate.circle,
            strip: gate.strip,
            marked: gate
                .mark
                .as_ref()
                .map(places)
                .transpose()?
                .unwrap_or_default(),
            form: Form::Number {
                unit: String::new(),
                curve: None,
            },
            hint: gate.hint.as_ref().map(fill).transpose()?,
            cursor,
            decided: decided(gate, scene)?,
            traced: Vec::new(),
            key: Key::Number(0.0),
            wrong: Vec::new(),
            sentences: Vec::new(),
            in_file: Vec::new(),
            otherwise: gate.otherwise.as_ref().map(fill).transpose()?,
            tolerance: 0.0,
            region: None,
            line: gate.line,
        };
        question.take_form(gate, scene)?;
        Ok(question)
    }

    /// Takes the form and the key of a gate, computed from the scene.
    fn take_form(&mut self, gate: &Gate, scene: &Scene) -> Result<(), LessonError> {
        let seed = scene.recording().run().parameters.seed;
        let draws = draws(gate, seed);
        match &gate.kind {
            GateKind::Pick {
                answer,
                candidates,
                several,
            } => {
                self.pick(scene, answer, candidates, *several)?;
            }
            GateKind::Place {
                right,
                answer,
                within,
                candidates,
            } => {
                let right = scene.places(right)?;
                let mut places: Vec<[f64; 2]> = right.iter().take(1).copied().collect();
                let wrong = gate.wrong.iter().map(|wrong| &wrong.answer);
                for candidate in candidates.iter().chain(wrong) {
                    places.push(scene.place(candidate)?);
                }
                shuffle(&mut places, draws);
                (self.tolerance, self.region) = (*within, answer.clone());
                self.form = Form::Place { candidates: places };
                self.key = Key::Place(right);
            }
            GateKind::Number {
                answer,
                tolerance,
                unit,
                curve: drawn,
            } => {
                self.tolerance = *tolerance;
                let drawn = drawn.as_ref().map(|set| power(scene, set, seed));
                self.form = Form::Number {
                    unit: unit.clone(),
                    curve: drawn.transpose()?.map(|power| curve(&power)),
                };
                self.key = Key::Number(scene.number(answer)?);
            }
            GateKind::Choice { options, curves } => {
                self.choice(scene, gate, options, curves)?;
            }
            GateKind::Order { items } => {
                let mut ranked = Vec::new();
                for (text, by) in items {
                    ranked.push((scene.fill(text)?, scene.number(by)?));
                }
                shuffle(&mut ranked, draws);
                let (items, ranks): (Vec<String>, Vec<f64>) = ranked.into_iter().unzip();
                self.form = Form::Order { items };
                self.key = Key::Order(ranks);
            }
            GateKind::Cut => self.cut(scene, draws)?,
            GateKind::Bands { from, to, bands } => self.bands(scene, from, to, bands, seed)?,
            GateKind::Trace {
                events,
                steps,
                options,
            } => {
                self.in_file = (0..options.len()).collect();
                shuffle(&mut self.in_file, draws);
                self.trace(scene, &gate.ask, events, *steps, options)?;
            }
        }
        Ok(())
    }

    fn wrong(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }

    /// Returns the valid samples of the moment.
    fn valid(&self, scene: &Scene) -> Result<Arc<PointSet>, LessonError> {
        let set = scene.now.set();
        set.map_err(|error| self.wrong(error.to_string()))
    }

    /// Takes the sentences of options, and returns their texts, both in the order in which they are shown.
    fn texts(
        &mut self,
        scene: &Scene,
        options: &[ChoiceOption],
    ) -> Result<Vec<String>, LessonError> {
        let mut texts = Vec::new();
        for &index in &self.in_file {
            let option = &options[index];
            let sentence = option.sentence.as_ref();
            self.sentences
                .push(sentence.map(|text| scene.fill(text)).transpose()?);
            texts.push(scene.fill(&option.text)?);
        }
        Ok(texts)
    }

    /// Returns where an option of the file is shown.
    fn shown_at(&self, option: usize) -> usize {
        let mut shown = self.in_file.iter();
        shown.position(|&index| index == option).unwrap_or(option)
    }

    /// Returns the index in the file of an option that is shown.
    pub(crate) fn in_file(&self, shown: usize) -> usize {
        self.in_file.get(shown).copied().unwrap_or(shown)
    }

    fn pick(
        &mut self,
        scene: &Scene,
        answer: &Text,
        candidates: &Text,
        several: bool,
    ) -> Result<(), LessonError> {
        let set = self.valid(scene)?;
        let listed = candidates;
        let candidates = scene.filter(listed, &set.ids)?;
        let count = candidates.len();
        if !(2..=MAX_CANDIDATES).contains(&count) {
            let message =
                format!("the list has {count} samples; it must have from 2 to {MAX_CANDIDATES}");
            return Err(listed.wrong(message));
        }
        let right = scene.filter(answer, &candidates)?;
        if right.is_empty() {
            return Err(answer.wrong("no sample of the list is right"));
        }
        if right.len() == count {
            return Err(answer.wrong("every sample of the list is right"));
        }
        self.form = Form::Pick {
            candidates,
            several,
        };
        self.key = Key::Pick(right);
        Ok(())
    }

    fn choice(
        &mut self,
        scene: &Scene,
        gate: &Gate,
        options: &[ChoiceOption],
        curves: &[Text],
    ) -> Result<(), LessonError> {
        let right = right_options(scene, options)?;
        let [index] = right[..] else {
            let letters: String = right.iter().map(|&index| letter(index)).collect();
            let which = if right.is_empty() {
                "none of the options is right".to_owned()
            } else {
                format!("the options {letters} are all right")
            };
            return Err(self.wrong(format!("{which}; exactly one must be")));
        };

        let seed = scene.recording().run().parameters.seed;
        self.in_file = balanced(gate, options.len(), index, seed);
        let index = self.shown_at(index);
        let texts = self.texts(scene, options)?;

        let mut drawn = Vec::new();
        // A gate has no curves, or one for each option.
        let beside = self.in_file.iter().filter_map(|&option| curves.get(option));
        for curve in beside {
            drawn.push(power(scene, curve, seed)?);
        }
        if let Some(own) = drawn.get(index) {
            // The curve of the right option must be the one nearest to the spectrum of the samples that are shown.
            let shown = self.valid(scene)?.power();
            let shown = shown.map_err(|error| self.wrong(error))?;
            let best = sets::rms(&shown, own);
            let mut others = drawn
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != index);
            if others.any(|(_, curve)| sets::rms(&shown, curve) <= best) {
                return Err(self.wrong(
                    "another curve is nearer to the spectrum than that of the right option",
                ));
            }
        }
        self.form = Form::Choice {
            options: texts,
            curves: drawn.iter().map(|power| curve(power)).collect(),
        };
        self.key = Key::Choice(index);
        Ok(())
    }

    fn cut(&mut self, scene: &Scene, draws: DrawKey) -> Result<(), LessonError> {
        let run = scene.recording().run();
        let next = scene.recording().event(scene.cursor());
        let next = next.and_then(tilescope_debugger::Event::run_event);
        let Some(RunEvent::Split { index, .. }) = next else {
            return Err(
                self.wrong("the next event must be a split: begin with \"moment: before split\"")
            );
        };
        let split = run.blocks.splits.get(index as usize);
        let split = split.ok_or_else(|| self.wrong("there is no such split"))?;
        let [low, high] = [split.rect.min, split.rect.max].map(position);
        let axis = match split.axis {
            Axis::X => CutAxis::X,
            Axis::Y => CutAxis::Y,
        };
        let other = axis.other();
        let (of, across) = (axis as usize, other as usize);
        let leaf = run.parameters.leaf;
        let legal = [low[of] + leaf, high[of] - leaf];
        let mut candidates = vec![
            (axis, 0.5 * (legal[0] + legal[1])),
            (axis, low[of] + 0.4 * leaf),
            (other, 0.5 * (low[across] + high[across])),
            (other, low[across] + 0.4 * leaf),
        ];
        shuffle(&mut candidates, draws);
        self.form = Form::Cut {
            min: low,
            max: high,
            candidates,
        };
        self.key = Key::Cut { axis, legal };
        Ok(())
    }

    fn bands(
        &mut self,
        scene: &Scene,
        from: &Text,
        to: &Text,
        bands: &[[f64; 2]],
        seed: u64,
    ) -> Result<(), LessonError> {
        let (before, after) = (power(scene, from, seed)?, power(scene, to, seed)?);
        let end = |power: &[sets::MeanPower]| power.last().map_or(0.0, |at| at.frequency);
        let last = end(&before).min(end(&after));
        if let Some([_, high]) = bands.iter().find(|[_, high]| *high > last) {
            let message = format!("a band ends at {high}, and the spectra at {last:.2} / r");
            return Err(self.wrong(message));
        }
        let change = |band: &[f64; 2]| {
            let ((a, a_error), (b, b_error)) =
                (sets::mean(&before, *band), sets::mean(&after, *band));
            // A smaller change is not to be seen in the curves, even where it is no noise.
            let noise = (3.0 * a_error.hypot(b_error)).max(SAME * a.max(b));
            if (b - a).abs() <= noise {
                Change::Same
            } else if b > a {
                Change::Up
            } else {
                Change::Down
            }
        };
        self.key = Key::Bands(bands.iter().map(change).collect());
        self.form = Form::Bands {
            bands: bands.to_vec(),
            curves: [curve(&before), curve(&after)],
        };
        Ok(())
    }

    fn trace(
        &mut self,
        scene: &Scene,
        ask: &Text,
        events: &Text,
        steps: usize,
        options: &[ChoiceOption],
    ) -> Result<(), LessonError> {
        let (_, mut traced) = coming(scene, events)?;
        traced.truncate(steps);
        if traced.len() < steps {
            let count = traced.len();
            let message =
                format!("only {count} events follow that match, and {steps} are asked for");
            return Err(events.wrong(message));
        }
        let mut right = Vec::new();
        let mut there = Scene::at(scene.recording(), scene.cursor());
        there.speak(&scene.translation);
        (self.asks, self.named) = (Vec::new(), Vec::new());
        for &event in &traced {
            there.go(event);
            self.asks.push(there.fill(ask)?);
            self.named.push(there.samples_in(ask)?);
            let holds = right_options(&there, options)?;
            let [index] = holds[..] else {
                let message = format!(
                    "{} options are right at event {}; exactly one must be",
                    holds.len(),
                    event + 1
                );
                return Err(self.wrong(message));
            };
            right.push(self.shown_at(index));
        }
        let options = self.texts(scene, options)?;
        self.form = Form::Trace { options, steps };
        self.key = Key::Trace(right);
        self.decided = traced.last().map_or(self.cursor, |&last| last + 1);
        self.traced = traced;
        Ok(())
    }

    fn wrong_answer(
        &self,
        kind: &GateKind,
        text: &Text,
        scene: &Scene,
    ) -> Result<Answer, LessonError> {
        Ok(match (kind, &self.form) {
            (GateKind::Pick { .. }, Form::Pick { candidates, .. }) => {
                let found = scene.filter(text, candidates)?;
                if found.is_empty() {
                    return Err(text.wrong("no sample of the list is this wrong answer"));
                }
                Answer::Pick(found)
            }
            (GateKind::Place { .. }, _) => Answer::Place(scene.place(text)?),
            _ => Answer::Number(scene.number(text)?),
        })
    }

    /// Returns the text of the question; of a trace, for the event of this index.
    #[must_use]
    pub fn ask(&self, step: usize) -> &str {
        let ask = self.asks.get(step).or(self.asks.last());
        ask.map_or("", String::as_str)
    }

    /// Returns the samples that [`Self::ask`] names.
    #[must_use]
    pub fn named(&self, step: usize) -> &[u32] {
        let named = self.named.get(step).or(self.named.last());
        named.map_or(&[], Vec::as_slice)
    }

    /// Returns the key.
    #[must_use]
    pub const fn key(&self) -> &Key {
        &self.key
    }

    /// Returns an answer that is right; of a trace, at the event of this index.
    #[must_use]
    pub fn right_answer(&self, event: usize) -> Answer {
        match (&self.key, &self.form) {
            (Key::Pick(right), Form::Pick { several: false, .. }) => {
                Answer::Pick(right[..1].to_vec())
            }
            (Key::Pick(right), _) => Answer::Pick(right.clone()),
            (Key::Place(right), _) => Answer::Place(right.first().copied().unwrap_or_default()),
            (Key::Number(number), _) => Answer::Number(*number),
            (Key::Choice(option), _) => Answer::Choice(*option),
            (Key::Order(ranks), _) => Answer::Order(sorted(ranks)),
            (Key::Cut { axis, legal }, _) => Answer::Cut {
                axis: *axis,
                at: 0.5 * (legal[0] + legal[1]),
            },
            (Key::Bands(changes), _) => Answer::Bands(changes.clone()),
            (Key::Trace(options), _) => {
                Answer::Choice(options.get(event).copied().unwrap_or_default())
            }
        }
    }

    /// Returns the chance of a guesser to be right at the first try: of one who takes any of what the list shows, draws any
    /// order, or types any whole number from 0 to 100. Of a trace, the chance at each event.
    ///
    /// # Errors
    ///
    /// A fault of the region of right places.
    pub(crate) fn chance(&self, scene: &Scene) -> Result<f64, LessonError> {
        let choices = |count: usize, of: f64| of.powi(count as i32);
        Ok(match (&self.form, &self.key) {
            (
                Form::Pick {
                    candidates,
                    several: false,
                },
                Key::Pick(right),
            ) => right.len() as f64 / candidates.len() as f64,
            // One set of samples is right, of all sets that are not empty.
            (Form::Pick { candidates, .. }, _) => 1.0 / (choices(candidates.len(), 2.0) - 1.0),
            (Form::Place { candidates }, _) => {
                let mut right = 0.0;
                for &place in candidates {
                    let score = self.score(&Answer::Place(place), 0, scene)?;
                    right += f64::from(u8::from(score > 0.999));
                }
                right / candidates.len().max(1) as f64
            }
            (Form::Number { .. }, _) => ((2.0 * self.tolerance + 1.0) / 101.0).min(1.0),
            (Form::Choice { options, .. } | Form::Trace { options, .. }, _) => {
                1.0 / options.len() as f64
            }
            (Form::Order { items }, _) => (1..=items.len()).map(|k| 1.0 / k as f64).product(),
            (Form::Cut { candidates, .. }, _) => 1.0 / candidates.len() as f64,
            (Form::Bands { bands, .. }, _) => 1.0 / choices(bands.len(), 3.0),
        })
    }

    /// Returns the grade of an answer; of a trace, to the event of the index `step`.
    ///
    /// # Errors
    ///
    /// An answer of another kind, or with unknown options, items or samples; a fault of the lesson's expressions.
    pub(crate) fn grade(
        &self,
        answer: &Answer,
        step: usize,
        scene: &Scene,
    ) -> Result<Grade, LessonError> {
        let score = self.score(answer, step, scene)?;
        let known = || {
            let mut wrong = self.wrong.iter();
            let known = wrong.find(|wrong| self.is_like(&wrong.answer, answer));
            known.map(|wrong| wrong.sentence.clone())
        };
        let sentence = match answer {
            _ if score > 0.999 => None,
            Answer::Choice(option) => self.sentences.get(*option).cloned().flatten(),
            _ => known().or_else(|| self.otherwise.clone()),
        };
        Ok(Grade { score, sentence })
    }

    fn check_option(&self, option: usize) -> Result<(), LessonError> {
        let (Form::Choice { options, .. } | Form::Trace { options, .. }) = &self.form else {
            return Err(self.wrong("the question has no options"));
        };
        if option < options.len() {
            return Ok(());
        }
        let (number, count) = (option + 1, options.len());
        Err(self.wrong(format!("there is no option {number}; there are {count}")))
    }

    /// Returns whether an answer is a known wrong one.
    fn is_like(&self, known: &Answer, answer: &Answer) -> bool {
        match (known, answer) {
            (Answer::Pick(a), Answer::Pick(b)) => {
                let one = matches!(self.form, Form::Pick { several: false, .. });
                if one {
                    b.iter().any(|s| a.contains(s))
                } else {
                    a.len() == b.len() && b.iter().all(|s| a.contains(s))
                }
            }
            (Answer::Place(a), Answer::Place(b)) => (a[0] - b[0]).hypot(a[1] - b[1]) <= 0.3,
            (Answer::Number(a), Answer::Number(b)) => (a - b).abs() <= self.tolerance.max(1e-9),
            _ => false,
        }
    }

    /// Returns the score of an answer, from 0 to 1.
    fn score(&self, answer: &Answer, step: usize, scene: &Scene) -> Result<f64, LessonError> {
        let worth = |is_right: bool| f64::from(u8::from(is_right));
        match (&self.key, &self.form, answer) {
            (
                Key::Pick(right),
                Form::Pick {
                    candidates,
                    several,
                },
                Answer::Pick(samples),
            ) => {
                let samples = self.picked(candidates, *several, samples)?;
                let hits = samples.iter().filter(|s| right.contains(s)).count() as f64;
                Ok(if *several {
                    2.0 * hits / (samples.len() + right.len()) as f64
                } else {
                    hits
                })
            }
            (Key::Place(right), _, Answer::Place(place)) => self.place_score(right, *place, scene),
            (Key::Number(number), _, Answer::Number(given)) => {
                let off = (given - number).abs();
                let tolerance = self.tolerance.max(1e-9);
                Ok(if off <= tolerance {
                    1.0
                } else if off <= 2.0 * tolerance {
                    0.5
                } else {
                    0.0
                })
            }
            (Key::Choice(right), _, Answer::Choice(option)) => {
                self.check_option(*option)?;
                Ok(worth(right == option))
            }
            (Key::Order(ranks), _, Answer::Order(items)) => self.order_score(ranks, items),
            (Key::Cut { axis, legal }, _, Answer::Cut { axis: given, at }) => {
                let is_legal = axis == given && (legal[0]..=legal[1]).contains(at);
                Ok(0.5 * worth(axis == given) + 0.5 * worth(is_legal))
            }
            (Key::Bands(right), _, Answer::Bands(changes)) => {
                if changes.len() != right.len() {
                    let (wanted, given) = (right.len(), changes.len());
                    return Err(self.wrong(format!("{wanted} bands are asked for, not {given}")));
                }
                let hits = right.iter().zip(changes).filter(|(a, b)| a == b).count();
                Ok(hits as f64 / right.len() as f64)
            }
            (Key::Trace(right), _, Answer::Choice(option)) => {
                self.check_option(*option)?;
                Ok(worth(right.get(step) == Some(option)))
            }
            _ => Err(self.wrong("the answer is not of the kind that is asked for")),
        }
    }

    /// Returns the samples of an answer, each once.
    ///
    /// # Errors
    ///
    /// None or too many of them, and samples that are not in the list.
    fn picked(
        &self,
        candidates: &[u32],
        several: bool,
        samples: &[u32],
    ) -> Result<Vec<u32>, LessonError> {
        let mut samples = samples.to_vec();
        samples.sort_unstable();
        samples.dedup();
        if !several && samples.len() != 1 {
            return Err(self.wrong("one sample is asked for"));
        }
        if samples.is_empty() {
            return Err(self.wrong("no sample is selected"));
        }
        if let Some(other) = samples.iter().find(|s| !candidates.contains(s)) {
            let message = format!("sample {other} is not one of the numbered ones");
            return Err(self.wrong(message));
        }
        Ok(samples)
    }

    /// Returns the share of pairs that are in the right order.
    fn order_score(&self, ranks: &[f64], items: &[usize]) -> Result<f64, LessonError> {
        let mut sorted = items.to_vec();
        sorted.sort_unstable();
        if !sorted.iter().copied().eq(0..ranks.len()) {
            let count = ranks.len();
            return Err(self.wrong(format!("an order names each of the {count} items once")));
        }

        let pairs = (0..items.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let (mut right, mut all) = (0.0, 0.0);
        for (a, b) in pairs {
            all += 1.0;
            right += f64::from(u8::from(ranks[items[a]] <= ranks[items[b]]));
        }
        Ok(right / f64::max(all, 1.0))
    }

    fn place_score(
        &self,
        right: &[[f64; 2]],
        place: [f64; 2],
        scene: &Scene,
    ) -> Result<f64, LessonError> {
        if !place.iter().all(|x| x.is_finite()) {
            return Err(self.wrong("a place has two numbers"));
        }
        let set = self.valid(scene)?;
        let distances = right.iter().map(|at| set.distance(*at, place));
        let nearest = distances.fold(f64::INFINITY, f64::min);
        let mut off = (nearest - self.tolerance).max(0.0);
        if let Some(region) = &self.region {
            let holds = |[x, y]: [f64; 2]| {
                scene.truth(region, |scope| {
                    scope.push_constant("x", x);
                    scope.push_constant("y", y);
                })
            };
            // The nearest place of the region, on rings around the answer.
            let rings = 16;
            'rings: for ring in 0..=rings {
                let reach = PLACE_REACH * f64::from(ring) / f64::from(rings);
                if reach >= off {
                    break;
                }
                for step in 0..if ring == 0 { 1 } else { 24 } {
                    let (sin, cos) = (std::f64::consts::TAU * f64::from(step) / 24.0).sin_cos();
                    if holds([place[0] + reach * cos, place[1] + reach * sin])? {
                        off = reach;
                        break 'rings;
                    }
                }
            }
        }
        Ok((1.0 - off / PLACE_REACH).max(0.0))
    }
}

fn curve(power: &[sets::MeanPower]) -> Curve {
    power.iter().map(|at| [at.frequency, at.mean]).collect()
}

/// Returns the indices of the options that are right at a moment.
fn right_options(scene: &Scene, options: &[ChoiceOption]) -> Result<Vec<usize>, LessonError> {
    let mut right = Vec::new();
    for (index, option) in options.iter().enumerate() {
        if scene.truth(&option.when, |_| {})? {
            right.push(index);
        }
    }
    Ok(right)
}

/// Returns the spectrum of a point set.
fn power(scene: &Scene, text: &Text, seed: u64) -> Result<Vec<sets::MeanPower>, LessonError> {
    let power = scene.set(text, seed)?.power();
    power.map_err(|error| text.wrong(error))
}

/// Returns a query with its values, and the events from the moment on that match it.
fn coming(scene: &Scene, text: &Text) -> Result<(String, Vec<usize>), LessonError> {
    let query = scene.fill(text)?;
    let found = scene.now.events(&query);
    let found = found.map_err(|error| text.wrong(error.to_string()))?;
    let from = found.partition_point(|&event| event < scene.cursor());
    Ok((query, found[from..].to_vec()))
}

/// Returns the moment after the deciding event.
fn decided(gate: &Gate, scene: &Scene) -> Result<usize, LessonError> {
    let Some(text) = &gate.decided else {
        return Ok(scene.cursor());
    };
    let (query, events) = coming(scene, text)?;
    let none = || {
        text.wrong(format!(
            "no event that matches \"{query}\" follows the question"
        ))
    };
    Ok(events.first().ok_or_else(none)? + 1)
}

/// Returns the key of the draws of a question. It depends on the question's name too, so that the questions of one run are
/// not all shuffled alike.
fn draws(gate: &Gate, seed: u64) -> DrawKey {
    let hash = blake3::hash(gate.name.as_bytes());
    let [a, b, c, d, ..] = *hash.as_bytes();
    DrawKey::from_seed(seed).derive(Stream::Order, u32::from_le_bytes([a, b, c, d]))
}

/// Returns the indices in the file of a number of options in the order in which they are shown, of which one is right. Of as
/// many successive seeds as there are options each shows the right one at another place, so that no place is right more
/// often than the others.
fn balanced(gate: &Gate, count: usize, right: usize, seed: u64) -> Vec<usize> {
    let mut places: Vec<usize> = (0..count).collect();
    shuffle(&mut places, draws(gate, seed / count as u64));
    let place = places[(seed % count as u64) as usize];

    let mut order: Vec<usize> = (0..count).filter(|&option| option != right).collect();
    shuffle(&mut order, draws(gate, seed));
    order.insert(place, right);
    order
}

/// Shuffles items.
fn shuffle<T>(items: &mut [T], draws: DrawKey) {
    for last in (1..items.len()).rev() {
        let other = below(draws.draw(Stream::Order, last as u32)[0], last as u32 + 1);
        items.swap(last, other as usize);
    }
}
