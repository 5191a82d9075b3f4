//! The rules by which a command is carried out: [`Command::rules`]. Each command is named and there is no default, so that a new
//! one does not compile until it is decided whether it can be undone, works in a frame, shows an answer, or names something by
//! a number.
#![deny(
    clippy::wildcard_enum_match_arm,
    clippy::match_wildcard_for_single_variants
)]
#![expect(
    clippy::match_same_arms,
    reason = "arms of one rule have different reasons"
)]

use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::TalkCommand;
use tilescope_debugger::Target;
use tilescope_session::combination::CombineCommand;
use tilescope_session::selection::Selection;

use crate::analysis::AnalysisCommand;
use crate::arrangement::DrawerCommand;
use crate::command::{
    AppearanceCommand, Command, DebugCommand, FormCommand, GpuCommand, LinkCommand, PaintCommand,
    TimeCommand, ViewCommand, Which, WindowCommand,
};
use crate::compare::CompareCommand;
use crate::export::ExportCommand;
use crate::files::FileCommand;
use crate::orbit::OrbitCommand;
use crate::passes::PassCommand;
use crate::scenes::SceneCommand;

/// The part of the state that a command changes and undo restores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UndoPart {
    /// The parameters in the panel, not yet run.
    Form,
    /// The parameters and the run.
    Run,
    /// The layout of the panels.
    Layout,
    /// The curve above the timeline.
    Curve,
    /// Breakpoints, watches and scenes.
    Stops,
    /// Everything that a link replaces.
    Everything,
}

/// Something that a command names by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbered {
    /// A sample, by its id in the run.
    Sample(u32),
    /// An event of the recording.
    Event(usize),
    /// A moment, by the number of events before it.
    Moment(usize),
    /// A stage, or a level of nested ones.
    Stage(usize),
    /// A scene of the user's.
    Scene(usize),
    /// A breakpoint, by its index in the list.
    Breakpoint(usize),
    /// A watch, by its index in the list.
    Watch(usize),
    /// A pass of the GPU.
    Pass(usize),
}

/// The rules of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each rule is its own")]
pub struct Rules {
    /// What undo restores. `None` for moves in time, tabs, layers, colours and the camera, which change the view only, and for
    /// commands that remember steps of their own when their work is done (runs, links, files).
    pub undo: Option<UndoPart>,
    /// Whether a key or the canvas may issue the command while the window is embedded in another page: what it opens must be
    /// shown there.
    pub in_frame: bool,
    /// Whether the command makes or shows a whole run, and thereby the answer to a question that is open. It is refused then.
    pub reveals: bool,
    /// Whether the command moves the camera. Linked cameras move with it.
    pub moves_camera: bool,
    /// Whether the command begins work of the user's own, which ends the tour.
    pub ends_tour: bool,
    /// What the command names by numbers. It is refused if one of them is not there.
    pub names: [Option<Numbered>; 2],
}

impl Rules {
    /// Returns the rules of a command that names something.
    const fn naming(self, item: Numbered) -> Self {
        let names = [Some(item), None];
        Self { names, ..self }
    }
}

/// The rules of commands that change only how moments are shown, and show none that is later than the moment of an open
/// question.
const VIEW: Rules = Rules {
    undo: None,
    in_frame: true,
    reveals: false,
    moves_camera: false,
    ends_tour: false,
    names: [None; 2],
};

/// The rules of commands that change breakpoints, watches or scenes.
const STOPS: Rules = Rules {
    undo: Some(UndoPart::Stops),
    ..VIEW
};

/// The rules of commands that open something that frames do not show.
const NOT_IN_FRAME: Rules = Rules {
    in_frame: false,
    ..VIEW
};

/// The rules of commands that make or show another run, or write the whole one to a file.
const REVEALING: Rules = Rules {
    reveals: true,
    ..NOT_IN_FRAME
};

