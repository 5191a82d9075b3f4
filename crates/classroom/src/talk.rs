//! Presenter mode: a lesson on a projector, led by a clicker, with the lecturer's notes on another screen. Begin with
//! [`Talk`]; `room/talk.rs` carries out its commands.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use tilescope_lessons::{Advice, Lesson, Vote, advice};

use tilescope_drawing::camera::Camera;
use tilescope_session::jobs::Job;

use crate::lesson_picture::NextPicture;
use crate::pen::{MAX_POINTS, PenStroke};

/// An action of a lecturer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TalkCommand {
    /// Presents the lesson that is open, from its first step or from the one that is shown.
    Lesson {
        /// Whether from its first step.
        from_start: bool,
    },
    /// Presents the lecture of fifty minutes.
    Lecture,
    /// Presents the scenes of the session.
    Scenes,
    /// Goes to the first step.
    First,
    /// Makes a handout of the lesson that is open.
    Handout {
        /// Whether with the answers.
        answers: bool,
        /// Whether with the speaker's notes.
        notes: bool,
        /// The file; a new one beside where the program runs, if none is given.
        #[serde(default)]
        path: Option<PathBuf>,
    },
    /// Ends the talk that is given.
    End,
    /// Goes on: shows the canvas again after a blank, asks for votes, reveals, or shows the next step.
    Next,
    /// Goes back by one press: a cover, a vote or a step.
    Previous,
    /// Makes the stage black, or ends that.
    Blank,
    /// Opens the window with the notes, or closes it.
    ToggleNotes,
    /// Exchanges the screens of stage and notes.
    Swap,
    /// Opens the window of the stage again.
    OpenStage,
    /// The window of the stage was closed.
    StageClosed,
    /// The window of the notes was closed.
    NotesClosed,
    /// Takes a tool, or puts it away.
    Tool(Tool),
    /// Takes the pen's next colour.
    NextColor,
    /// Points at a place, in r, or at none.
    Point(Option<[f64; 2]>),
    /// Draws to a place, in r.
    Draw([f64; 2]),
    /// Lifts the pen, so that the next point begins a line.
    Lift,
    /// Removes the last line.
    UndoStroke,
    /// Removes all lines of the step.
    ClearStrokes,
    /// Keeps a vote, as it was typed: `A 12 B 30`, or `none`, `few`, `half`, `most`.
    Vote(String),
    /// Removes the last vote.
    Unvote,
    /// Shows the code of the link for phones, or hides it.
    ToggleCode,
    /// Sets the address of the page that the code leads to.
    Address(String),
    /// Keeps drawings and votes with the session, or does not.
    Keep(bool),
    /// Continues a talk of an earlier window, [`Kept`] as JSON.
    Restore(String),
}

/// The effect of the pointer on the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tool {
    /// It moves the canvas.
    #[default]
    Hand,
    /// It points at places for the class.
    Laser,
    /// It draws lines over the canvas.
    Pen,
}

/// A lesson of a talk.
#[derive(Clone, Debug, PartialEq)]
pub struct TalkPart {
    /// The name of the lesson.
    pub name: String,
    /// The title of the lesson.
    pub title: String,
    /// The planned seconds of each step.
    pub secs: Vec<f64>,
}

impl TalkPart {
    /// Returns a part that takes `minutes`; as long as the lesson says if none are given.
    #[must_use]
    pub fn of(lesson: &Lesson, minutes: Option<u32>) -> Self {
        let scale = minutes.map_or(1.0, |minutes| {
            f64::from(minutes) / f64::from(lesson.minutes)
        });
        let planned = lesson.planned_secs().into_iter();
        Self {
            name: lesson.name.clone(),
            title: lesson.title.clone(),
            secs: planned.map(|secs| secs * scale).collect(),
        }
    }
}

/// The votes and drawings of a talk, by step: `lesson/step`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TalkRecord {
    /// The votes, at most two for a question.
    pub votes: BTreeMap<String, Vec<Vote>>,
    /// The lines that were drawn.
    pub strokes: BTreeMap<String, Vec<PenStroke>>,
}

/// A talk as it is kept when its windows are closed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Kept {
    /// The lesson that is shown, and its text if it does not come with the program.
    pub lesson: (String, Option<String>),
    /// Whether it is the lecture of fifty minutes.
    pub is_lecture: bool,
    /// When the talk began, in seconds since 1970.
    pub begun: f64,
    /// Which lesson of the talk is shown.
    pub part: usize,
    /// The step that is shown.
    pub step: String,
    /// Whether the answer to its question was revealed.
    pub is_revealed: bool,
    /// The camera, if it is not the one that the step begins with.
    pub camera: Option<Camera>,
    /// The votes and drawings so far.
    pub record: TalkRecord,
}

/// A cover over the whole stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// The code of the link for phones.
    Code,
    /// Black, until the lecturer goes on.
    Blank,
    /// Black, after the last step.
    Over,
}

/// The windows of a talk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TalkWindows {
    /// Whether that of the stage is open.
    pub stage: bool,
    /// Whether that of the notes is open.
    pub notes: bool,
    /// Whether they have exchanged their screens.
    pub are_swapped: bool,
}

