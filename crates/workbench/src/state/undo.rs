//! Undo and redo of parameters and the runs made from them, of panels that were moved or hidden, of breakpoints, watches
//! and scenes, and of opened links. Moves in time, tabs, layers, colours and the camera cannot be undone, since they change
//! the view only. [`crate::rules`] says which commands can be undone.

use tilescope_core::combine::file::Layout as Combination;
use tilescope_debugger::Stops;
use tilescope_session::layers::SessionKind;
use tilescope_session::recipe::Recipe;

use super::{Form, State};
use crate::appearance::Appearance;
use crate::command::{Command, DebugCommand, FormCommand, Which, WindowCommand};
use crate::draft::{Draft, Field};
use crate::layout::{Layout, Panel};
use crate::rules::UndoPart;
use crate::scenes::SceneCommand;

/// The most steps that are kept.
const MAX_STEPS: usize = 200;

/// The input of the current run, so that it can be made again.
#[derive(Clone, Debug, PartialEq)]
enum Made {
    Run(Recipe),
    Combination(Combination),
}

/// A snapshot of everything that can be undone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Memento {
    form: Form,
    made: Option<Made>,
    appearance: Appearance,
    layout: Layout,
    stops: Stops,
}

/// A field in which typing is a single step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Typed {
    Parameter(Field),
    Condition(usize),
    Watch(usize),
    Caption(usize),
    Exactly,
}

/// Returns the field in which a command types.
const fn typed_in(command: &Command) -> Option<Typed> {
    Some(match command {
        Command::Form(FormCommand::Type(field, _) | FormCommand::Nudge(field, _)) => {
            Typed::Parameter(*field)
        }
        Command::Form(FormCommand::Count(_)) => Typed::Parameter(Field::Radius),
        Command::Form(FormCommand::Exactly(_)) => Typed::Exactly,
        Command::Debug(DebugCommand::Condition(index, _)) => Typed::Condition(*index),
        Command::Debug(DebugCommand::EditWatch(index, _)) => Typed::Watch(*index),
        Command::Scene(SceneCommand::Caption(index, _)) => Typed::Caption(*index),
        _ => return None,
    })
}

/// A change, with the snapshot before it or, once it is undone, after it.
struct Change {
    part: UndoPart,
    memento: Memento,
}

/// The changes to undo and to redo.
#[derive(Default)]
pub struct History {
    past: Vec<Change>,
    future: Vec<Change>,
    /// The field that was typed in last; typing in one field is a single step.
    typing: Option<Typed>,
    /// The field whose changes were run live last, and the number of steps then: changes of one field are one step.
    live: Option<(Typed, usize)>,
}