impl Command {
    /// Returns the rules of the command.
    #[must_use]
    pub const fn rules(&self) -> Rules {
        match self {
            Self::Form(command) => form(command),
            // An engine is only chosen here: it makes no run yet.
            Self::Gpu(GpuCommand::Engine(_) | GpuCommand::NameAdapter(_)) => VIEW,
            Self::Run => Rules {
                ends_tour: true,
                ..REVEALING
            },
            Self::Combine(CombineCommand::Nine | CombineCommand::Text(_)) => Rules {
                ends_tour: true,
                ..REVEALING
            },

            // A frame shows no second run.
            Self::Cancel(Which::First) => VIEW,
            Self::Cancel(Which::Second) => NOT_IN_FRAME,

            Self::Time(command) => time(command),
            Self::Scene(command) => scene(command),
            Self::Lesson(command) => lesson(command),
            Self::Talk(command) => talk(command),
            Self::Debug(command) => debug(command),
            Self::View(which, command) => view(*which, command),
            Self::Appearance(command) => appearance(*command),
            Self::Window(command) => window(command),

            Self::OpenPasses => REVEALING,
            Self::Passes(command) => passes(command),
            Self::Compare(command) => compare(*command),
            Self::Analysis(command) => analysis(command),
            Self::File(command) => file(command),
            Self::Export(command) => export(command),

            // Opening a link closes the lesson first, so that it shows no answer to an open question.
            Self::Link(LinkCommand::Copy | LinkCommand::Open(_)) => VIEW,
            // Undo and redo may bring back another run, and with it the answer to an open question.
            Self::Undo | Self::Redo => REVEALING,
            Self::DismissNotice | Self::OpenFolder(_) => VIEW,
        }
    }
}

/// Returns the rules of a command of the form.
const fn form(command: &FormCommand) -> Rules {
    let undo = match command {
        // Whether runs begin by themselves is no parameter of a run.
        FormCommand::Live(_) => None,
        FormCommand::Paint(command) => paint(command),
        FormCommand::Type(..)
        | FormCommand::Nudge(..)
        | FormCommand::Count(_)
        | FormCommand::Exactly(_)
        | FormCommand::Choose(_)
        | FormCommand::Preset(_)
        | FormCommand::Reset
        | FormCommand::GeneratedPattern
        | FormCommand::Depth(_)
        | FormCommand::Expression(_)
        | FormCommand::White(_)
        | FormCommand::Stipple(..)
        | FormCommand::Inverted(_)
        | FormCommand::RunOn(_)
        | FormCommand::CoverImage
        | FormCommand::WholeDomain
        | FormCommand::ReferenceSampler => Some(UndoPart::Form),
    };

    Rules {
        undo,
        // A small run is made again as soon as a parameter changes, and may answer an open question.
        reveals: true,
        ends_tour: true,
        ..VIEW
    }
}

/// Returns what undo restores after a command of the brush.
const fn paint(command: &PaintCommand) -> Option<UndoPart> {
    match command {
        PaintCommand::Stroke(_) | PaintCommand::Reset => Some(UndoPart::Form),
        // The brush is no parameter of a run, a saved file changes nothing, and a dab issues its stroke.
        PaintCommand::Tool(_) | PaintCommand::Brush(_) | PaintCommand::Dab | PaintCommand::Save => {
            None
        }
    }
}

/// Returns the rules of a move in time.
const fn time(command: &TimeCommand) -> Rules {
    // While a question is open, the run has no events after the question's moment, so that no move in time shows the answer.
    match command {
        TimeCommand::ShowStage(index) => VIEW.naming(Numbered::Stage(*index)),
        TimeCommand::Jump(at) => VIEW.naming(Numbered::Moment(*at)),
        TimeCommand::Loop(Some(range)) => Rules {
            names: [
                Some(Numbered::Moment(range.start)),
                Some(Numbered::Moment(range.end)),
            ],
            ..VIEW
        },
        TimeCommand::RunTo(Target::Sample(id), _) => VIEW.naming(Numbered::Sample(*id)),

        TimeCommand::StepBack
        | TimeCommand::StepForward
        | TimeCommand::FirstStage
        | TimeCommand::LastStage
        | TimeCommand::TogglePlay
        | TimeCommand::Clock(_)
        | TimeCommand::Speed(_)
        | TimeCommand::WholeRun(_)
        | TimeCommand::Step(..)
        | TimeCommand::RunTo(..)
        | TimeCommand::Continue(_)
        | TimeCommand::ToRise(_)
        | TimeCommand::LoopStart
        | TimeCommand::LoopEnd
        | TimeCommand::Loop(None) => VIEW,
    }
}

