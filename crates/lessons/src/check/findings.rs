//! What the check finds about one step: its keys and scores in all runs, and the values of its claims.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::asked::Asked;
use super::claims::Claimed;
use crate::error::LessonError;
use crate::kinds::Novelty;
use crate::lesson::Gate;
use crate::question::Question;

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
    /// The part of the question that is out of sight in the step's own run.
    pub unseen: Option<String>,
    pub claimed: Claimed,
    pub faults: Vec<LessonError>,
}

impl Findings {
    /// Adds what asking the question in the run of a seed gave: the question, `None` where the run lacks the moment or
    /// the step has no question, or a fault.
    pub fn add(
        &mut self,
        gate: Option<&Gate>,
        asked: Result<Option<Asked>, LessonError>,
        is_practised: bool,
        seed: u64,
    ) {
        self.asked += usize::from(is_practised);

        match asked {
            // Of perfect answers and of guesses the check needs only the mean over all questions, which it adds up
            // itself.
            Ok(Some(Asked {
                question,
                scores: [_perfect, _guessing, misconceived],
                chance,
                unseen,
            })) => {
                let run = (is_practised, seed);
                // Only the step's own run can have a part out of sight here: a run of practice with one counts as a run
                // that lacks the moment.
                self.unseen = self.unseen.take().or(unseen);
                self.keys.insert(run, question.key());
                self.cursors.insert(run, question.cursor);
                self.chances.push(chance);
                self.misconceived.extend(misconceived);
                self.add_options(&question);

                // The author chose the step's own run: among the shares of drawn runs it does not count.
                if is_practised {
                    self.add_practised(gate, &question);
                }
            }
            // The run lacks the moment, or the step a question: it only counts as asked.
            Ok(None) => {}
            Err(mut error) => {
                let _ = write!(error.message, " (seed {seed})");
                self.faults.push(error);
            }
        }
    }

    /// Adds which options are right and wrong.
    fn add_options(&mut self, question: &Question) {
        let Some(options) = question.interaction.options() else {
            return;
        };
        for &right in question.interaction.right_options() {
            self.right.insert(options.in_file(right));
            let others = (0..options.texts.len()).filter(|&shown| shown != right);
            self.wrong
                .extend(others.map(|shown| options.in_file(shown)));
        }
    }

    /// Adds to the counts over the practised runs.
    fn add_practised(&mut self, gate: Option<&Gate>, question: &Question) {
        self.fitting += 1;
        let options = question.interaction.options();
        if let Some((options, shown)) = options.zip(question.right_option()) {
            *self.places.entry(shown).or_default() += 1;
            let option = options.in_file(shown);
            *self.options.entry(option).or_default() += 1;
        }

        let instance = gate.and_then(|gate| instance(gate, question));
        self.instances.extend(instance);
    }
}

/// Returns what "again" should change: the key, or the samples and numbers that the texts name. `None` for questions
/// that are new in every run, and for texts that name nothing.
fn instance(gate: &Gate, question: &Question) -> Option<String> {
    match gate.kind.novelty() {
        Novelty::Key => Some(question.key()),
        Novelty::Texts => {
            let mut texts = gate.kind.shown();
            texts.push(&gate.ask);
            if !texts.iter().any(|text| text.has_value()) {
                return None;
            }

            // The order in which options are shown makes no new question. The text of the question is that of its first
            // event, 0: only a trace has several, and a trace is new in every run.
            let mut shown = question.interaction.listed().to_vec();
            shown.sort();
            Some(format!("{} {}", question.ask(0), shown.join(" ")))
        }
        Novelty::Any => None,
    }
}
