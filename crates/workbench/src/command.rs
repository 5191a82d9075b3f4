//! All that a user can do, as values. Buttons, keys, the canvas and scripts issue the same commands, and only
//! [`crate::State::apply`] applies them.

use glam::DVec2;

use emath::{Pos2, Rect, Vec2};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::TalkCommand;
use tilescope_core::Parameter;
use tilescope_debugger::{Direction, LineId, Step, Target};
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::verification::Witness;
pub use tilescope_sets::Brush;

use crate::analysis::AnalysisCommand;
use crate::arrangement::DrawerCommand;
use crate::clock::Clock;
use crate::compare::CompareCommand;
use crate::curve::CurveNumber;
use crate::device::EngineChoice;
use crate::draft::{Choice, Preset, StippleNumber};
use crate::export::ExportCommand;
use crate::files::FileCommand;
use crate::help::HelpPage;
use crate::layout::Panel;
use crate::orbit::OrbitCommand;
use crate::passes::PassCommand;
use crate::scenes::SceneCommand;

/// A move in time.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeCommand {
    /// Shows the state after the stage of this index.
    ShowStage(usize),
    /// Steps one tick back.
    StepBack,
    /// Steps one tick forward.
    StepForward,
    /// Goes to the first stage.
    FirstStage,
    /// Goes to the last stage.
    LastStage,
    /// Starts or stops playing.
    TogglePlay,
    /// Chooses the unit of a tick.
    Clock(Clock),
    /// Plays by ticks of the clock, at this speed.
    Speed(f32),
    /// Plays the whole run in this many seconds.
    WholeRun(f32),
    /// Goes to the moment after this many events; shows this many samples of nested levels.
    Jump(usize),
    /// Steps into, over or out.
    Step(Step, Direction),
    /// Runs until an event has happened, or until a line is the next one.
    RunTo(Target, Direction),
    /// Runs to the next breakpoint, or to the end.
    Continue(Direction),
    /// Goes to the next event, or the one before, at which the number of the curve rises.
    ToRise(Direction),
    /// Starts the loop here.
    LoopStart,
    /// Ends the loop here.
    LoopEnd,
    /// Sets the loop between two cursors, or removes it.
    Loop(Option<std::ops::Range<usize>>),
}

/// An action of the debugger.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DebugCommand {
    /// Sets a breakpoint on a line, or removes the one that is there.
    ToggleBreakpoint(#[serde(with = "tilescope_debugger::by_id")] LineId),
    /// Sets the condition of a breakpoint.
    Condition(usize, String),
    /// Enables or disables a breakpoint.
    Enable(usize, bool),
    /// Removes the breakpoint of this index.
    RemoveBreakpoint(usize),
    /// Adds a watched expression, as typed.
    Watch(String),
    /// Changes a watched expression.
    EditWatch(usize, String),
    /// Stops watching an expression.
    RemoveWatch(usize),
    /// Goes to the cause of the last event.
    Why,
    /// Goes to the moment after an event and all events inside it.
    SelectEvent(usize),
    /// Expands or collapses an event.
    ToggleEvent(usize),
    /// Sets the query of the event browser.
    Query(String),
}

/// A change of the input of the next run.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FormCommand {
    /// Sets the text of a parameter.
    Type(
        #[serde(deserialize_with = "crate::draft::number")] Parameter,
        String,
    ),
    /// Changes a parameter by this many small steps.
    Nudge(
        #[serde(deserialize_with = "crate::draft::number")] Parameter,
        i32,
    ),
    /// Chooses whether small runs start at once when a parameter changes.
    Live(bool),
    /// Types a number of samples, which sets the radius.
    Count(String),
    /// Types how many samples nested levels are to have exactly; nothing if their radius decides.
    Exactly(String),
    /// Chooses a value from a list of options.
    Choose(Choice),
    /// Sets all parameters to those of a preset.
    Preset(Preset),
    /// Returns to the parameters of the default session.
    Reset,
    /// Returns from a pattern of a file to the pattern that the parameters describe.
    GeneratedPattern,
    /// Types the third side, which makes the set one in space; nothing for a planar set.
    Depth(String),
    /// Types the radius as a function of x and y.
    Expression(String),
    /// Types the radius of white, of an image.
    White(String),
    /// Types a number of a stipple.
    Stipple(StippleNumber, String),
    /// Chooses whether a stipple has its dots where the image is light.
    Inverted(bool),
    /// Chooses whether dots of a stipple are made beyond the frame, too, and dropped there.
    RunOn(bool),
    /// Covers the opaque or the light pixels of the image alone, as a mask.
    CoverImage,
    /// Covers the whole domain again, instead of a shape.
    WholeDomain,
    /// Takes the reference sampler instead of exact tiling: domain, radius and seed stay.
    ReferenceSampler,
    /// Paints radii on the canvas.
    Paint(PaintCommand),
}

/// A command of the brush that paints radii.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PaintCommand {
    /// Chooses whether the pointer paints on the canvas, and does not move the picture.
    Tool(bool),
    /// Sets the brush.
    Brush(Brush),
    /// Paints a stroke through places from the lower corner of the domain, in its unit, and makes the run again.
    Stroke(Vec<[f64; 2]>),
    /// Paints a dab in the middle of the view.
    Dab,
    /// Returns to the radii from before they were painted.
    Reset,
    /// Saves the painted radii as an image, beside where the program runs; on a page, downloads it.
    Save,
}

/// A choice of the engine.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GpuCommand {
    /// Chooses the engine. The first choice of the GPU opens and tests it.
    Engine(EngineChoice),
    /// Names the GPU adapter by a part of its name, or returns to the fastest. It takes effect the next time
    /// the GPU is chosen.
    NameAdapter(Option<String>),
}