/// Returns the rules of a command of scenes.
const fn scene(command: &SceneCommand) -> Rules {
    match command {
        SceneCommand::Add => STOPS,
        SceneCommand::Replace(index)
        | SceneCommand::Caption(index, _)
        | SceneCommand::Remove(index) => STOPS.naming(Numbered::Scene(*index)),
        SceneCommand::Move(from, to) => Rules {
            names: [Some(Numbered::Scene(*from)), Some(Numbered::Scene(*to))],
            ..STOPS
        },
        SceneCommand::Show(index) => VIEW.naming(Numbered::Scene(*index)),
        // `Offer` has the number of a button of the tour. A scene without such a button does nothing.
        SceneCommand::Step(_) | SceneCommand::Offer(_) | SceneCommand::Leave => VIEW,
        // The tour makes a run of its own.
        SceneCommand::Tour => Rules {
            reveals: true,
            ..VIEW
        },
    }
}

/// Returns the rules of a command of lessons.
const fn lesson(command: &LessonCommand) -> Rules {
    use LessonCommand as L;

    // Numbers in these commands are indices into a list that the lesson shows; a number beyond its end changes nothing.
    match command {
        L::ToggleList
        | L::Open(_)
        | L::Read(..)
        | L::Leave
        | L::Step(_)
        | L::Go(_)
        | L::Draft(_)
        | L::Answer
        | L::Hint
        | L::GiveUp
        | L::Practise(_)
        | L::Sure(_)
        | L::Language(_)
        | L::File(_)
        | L::SaveResults(_)
        | L::ClearResults
        | L::KeepResults
        | L::Name(_)
        | L::Package(_)
        | L::CopyPackaging => VIEW,
    }
}

/// Returns the rules of a command of talks.
const fn talk(command: &TalkCommand) -> Rules {
    let reveals = match command {
        // A handout without answers and notes says no more than the lesson itself.
        TalkCommand::Handout { answers, notes, .. } => *answers || *notes,

        TalkCommand::Lesson { .. }
        | TalkCommand::Lecture
        | TalkCommand::Scenes
        | TalkCommand::First
        | TalkCommand::End
        | TalkCommand::Next
        | TalkCommand::Previous
        | TalkCommand::Blank
        | TalkCommand::ToggleNotes
        | TalkCommand::Swap
        | TalkCommand::OpenStage
        | TalkCommand::StageClosed
        | TalkCommand::NotesClosed
        | TalkCommand::Tool(_)
        | TalkCommand::NextColor
        | TalkCommand::Point(_)
        | TalkCommand::Draw(_)
        | TalkCommand::Lift
        | TalkCommand::UndoStroke
        | TalkCommand::ClearStrokes
        | TalkCommand::Vote(_)
        | TalkCommand::Unvote
        | TalkCommand::ToggleCode
        | TalkCommand::Address(_)
        | TalkCommand::Keep(_)
        | TalkCommand::Restore(_) => false,
    };

    // A talk opens windows for the stage and the notes, and a frame opens no windows.
    Rules {
        reveals,
        ..NOT_IN_FRAME
    }
}

/// Returns the rules of a command of the debugger.
const fn debug(command: &DebugCommand) -> Rules {
    match command {
        DebugCommand::ToggleBreakpoint(_) | DebugCommand::Watch(_) => STOPS,
        DebugCommand::Condition(index, _)
        | DebugCommand::Enable(index, _)
        | DebugCommand::RemoveBreakpoint(index) => STOPS.naming(Numbered::Breakpoint(*index)),
        DebugCommand::EditWatch(index, _) | DebugCommand::RemoveWatch(index) => {
            STOPS.naming(Numbered::Watch(*index))
        }
        DebugCommand::SelectEvent(index) | DebugCommand::ToggleEvent(index) => {
            VIEW.naming(Numbered::Event(*index))
        }
        DebugCommand::Why | DebugCommand::Query(_) => VIEW,
    }
}