/// Returns a layout with the tabs that are open `now`, as far as it has their panels; panels that were hidden meanwhile
/// are as they were.
fn with_tabs_of(mut layout: Layout, now: &Layout) -> Layout {
    let restored = layout.clone();
    let is_kept = |panel: &Panel| now.shows(*panel) && !restored.hidden().has(*panel);
    let is_back = |panel: &Panel| now.hidden().has(*panel) && restored.shows(*panel);
    let is_kept = Panel::all().filter(is_kept);
    for panel in is_kept.chain(Panel::all().filter(is_back)) {
        layout.open(panel);
    }
    layout
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

    /// Drops all steps, as another session was opened.
    pub(super) fn forget_changes(&mut self) {
        self.history = History::default();
    }

    pub(super) fn memento(&self) -> Memento {
        Memento {
            form: self.form.clone(),
            made: self.made(),
            appearance: self.appearance.clone(),
            layout: self.window.layout.clone(),
            stops: self.runs.first.stops(),
        }
    }

    fn made(&self) -> Option<Made> {
        let session = self.runs.first.session.as_ref()?;
        match &session.combination {
            None if session.has_recipe() => Some(Made::Run(session.recipe())),
            None => None,
            // The content of its files is not kept.
            Some(combination) if combination.files > 0 => None,
            Some(combination) => Some(Made::Combination(combination.layout.clone())),
        }
    }

    /// Adds a step for `command`, if it changed something since `before`.
    pub(super) fn remember(&mut self, before: Memento, part: UndoPart, command: Option<&Command>) {
        // To open a tab is no change of the layout; to bring back a hidden panel is.
        if let Some(Command::Window(WindowCommand::OpenPanel(_))) = command
            && before.layout.hidden() == self.window.layout.hidden()
        {
            return;
        }
        let field = command.and_then(typed_in);
        if before != self.memento() {
            let goes_on = field.is_some() && field == self.history.typing;
            if goes_on {
                self.history.future.clear();
            } else {
                self.push(part, before);
            }
        }
        self.history.typing = field;
    }

    fn push(&mut self, part: UndoPart, memento: Memento) {
        let History { past, future, .. } = &mut self.history;
        past.push(Change { part, memento });
        let surplus = past.len().saturating_sub(MAX_STEPS);
        past.drain(..surplus);
        future.clear();
    }

    /// Adds the step of a run that is about to replace the current one. What was typed since the last run is
    /// part of it, so that undo restores parameters and run together.
    pub(super) fn remember_run(&mut self, part: UndoPart) {
        if self.runs.first.session.is_none() {
            return;
        }
        let mut before = self.memento();
        let past = &mut self.history.past;
        let is_run = |change: &Change| matches!(change.part, UndoPart::Run | UndoPart::Everything);
        let last = past.iter().rposition(is_run);
        let since = last.map_or(0, |index| index + 1);
        let mut later = past[since..].iter();
        if let Some(typed) = later.find(|change| change.part == UndoPart::Form) {
            before.form = typed.memento.form.clone();
        }
        let mut count = 0;
        past.retain(|change| {
            count += 1;
            count <= since || change.part != UndoPart::Form
        });
        self.history.typing = None;
        // A run that was cancelled is not a step.
        let stopped =
            last.is_some_and(|index| self.history.past[index].memento.made == before.made);
        if stopped && part == UndoPart::Run {
            self.history.future.clear();
        } else {
            self.push(part, before);
        }
    }

    /// Adds the step of a run that starts since a parameter changed, unless it goes on with the step of the one before.
    pub(super) fn remember_live_run(&mut self, command: &Command) {
        let field = typed_in(command);
        let last = self.history.past.len().checked_sub(1);
        let goes_on = field
            .zip(last)
            .is_some_and(|step| self.history.live == Some(step));
        if goes_on {
            // The change of the form belongs to that step.
            self.history.past.pop();
            self.history.typing = None;
        } else {
            self.remember_run(UndoPart::Run);
        }
        self.history.live = field.map(|field| (field, self.history.past.len()));
    }

    /// Takes a layout that the user changed by dragging. Moving a panel can be undone.
    pub fn replace_layout(&mut self, layout: Layout, is_moved: bool) {
        let before = self.memento();
        self.window.layout = layout;
        if is_moved {
            self.remember(before, UndoPart::Layout, None);
        }
    }

    /// Returns the question to ask before a change is taken back: whether to make a run again that takes minutes and much
    /// memory. It is answered by undoing once more while the question stands.
    fn question(&self, change: Option<&Change>) -> Option<String> {
        let change = change?;
        let is_run = matches!(change.part, UndoPart::Run | UndoPart::Everything);
        let Some(Made::Run(recipe)) = change.memento.made.as_ref().filter(|_| is_run) else {
            return None;
        };
        if change.memento.made == self.made() {
            return None;
        }
        let needed = Draft::from_parameters(recipe.parameters).memory_needed()?;
        Some(format!(
            "This makes an earlier run again. {needed} Do the same once more to go on."
        ))
    }

    /// Asks before a large run is made again; returns whether to wait for the answer.
    fn waits_for_answer(&mut self, question: Option<String>) -> bool {
        let Some(question) = question else {
            return false;
        };
        let asked = self.messages.notice.take();
        if asked.is_some_and(|notice| notice.text == question) {
            return false;
        }
        self.tell(question, false);
        true
    }

    pub(super) fn undo(&mut self) {
        if self.waits_for_answer(self.question(self.history.past.last())) {
            return;
        }
        if let Some(Change { part, memento }) = self.history.past.pop() {
            let mut now = self.memento();
            // The run may still be being made.
            let session = self.runs.first.session.as_ref();
            let is_made = session.is_none_or(|session| session.has_recipe());
            if matches!(part, UndoPart::Run | UndoPart::Everything) && is_made {
                now.made = Some(Made::Run(self.typed()));
            }
            self.history.future.push(Change { part, memento: now });
            self.recall(part, memento);
        }
    }

    pub(super) fn redo(&mut self) {
        if self.waits_for_answer(self.question(self.history.future.last())) {
            return;
        }
        if let Some(Change { part, memento }) = self.history.future.pop() {
            let now = self.memento();
            self.history.past.push(Change { part, memento: now });
            self.recall(part, memento);
        }
    }

    fn recall(&mut self, part: UndoPart, memento: Memento) {
        self.history.typing = None;
        if !matches!(part, UndoPart::Layout | UndoPart::Stops) {
            let live = self.form.live;
            self.form = Form {
                live,
                ..memento.form
            };
        }
        match part {
            UndoPart::Layout if memento.layout.hidden() != self.window.layout.hidden() => {
                self.window.layout = with_tabs_of(memento.layout, &self.window.layout);
            }
            UndoPart::Layout | UndoPart::Everything => self.window.layout = memento.layout,
            UndoPart::Form | UndoPart::Run | UndoPart::Stops => {}
        }
        if part == UndoPart::Stops {
            self.on(Which::First, |run, context| {
                run.put_stops(memento.stops, context);
            });
        }
        if part == UndoPart::Everything {
            self.appearance.chosen_layers = memento.appearance.chosen_layers;
            self.appearance.colouring = memento.appearance.colouring;
        }
        if matches!(part, UndoPart::Run | UndoPart::Everything) {
            self.make_again(memento.made);
        }
    }

    /// Makes a run again, unless it is the current one.
    fn make_again(&mut self, made: Option<Made>) {
        self.stop_making();
        if made == self.made() {
            return;
        }
        match made {
            Some(Made::Run(recipe)) => self.start_sampling(Which::First, recipe, self.gpu.engine),
            Some(Made::Combination(layout)) => self.start_combining(layout),
            None => {}
        }
    }

    /// Returns a sentence that names the parameters of the panel that differ from those of the run shown, if any.
    #[must_use]
    pub fn run_remark(&self) -> Option<String> {
        let run = &self.runs.first;
        let session = run.session.as_ref().filter(|_| run.sampling.is_none())?;
        if !session.has_recipe() {
            let what = match session.kind() {
                SessionKind::Combination => "A combination is",
                _ => "Nested levels of a file are",
            };
            return Some(format!("{what} shown, not a run of these parameters."));
        }
        let made = session.recipe();
        let mut names = self.form.draft.differences(&made.parameters);
        if self.form.draft.nesting() != made.nested {
            names.push("nested levels");
        }
        if self.form.own_pattern != session.own {
            names.push("pattern file");
        }
        if self.engine_differs() {
            names.push("engine");
        }
        (!names.is_empty()).then(|| format!("Not in the run shown: {}.", names.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn type_in(state: &mut State, field: Field, text: &str) {
        let command = crate::command::FormCommand::Type(field, text.to_owned());
        state.apply(Command::Form(command));
    }

    #[test]
    fn a_new_change_clears_redo() {
        let mut state = State::new(Arc::new(|| {}));
        type_in(&mut state, Field::Seed, "5");
        state.apply(Command::Undo);
        assert!(state.can_redo());
        type_in(&mut state, Field::Leaf, "40");
        assert!(state.can_undo() && !state.can_redo());
    }

    #[test]
    fn undo_asks_before_it_makes_a_large_run_again() {
        let mut state = State::new(Arc::new(|| {}));
        state.settle();
        let mut step = |radius: f64| {
            let mut memento = state.memento();
            let mut recipe = state.typed();
            recipe.parameters.radius = radius;
            memento.made = Some(Made::Run(recipe));
            state.push(UndoPart::Run, memento);
            state.apply(Command::Undo);
            let is_running = state.runs.first.sampling.is_some();
            let asked = state.messages.notice.clone();
            state.apply(Command::Cancel(Which::First));
            state.settle();
            state.messages.notice = None;
            (is_running, asked.map(|notice| notice.text))
        };
        assert_eq!(step(0.02), (true, None));
        let (is_running, asked) = step(0.000_083);
        let asked = asked.expect("a question");
        assert!(
            !is_running && asked.contains("samples need about 9 GB"),
            "{asked}"
        );
        // While the question stands, the same once more is the answer.
        state.apply(Command::Undo);
        assert!(state.runs.first.sampling.is_none());
        state.apply(Command::Undo);
        assert!(state.runs.first.sampling.is_some());
        state.apply(Command::Cancel(Which::First));
        state.settle();
    }

    #[test]
    fn undo_of_a_hidden_panel_leaves_the_tabs_that_were_opened_since() {
        let mut state = State::new(Arc::new(|| {}));
        let window = |state: &mut State, command| state.apply(Command::Window(command));
        window(&mut state, WindowCommand::HidePanel(Panel::Legend));
        window(&mut state, WindowCommand::OpenPanel(Panel::Events));
        state.apply(Command::Undo);
        assert!(!state.window.layout.hidden().has(Panel::Legend));
        assert!(state.window.shows(Panel::Events));
        state.apply(Command::Redo);
        assert!(state.window.layout.hidden().has(Panel::Legend));
        assert!(state.window.shows(Panel::Events));
        // A panel that was visible when it was hidden is visible again.
        window(&mut state, WindowCommand::HidePanel(Panel::Events));
        state.apply(Command::Undo);
        assert!(state.window.shows(Panel::Events));
    }

    #[test]
    fn the_number_of_steps_is_limited() {
        let mut state = State::new(Arc::new(|| {}));
        for step in 0..MAX_STEPS + 10 {
            let field = [Field::Seed, Field::Leaf][step % 2];
            type_in(&mut state, field, &(step + 6).to_string());
        }
        let mut undone = 0;
        while state.can_undo() {
            state.apply(Command::Undo);
            undone += 1;
        }
        assert_eq!(undone, MAX_STEPS);
    }
}
