//! Everything a user can do, as values: buttons, keys, the canvas and scripts issue the same ones,
//! and only [`crate::State::apply`] carries them out.

use glam::DVec2;

use emath::{Pos2, Rect, Vec2};
use tilescope_debugger::{Direction, LineId, Step, Target};
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::verification::Witness;

use crate::analysis::AnalysisCommand;
use crate::arrangement::DrawerCommand;
use crate::clock::Clock;
use crate::compare::CompareCommand;
use crate::device::Engine;
use crate::draft::{Choice, Field};
use crate::export::ExportCommand;
use crate::files::FileCommand;
use crate::layout::Panel;
use crate::passes::PassCommand;

/// A move in time.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeCommand {
    /// Shows the state after the stage of this place in the session's list.
    ShowStage(usize),
    /// Goes one tick back.
    StepBack,
    /// Goes one tick forward.
    StepForward,
    /// Goes to the first stage.
    FirstStage,
    /// Goes to the last stage.
    LastStage,
    /// Starts or stops the play.
    TogglePlay,
    /// Chooses what a tick is.
    Clock(Clock),
    /// Chooses how fast time runs when playing.
    Speed(f32),
    /// Goes to the moment when so many events have happened.
    Jump(usize),
    /// Steps into, over or out.
    Step(Step, Direction),
    /// Goes behind an event, or to where a line is the next one.
    RunTo(Target, Direction),
    /// Goes to a breakpoint, else to the end.
    Continue(Direction),
    /// Play goes round from here.
    LoopStart,
    /// Play goes round up to here.
    LoopEnd,
    /// Play goes round between two cursors, or not.
    Loop(Option<std::ops::Range<usize>>),
}

/// An action of the debugger.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DebugCommand {
    /// Sets a breakpoint on a line, or removes the one that is there.
    ToggleBreakpoint(#[serde(with = "tilescope_debugger::by_id")] LineId),
    /// Types the condition of a breakpoint.
    Condition(usize, String),
    /// Has a breakpoint stop a run, or not.
    Enable(usize, bool),
    /// Removes a breakpoint.
    RemoveBreakpoint(usize),
    /// Watches an expression.
    Watch(String),
    /// Types a watched expression.
    EditWatch(usize, String),
    /// Stops watching an expression.
    RemoveWatch(usize),
    /// Remembers the moment.
    Bookmark,
    /// Types the note of a bookmark.
    Note(usize, String),
    /// Removes a bookmark.
    RemoveBookmark(usize),
    /// Goes to the cause of the last event.
    Why,
    /// Goes behind an event and everything that it holds.
    SelectEvent(usize),
    /// Shows what an event holds, or no longer.
    ToggleEvent(usize),
    /// Types what the event browser looks for.
    Query(String),
}

/// A change of what the next run is made from.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FormCommand {
    /// Types a parameter.
    Type(Field, String),
    /// Chooses a parameter.
    Choose(Choice),
    /// Returns to the parameters of the default session.
    Reset,
    /// Returns to the pattern that the parameters describe.
    GeneratedPattern,
}

/// A choice of who samples.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GpuCommand {
    /// Chooses the engine. The first choice of the GPU opens and tests it.
    Engine(Engine),
    /// Names the GPU adapter by a part of its name, or returns to the fastest. It counts from the next choice of the
    /// GPU on.
    NameAdapter(Option<String>),
}

/// A change of how moments are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AppearanceCommand {
    /// Shows or hides a layer.
    ToggleLayer(Layer),
    /// Chooses what the colour of samples means.
    Colour(Colouring),
    /// Changes between the light and the dark theme.
    ToggleTheme,
    /// Chooses a look.
    Look(Look),
    /// Enters the projector mode, or returns to the look before it.
    ToggleProjector,
    /// Jumps instead of flying, or flies again.
    ToggleReducedMotion,
}

/// A change of what stands where.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowCommand {
    /// Shows the window on the full screen, or no longer.
    ToggleFullScreen,
    /// Brings a panel into view.
    OpenPanel(Panel),
    /// Does something with the one panel of a compact window.
    Drawer(DrawerCommand),
    /// Puts all panels where they were at first.
    ResetLayout,
    /// Opens the list of all actions, or closes it.
    ToggleFinder,
    /// Closes the list of all actions.
    CloseFinder,
    /// Types what action is looked for.
    FinderText(String),
    /// Chooses an action of the list.
    FinderChoice(usize),
}