/// Returns the rules of a command of a run's view.
const fn view(which: Which, command: &ViewCommand) -> Rules {
    let rules = match which {
        Which::First => VIEW,
        Which::Second => NOT_IN_FRAME,
    };

    match command {
        ViewCommand::Pan(_)
        | ViewCommand::Zoom(..)
        | ViewCommand::Fit
        | ViewCommand::FlyTo(..)
        | ViewCommand::Centre(_)
        | ViewCommand::FlyToBlock(_) => Rules {
            moves_camera: true,
            ..rules
        },
        ViewCommand::GoToSample(id) => Rules {
            moves_camera: true,
            ..rules.naming(Numbered::Sample(*id))
        },

        ViewCommand::Pick(Selection::Sample(id)) => rules.naming(Numbered::Sample(*id)),
        // Frames have no panels.
        ViewCommand::Inspect => NOT_IN_FRAME,

        // If the cameras of two runs are linked, the second run shows the plane of the first. The first run never
        // takes the plane of the second.
        ViewCommand::Plane(_)
        | ViewCommand::StepPlane(_)
        | ViewCommand::PinPlane(_) => rules,
        ViewCommand::Orbit(command) => orbit(*command, rules),

        // The last event and the witness of a verdict belong to one run alone, so that a linked camera does not go
        // there.
        ViewCommand::GoToCurrent | ViewCommand::FlyToWitness(_) => rules,

        // Each of two runs has a selection and a canvas of its own.
        ViewCommand::SelectMiddle
        | ViewCommand::Pick(Selection::Nothing | Selection::Place(_))
        | ViewCommand::Viewport(_)
        | ViewCommand::CopyPosition(_)
        // A sample under the pointer is not checked: right after a new run, it may be a sample of the run before.
        | ViewCommand::Hover(_) => rules,
    }
}

/// Returns the rules of a command of the balls of a set in space; `rules` are those of the run's view.
const fn orbit(command: OrbitCommand, rules: Rules) -> Rules {
    match command {
        // Each of two canvases has its own size.
        OrbitCommand::Size(_) => rules,
        OrbitCommand::Show(_)
        | OrbitCommand::Turn(_)
        | OrbitCommand::Zoom(_)
        | OrbitCommand::Cut(_)
        | OrbitCommand::Reset => Rules {
            moves_camera: true,
            ..rules
        },
    }
}

/// Returns the rules of a command of the appearance.
const fn appearance(command: AppearanceCommand) -> Rules {
    match command {
        // The page around a frame chooses its look. Keys issue these two commands. `ToggleTheme` comes only from
        // buttons, which a frame does not show.
        AppearanceCommand::Look(_) | AppearanceCommand::ToggleProjector => NOT_IN_FRAME,
        AppearanceCommand::Curve(_) | AppearanceCommand::CurveHeight(_) => Rules {
            undo: Some(UndoPart::Curve),
            ..VIEW
        },
        // Layers that a question hides are refused one by one (`Lessons::hidden_layers`).
        AppearanceCommand::ToggleLayer(_)
        | AppearanceCommand::AutomaticLayers
        | AppearanceCommand::Colour(_)
        | AppearanceCommand::ToggleTheme
        | AppearanceCommand::ToggleSideBySide
        | AppearanceCommand::ToggleFollow
        | AppearanceCommand::ToggleReducedMotion => VIEW,
    }
}

/// Returns the rules of a command of the window.
const fn window(command: &WindowCommand) -> Rules {
    // A number beyond the end of the list of actions chooses the last one, so that none needs to be checked.
    match command {
        WindowCommand::ResetLayout
        | WindowCommand::OpenPanel(_)
        | WindowCommand::HidePanel(_)
        | WindowCommand::ToggleSides => Rules {
            undo: Some(UndoPart::Layout),
            ..NOT_IN_FRAME
        },
        WindowCommand::ToggleFinder | WindowCommand::Help(_) | WindowCommand::Quit => NOT_IN_FRAME,
        WindowCommand::ToggleFullScreen
        | WindowCommand::Drawer(
            DrawerCommand::Arrange(_) | DrawerCommand::Show(_) | DrawerCommand::Tall(_),
        )
        | WindowCommand::CloseFinder
        | WindowCommand::FinderText(_)
        | WindowCommand::FinderChoice(_)
        | WindowCommand::CloseHelp => VIEW,
    }
}

