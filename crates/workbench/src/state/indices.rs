//! The numbers by which commands name samples, events, stages, breakpoints, scenes and passes. A command that names one
//! that is not there is refused: it may come from a script, or from a file or page of others.

use tilescope_debugger::Target;
use tilescope_session::selection::Selection;
use tilescope_session::words::counted;

use super::Runs;
use super::run_view::RunView;
use crate::command::{Command, DebugCommand, TimeCommand, ViewCommand};
use crate::passes::PassCommand;
use crate::scenes::{SceneCommand, SceneList};

/// Something that a command names by its number.
struct Named {
    /// What it is, for one and for several.
    what: [&'static str; 2],
    index: usize,
    /// How many there are.
    count: usize,
    /// What has them.
    of: &'static str,
}

impl Named {
    const fn new(what: [&'static str; 2], index: usize, count: usize) -> Self {
        let of = "the run";
        Self {
            what,
            index,
            count,
            of,
        }
    }

    /// Returns why there is no such thing, or `None` if there is.
    fn refusal(&self) -> Option<String> {
        let Self {
            what: [one, many],
            index,
            count,
            of,
        } = *self;
        let there = counted(count, one, many);
        (index >= count).then(|| format!("{one} {index}: {of} has {there}, numbered from 0"))
    }
}

const SAMPLE: [&str; 2] = ["sample", "samples"];
const EVENT: [&str; 2] = ["event", "events"];
const STAGE: [&str; 2] = ["stage", "stages"];
const SCENE: [&str; 2] = ["scene", "scenes"];

impl Runs {
    /// Returns why a command is refused, or `None` if everything that it names by a number is there. Without a run there is
    /// nothing to compare with, and such commands do nothing.
    pub(super) fn index_refusal(&self, command: &Command) -> Option<String> {
        match command {
            Command::View(which, command) => self.get(*which)?.view_refusal(command),
            Command::Time(command) => self.first.time_refusal(command),
            Command::Debug(command) => self.first.debug_refusal(command),
            Command::Scene(command) => self.scene_refusal(command),
            Command::Passes(command) => self.pass_refusal(command),
            Command::Form(_)
            | Command::Gpu(_)
            | Command::Run
            | Command::Combine(_)
            | Command::Cancel(_)
            // Their numbers are those of a list that the lesson shows; others change nothing.
            | Command::Lesson(_)
            | Command::Talk(_)
            | Command::Appearance(_)
            // The list of actions is the window's, which takes the last one for a larger number.
            | Command::Window(_)
            | Command::OpenPasses
            | Command::Compare(_)
            | Command::Analysis(_)
            | Command::File(_)
            | Command::Export(_)
            | Command::Link(_)
            | Command::Undo
            | Command::Redo
            | Command::DismissNotice
            | Command::OpenFolder(_) => None,
        }
    }

    fn scene_refusal(&self, command: &SceneCommand) -> Option<String> {
        let count = SceneList::Own.scenes(&self.first).len();
        let scene = |index: usize| {
            let of = "the session";
            Named {
                of,
                ..Named::new(SCENE, index, count)
            }
            .refusal()
        };
        match *command {
            SceneCommand::Replace(index)
            | SceneCommand::Caption(index, _)
            | SceneCommand::Remove(index)
            | SceneCommand::Show(index) => scene(index),
            SceneCommand::Move(from, to) => scene(from).or_else(|| scene(to)),
            SceneCommand::Add
            | SceneCommand::Step(_)
            // A scene of the tour that has no such button does nothing.
            | SceneCommand::Offer(_)
            | SceneCommand::Tour
            | SceneCommand::Leave => None,
        }
    }

