//! Tasks run in the memory of another thread, as in a web worker, and return what a thread of the window returns.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::TalkCommand;
use tilescope_debugger::{Debugger, Event, LineId, digest};
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::task::{
    PendingTask, TaskEnd, TaskPool, keep_session, session_bytes, session_ref, set_task_pool,
};

use super::*;
use crate::analysis::AnalysisCommand;
use crate::analysis::brush::{Brush, BrushAxis};
use crate::command::{AppearanceCommand, Command, DebugCommand, ViewCommand, Which, WindowCommand};
use crate::compare::{CompareCommand, ComparePreset};
use crate::curve::CurveNumber;
use crate::export::{ExportCommand, ExportKind};
use crate::files::{Delivery, FileCommand};
use crate::layout::Panel;
use crate::orbit::OrbitCommand;
use crate::scenes::SceneCommand;
use crate::state::{Settings, State, Verification};

type Reply = Result<Vec<u8>, TaskError>;

/// A message to the other thread.
enum Message {
    Task(&'static str, Vec<u8>),
    Session(Vec<u8>),
}

/// Runs tasks on a thread that shares no memory with the window.
struct OtherThread {
    messages: Sender<Message>,
    replies: Receiver<Reply>,
    /// The names of the tasks that ran, and whether sessions had to be sent.
    log: RefCell<Vec<(&'static str, bool)>>,
}

impl OtherThread {
    fn new() -> Rc<Self> {
        let (messages, inbox) = channel();
        let (outbox, replies) = channel();
        std::thread::spawn(move || {
            let monitor = Monitor::reporting(|_, _| {});
            for message in inbox {
                match message {
                    Message::Task(name, input) => {
                        let _ = outbox.send(perform(name, &input, &monitor));
                    }
                    Message::Session(bytes) => keep_session(&bytes).expect("a session"),
                }
            }
        });
        Rc::new(Self {
            messages,
            replies,
            log: RefCell::default(),
        })
    }

    fn ask(&self, name: &'static str, input: &[u8]) -> Reply {
        let message = Message::Task(name, input.to_vec());
        self.messages.send(message).expect("a thread");
        self.replies.recv().expect("a reply")
    }
}

impl TaskPool for OtherThread {
    fn run(&self, task: PendingTask) {
        let mut reply = self.ask(task.name, &task.input);
        let lacked_sessions = matches!(reply, Err(TaskError::UnknownSessions(_)));
        if lacked_sessions {
            for session in &task.sessions {
                let bytes = session_bytes(session).expect("bytes");
                self.messages
                    .send(Message::Session(bytes))
                    .expect("a thread");
            }
            reply = self.ask(task.name, &task.input);
        }
        self.log.borrow_mut().push((task.name, lacked_sessions));
        (task.answer)(match reply {
            Ok(bytes) => TaskEnd::Done(bytes),
            Err(refused) => TaskEnd::Failed(format!("{refused:?}")),
        });
    }
}

/// Applies many commands of a window, and returns the results.
fn visit() -> Vec<String> {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Voronoi,
    )));
    let curve = AppearanceCommand::Curve(CurveNumber::of("conflicts"));
    state.apply(Command::Appearance(curve));
    state.apply(Command::Debug(DebugCommand::Query(
        "insert iteration>1".to_owned(),
    )));
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Sample(412)),
    ));
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.advance(0.0);
    state.settle();
    let brush = Brush::between(BrushAxis::Frequency, 1.0, 1.3);
    state.apply(Command::Analysis(AnalysisCommand::Brush(brush)));
    state.advance(0.0);
    state.settle();
    state.apply(Command::Compare(CompareCommand::Start(
        ComparePreset::NextSeed,
    )));
    state.settle();
    state.advance(0.0);
    state.settle();
    let line = state
        .runs()
        .first
        .debugger
        .as_ref()
        .and_then(Debugger::event)
        .map(Event::line);
    let line = line.unwrap_or(LineId(0));
    state.apply(Command::Debug(DebugCommand::ToggleBreakpoint(line)));
    state.settle();
    let session = state.runs().first.session.as_ref().expect("a session");
    let shown = state.runs().first.shown().expect("a moment");
    let known = state.runs().first.measuring.of(&shown).expect("measures");
    let brushed = brush.expect("a brush");
    let second = state.runs().second.as_ref().expect("a second run");
    let other = second.0.session.as_ref().expect("a second session");
    let Verification::Done(verdict) = &state.runs().first.verification else {
        panic!("no verdict");
    };
    let mut found = vec![
        format!("{:?}", state.runs().first.hits.events()),
        digest(session.run()),
        digest(other.run()),
        format!("{:?}", session.summary),
        format!("{:?}", session.outline),
        format!("{:?}", session.conflicts),
        format!("{verdict:?}"),
        format!("{:?}", state.runs().first.query.found.events()),
        format!("{:?}", state.runs().first.history_found.events()),
        format!(
            "{:?}",
            state.runs().first.geometry.of(&shown).expect("triangles")
        ),
        format!(
            "{:?}",
            state.runs().first.geometry.borders(&shown).expect("gaps")
        ),
        format!("{:?}", state.runs().first.curve.points().expect("a curve")),
        format!("{:?}", known.measured),
        format!("{:?}", state.analysis().reference.measured()),
        format!(
            "{:?}",
            state
                .analysis()
                .marks
                .of(&shown, brushed)
                .expect("causes")
                .cause
        ),
        format!(
            "{:?}",
            second.1.divergence(session, other).expect("a parting")
        ),
    ];
    found.push(picture_of_a_scene(&mut state));
    found.extend(hand_over(&mut state));
    found.extend(present());
    found.push(picture_of_balls());
    found
}