/// A talk that is being given.
pub struct Talk {
    /// The lessons of the talk, in order.
    pub parts: Vec<TalkPart>,
    /// The index of the one that is shown.
    pub part: usize,
    /// When it began, in seconds since 1970.
    pub begun: f64,
    /// When the step was first shown.
    pub step_begun: f64,
    /// Whether "next" was pressed at the open question: the class votes, and another press reveals.
    pub is_voting: bool,
    /// The cover over the stage, if there is one.
    pub cover: Option<Cover>,
    /// Which of its windows are open.
    pub windows: TalkWindows,
    /// The tool of the pointer on the stage.
    pub tool: Tool,
    /// The index of the pen's colour.
    pub color: usize,
    /// Whether the pen is down.
    pub is_drawing: bool,
    /// Where the laser points, in r.
    pub pointer: Option<[f64; 2]>,
    /// The fault of the vote that was typed, if it has one.
    pub vote_fault: Option<String>,
}

impl Talk {
    /// Returns a talk at the first step of its first part, which begins now.
    pub(crate) fn new(parts: Vec<TalkPart>, now: f64) -> Self {
        Self {
            parts,
            part: 0,
            begun: now,
            step_begun: now,
            is_voting: false,
            cover: None,
            windows: TalkWindows {
                stage: true,
                notes: true,
                are_swapped: false,
            },
            tool: Tool::Hand,
            color: 0,
            is_drawing: false,
            pointer: None,
            vote_fault: None,
        }
    }

    /// Returns the planned seconds before a step of the shown lesson, of the step, and of the whole talk.
    #[must_use]
    pub fn planned_secs(&self, step: usize) -> [f64; 3] {
        let of = |part: &TalkPart| part.secs.iter().sum::<f64>();
        let earlier: f64 = self.parts.iter().take(self.part).map(of).sum();
        let here = self.parts.get(self.part).map_or(&[][..], |part| &part.secs);
        let before: f64 = here.iter().take(step).sum();
        let all = self.parts.iter().map(of).sum();
        let this = here.get(step).copied().unwrap_or(0.0);
        [earlier + before, this, all]
    }
}

impl Talks {
    /// Returns whether a handout is being made.
    #[must_use]
    pub const fn makes_handout(&self) -> bool {
        self.handout.is_some()
    }
}

impl TalkRecord {
    /// Returns the votes on the question of a step.
    #[must_use]
    pub fn votes_on(&self, key: &str) -> &[Vote] {
        self.votes.get(key).map_or(&[], Vec::as_slice)
    }

    /// Returns the lines over a step.
    pub(crate) fn strokes_in(&self, key: &str) -> &[PenStroke] {
        self.strokes.get(key).map_or(&[], Vec::as_slice)
    }

    /// Draws to a place; `begins` a line of this colour or goes on with the last one. Beyond [`MAX_POINTS`] nothing is drawn, nor
    /// at a place that is not finite.
    pub(crate) fn draw(&mut self, key: &str, at: [f64; 2], color: usize, begins: bool) {
        let strokes = self.strokes.entry(key.to_owned()).or_default();
        let points: usize = strokes.iter().map(|stroke| stroke.points.len()).sum();
        if points >= MAX_POINTS || !at.iter().all(|x| x.is_finite()) {
            return;
        }
        match strokes.last_mut().filter(|_| !begins) {
            Some(stroke) => stroke.points.push(at),
            None => strokes.push(PenStroke {
                color,
                points: vec![at],
            }),
        }
    }

    /// Removes the last line of a step.
    pub(crate) fn undo(&mut self, key: &str) {
        if let Some(strokes) = self.strokes.get_mut(key) {
            strokes.pop();
        }
    }

    /// Keeps a vote; a third one replaces the second.
    pub(crate) fn vote(&mut self, key: &str, vote: Vote) {
        let votes = self.votes.entry(key.to_owned()).or_default();
        votes.truncate(1);
        votes.push(vote);
    }
}

/// Returns the QR code of a text, row by row, true where it is dark; None for an empty text or one that is too long.
#[must_use]
pub fn code(text: &str) -> Option<Vec<Vec<bool>>> {
    let made = fast_qr::QRBuilder::new(text).build().ok();
    let code = made.filter(|_| !text.is_empty())?;
    let row = |y: usize| (0..code.size).map(|x| code[y][x].value()).collect();
    Some((0..code.size).map(row).collect())
}

/// Returns the advice by the last vote; `right` is the option of the question that is right, if it is one.
#[must_use]
pub fn advised(votes: &[Vote], right: Option<usize>) -> Option<Advice> {
    Some(advice(votes.last()?.right_share(right)?))
}

/// The file of a handout.
pub(crate) struct HandoutFile {
    /// Its name without the extension, for a file that the window places.
    pub stem: String,
    /// Its path, if one was given.
    pub path: Option<PathBuf>,
}

/// Presenter mode in the state of the window.
#[derive(Default)]
pub struct Talks {
    /// The handout that is being made, and its file.
    pub(crate) handout: Option<(HandoutFile, Job<Result<String, String>>)>,
    /// The talk, while it is given.
    pub open: Option<Box<Talk>>,
    /// The votes and drawings of the talk.
    pub record: TalkRecord,
    /// Whether they are kept with the session.
    pub is_kept: bool,
    /// The address of the page that the code for phones leads to.
    pub address: String,
    /// The command that begins a talk, to be carried out once the lessons are loaded.
    pub(crate) wanted: Option<TalkCommand>,
    /// The picture of the next step.
    pub next_picture: NextPicture,
    /// How a step of a restored talk is shown, once its run is made.
    pub(crate) restored: Option<RestoredStep>,
}

/// A step of a talk that another window continues.
pub(crate) struct RestoredStep {
    /// The step, as `lesson/step`.
    pub key: String,
    /// Whether the answer to its question was revealed.
    pub is_revealed: bool,
    /// The camera, if it is not the one that the step begins with.
    pub camera: Option<Camera>,
}
