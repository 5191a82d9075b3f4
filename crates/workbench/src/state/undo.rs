//! Undo and redo of parameters and the runs made from them, of panels that were moved or hidden, of the curve above the
//! timeline, of breakpoints, watches and scenes, and of opened links. Moves in time, tabs, layers, colours and the camera
//! cannot be undone, since they change the view only. [`crate::rules`] says which commands can be undone.

use tilescope_core::Parameter;
use tilescope_core::combine::file::Layout as Combination;
use tilescope_debugger::Stops;
use tilescope_session::recipe::Recipe;

use super::effects::{Context, Effect};
use super::{Appearance, Form, RunView, State};
use crate::command::{AppearanceCommand, Command, DebugCommand, FormCommand, WindowCommand};
use crate::draft::{Draft, StippleNumber};
use crate::layout::{Layout, Panel};
use crate::rules::UndoPart;
use crate::scenes::SceneCommand;

/// The most steps that are kept. Chosen, not measured.
const MAX_STEPS: usize = 200;

/// The input of the current run, so that it can be made again.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Made {
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
    Parameter(Parameter),
    /// The condition of the breakpoint of this index.
    Condition(usize),
    /// The watch of this index.
    Watch(usize),
    /// The caption of the scene of this index.
    Caption(usize),
    /// How many samples nested levels have exactly.
    Exactly,
    /// The radius as a function of x and y.
    Expression,
    /// The radius of white, of an image.
    White,
    /// A number of a stipple.
    Stipple(StippleNumber),
    /// The third side of a set in space.
    Depth,
    CurveHeight,
}