/// Makes a set in space and returns the picture of its balls, and its measures.
fn picture_of_balls() -> String {
    let mut state = State::new(Arc::new(|| {}));
    state.open_link("v=1&radius=0.5&width=3&height=3&depth=3");
    state.settle();
    for command in [OrbitCommand::Size([60, 40]), OrbitCommand::Show(true)] {
        state.apply(Command::View(Which::First, ViewCommand::Orbit(command)));
    }
    state.settle();
    let balls = state.runs().first.orbit().expect("balls");
    let picture = format!("{:?}", balls.image().expect("a picture"));

    // Nothing is measured before the panel of the analysis is visible.
    let panel = WindowCommand::OpenPanel(Panel::Analysis);
    state.apply(Command::Window(panel));
    state.settle();
    let run = &state.runs().first;
    let measured = run.solid_measuring.last(&run.shown().expect("a moment"));
    let (known, _) = measured.expect("measures in space");
    format!("{picture}{:?}", known.measures)
}

/// Makes a scene and returns its small picture.
fn picture_of_a_scene(state: &mut State) -> String {
    state.apply(Command::Scene(SceneCommand::Add));
    let panel = WindowCommand::OpenPanel(Panel::Scenes);
    state.apply(Command::Window(panel));
    state.settle();
    let run = &state.runs().first;
    let session = run.session.as_ref().expect("a session");
    let debugger = run.debugger.as_ref().expect("events");
    let scene = &debugger.scenes[0];
    let picture = state.scenes().thumbnails.of(session, scene, true);
    format!("{:?}", picture.expect("a picture"))
}

/// Exports samples and opens them again, and combines sets; returns the results.
fn hand_over(state: &mut State) -> Vec<String> {
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    state.apply(Command::Compare(CompareCommand::Close));
    state.apply(Command::Export(ExportCommand::Open(ExportKind::Result)));
    state.apply(Command::Export(ExportCommand::Write));
    state.settle();
    let files = state.take_requests().downloads;
    let sizes = format!("{files:?}");
    let dropped = FileCommand::DroppedBytes(files, Vec::new());
    state.apply(Command::File(dropped));
    state.settle();
    let pattern = state
        .form()
        .own_pattern
        .as_ref()
        .map(|own| own.file.digest.clone());
    state.apply(Command::Combine(CombineCommand::Nine));
    state.settle();
    let session = state.runs().first.session.as_ref().expect("a combination");
    let combination = session.combination.as_ref().expect("seams");
    vec![
        sizes,
        pattern.expect("a pattern"),
        digest(session.run()),
        format!("{combination:?}"),
    ]
}

