//! The input of the next run.

use tilescope_session::recipe::OwnPattern;

use crate::command::FormCommand;
use crate::draft::Draft;

/// The input of the next run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form {
    /// The parameters as typed.
    pub draft: Draft,
    /// The pattern from a file to use instead of the one that the parameters describe.
    pub own_pattern: Option<OwnPattern>,
    /// Whether small runs start at once when a parameter changes.
    pub live: bool,
}

impl Form {
    pub(super) fn apply(&mut self, command: FormCommand) {
        match command {
            FormCommand::Type(field, text) => self.draft.set_text(field, text),
            FormCommand::Nudge(field, steps) => self.draft.nudge(field, steps),
            FormCommand::Live(live) => self.live = live,
            FormCommand::Count(text) => self.draft.set_count(text),
            FormCommand::Exactly(text) => self.draft.exactly = text,
            FormCommand::Preset(preset) => {
                let draft = Draft::from_parameters(preset.parameters());
                self.draft = draft.with_nesting(preset.nesting());
                self.own_pattern = None;
            }
            FormCommand::Choose(choice) => self.draft.choose(choice),
            FormCommand::GeneratedPattern => self.own_pattern = None,
            FormCommand::Reset => (self.draft, self.own_pattern) = (Draft::default(), None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draft::Field;

    #[test]
    fn a_reset_discards_what_was_typed() {
        let mut form = Form::default();
        form.apply(FormCommand::Type(Field::Seed, "7".to_owned()));
        assert_eq!(form.draft.parameters.seed, 7);
        form.apply(FormCommand::Reset);
        assert_eq!(form.draft, Draft::default());
    }
}