/// A change of how moments are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AppearanceCommand {
    /// Shows or hides a layer. From then on, layers do not follow the stage.
    ToggleLayer(Layer),
    /// Shows the layers that explain the stage, at every stage.
    AutomaticLayers,
    /// Chooses what the colour of samples stands for.
    Colour(Colouring),
    /// Changes between the light and the dark theme.
    ToggleTheme,
    /// Chooses the light or dark look, or a projector's.
    Look(Look),
    /// Enters the projector mode, or returns to the look before it.
    ToggleProjector,
    /// Draws a number over the events above the timeline, or nothing.
    Curve(Option<CurveNumber>),
    /// Sets the height of that curve, in screen points.
    CurveHeight(u16),
    /// Shows the radii, the shape and the dots of a set in a field or a shape beside it, or the set alone.
    ToggleSideBySide,
    /// Makes the camera follow the current event, or no longer.
    ToggleFollow,
    /// Switches between flying and jumping of the camera.
    ToggleReducedMotion,
}

/// A change of the window.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowCommand {
    /// Enters or leaves full screen.
    ToggleFullScreen,
    /// Brings a panel into view.
    OpenPanel(Panel),
    /// Hides a panel; the canvas stays.
    HidePanel(Panel),
    /// Hides the panels beside the canvas, or brings them back.
    ToggleSides,
    /// Changes a compact window.
    Drawer(DrawerCommand),
    /// Restores the default layout of the panels.
    ResetLayout,
    /// Opens the list of all actions, or closes it.
    ToggleFinder,
    /// Closes the list of all actions.
    CloseFinder,
    /// Sets the search text of the list of actions.
    FinderText(String),
    /// Selects an action of the list.
    FinderChoice(usize),
    /// Opens a page of the help sheet.
    Help(HelpPage),
    /// Closes the help sheet.
    CloseHelp,
    /// Closes the window, natively; what would be lost is asked about first.
    Quit,
}

/// A change of the view of a run, of its selection, or of the sample under the pointer.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ViewCommand {
    /// Sets the rectangle of the canvas in the window.
    Viewport(Rect),
    /// Moves the picture by screen points.
    Pan(Vec2),
    /// Zooms about a position on the screen.
    Zoom(Pos2, f64),
    /// Selects the sample nearest to the middle of the view, or the place in the middle if no sample is near.
    SelectMiddle,
    /// Shows the whole domain.
    Fit,
    /// Flies to a place, given in r, at a scale that shows about this many r.
    FlyTo(DVec2, f64),
    /// Moves a place, given in r, into the middle of the view.
    Centre(DVec2),
    /// Copies a place, given in r, to the clipboard, in the unit of the domain.
    CopyPosition(DVec2),
    /// Flies to the gap that contains a place, given in r, or otherwise to its block.
    FlyToBlock(DVec2),
    /// Flies to the place that decides a verdict.
    FlyToWitness(Witness),
    /// Sets the sample under the pointer.
    Hover(Option<u32>),
    /// Flies to where the last event happened.
    GoToCurrent,
    /// Selects a sample and flies to it.
    GoToSample(u32),
    /// Selects a sample or place, and looks up its history.
    Pick(Selection),
    /// Opens the panel with the details of the selection.
    Inspect,
    /// Moves the plane through a set in space to a place of the third axis, in the unit of the domain.
    Plane(f64),
    /// Moves the plane by this many steps of r / 20.
    StepPlane(i32),
    /// Pins the plane where it lies, or has it follow the events of the run.
    PinPlane(bool),
    /// Shows a set in space as balls instead of a plane through it, or changes how they are seen.
    Orbit(OrbitCommand),
}

/// One of the runs that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Which {
    /// The run that the panels show; run A where there are two.
    First,
    /// The run beside it, run B.
    Second,
}

/// A command for links.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LinkCommand {
    /// Copies to the clipboard a link to the run, moment and view that are shown.
    Copy,
    /// Opens a link: a fragment of an address, or a whole one.
    Open(String),
}

/// One action of the user.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Command {
    /// Changes the input of the next run.
    Form(FormCommand),
    /// Chooses the engine, or names the GPU adapter.
    Gpu(GpuCommand),
    /// Samples with the parameters of the panel.
    Run,
    /// Makes a combination: glues the sets of a layout.
    Combine(CombineCommand),
    /// Cancels the sampling of a run.
    Cancel(Which),
    /// Moves in time, or changes how playback goes.
    Time(TimeCommand),
    /// Makes, changes and shows scenes.
    Scene(SceneCommand),
    /// Opens lessons, and answers their questions.
    Lesson(LessonCommand),
    /// Does something in presenter mode.
    Talk(TalkCommand),
    /// Changes breakpoints, watches or the event browser.
    Debug(DebugCommand),
    /// Changes the view of a run.
    View(Which, ViewCommand),
    /// Changes how moments are drawn.
    Appearance(AppearanceCommand),
    /// Changes panels and the window.
    Window(WindowCommand),
    /// Runs the passes of the session's parameters on the GPU, to inspect them.
    OpenPasses,
    /// Changes the view of the passes.
    Passes(PassCommand),
    /// Changes the comparison of two runs.
    Compare(CompareCommand),
    /// Stops or resumes measuring, removes the reference file, or sets the brush.
    Analysis(AnalysisCommand),
    /// Opens and saves sessions, layouts and point sets.
    File(FileCommand),
    /// Fills in the export sheet, or exports.
    Export(ExportCommand),
    /// Copies or opens a link.
    Link(LinkCommand),
    /// Undoes the last change of parameters, run or layout.
    Undo,
    /// Redoes the change that was undone last.
    Redo,
    /// Closes the notice, whatever it says.
    DismissNotice,
    /// Opens a folder in the system's file manager.
    OpenFolder(std::path::PathBuf),
}