    fn pass_refusal(&self, command: &PassCommand) -> Option<String> {
        let passes = self.first.passes.as_ref()?;
        match *command {
            PassCommand::Select(index) => {
                Named::new(["pass", "passes"], index, passes.entries().len()).refusal()
            }
            // Buffers and rows are those of a pass that may still be on its way; others than it has change nothing.
            PassCommand::Buffer(_)
            | PassCommand::PickRow(_)
            | PassCommand::PointRow(_)
            | PassCommand::Previous
            | PassCommand::Next
            | PassCommand::First
            | PassCommand::Last
            | PassCommand::Side(_)
            | PassCommand::Filter(_)
            | PassCommand::OnCanvas(_)
            | PassCommand::ShowCanvas
            | PassCommand::Cancel
            | PassCommand::Again
            | PassCommand::Path(_)
            | PassCommand::Export
            | PassCommand::Fault(_) => None,
        }
    }
}

impl RunView {
    fn sample_refusal(&self, id: u32) -> Option<String> {
        let session = self.session.as_ref()?;
        Named::new(SAMPLE, id as usize, session.run().samples.len()).refusal()
    }

    fn view_refusal(&self, command: &ViewCommand) -> Option<String> {
        match *command {
            ViewCommand::GoToSample(id) | ViewCommand::Pick(Selection::Sample(id)) => {
                self.sample_refusal(id)
            }
            // The pointer may still be where a sample of the run before was: it then points at none.
            ViewCommand::Hover(_)
            | ViewCommand::Pick(Selection::Nothing | Selection::Place(_))
            | ViewCommand::Viewport(_)
            | ViewCommand::Pan(_)
            | ViewCommand::Zoom(..)
            | ViewCommand::SelectMiddle
            | ViewCommand::Fit
            | ViewCommand::FlyTo(..)
            | ViewCommand::Centre(_)
            | ViewCommand::CopyPosition(_)
            | ViewCommand::FlyToBlock(_)
            | ViewCommand::FlyToWitness(_)
            | ViewCommand::GoToCurrent
            | ViewCommand::Inspect => None,
        }
    }

    fn time_refusal(&self, command: &TimeCommand) -> Option<String> {
        let session = self.session.as_ref()?;
        // A moment lies between events: there is one more than events.
        let moment = |at: usize| {
            let (_, count) = self.cursor()?;
            let what = if session.nested.is_some() {
                SAMPLE
            } else {
                EVENT
            };
            (at > count).then(|| Named::new(what, at, count).refusal())?
        };
        match command {
            TimeCommand::ShowStage(index) => {
                let count = match &session.nested {
                    Some(nested) => nested.ends().count(),
                    None => session.stages.len(),
                };
                Named::new(STAGE, *index, count).refusal()
            }
            TimeCommand::Jump(at) => moment(*at),
            TimeCommand::Loop(Some(range)) => moment(range.start).or_else(|| moment(range.end)),
            TimeCommand::RunTo(Target::Sample(id), _) => self.sample_refusal(*id),
            TimeCommand::RunTo(..)
            | TimeCommand::Loop(None)
            | TimeCommand::StepBack
            | TimeCommand::StepForward
            | TimeCommand::FirstStage
            | TimeCommand::LastStage
            | TimeCommand::TogglePlay
            | TimeCommand::Clock(_)
            | TimeCommand::Speed(_)
            | TimeCommand::WholeRun(_)
            | TimeCommand::Step(..)
            | TimeCommand::Continue(_)
            | TimeCommand::LoopStart
            | TimeCommand::LoopEnd => None,
        }
    }

    fn debug_refusal(&self, command: &DebugCommand) -> Option<String> {
        let debugger = self.debugger.as_ref()?;
        let of_session = |what: [&'static str; 2], index: usize, count: usize| {
            let of = "the session";
            Named {
                of,
                ..Named::new(what, index, count)
            }
            .refusal()
        };
        match *command {
            DebugCommand::Condition(index, _)
            | DebugCommand::Enable(index, _)
            | DebugCommand::RemoveBreakpoint(index) => {
                let what = ["breakpoint", "breakpoints"];
                of_session(what, index, debugger.breakpoints().len())
            }
            DebugCommand::EditWatch(index, _) | DebugCommand::RemoveWatch(index) => {
                of_session(["watch", "watches"], index, debugger.watches.len())
            }
            DebugCommand::SelectEvent(index) | DebugCommand::ToggleEvent(index) => {
                Named::new(EVENT, index, debugger.recording().len()).refusal()
            }
            DebugCommand::ToggleBreakpoint(_)
            | DebugCommand::Watch(_)
            | DebugCommand::Why
            | DebugCommand::Query(_) => None,
        }
    }
}
