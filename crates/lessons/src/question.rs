//! A question about a moment of a run: what the learner sees, and the key, which is computed from the recording.

use tilescope_core::stages::blocks::Axis;
use tilescope_core::{Key as DrawKey, R, RunEvent, Stream, below};

use crate::answer::{Answer, Change, CutAxis, Key, letter};
use crate::error::LessonError;
use crate::lesson::{ChoiceOption, Gate, GateKind, Text};
use crate::scene::Scene;
use crate::sets;

/// How far from a right place a place still scores, in r.
const PLACE_REACH: f64 = 0.5;
/// The most samples in the list of a question.
pub const MAX_CANDIDATES: usize = 24;

/// A curve beside an option: mean power by frequency in 1/r.
pub type Curve = Vec<[f64; 2]>;

/// What a learner sees of a question, and answers with.
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
    /// A place; those of the list stand for a pointer.
    Place {
        /// Places of the list, in r.
        candidates: Vec<[f64; 2]>,
    },
    /// A number in a unit.
    Number {
        /// The unit; empty for counts.
        unit: String,
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
    /// What is said to it.
    pub sentence: String,
}

/// A question about a moment of a run.
#[derive(Clone, Debug)]
pub struct Question {
    /// What it asks; of a trace, at each of its events.
    asks: Vec<String>,
    /// The samples that the question names, as for `asks`.
    named: Vec<Vec<u32>>,
    /// What the learner sees and answers with.
    pub form: Form,
    /// A hint.
    pub hint: Option<String>,
    /// The moment, as the number of events that have happened.
    pub cursor: usize,
    /// The moment after the event that decides; the question's own if it is known already.
    pub decided: usize,
    /// The moments at which the events of a trace are predicted.
    pub traced: Vec<usize>,
    pub(crate) key: Key,
    pub(crate) wrong: Vec<WrongAnswer>,
    /// What is said to each option, if it is wrong.
    sentences: Vec<Option<String>>,
    tolerance: f64,
    region: Option<Text>,
    line: usize,
}

/// What an answer is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Grade {
    /// From 0 to 1.
    pub score: f64,
    /// What is said to a known wrong answer.
    pub sentence: Option<String>,
}