/// Returns the field in which a command types, or whose value it changes step by step; `None` for all other commands.
const fn typed_in(command: &Command) -> Option<Typed> {
    Some(match command {
        Command::Form(FormCommand::Type(field, _) | FormCommand::Nudge(field, _)) => {
            Typed::Parameter(*field)
        }
        // A number of samples that is typed sets the radius.
        Command::Form(FormCommand::Count(_)) => Typed::Parameter(Parameter::Radius),
        Command::Form(FormCommand::Exactly(_)) => Typed::Exactly,
        Command::Form(FormCommand::Expression(_)) => Typed::Expression,
        Command::Form(FormCommand::White(_)) => Typed::White,
        Command::Form(FormCommand::Depth(_)) => Typed::Depth,
        Command::Form(FormCommand::Stipple(number, _)) => Typed::Stipple(*number),
        Command::Debug(DebugCommand::Condition(index, _)) => Typed::Condition(*index),
        Command::Debug(DebugCommand::EditWatch(index, _)) => Typed::Watch(*index),
        // A border that is dragged changes the height from frame to frame.
        Command::Appearance(AppearanceCommand::CurveHeight(_)) => Typed::CurveHeight,
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

/// Returns a layout in which those tabs are open that are open `now`, except of panels that it hides. Panels that are
/// hidden `now` and were open in the layout are opened last, so that no other tab covers them.
fn with_tabs_of(mut layout: Layout, now: &Layout) -> Layout {
    let restored = layout.clone();
    let is_kept = |panel: &Panel| now.shows(*panel) && !restored.hidden().has(*panel);
    let is_back = |panel: &Panel| now.hidden().has(*panel) && restored.shows(*panel);
    let kept = Panel::all().filter(is_kept);
    for panel in kept.chain(Panel::all().filter(is_back)) {
        layout.open(panel);
    }
    layout
}

impl Made {
    /// Returns the input of the session that is shown; `None` if it cannot be made again.
    pub(super) fn of(run: &RunView) -> Option<Self> {
        let session = run.session.as_ref()?;
        match &session.combination {
            None if session.has_recipe() => Some(Self::Run(session.recipe())),
            None => None,
            // The content of its files is not kept.
            Some(combination) if combination.files > 0 => None,
            Some(combination) => Some(Self::Combination(combination.layout.clone())),
        }
    }
}

impl Memento {
    /// Returns a snapshot of everything that can be undone.
    pub(super) fn of(state: &State) -> Self {
        let run = &state.runs.first;
        Self {
            form: state.form.clone(),
            made: Made::of(run),
            appearance: state.appearance.clone(),
            layout: state.window.layout.clone(),
            stops: run.stops(),
        }
    }
}

impl Change {
    /// Returns whether to undo it makes a run again.
    const fn makes_run(&self) -> bool {
        matches!(self.part, UndoPart::Run | UndoPart::Everything)
    }

    /// Returns the question to ask before the change is taken back: whether to make a run again that takes minutes and much
    /// memory. It is answered by undoing once more while the question stands.
    fn question(&self, now: &Memento) -> Option<String> {
        let Some(Made::Run(recipe)) = self.memento.made.as_ref().filter(|_| self.makes_run())
        else {
            return None;
        };
        if self.memento.made == now.made {
            return None;
        }
        let draft = Draft::from_parameters(recipe.parameters).with_depth(recipe.depth);
        let needed = draft.memory_needed()?;
        Some(format!(
            "This makes an earlier run again. {needed} Do the same once more to go on."
        ))
    }

    /// Asks for the effects that restore its snapshot, to undo the change or to redo it; `layout` is the layout that is
    /// shown, and `made` is what the run that is shown was made from.
    fn recall(self, layout: &Layout, made: Option<&Made>, context: &mut Context) {
        let Self { part, memento } = self;
        match part {
            // The change hid panels or brought some back. The tabs that were opened meanwhile stay open.
            UndoPart::Layout if memento.layout.hidden() != layout.hidden() => {
                context.ask(Effect::Layout(with_tabs_of(memento.layout, layout)));
            }
            UndoPart::Layout => context.ask(Effect::Layout(memento.layout)),
            UndoPart::Curve => context.ask(Effect::Curve(memento.appearance.curve)),
            UndoPart::Stops => context.ask(Effect::Stops(memento.stops)),
            UndoPart::Form => context.ask(Effect::Form(Box::new(memento.form))),

            UndoPart::Run => {
                context.ask(Effect::Form(Box::new(memento.form)));
                make_again(memento.made, made, context);
            }

            // A link replaces all of these. So the layout from before the link comes back whole, with the tabs that
            // were open then. The look stays, although a link may change it too.
            UndoPart::Everything => {
                context.ask(Effect::Form(Box::new(memento.form)));
                context.ask(Effect::Layout(memento.layout));
                let appearance = memento.appearance;
                context.ask(Effect::Layers(
                    appearance.chosen_layers,
                    appearance.colouring,
                ));
                context.ask(Effect::Curve(appearance.curve));
                // Breakpoints, watches and scenes come before the run, which takes over the present ones.
                context.ask(Effect::Stops(memento.stops));
                make_again(memento.made, made, context);
            }
        }
    }
}

/// Asks for a run or a combination again, unless it is the one that is shown.
fn make_again(made: Option<Made>, shown: Option<&Made>, context: &mut Context) {
    context.ask(Effect::StopMaking);
    if let Some(made) = made.filter(|made| Some(made) != shown) {
        context.ask(Effect::Make(Box::new(made)));
    }
}

/// A step back or forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HistoryStep {
    /// Undoes the last change.
    Undo,
    /// Redoes the change that was undone last.
    Redo,
}

impl History {
    /// Returns whether there is something to undo.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Returns whether there is something to redo.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Adds a step for `command`, if it changed something between `before` and `now`. Without a command it is a dragged
    /// panel, an opened link or a pattern from a file.
    pub(super) fn remember(
        &mut self,
        before: Memento,
        now: &Memento,
        part: UndoPart,
        command: Option<&Command>,
    ) {
        // Opening a tab is no change of the layout, but bringing back a hidden panel is one.
        if let Some(Command::Window(WindowCommand::OpenPanel(_))) = command
            && before.layout.hidden() == now.layout.hidden()
        {
            return;
        }

        let field = command.and_then(typed_in);
        if before != *now {
            // All typing in one field is one step, and undoing it goes back to before the first letter.
            let goes_on = field.is_some() && field == self.typing;
            if goes_on {
                self.future.clear();
            } else {
                self.push(part, before);
            }
        }
        self.typing = field;
    }

    /// Adds a step. Nothing can be redone then, and the oldest steps beyond [`MAX_STEPS`] go.
    fn push(&mut self, part: UndoPart, memento: Memento) {
        let past = &mut self.past;
        past.push(Change { part, memento });
        let surplus = past.len().saturating_sub(MAX_STEPS);
        past.drain(..surplus);
        self.future.clear();
    }

    /// Adds the step of a run that is about to replace the current one, `now`. Parameters typed since the last run are part of
    /// it, so that undo restores parameters and run together.
    pub(super) fn remember_run(&mut self, part: UndoPart, now: Memento) {
        let mut before = now;
        let past = &mut self.past;
        let last = past.iter().rposition(Change::makes_run);
        let first_since = last.map_or(0, |index| index + 1);
        // The first change of the form since then has the form from before all typing.
        let mut later = past[first_since..].iter();
        if let Some(typed) = later.find(|change| change.part == UndoPart::Form) {
            before.form = typed.memento.form.clone();
        }

        // From now on, the changes of the form since the last run are part of this step. `retain` gives no index, so that `count` has it.
        let mut count = 0;
        past.retain(|change| {
            count += 1;
            count <= first_since || change.part != UndoPart::Form
        });

        self.typing = None;
        // If the run shown is still the one from before the last step, the run of that step was cancelled. The step
        // then stands for the new run, too, unless this change replaces more than the run and its form.
        let was_cancelled = last.is_some_and(|index| self.past[index].memento.made == before.made);
        if was_cancelled && part == UndoPart::Run {
            self.future.clear();
        } else {
            self.push(part, before);
        }
    }

    /// Adds the step of a run that starts because a parameter changed, unless it goes on with the step of the one before. `now`
    /// is `None` if there is no run yet.
    pub(super) fn remember_live_run(&mut self, command: &Command, now: Option<Memento>) {
        let field = typed_in(command);
        let last = self.past.len().checked_sub(1);
        // The change of the form has just been added as the last step. It goes on with a live run if that run was made
        // after the same number of steps, by changes of the same field.
        let goes_on = field.zip(last).is_some_and(|step| self.live == Some(step));
        if goes_on {
            // The change of the form belongs to that step.
            self.past.pop();
            self.typing = None;
        } else if let Some(now) = now {
            self.remember_run(UndoPart::Run, now);
        }
        self.live = field.map(|field| (field, self.past.len()));
    }

    /// Takes the last change back, or does it again. Before a large run is made again, asks; `asked` is the notice that
    /// is shown. `typed` are the parameters of the panel, for which the run may still be being made; `None` if the
    /// set that is shown was not made from parameters, as a combination.
    pub(super) fn step(
        &mut self,
        step: HistoryStep,
        now: Memento,
        typed: Option<Recipe>,
        asked: Option<&str>,
        context: &mut Context,
    ) {
        let (from, to) = match step {
            HistoryStep::Undo => (&mut self.past, &mut self.future),
            HistoryStep::Redo => (&mut self.future, &mut self.past),
        };
        let Some(change) = from.pop() else {
            return;
        };
        // Doing the same once more, while the notice shows the question, is the answer to it.
        let question = change.question(&now);
        if let Some(question) = question.filter(|question| asked != Some(question)) {
            from.push(change);
            return context.tell(question);
        }

        let (layout, made) = (now.layout.clone(), now.made.clone());
        let mut memento = now;
        // A later redo has to make the run of the typed parameters, which may not be ready yet, not the one that is shown.
        // An undo after a redo makes the run that was shown before it.
        if change.makes_run() && step == HistoryStep::Undo {
            memento.made = typed.map(Made::Run).or(memento.made);
        }

        let part = change.part;
        to.push(Change { part, memento });
        self.typing = None;
        change.recall(&layout, made.as_ref(), context);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::command::Which;

    fn type_in(state: &mut State, field: Parameter, text: &str) {
        let command = crate::command::FormCommand::Type(field, text.to_owned());
        state.apply(Command::Form(command));
    }

    #[test]
    fn a_new_change_clears_redo() {
        let mut state = State::new(Arc::new(|| {}));
        type_in(&mut state, Parameter::Seed, "5");
        state.apply(Command::Undo);
        assert!(state.past.history.can_redo());
        type_in(&mut state, Parameter::Leaf, "40");
        assert!(state.past.history.can_undo() && !state.past.history.can_redo());
    }

    #[test]
    fn undo_asks_before_it_makes_a_large_run_again() {
        let mut state = State::new(Arc::new(|| {}));
        state.settle();
        let mut step = |radius: f64| {
            let mut memento = Memento::of(&state);
            let mut recipe = state.form.recipe();
            recipe.parameters.radius = radius;
            memento.made = Some(Made::Run(recipe));
            state.past.history.push(UndoPart::Run, memento);
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
            let field = [Parameter::Seed, Parameter::Leaf][step % 2];
            type_in(&mut state, field, &(step + 6).to_string());
        }
        let mut undone = 0;
        while state.past.history.can_undo() {
            state.apply(Command::Undo);
            undone += 1;
        }
        assert_eq!(undone, MAX_STEPS);
    }
}
