//! `trace`: the learner does the next steps of the algorithm by hand.

use std::sync::Arc;

use super::options::{Lettered, Options, right_options, shown_at};
use super::{Asking, GateKind, Interaction, KindRow, TracedEvent};
use crate::draws::shuffle;
use crate::error::LessonError;
use crate::fields::Fields;
use crate::scene::Scene;
use crate::text::{ChoiceOption, Text};

/// The most steps of a `trace`. Chosen, not measured.
const MAX_TRACED: u32 = 12;

pub(super) const ROW: KindRow = KindRow {
    name: "trace",
    once: &["events", "steps"],
    many: &["option"],
    wrong_names: &[],
    read,
};

#[derive(Debug)]
struct TraceGate {
    /// The query of the events that are predicted.
    events: Text,
    /// How many of them: 6 if the file does not say (chosen, not measured).
    steps: usize,
    /// The things that may happen, each with the expression that is true if it does.
    options: Vec<ChoiceOption>,
}

fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    Ok(Arc::new(TraceGate {
        events: fields.need("events")?.query()?,
        steps: fields
            .optional("steps", |field| field.whole([1, MAX_TRACED]))?
            .unwrap_or(6) as usize,
        options: fields.options()?,
    }))
}

impl GateKind for TraceGate {
    fn options(&self) -> &[ChoiceOption] {
        &self.options
    }

    fn is_trace(&self) -> bool {
        true
    }

    /// Asks for each of the coming events in turn, with the same options.
    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        // The query itself, with its values filled in, is of no use here.
        let (_query, mut coming) = asking.scene.coming(&self.events)?;
        coming.truncate(self.steps);
        if coming.len() < self.steps {
            let (count, steps) = (coming.len(), self.steps);
            let message =
                format!("only {count} events follow that match, and {steps} are asked for");
            return Err(self.events.wrong(message));
        }

        let mut in_file: Vec<usize> = (0..self.options.len()).collect();
        // The options are shuffled once for all events, so that each keeps its letter.
        shuffle(&mut in_file, asking.draws());

        let (mut events, mut right) = (Vec::new(), Vec::new());
        let mut there = Scene::at(asking.scene.recording(), asking.scene.cursor());
        there.speak(&asking.scene.translation);

        for cursor in coming {
            // To the moment before the event, where texts and options name it as the next one.
            there.go(cursor);
            events.push(TracedEvent {
                cursor,
                ask: there.fill(asking.ask)?,
                named: there.samples_in(asking.ask)?,
            });

            // An event with no right option, or with several, could not be graded.
            let holds = right_options(&there, &self.options)?;
            let [index] = holds[..] else {
                // Lessons count events from 1.
                let (count, event) = (holds.len(), cursor + 1);
                let message =
                    format!("{count} options are right at event {event}; exactly one must be");
                return Err(asking.fault(message));
            };

            right.push(shown_at(&in_file, index));
        }

        let options = Options::of(asking.scene, &self.options, in_file)?;
        Ok(Arc::new(Lettered {
            options,
            curves: Vec::new(),
            right,
            events,
        }))
    }
}