/// A change of the view of a run, or of what is pointed at.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ViewCommand {
    /// Tells where the canvas is in the window.
    Viewport(Rect),
    /// Moves the picture by screen points.
    Pan(Vec2),
    /// Zooms about a place of the screen.
    Zoom(Pos2, f64),
    /// Selects the sample nearest to the middle of the view, or else the place there.
    SelectMiddle,
    /// Shows the whole domain.
    Fit,
    /// Flies to a place, given in r, until about this many r are visible.
    FlyTo(DVec2, f64),
    /// Flies to the gap that holds a place, given in r, else to its block.
    FlyToBlock(DVec2),
    /// Flies to what decides a verdict.
    FlyToWitness(Witness),
    /// Points at a sample, or at none.
    Hover(Option<u32>),
    /// Flies to where the last event happened.
    GoToCurrent,
    /// Selects a sample and flies to it.
    GoToSample(u32),
    /// Selects something, and looks up its history.
    Pick(Selection),
    /// Brings what is known of the selection into view.
    Inspect,
}

/// One of the runs that are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Which {
    /// The run that the panels show; run A where there are two.
    First,
    /// The run beside it, run B.
    Second,
}

/// What is done with links.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LinkCommand {
    /// Puts a link to what is shown on the clipboard.
    Copy,
    /// Opens a link: a fragment of an address, or a whole one.
    Open(String),
}

/// One action of the user.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Command {
    /// Changes what the next run is made from.
    Form(FormCommand),
    /// Chooses who samples.
    Gpu(GpuCommand),
    /// Samples with the parameters of the panel.
    Run,
    /// Glues the sets of a layout to one.
    Combine(CombineCommand),
    /// Stops the sampling of a run.
    Cancel(Which),
    /// Moves in time.
    Time(TimeCommand),
    /// Does something with the debugger.
    Debug(DebugCommand),
    /// Changes the view of a run.
    View(Which, ViewCommand),
    /// Changes how moments are drawn.
    Appearance(AppearanceCommand),
    /// Changes what stands where.
    Window(WindowCommand),
    /// Runs the passes of the session's parameters on the GPU, to be looked at.
    OpenPasses,
    /// Does something with the passes.
    Passes(PassCommand),
    /// Does something with the comparison of two runs.
    Compare(CompareCommand),
    /// Does something with what is measured.
    Analysis(AnalysisCommand),
    /// Does something with saved sessions and pattern files.
    File(FileCommand),
    /// Does something with the export sheet.
    Export(ExportCommand),
    /// Does something with links.
    Link(LinkCommand),
    /// Takes back the last change of parameters, layers or layout.
    Undo,
    /// Makes it again.
    Redo,
    /// Closes the notice.
    DismissNotice,
}

impl ViewCommand {
    /// Returns whether the command moves the camera.
    #[must_use]
    pub const fn moves_camera(&self) -> bool {
        matches!(
            self,
            Self::Pan(_)
                | Self::Zoom(..)
                | Self::Fit
                | Self::FlyTo(..)
                | Self::FlyToBlock(_)
                | Self::GoToSample(_)
        )
    }
}

impl Command {
    /// Returns whether a key may do this where the window is part of another page: nothing that opens what is not shown
    /// there.
    #[must_use]
    pub const fn works_in_frame(&self) -> bool {
        use AppearanceCommand as A;
        use WindowCommand as W;
        !matches!(
            self,
            Self::File(_)
                | Self::Export(_)
                | Self::Combine(_)
                | Self::Window(W::ToggleFinder | W::OpenPanel(_) | W::ResetLayout)
                | Self::OpenPasses
                | Self::Run
                | Self::Undo
                | Self::Redo
                | Self::Compare(_)
                | Self::View(_, ViewCommand::Inspect)
                | Self::View(Which::Second, _)
                | Self::Cancel(Which::Second)
                | Self::Appearance(A::Look(_) | A::ToggleProjector)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_a_frame_open_nothing_that_it_lacks() {
        assert!(Command::Time(TimeCommand::StepForward).works_in_frame());
        assert!(!Command::Window(WindowCommand::ToggleFinder).works_in_frame());
    }
}