/// Returns the rules of a command of the GPU's passes.
const fn passes(command: &PassCommand) -> Rules {
    // A pass works on the whole run, and so shows what comes after an open question's moment.
    let rules = Rules {
        reveals: true,
        ..VIEW
    };

    match command {
        PassCommand::Select(index) => rules.naming(Numbered::Pass(*index)),

        // Numbers of buffers and rows are not checked here, because the buffers of a pass may still be loading. A number that the
        // pass does not have changes nothing.
        PassCommand::Previous
        | PassCommand::Next
        | PassCommand::First
        | PassCommand::Last
        | PassCommand::Buffer(_)
        | PassCommand::Side(_)
        | PassCommand::Filter(_)
        | PassCommand::PickRow(_)
        | PassCommand::PointRow(_)
        | PassCommand::OnCanvas(_)
        | PassCommand::ShowCanvas
        | PassCommand::Cancel
        | PassCommand::Again
        | PassCommand::Path(_)
        | PassCommand::Export
        | PassCommand::Fault(_) => rules,
    }
}

/// Returns the rules of a command of the comparison.
const fn compare(command: CompareCommand) -> Rules {
    match command {
        // While a question is open all are refused: the second run may be the run of the question, made again, and would show
        // the answer. A comparison is own work, which ends the tour.
        CompareCommand::Start(_)
        | CompareCommand::Keep
        | CompareCommand::Swap
        | CompareCommand::Close
        | CompareCommand::LinkCameras(_)
        | CompareCommand::LinkPlayback(_)
        | CompareCommand::ShowDifferences(_)
        | CompareCommand::GoToDivergence => Rules {
            ends_tour: true,
            ..REVEALING
        },
    }
}

const fn analysis(command: &AnalysisCommand) -> Rules {
    // Only the moment that is shown is measured.
    match command {
        AnalysisCommand::Stop
        | AnalysisCommand::Resume
        | AnalysisCommand::Clear
        | AnalysisCommand::Brush(_) => VIEW,
    }
}

/// Returns the rules of a command of files.
const fn file(command: &FileCommand) -> Rules {
    // Pages choose files of their visitors by dialogs of their own, not by those of a frame. While a question is open,
    // all commands of files are refused: a file may bring another run, or take the answer with the whole run.
    match command {
        FileCommand::Sheet(_)
        | FileCommand::Close
        | FileCommand::Path(_)
        | FileCommand::Browse
        | FileCommand::Chosen(_)
        | FileCommand::Go
        | FileCommand::Cancel
        | FileCommand::Open(_)
        | FileCommand::SaveCurve(_)
        | FileCommand::Last
        | FileCommand::Dropped(_)
        | FileCommand::DroppedBytes(..) => REVEALING,
    }
}

/// Returns the rules of a command of the export sheet.
const fn export(command: &ExportCommand) -> Rules {
    // While a question is open, the whole sheet is refused, because an export may show what comes after the question.
    match command {
        ExportCommand::Open(_)
        | ExportCommand::Close
        | ExportCommand::Choose(_)
        | ExportCommand::Path(_)
        | ExportCommand::Precision(_)
        | ExportCommand::Type(..)
        | ExportCommand::Print(_)
        | ExportCommand::Legend(_)
        | ExportCommand::Analysis(_)
        | ExportCommand::WholeRun(_)
        | ExportCommand::Clock(_)
        | ExportCommand::Ink(_)
        | ExportCommand::Browse
        | ExportCommand::Write
        | ExportCommand::Passage(_)
        | ExportCommand::Cancel => REVEALING,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_that_make_or_show_another_run_reveal_and_moves_in_time_do_not() {
        assert!(Command::Run.rules().reveals);
        assert!(Command::Form(FormCommand::Reset).rules().reveals);
        assert!(!Command::Time(TimeCommand::LastStage).rules().reveals);
        for (answers, reveals) in [(true, true), (false, false)] {
            let handout = TalkCommand::Handout {
                answers,
                notes: false,
                path: None,
            };
            assert_eq!(Command::Talk(handout).rules().reveals, reveals);
        }
    }

    #[test]
    fn keys_in_an_embedded_window_open_only_what_it_shows() {
        assert!(Command::Time(TimeCommand::StepForward).rules().in_frame);
        assert!(
            Command::View(Which::First, ViewCommand::Fit)
                .rules()
                .in_frame
        );
        for command in [
            Command::Window(WindowCommand::ToggleFinder),
            Command::View(Which::First, ViewCommand::Inspect),
            Command::View(Which::Second, ViewCommand::Fit),
        ] {
            assert!(!command.rules().in_frame, "{command:?}");
        }
    }
}
