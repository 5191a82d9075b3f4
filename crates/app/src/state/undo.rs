//! Undo and redo of parameters, layers and layout. Time needs none: it runs backwards by itself.

use super::State;
use crate::canvas::layers::{Colouring, Layers};
use crate::command::{Command, Field};
use crate::draft::Draft;
use crate::files::FileCommand;
use crate::layout::Layout;
use crate::recipe::OwnPattern;

/// Most steps that are remembered.
const MOST_STEPS: usize = 200;

/// What can be undone.
#[derive(Clone, Debug, PartialEq)]
pub struct Memento {
    draft: Draft,
    own_pattern: Option<OwnPattern>,
    layers: Layers,
    colouring: Colouring,
    layout: Layout,
}

/// What was, and what was undone.
#[derive(Default)]
pub struct History {
    past: Vec<Memento>,
    future: Vec<Memento>,
    /// The field that was typed in last: what is typed in one field is one step.
    typing: Option<Field>,
}

/// Returns whether a command may change what can be undone. The others, such as moves of the pointer, come with every
/// frame.
pub(super) const fn concerns(command: &Command) -> bool {
    matches!(
        command,
        Command::Type(..)
            | Command::Choose(_)
            | Command::ResetParameters
            | Command::ToggleLayer(_)
            | Command::Colour(_)
            | Command::OpenPanel(_)
            | Command::ResetLayout
            | Command::File(FileCommand::GeneratedPattern)
    )
}

impl State {
    /// Returns whether there is something to undo.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        !self.history.past.is_empty()
    }

    /// Returns whether there is something to redo.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        !self.history.future.is_empty()
    }

    /// Forgets all changes: another session is at hand, to which they do not belong.
    pub(super) fn forget_changes(&mut self) {
        self.history = History::default();
    }

    pub(super) fn memento(&self) -> Memento {
        Memento {
            draft: self.draft.clone(),
            own_pattern: self.own_pattern.clone(),
            layers: self.layers,
            colouring: self.colouring,
            layout: self.layout.clone(),
        }
    }

    /// Remembers what was before `command`, if the command changed it.
    pub(super) fn remember(&mut self, before: Memento, command: &Command) {
        let field = match command {
            Command::Type(field, _) => Some(*field),
            _ => None,
        };
        if before != self.memento() {
            let goes_on = field.is_some() && field == self.history.typing;
            if !goes_on {
                self.history.past.push(before);
                let surplus = self.history.past.len().saturating_sub(MOST_STEPS);
                self.history.past.drain(..surplus);
            }
            self.history.future.clear();
        }
        self.history.typing = field;
    }

    /// Takes over a layout that was changed by hand.
    pub fn replace_layout(&mut self, layout: Layout) {
        let before = self.memento();
        self.layout = layout;
        self.remember(before, &Command::ResetLayout);
    }

    pub(super) fn undo(&mut self) {
        if let Some(memento) = self.history.past.pop() {
            let now = self.memento();
            self.history.future.push(now);
            self.recall(memento);
        }
    }

    pub(super) fn redo(&mut self) {
        if let Some(memento) = self.history.future.pop() {
            let now = self.memento();
            self.history.past.push(now);
            self.recall(memento);
        }
    }

    fn recall(&mut self, memento: Memento) {
        self.history.typing = None;
        self.draft = memento.draft;
        self.own_pattern = memento.own_pattern;
        self.layers = memento.layers;
        self.colouring = memento.colouring;
        self.layout = memento.layout;
    }
}