/// Presents a lesson; returns the picture of its next step, and its handout.
fn present() -> [String; 2] {
    let mut state = State::new(Arc::new(|| {}));
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    state.settle();
    state.apply(Command::Lesson(LessonCommand::Open("survivors".to_owned())));
    state.settle();
    let present = TalkCommand::Lesson { from_start: true };
    state.apply(Command::Talk(present));
    state.settle();
    let next = format!("{:?}", state.talks().next_picture.drawn());
    let handout = TalkCommand::Handout {
        answers: true,
        notes: true,
        path: None,
    };
    state.apply(Command::Talk(handout));
    state.settle();
    [next, format!("{:?}", state.take_requests().downloads)]
}

#[test]
fn another_memory_returns_what_a_thread_returns() {
    let here = visit();
    let other = OtherThread::new();
    set_task_pool(Some(other.clone()));
    let there = visit();
    set_task_pool(None);
    for (here, there) in here.iter().zip(&there) {
        let differ = here.chars().zip(there.chars()).position(|(a, b)| a != b);
        let around = differ.unwrap_or(0).saturating_sub(100);
        let part = |text: &str| text.chars().skip(around).take(200).collect::<String>();
        assert!(here == there, "{} is {}", part(here), part(there));
    }
    let log = other.log.borrow();
    // Tasks of a GPU, one for larger sets, and one that has a test of its own, with a folder for the page.
    let others = ["difference", "pattern", "arrivals", "twin", "package"];
    for name in NAMES.iter().filter(|name| !others.contains(name)) {
        let is_carried = log.iter().any(|(other, _)| other == name);
        assert!(is_carried, "{name} of {log:?}");
    }
    // A session made on the other thread is kept there.
    assert!(
        log.iter().all(|(_, lacked_sessions)| !lacked_sessions),
        "{log:?}"
    );
}

#[test]
fn a_session_that_is_no_longer_kept_is_sent_again() {
    let made = |other: &Rc<OtherThread>| {
        set_task_pool(Some(other.clone()));
        let mut state = State::new(Arc::new(|| {}));
        state.settle();
        state
    };
    let first = OtherThread::new();
    let mut state = made(&first);
    let second = OtherThread::new();
    set_task_pool(Some(second.clone()));
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Sample(5)),
    ));
    state.settle();
    set_task_pool(None);
    assert_eq!(*second.log.borrow(), [("look", true)]);
    assert!(!state.runs().first.history_found.events().is_empty());
}

#[test]
fn names_are_unique_and_unknown_tasks_are_refused() {
    let mut names = NAMES.to_vec();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), NAMES.len());
    let monitor = Monitor::reporting(|_, _| {});
    let unknown = perform("tidy up", &[], &monitor);
    assert!(matches!(unknown, Err(TaskError::Failed(text)) if text.contains("tidy up")));
    for name in NAMES {
        let cut = perform(name, &[255; 3], &monitor);
        assert!(cut.is_err() || *name == "measure the reference", "{name}");
    }
}

#[test]
fn malformed_sessions_are_refused_and_a_cancelled_task_reports_it() {
    assert!(keep_session(&[1, 2, 3]).is_err());
    let monitor = Monitor::reporting(|_, _| {});
    let sampling = tilescope_session::sampling::SampleTask {
        recipe: tilescope_core::Parameters::default().into(),
        generation: 1,
    };
    let (input, _) = session_ref::packed(&sampling).unwrap();
    monitor.cancel();
    let bytes = perform("sample", &input, &monitor).unwrap();
    let made: Result<Session, tilescope_session::session::MakeError> =
        postcard::from_bytes(&bytes).unwrap();
    let Err(error) = made else {
        panic!("nobody waits for it");
    };
    assert!(error.cancelled().is_some(), "{error}");
}