impl Grade {
    /// Returns whether the answer is right.
    #[must_use]
    pub fn is_right(&self) -> bool {
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
            let grade = question.score(&answer, scene)?;
            if grade > 0.999 {
                let line = wrong.answer.line;
                return Err(LessonError::new(
                    line,
                    format!("the wrong answer {answer} is right here"),
                ));
            }
            let sentence = scene.fill(&wrong.sentence, wrong.answer.line)?;
            question.wrong.push(WrongAnswer { answer, sentence });
        }
        Ok(question)
    }

    fn unchecked(gate: &Gate, scene: &Scene) -> Result<Self, LessonError> {
        let fill = |text: &Text| scene.fill(&text.text, text.line);
        let cursor = scene.cursor();
        let mut question = Self {
            asks: vec![fill(&gate.ask)?],
            named: vec![scene.samples_in(&gate.ask)?],
            form: Form::Number {
                unit: String::new(),
            },
            hint: gate.hint.as_ref().map(fill).transpose()?,
            cursor,
            decided: decided(gate, scene)?,
            traced: Vec::new(),
            key: Key::Number(0.0),
            wrong: Vec::new(),
            sentences: Vec::new(),
            tolerance: 0.0,
            region: None,
            line: gate.line,
        };
        let seed = scene.recording().run().parameters.seed;
        match &gate.kind {
            GateKind::Pick {
                answer,
                candidates,
                several,
            } => {
                question.pick(scene, answer, candidates, *several)?;
            }
            GateKind::Place {
                right,
                answer,
                within,
                candidates,
            } => {
                let right = scene.places(right)?;
                let mut places: Vec<[f64; 2]> = right.iter().take(1).copied().collect();
                for candidate in candidates
                    .iter()
                    .chain(gate.wrong.iter().map(|wrong| &wrong.answer))
                {
                    places.push(scene.place(candidate)?);
                }
                shuffle(&mut places, seed);
                (question.tolerance, question.region) = (*within, answer.clone());
                question.form = Form::Place { candidates: places };
                question.key = Key::Place(right);
            }
            GateKind::Number {
                answer,
                tolerance,
                unit,
            } => {
                question.tolerance = *tolerance;
                question.form = Form::Number { unit: unit.clone() };
                question.key = Key::Number(scene.number(answer)?);
            }
            GateKind::Choice { options, curves } => {
                question.choice(scene, options, curves, seed)?;
            }
            GateKind::Order { items } => {
                let mut ranked = Vec::new();
                for (text, by) in items {
                    ranked.push((fill(text)?, scene.number(by)?));
                }
                shuffle(&mut ranked, seed);
                let (items, ranks): (Vec<String>, Vec<f64>) = ranked.into_iter().unzip();
                question.form = Form::Order { items };
                question.key = Key::Order(ranks);
            }
            GateKind::Cut => question.cut(scene, seed)?,
            GateKind::Bands { from, to, bands } => question.bands(scene, from, to, bands, seed)?,
            GateKind::Trace {
                events,
                steps,
                options,
            } => question.trace(scene, &gate.ask, events, *steps, options)?,
        }
        Ok(question)
    }

    fn wrong(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }

    fn pick(
        &mut self,
        scene: &Scene,
        answer: &Text,
        candidates: &Text,
        several: bool,
    ) -> Result<(), LessonError> {
        let set = scene
            .now
            .set()
            .map_err(|error| self.wrong(error.to_string()))?;
        let candidates_line = candidates.line;
        let candidates = scene.filter(candidates, &set.ids)?;
        if candidates.len() < 2 || candidates.len() > MAX_CANDIDATES {
            let message = format!(
                "the list has {} samples; it has from 2 to {MAX_CANDIDATES}",
                candidates.len()
            );
            return Err(LessonError::new(candidates_line, message));
        }
        let right = scene.filter(answer, &candidates)?;
        if right.is_empty() || right.len() == candidates.len() {
            let message = if right.is_empty() {
                "no sample of the list is right"
            } else {
                "every sample of the list is right"
            };
            return Err(LessonError::new(answer.line, message));
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
        options: &[ChoiceOption],
        curves: &[Text],
        seed: u64,
    ) -> Result<(), LessonError> {
        let mut right = Vec::new();
        let mut texts = Vec::new();
        for (index, option) in options.iter().enumerate() {
            texts.push(scene.fill(&option.text.text, option.text.line)?);
            let sentence = option.sentence.as_ref();
            self.sentences.push(
                sentence
                    .map(|text| scene.fill(text, option.text.line))
                    .transpose()?,
            );
            if scene.truth(&option.when, |_| {})? {
                right.push(index);
            }
        }
        let [index] = right[..] else {
            let letters: String = right.iter().map(|&index| letter(index)).collect();
            let which = if right.is_empty() {
                "none of the options is right".to_owned()
            } else {
                format!("the options {letters} are all right")
            };
            return Err(self.wrong(format!("{which}; exactly one must be")));
        };
        let mut drawn = Vec::new();
        for curve in curves {
            let power = scene
                .set(curve, seed)?
                .power()
                .map_err(|error| LessonError::new(curve.line, error))?;
            drawn.push(power);
        }
        if let Some(own) = drawn.get(index) {
            // The curve of the right option must be the one nearest to the spectrum of the samples that are shown.
            let shown = scene
                .now
                .set()
                .map_err(|error| self.wrong(error.to_string()))?;
            let shown = shown.power().map_err(|error| self.wrong(error))?;
            let best = sets::rms(&shown, own);
            if drawn
                .iter()
                .enumerate()
                .any(|(other, curve)| other != index && sets::rms(&shown, curve) <= best)
            {
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

    fn cut(&mut self, scene: &Scene, seed: u64) -> Result<(), LessonError> {
        let run = scene.recording().run();
        let next = scene
            .recording()
            .event(scene.cursor())
            .and_then(tilescope_debugger::Event::run_event);
        let Some(RunEvent::Split { index, .. }) = next else {
            return Err(
                self.wrong("the next event must be a split: begin with \"moment: before split\"")
            );
        };
        let split = run
            .blocks
            .splits
            .get(index as usize)
            .ok_or_else(|| self.wrong("there is no such split"))?;
        let radii = |units: i32| f64::from(units) / f64::from(R);
        let (min, max) = (split.rect.min, split.rect.max);
        let (low, high) = ([radii(min.x), radii(min.y)], [radii(max.x), radii(max.y)]);
        let (axis, of) = match split.axis {
            Axis::X => (CutAxis::X, 0),
            Axis::Y => (CutAxis::Y, 1),
        };
        let leaf = run.parameters.leaf;
        let legal = [low[of] + leaf, high[of] - leaf];
        let other = if axis == CutAxis::X {
            CutAxis::Y
        } else {
            CutAxis::X
        };
        let across = 1 - of;
        let mut candidates = vec![
            (axis, 0.5 * (legal[0] + legal[1])),
            (axis, low[of] + 0.4 * leaf),
            (other, 0.5 * (low[across] + high[across])),
            (other, low[across] + 0.4 * leaf),
        ];
        shuffle(&mut candidates, seed);
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
        let power = |text: &Text| {
            scene
                .set(text, seed)?
                .power()
                .map_err(|error| LessonError::new(text.line, error))
        };
        let (before, after) = (power(from)?, power(to)?);
        let end = |power: &[sets::MeanPower]| power.last().map_or(0.0, |at| at.frequency);
        let last = end(&before).min(end(&after));
        if let Some([_, high]) = bands.iter().find(|[_, high]| *high > last) {
            let message = format!("a band ends at {high}, and the spectra at {last:.2} / r");
            return Err(self.wrong(message));
        }
        let change = |band: &[f64; 2]| {
            let ((a, a_error), (b, b_error)) =
                (sets::mean(&before, *band), sets::mean(&after, *band));
            let noise = (3.0 * a_error.hypot(b_error)).max(0.15 * a.max(b));
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
        let query = scene.fill(&events.text, events.line)?;
        let found = scene
            .now
            .events(&query)
            .map_err(|error| LessonError::new(events.line, error.to_string()))?;
        let from = found.partition_point(|&event| event < scene.cursor());
        let traced: Vec<usize> = found[from..].iter().copied().take(steps).collect();
        if traced.len() < steps {
            let message = format!(
                "only {} events follow that match, and {steps} are asked for",
                traced.len()
            );
            return Err(LessonError::new(events.line, message));
        }
        let mut right = Vec::new();
        let mut there = Scene::at(scene.recording(), scene.cursor());
        there.speak_as(scene);
        (self.asks, self.named) = (Vec::new(), Vec::new());
        for &event in &traced {
            there.go(event);
            self.asks.push(there.fill(&ask.text, ask.line)?);
            self.named.push(there.samples_in(ask)?);
            let mut holds = Vec::new();
            for (index, option) in options.iter().enumerate() {
                if there.truth(&option.when, |_| {})? {
                    holds.push(index);
                }
            }
            let [index] = holds[..] else {
                let message = format!(
                    "{} options are right at event {}; exactly one must be",
                    holds.len(),
                    event + 1
                );
                return Err(self.wrong(message));
            };
            right.push(index);
        }
        let texts: Result<Vec<String>, LessonError> = options
            .iter()
            .map(|o| scene.fill(&o.text.text, o.text.line))
            .collect();
        for option in options {
            let sentence = option.sentence.as_ref();
            let filled = sentence.map(|text| scene.fill(text, option.text.line));
            self.sentences.push(filled.transpose()?);
        }
        self.form = Form::Trace {
            options: texts?,
            steps,
        };
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
                    return Err(LessonError::new(
                        text.line,
                        "no sample of the list is this wrong answer",
                    ));
                }
                Answer::Pick(found)
            }
            (GateKind::Place { .. }, _) => Answer::Place(scene.place(text)?),
            _ => Answer::Number(scene.number(text)?),
        })
    }

    /// Returns what is asked; of a trace, at one of its events.
    #[must_use]
    pub fn ask(&self, step: usize) -> &str {
        self.asks
            .get(step)
            .or(self.asks.last())
            .map_or("", String::as_str)
    }

    /// Returns the samples that the question names, as for [`Self::ask`].
    #[must_use]
    pub fn named(&self, step: usize) -> &[u32] {
        self.named
            .get(step)
            .or(self.named.last())
            .map_or(&[], Vec::as_slice)
    }

    /// Returns the key.
    #[must_use]
    pub const fn key(&self) -> &Key {
        &self.key
    }

    /// Returns the known wrong answers.
    #[must_use]
    pub fn wrong_answers(&self) -> &[WrongAnswer] {
        &self.wrong
    }

    /// Returns an answer that is right; of a trace, its first event's.
    #[must_use]
    pub fn right_answer(&self) -> Answer {
        self.right_answer_at(0)
    }

    /// Returns an answer that is right; of a trace, at the event of this index.
    #[must_use]
    pub fn right_answer_at(&self, event: usize) -> Answer {
        match (&self.key, &self.form) {
            (Key::Pick(right), Form::Pick { several: false, .. }) => {
                Answer::Pick(right[..1].to_vec())
            }
            (Key::Pick(right), _) => Answer::Pick(right.clone()),
            (Key::Place(right), _) => Answer::Place(right.first().copied().unwrap_or_default()),
            (Key::Number(number), _) => Answer::Number(*number),
            (Key::Choice(option), _) => Answer::Choice(*option),
            (Key::Order(ranks), _) => {
                let mut order: Vec<usize> = (0..ranks.len()).collect();
                order.sort_by(|&a, &b| ranks[a].total_cmp(&ranks[b]));
                Answer::Order(order)
            }
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

    /// Returns what an answer is worth. Of a trace, `step` is the event that is predicted.
    ///
    /// # Errors
    ///
    /// An answer of another kind, or of options, items or samples that there are not; a fault of the lesson's expressions.
    pub fn grade(&self, answer: &Answer, step: usize, scene: &Scene) -> Result<Grade, LessonError> {
        if let (Key::Trace(right), Answer::Choice(option)) = (&self.key, answer) {
            self.check_option(*option)?;
            let is_right = right.get(step) == Some(option);
            let sentence = self
                .sentences
                .get(*option)
                .cloned()
                .flatten()
                .filter(|_| !is_right);
            return Ok(Grade {
                score: f64::from(u8::from(is_right)),
                sentence,
            });
        }
        let score = self.score(answer, scene)?;
        let mut sentence = None;
        if score <= 0.999 {
            sentence = match answer {
                Answer::Choice(option) => self.sentences.get(*option).cloned().flatten(),
                _ => self
                    .wrong
                    .iter()
                    .find(|wrong| self.is_like(&wrong.answer, answer))
                    .map(|wrong| wrong.sentence.clone()),
            };
        }
        Ok(Grade { score, sentence })
    }

    fn check_option(&self, option: usize) -> Result<(), LessonError> {
        let (Form::Choice { options, .. } | Form::Trace { options, .. }) = &self.form else {
            return Err(self.wrong("the question has no options"));
        };
        if option < options.len() {
            return Ok(());
        }
        Err(self.wrong(format!(
            "there is no option {}; there are {}",
            option + 1,
            options.len()
        )))
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

    fn score(&self, answer: &Answer, scene: &Scene) -> Result<f64, LessonError> {
        match (&self.key, &self.form, answer) {
            (
                Key::Pick(right),
                Form::Pick {
                    candidates,
                    several,
                },
                Answer::Pick(samples),
            ) => {
                let mut samples = samples.clone();
                samples.sort_unstable();
                samples.dedup();
                if samples.is_empty() || !*several && samples.len() > 1 {
                    return Err(self.wrong(if *several {
                        "no sample is selected"
                    } else {
                        "one sample is asked for"
                    }));
                }
                if let Some(other) = samples.iter().find(|s| !candidates.contains(s)) {
                    return Err(
                        self.wrong(format!("sample {other} is not one of the numbered ones"))
                    );
                }
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
                Ok(f64::from(u8::from(right == option)))
            }
            (Key::Order(ranks), _, Answer::Order(items)) => {
                let mut sorted = items.clone();
                sorted.sort_unstable();
                if !sorted.iter().copied().eq(0..ranks.len()) {
                    return Err(self.wrong(format!(
                        "an order names each of the {} items once",
                        ranks.len()
                    )));
                }
                let pairs = (0..items.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
                let (mut right, mut all) = (0.0, 0.0);
                for (a, b) in pairs {
                    all += 1.0;
                    right += f64::from(u8::from(ranks[items[a]] <= ranks[items[b]]));
                }
                Ok(right / f64::max(all, 1.0))
            }
            (Key::Cut { axis, legal }, _, Answer::Cut { axis: given, at }) => {
                let is_legal = axis == given && (legal[0]..=legal[1]).contains(at);
                Ok(0.5 * f64::from(u8::from(axis == given)) + 0.5 * f64::from(u8::from(is_legal)))
            }
            (Key::Bands(right), _, Answer::Bands(changes)) => {
                if changes.len() != right.len() {
                    return Err(self.wrong(format!(
                        "{} bands are asked for, not {}",
                        right.len(),
                        changes.len()
                    )));
                }
                let hits = right.iter().zip(changes).filter(|(a, b)| a == b).count();
                Ok(hits as f64 / right.len() as f64)
            }
            (Key::Trace(right), _, Answer::Choice(option)) => {
                Ok(f64::from(u8::from(right.first() == Some(option))))
            }
            _ => Err(self.wrong("the answer is not of the kind that is asked for")),
        }
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
        let set = scene
            .now
            .set()
            .map_err(|error| self.wrong(error.to_string()))?;
        let nearest = right
            .iter()
            .map(|at| set.distance(*at, place))
            .fold(f64::INFINITY, f64::min);
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

/// Returns the moment after the event that decides.
fn decided(gate: &Gate, scene: &Scene) -> Result<usize, LessonError> {
    let Some(text) = &gate.decided else {
        return Ok(scene.cursor());
    };
    let query = scene.fill(&text.text, text.line)?;
    let found = scene
        .now
        .events(&query)
        .map_err(|error| LessonError::new(text.line, error.to_string()))?;
    let at = found.partition_point(|&event| event < scene.cursor());
    let event = found.get(at).ok_or_else(|| {
        LessonError::new(
            text.line,
            format!("no event that matches \"{query}\" follows the question"),
        )
    })?;
    Ok(event + 1)
}

/// Shuffles items by a seed.
fn shuffle<T>(items: &mut [T], seed: u64) {
    let key = DrawKey::from_seed(seed).derive(Stream::Order, 0);
    for last in (1..items.len()).rev() {
        let other = below(key.draw(Stream::Order, last as u32)[0], last as u32 + 1);
        items.swap(last, other as usize);
    }
}
