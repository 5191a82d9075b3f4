//! What the check finds about one step: its keys and scores in all runs, and the values of its claims.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::asked::Asked;
use super::claims::Claimed;
use crate::answer::Key;
use crate::error::LessonError;
use crate::lesson::{ChoiceOption, Gate, GateKind, Text};
use crate::question::{Form, Question};

/// A run of a step: whether it is practised, and its seed.
type OfRun = (bool, u64);

/// The findings about one step.
#[derive(Default)]
pub(super) struct Findings {
    pub keys: BTreeMap<OfRun, String>,
    /// The moments at which the question was asked.
    pub cursors: BTreeMap<OfRun, usize>,
    /// What "again" should change, in the practised runs in the order of their seeds.
    pub instances: Vec<String>,
    /// How many practised runs each option of the file is right in.
    pub options: BTreeMap<usize, usize>,
    /// How many practised runs show the right option at each place of the list.
    pub places: BTreeMap<usize, usize>,
    /// The options of the file that are right in some run, and those that are wrong in some.
    pub right: BTreeSet<usize>,
    pub wrong: BTreeSet<usize>,
    /// A guesser's chances at the first try, and the scores of the learner with a misconception.
    pub chances: Vec<f64>,
    pub misconceived: Vec<f64>,
    /// How many practised runs were asked, and how many of them have the moment.
    pub asked: usize,
    pub fitting: usize,
    /// What is not to be seen of the question in the step's own run.
    pub unseen: Option<String>,
    pub claimed: Claimed,
    pub faults: Vec<LessonError>,
}

impl Findings {
    /// Adds what asking the question in the run of a seed gave: the question, none where the run lacks its moment, or a
    /// fault.
    pub fn add(
        &mut self,
        gate: Option<&Gate>,
        asked: Result<Option<Asked>, LessonError>,
        is_practised: bool,
        seed: u64,
    ) {
        self.asked += usize::from(is_practised);
        match asked {
            Ok(Some(Asked {
                question,
                scores: [_, _, misconceived],
                chance,
                unseen,
            })) => {
                let run = (is_practised, seed);
                self.unseen = self.unseen.take().or(unseen);
                self.keys.insert(run, question.key().to_string());
                self.cursors.insert(run, question.cursor);
                self.chances.push(chance);
                self.misconceived.extend(misconceived);
                self.add_options(&question);
                // The step's own run is one that the author chose, so it does not count among shares.
                if is_practised {
                    self.add_practised(gate, &question);
                }
            }
            Ok(None) => {}
            Err(mut error) => {
                let _ = write!(error.message, " (seed {seed})");
                self.faults.push(error);
            }
        }
    }

    /// Adds which options are right and wrong.
    fn add_options(&mut self, question: &Question) {
        let (Form::Choice { options, .. } | Form::Trace { options, .. }) = &question.form else {
            return;
        };
        let rights = match question.key() {
            Key::Choice(right) => std::slice::from_ref(right),
            Key::Trace(rights) => rights.as_slice(),
            _ => return,
        };
        for &right in rights {
            self.right.insert(question.in_file(right));
            let others = (0..options.len()).filter(|&shown| shown != right);
            self.wrong
                .extend(others.map(|shown| question.in_file(shown)));
        }
    }

    /// Adds what is counted over the practised runs.
    fn add_practised(&mut self, gate: Option<&Gate>, question: &Question) {
        self.fitting += 1;
        if let Key::Choice(shown) = question.key() {
            *self.places.entry(*shown).or_default() += 1;
            let option = question.in_file(*shown);
            *self.options.entry(option).or_default() += 1;
        }
        let instance = gate.and_then(|gate| instance(gate, question));
        self.instances.extend(instance);
    }
}

/// Returns what "again" should change: the key of a number or of a pick, the samples and numbers that a choice names; none
/// of other questions and of a choice that names nothing.
fn instance(gate: &Gate, question: &Question) -> Option<String> {
    let has_value = |text: &Text| text.text.contains('{');
    match (&gate.kind, &question.form) {
        (GateKind::Number { .. } | GateKind::Pick { .. }, _) => Some(question.key().to_string()),
        (GateKind::Choice { options, .. }, Form::Choice { options: shown, .. }) => {
            let names = |option: &ChoiceOption| has_value(&option.text);
            if !has_value(&gate.ask) && !options.iter().any(names) {
                return None;
            }
            // The order in which options are shown makes no new question.
            let mut shown = shown.clone();
            shown.sort();
            Some(format!("{} {}", question.ask(0), shown.join(" ")))
        }
        _ => None,
    }
}
