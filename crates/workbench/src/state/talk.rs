//! Presenter mode in the state: starts a talk, goes on and back, takes votes and drawings, makes handouts, and draws the
//! picture of the next step. `talk.rs` has the commands and the data, `state/talk_told.rs` the lecturer's notes as JSON.

use std::path::PathBuf;

use tilescope_lessons::results::ClassVote;
use tilescope_lessons::{Form, Key, Lesson, Question, Vote, shipped};
use tilescope_session::task;

use super::State;
use crate::handout::HandoutTask;
use crate::lesson_picture::{PictureKey, PictureStyle, StepPictureTask};
use crate::lessons::{LessonCommand, LessonSource};
use crate::pen::PenStroke;
use crate::scene_lesson::lesson_of;
use crate::talk::{
    Cover, HandoutFile, Kept, RestoredStep, Talk, TalkCommand, TalkPart, TalkRecord, Tool,
};
use crate::view::sound_camera;

/// Width and height of the picture of the next step, in points.
const NEXT: [f64; 2] = [440.0, 330.0];

impl State {
    /// Returns the key of the step that is shown, for votes and drawings.
    #[must_use]
    pub fn talk_key(&self) -> String {
        let learner = self.lessons.learner();
        let key =
            learner.map(|learner| format!("{}/{}", learner.lesson().name, learner.step().name));
        key.unwrap_or_default()
    }

    pub(super) fn apply_to_talk(&mut self, command: TalkCommand) {
        let key = self.talk_key();
        match command {
            TalkCommand::Lesson { from_start } => self.present_lesson(from_start),
            TalkCommand::First => {
                if self.talks.open.as_ref().is_some_and(|talk| talk.part > 0) {
                    self.go_to_part(0, false);
                } else {
                    self.go_in_talk(0);
                }
            }
            TalkCommand::Handout {
                answers,
                notes,
                path,
            } => self.make_handout(answers, notes, path),
            TalkCommand::Lecture => self.present_lecture(),
            TalkCommand::Scenes => self.present_scenes(),
            TalkCommand::Address(address) => {
                self.talks.address = address.trim().chars().take(200).collect();
            }
            TalkCommand::Keep(is_kept) => self.talks.is_kept = is_kept,
            TalkCommand::End => self.end_talk(),
            TalkCommand::Next => self.next_in_talk(),
            TalkCommand::Previous => self.previous_in_talk(),
            TalkCommand::Vote(text) => self.vote(&text),
            TalkCommand::Restore(kept) => self.restore_talk(&kept),
            TalkCommand::Draw(at) => {
                if let Some(talk) = &mut self.talks.open {
                    let (begins, color) = (!talk.is_drawing, talk.color);
                    talk.is_drawing = true;
                    self.talks.record.draw(&key, at, color, begins);
                }
            }
            TalkCommand::UndoStroke => self.talks.record.undo(&key),
            TalkCommand::ClearStrokes => {
                self.talks.record.strokes.remove(&key);
            }
            TalkCommand::Unvote => {
                if let Some(votes) = self.talks.record.votes.get_mut(&key) {
                    votes.pop();
                    self.keep_vote_on_form();
                }
            }
            _ => {
                if let Some(talk) = &mut self.talks.open {
                    talk.apply(&command);
                    if !(talk.windows.stage || talk.windows.notes) {
                        self.end_talk();
                    }
                }
            }
        }
    }

    fn present_lesson(&mut self, from_start: bool) {
        let Some(open) = &self.lessons.open else {
            return self.tell("Open a lesson first.".to_owned(), false);
        };
        let part = TalkPart::of(open.learner.lesson(), None);
        self.begin_talk(vec![part]);
        if from_start {
            self.enter_step(0);
        }
    }

    fn present_lecture(&mut self) {
        if self.lessons.shelf.is_empty() {
            self.talks.wanted = Some(TalkCommand::Lecture);
            return;
        }
        let parts = shipped::LECTURE.iter().filter_map(|&(name, minutes)| {
            let shipped = self.lessons.shipped(name)?;
            let lesson = Lesson::read(name, &shipped.text).ok()?;
            Some(TalkPart::of(&lesson, Some(minutes)))
        });
        let parts: Vec<TalkPart> = parts.collect();
        if let Some(first) = parts.first().map(|part| part.name.clone()) {
            self.apply_to_lessons(LessonCommand::Open(first));
            self.begin_talk(parts);
        }
    }

    /// Presents the scenes: a lesson is made of them, and the session comes back when the talk ends.
    fn present_scenes(&mut self) {
        self.end_talk();
        let text = self.lesson_of_scenes();
        let read = text.and_then(|text| {
            let lesson = Lesson::read("scenes", &text);
            Ok((lesson.map_err(|error| error.to_string())?, text))
        });
        match read {
            Ok((lesson, text)) => {
                self.open_lesson("scenes", &text, LessonSource::Text);
                if let Some(open) = &mut self.lessons.open {
                    open.is_of_scenes = true;
                }
                self.begin_talk(vec![TalkPart::of(&lesson, None)]);
            }
            Err(why) => self.tell(format!("The scenes cannot be presented. {why}"), true),
        }
    }

    /// Returns a lesson with a step for each scene.
    ///
    /// # Errors
    ///
    /// Those of [`lesson_of`].
    pub(crate) fn lesson_of_scenes(&self) -> Result<String, String> {
        let (Some(session), Some(debugger)) = (&self.runs.first.session, &self.runs.first.debugger)
        else {
            return Err("There is no session with events.".to_owned());
        };
        let has_own_pattern = session.own.is_some();
        lesson_of(&debugger.scenes, &session.run().parameters, has_own_pattern)
    }

    fn begin_talk(&mut self, parts: Vec<TalkPart>) {
        self.talks.open = Some(Box::new(Talk::new(parts, self.lessons.now)));
        self.begin_step();
        (self.window.finder, self.window.help) = (None, None);
        self.lessons.lists = false;
    }

    /// Ends the talk; the lesson stays open, except for one that was made of scenes.
    pub(super) fn end_talk(&mut self) {
        self.talks.open = None;
        let open = self.lessons.open.as_ref();
        if open.is_some_and(|open| open.is_of_scenes) {
            self.give_back();
        }
    }

    fn next_in_talk(&mut self) {
        let (Some(talk), Some(open)) = (&mut self.talks.open, &mut self.lessons.open) else {
            return;
        };
        if talk.cover == Some(Cover::Blank) {
            talk.cover = None;
            return;
        }
        let learner = &mut open.learner;
        let is_last = learner.index() + 1 == learner.lesson().steps.len();
        let waits = learner.is_open() && !learner.is_taken() && open.fault.is_none();
        if waits {
            if learner.question().is_none() {
                // The run is being made.
                return;
            }
            if !std::mem::replace(&mut talk.is_voting, true) {
                return;
            }
            learner.reveal();
            (open.lacking, open.hint) = (None, None);
            (talk.is_voting, talk.cover) = (false, None);
            // A form reveals nothing and goes on.
            if !learner.is_taken() {
                return self.show_moment();
            }
        }
        if !is_last {
            let index = learner.index() + 1;
            return self.go_in_talk(index);
        }
        let part = talk.part + 1;
        if part < talk.parts.len() {
            return self.go_to_part(part, false);
        }
        talk.cover = Some(Cover::Over);
    }

    fn previous_in_talk(&mut self) {
        let (Some(talk), Some(open)) = (&mut self.talks.open, &self.lessons.open) else {
            return;
        };
        if matches!(talk.cover, Some(Cover::Blank | Cover::Over)) {
            talk.cover = None;
            return;
        }
        if talk.is_voting {
            talk.is_voting = false;
            return;
        }
        match (open.learner.index(), talk.part) {
            (0, 0) => {}
            (0, part) => self.go_to_part(part - 1, true),
            (index, _) => self.go_in_talk(index - 1),
        }
    }

    fn go_in_talk(&mut self, index: usize) {
        self.enter_step(index);
        self.begin_step();
    }

    fn begin_step(&mut self) {
        let now = self.lessons.now;
        if let Some(open) = &mut self.lessons.open {
            open.was_presented = true;
        }
        if let Some(talk) = &mut self.talks.open {
            (talk.is_voting, talk.is_drawing, talk.cover) = (false, false, None);
            (talk.pointer, talk.vote_fault) = (None, None);
            talk.step_begun = now;
        }
    }

    /// Opens another lesson of the talk, at its first or last step.
    fn go_to_part(&mut self, part: usize, at_end: bool) {
        let Some(talk) = &mut self.talks.open else {
            return;
        };
        talk.part = part;
        let name = talk.parts[part].name.clone();
        self.apply_to_lessons(LessonCommand::Open(name));
        if at_end {
            self.enter_step(usize::MAX);
        }
        self.begin_step();
    }

    fn vote(&mut self, text: &str) {
        let key = self.talk_key();
        let question = self
            .lessons
            .learner()
            .and_then(|learner| learner.question());
        let options = question.map_or(0, |question| match &question.form {
            Form::Choice { options, .. } | Form::Trace { options, .. } => options.len(),
            Form::Place { candidates } => candidates.len(),
            Form::Order { items } => items.len(),
            _ => 0,
        });
        let vote = Vote::read(text, options);
        if let Some(talk) = &mut self.talks.open {
            talk.vote_fault = vote.as_ref().err().cloned();
        }
        if let Ok(vote) = vote {
            self.talks.record.vote(&key, vote);
            self.keep_vote_on_form();
        }
    }

    /// Keeps the first vote on the question of a form with the results, so that the gain can be computed of votes too. One of
    /// this talk that was typed before is replaced, and removed if it was taken back.
    fn keep_vote_on_form(&mut self) {
        let (key, now) = (self.talk_key(), self.lessons.now);
        let (Some(talk), Some(learner)) = (&self.talks.open, self.lessons.learner()) else {
            return;
        };
        let lesson = learner.lesson();
        let concept = learner.step().gate.as_ref().and_then(|gate| gate.concept);
        let Some((form, concept)) = lesson.form.zip(concept) else {
            return;
        };

        let right = match learner.question().map(Question::key) {
            Some(Key::Choice(right)) => Some(*right),
            _ => None,
        };
        let first = self.talks.record.votes_on(&key).first();
        let share = first.and_then(|vote| vote.right_share(right));
        let vote = share.map(|share| ClassVote {
            lesson: lesson.name.clone(),
            form,
            concept,
            share,
            count: first.and_then(Vote::count),
            time: now,
        });
        let (begun, name) = (talk.begun, lesson.name.clone());
        let votes = &mut self.lessons.results.votes;
        let is_of_talk = |kept: &ClassVote| kept.time >= begun && kept.lesson == name;
        votes.retain(|kept| !(is_of_talk(kept) && kept.concept == concept));
        votes.extend(vote);
        self.lessons.mark_unstored();
    }

    /// Returns everything that another window needs to continue this talk.
    pub(crate) fn kept_of_talk(&self) -> Kept {
        let (Some(talk), Some(open)) = (&self.talks.open, &self.lessons.open) else {
            return Kept::default();
        };
        let name = open.learner.lesson().name.clone();
        let text = (open.source != LessonSource::Shipped).then(|| open.text.clone());
        Kept {
            lesson: (name, text),
            is_lecture: talk.parts.len() > 1,
            begun: talk.begun,
            part: talk.part,
            step: open.learner.step().name.clone(),
            is_revealed: open.learner.step().gate.is_some() && !open.learner.is_open(),
            camera: self.chosen_camera_of_step(),
            record: self.talks.record.clone(),
        }
    }

    fn restore_talk(&mut self, text: &str) {
        let Ok(kept) = serde_json::from_str::<Kept>(text) else {
            let text = "The talk that the notes kept cannot be read.";
            return self.tell(text.to_owned(), true);
        };
        if self.lessons.shelf.is_empty() {
            self.talks.wanted = Some(TalkCommand::Restore(text.to_owned()));
            return;
        }
        if self.talks.open.is_none() {
            match &kept.lesson {
                _ if kept.is_lecture => self.present_lecture(),
                (name, Some(text)) => {
                    self.open_lesson(name, text, LessonSource::Text);
                    self.present_lesson(false);
                }
                (name, None) => {
                    self.apply_to_lessons(LessonCommand::Open(name.clone()));
                    self.present_lesson(false);
                }
            }
        }
        let Some(talk) = &mut self.talks.open else {
            return;
        };
        if kept.begun > 0.0 {
            talk.begun = kept.begun;
        }
        let part = kept.part.min(talk.parts.len().saturating_sub(1));
        if part != talk.part {
            self.go_to_part(part, false);
        }
        self.talks.record = kept.record;

        if let Some(index) = self.lessons.step_named(&kept.step) {
            let name = self
                .lessons
                .learner()
                .map(|learner| learner.lesson().name.as_str());
            self.talks.restored = Some(RestoredStep {
                key: format!("{}/{}", name.unwrap_or_default(), kept.step),
                is_revealed: kept.is_revealed,
                // The text comes from a page's store, which anyone can change.
                camera: kept
                    .camera
                    .and_then(|kept| sound_camera(kept.center, kept.scale)),
            });
            self.go_in_talk(index);
        }
    }

    /// Reveals the answer of a restored step, and sets its camera, now that its run is there. A step that was left
    /// meanwhile stays as it is.
    pub(super) fn restore_step(&mut self) {
        let restored = self.talks.restored.take();
        let Some(restored) = restored.filter(|restored| restored.key == self.talk_key()) else {
            return;
        };

        if let Some(open) = &mut self.lessons.open
            && restored.is_revealed
            && open.learner.reveal()
        {
            self.show_moment();
        }

        if let Some(camera) = restored.camera {
            self.runs.first.take_camera(Some(camera), camera);
        }
    }

    /// Ends the talk when its lesson was closed, and draws the picture of the next step.
    pub(super) fn follow_talk(&mut self) {
        if self.talks.open.is_some() && self.lessons.open.is_none() {
            self.end_talk();
        }
        let wanted = self.next_in_picture();
        if self.next_picture.wants(wanted.as_ref())
            && let Some((name, _, index, style)) = &wanted
        {
            let task = StepPictureTask {
                lesson: (name.clone(), self.text_of(name)),
                index: *index,
                style: *style,
                as_svg: self.lessons.on_page,
            };
            let job = task::start(&self.jobs.wake, task);
            self.next_picture.draw(wanted, job);
        }
    }

    /// Returns the key of the picture of the next step; `None` in the last step and without a talk.
    fn next_in_picture(&self) -> Option<PictureKey> {
        let (talk, open) = (self.talks.open.as_ref()?, self.lessons.open.as_ref()?);
        let lesson = open.learner.lesson();
        let index = open.learner.index() + 1;
        let (name, index) = if index == lesson.steps.len() {
            (talk.parts.get(talk.part + 1)?.name.clone(), 0)
        } else {
            (lesson.name.clone(), index)
        };
        let (size, dark) = (NEXT, self.appearance.look.is_dark());
        let style = PictureStyle { size, dark };
        // A lesson's file may change while it is presented.
        Some((name, lesson.hash.clone(), index, style))
    }

    /// Returns the text of a lesson of the talk.
    fn text_of(&self, name: &str) -> String {
        match (&self.lessons.open, self.lessons.shipped(name)) {
            (Some(open), _) if open.learner.lesson().name == name => open.text.clone(),
            (_, Some(shipped)) => shipped.text.to_string(),
            _ => String::new(),
        }
    }

    fn make_handout(&mut self, answers: bool, notes: bool, path: Option<PathBuf>) {
        let Some(open) = &self.lessons.open else {
            return self.tell("Open a lesson first.".to_owned(), false);
        };
        let name = open.learner.lesson().name.clone();
        let is_german = self.lessons.language == "de" && open.source == LessonSource::Shipped;
        let shipped = self.lessons.shipped(&name).filter(|_| is_german);
        let german = shipped.map(|shipped| shipped.german.to_string());
        let task = HandoutTask {
            lesson: (name.clone(), open.text.clone()),
            language: (self.lessons.language.clone(), german),
            answers,
            notes,
            // The drawings of a talk are printed if they are kept.
            record: self.saved_record().cloned(),
        };
        let file = (format!("{name}-handout"), path);
        self.talks.handout = Some((file, task::start(&self.jobs.wake, task)));
    }

    /// Saves the handout once it is made.
    pub(super) fn follow_handout(&mut self) {
        let outcome = self.talks.handout.as_ref().and_then(|(_, job)| job.poll());
        if let Some(outcome) = outcome
            && let Some((file, _)) = self.talks.handout.take()
        {
            self.take_handout(file, outcome.and_then(|made| made));
        }
    }

    fn take_handout(&mut self, (stem, path): HandoutFile, made: Result<String, String>) {
        match made {
            Ok(html) => self.save_text(&stem, "html", path, &html),
            Err(why) => self.tell(format!("There is no handout. {why}"), true),
        }
    }

    /// Waits for the picture of the next step, and for the handout.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_talk(&mut self) {
        if let Some((file, job)) = self.talks.handout.take() {
            let made = job.wait().and_then(|made| made);
            self.take_handout(file, made);
        }
        self.follow_talk();
        self.next_picture.settle();
    }

    /// Begins the talk that waited for the lessons.
    pub(super) fn begin_wanted_talk(&mut self) {
        if let Some(command) = self.talks.wanted.take() {
            self.apply_to_talk(command);
        }
    }

    /// Returns the address that leads a phone to the step, or to the voting card for a step with a question; empty if the
    /// page's address is not known.
    #[must_use]
    pub fn talk_address(&self) -> String {
        let base = match (&self.links.base, self.talks.address.as_str()) {
            (Some(base), "") => base.as_str(),
            (_, address) => address,
        };
        let base = base.split('#').next().unwrap_or_default();
        let fragment = self.link().fragment;
        match (base, self.lessons.open_question()) {
            ("", _) => String::new(),
            // As in links to lessons, English is not named, so that readers of other languages get theirs.
            (base, Some(_)) if self.lessons.language == "de" => format!("{base}#card&language=de"),
            (base, Some(_)) => format!("{base}#card"),
            (base, None) => format!("{base}#{fragment}"),
        }
    }

    /// Returns whether a page has to load the lessons that come with the program.
    #[must_use]
    pub fn wants_lessons(&self) -> bool {
        let wanted = self.talks.wanted.is_some() && self.lessons.shelf.is_empty();
        wanted || self.lessons.wants_shelf()
    }

    /// Returns the lecturer's lines over the step that is shown.
    #[must_use]
    pub fn strokes(&self) -> &[PenStroke] {
        self.talks.record.strokes_in(&self.talk_key())
    }

    /// Returns the votes and drawings to be saved with the session, if the lecturer chose so and there are any.
    pub(super) fn saved_record(&self) -> Option<&TalkRecord> {
        let record = &self.talks.record;
        (self.talks.is_kept && *record != TalkRecord::default()).then_some(record)
    }

    /// Takes the votes and drawings that were saved with a session.
    pub(super) fn take_record(&mut self, view: &serde_json::Value) {
        let talk = view.get("talk").cloned();
        if let Some(record) = talk.and_then(|talk| serde_json::from_value(talk).ok()) {
            (self.talks.record, self.talks.is_kept) = (record, true);
        }
    }
}

impl Talk {
    fn toggle_cover(&mut self, cover: Cover) {
        self.cover = Some(cover).filter(|_| self.cover != Some(cover));
    }

    fn apply(&mut self, command: &TalkCommand) {
        match *command {
            TalkCommand::Blank => self.toggle_cover(Cover::Blank),
            TalkCommand::ToggleNotes => self.windows.notes = !self.windows.notes,
            TalkCommand::NotesClosed => self.windows.notes = false,
            TalkCommand::StageClosed => self.windows.stage = false,
            TalkCommand::OpenStage => self.windows.stage = true,
            TalkCommand::Swap => self.windows.are_swapped = !self.windows.are_swapped,
            TalkCommand::Tool(tool) => {
                self.tool = if self.tool == tool { Tool::Hand } else { tool };
                (self.pointer, self.is_drawing) = (None, false);
            }
            TalkCommand::NextColor => self.color = (self.color + 1) % PenStroke::COLORS,
            TalkCommand::Point(at) => self.pointer = at,
            TalkCommand::Lift => self.is_drawing = false,
            TalkCommand::ToggleCode => self.toggle_cover(Cover::Code),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::settled;
    use super::*;
    use crate::command::{Command, TimeCommand, ViewCommand, Which};
    use crate::lessons::DraftCommand;
    use crate::scenes::{SceneCommand, SceneList};
    use crate::talk::advised;
    use tilescope_lessons::{Advice, RightShare};

    fn talk(state: &mut State, command: TalkCommand) {
        state.apply(Command::Talk(command));
        state.settle();
    }

    fn presented(name: &str) -> State {
        let mut state = settled();
        state.lessons.now = 1_000.0;
        state.apply(Command::Lesson(LessonCommand::Open(name.to_owned())));
        state.settle();
        talk(&mut state, TalkCommand::Lesson { from_start: true });
        state
    }

    fn step(state: &State) -> usize {
        state.lessons.open.as_ref().unwrap().learner.index()
    }

    fn open(state: &State) -> &Talk {
        state.talks.open.as_ref().unwrap()
    }

    fn to_question(state: &mut State) {
        while state.lessons.open_question().is_none() {
            talk(state, TalkCommand::Next);
        }
    }

    #[test]
    fn next_asks_for_votes_then_reveals_then_goes_on_and_records_nothing() {
        let mut state = presented("survivors");
        to_question(&mut state);
        let at = step(&state);
        talk(&mut state, TalkCommand::Next);
        assert!(open(&state).is_voting && state.lessons.open_question().is_some());
        assert_eq!(state.lessons.veil(), state.cursor().map(|(_, len)| len));
        talk(&mut state, TalkCommand::Next);
        assert!(state.lessons.open_question().is_none() && step(&state) == at);
        talk(&mut state, TalkCommand::Next);
        assert_eq!(step(&state), at + 1);
        talk(&mut state, TalkCommand::Previous);
        assert_eq!(step(&state), at);
        assert!(state.lessons.results.entries.is_empty());
    }

    #[test]
    fn a_blank_stage_is_shown_again_by_next() {
        let mut state = presented("survivors");
        talk(&mut state, TalkCommand::Blank);
        talk(&mut state, TalkCommand::Next);
        assert!(open(&state).cover.is_none() && step(&state) == 0);
    }

    #[test]
    fn votes_are_two_for_a_question_and_advise() {
        let mut state = presented("survivors");
        to_question(&mut state);
        let key = state.talk_key();
        for text in ["A 3 B 1", "half", "1 30 2"] {
            talk(&mut state, TalkCommand::Vote(text.to_owned()));
        }
        let votes = state.talks.record.votes_on(&key);
        assert_eq!(
            votes,
            [Vote::Counts(vec![3, 1, 0]), Vote::Counts(vec![1, 30, 2])]
        );
        let question = state
            .lessons
            .open_question()
            .map(tilescope_lessons::Question::key);
        assert!(advised(votes, question).is_some());
        talk(&mut state, TalkCommand::Unvote);
        talk(&mut state, TalkCommand::Vote("Z 4".to_owned()));
        assert!(open(&state).vote_fault.as_ref().unwrap().contains("A to C"));
        let few = [Vote::Right(RightShare::Few)];
        assert_eq!(advised(&few, None), Some(Advice::Explain));
        assert_eq!(advised(&[], None), None);
    }

    #[test]
    fn the_lecture_is_fifty_minutes_and_goes_from_lesson_to_lesson_and_back() {
        let mut state = settled();
        talk(&mut state, TalkCommand::Lecture);
        let [_, _, all] = open(&state).planned_secs(0);
        assert!((all - 3_000.0).abs() < 1e-6, "{all}");
        assert_eq!(open(&state).parts.len(), shipped::LECTURE.len());
        while open(&state).part == 0 {
            talk(&mut state, TalkCommand::Next);
        }
        let [before, ..] = open(&state).planned_secs(0);
        assert!((before - 240.0).abs() < 1e-6);
        talk(&mut state, TalkCommand::Previous);
        assert_eq!(open(&state).part, 0);
        let last = state
            .lessons
            .open
            .as_ref()
            .unwrap()
            .learner
            .lesson()
            .steps
            .len()
            - 1;
        assert_eq!(step(&state), last);
        talk(&mut state, TalkCommand::First);
        assert_eq!((open(&state).part, step(&state)), (0, 0));
    }

    #[test]
    fn lines_belong_to_their_step_and_are_kept_only_on_request() {
        let mut state = presented("survivors");
        for at in [[1.0, 1.0], [2.0, 2.0]] {
            talk(&mut state, TalkCommand::Draw(at));
        }
        talk(&mut state, TalkCommand::Lift);
        talk(&mut state, TalkCommand::NextColor);
        talk(&mut state, TalkCommand::Draw([3.0, 3.0]));
        talk(&mut state, TalkCommand::Draw([f64::NAN, 3.0]));
        let colors: Vec<usize> = state.strokes().iter().map(|stroke| stroke.color).collect();
        assert_eq!(colors, [0, 1]);
        assert_eq!(state.strokes()[0].points, [[1.0, 1.0], [2.0, 2.0]]);
        talk(&mut state, TalkCommand::UndoStroke);
        assert_eq!(state.strokes().len(), 1);
        talk(&mut state, TalkCommand::Next);
        assert!(state.strokes().is_empty());
        let saved = |state: &State| state.saved().unwrap().view.get("talk").cloned();
        assert_eq!(saved(&state), None);
        talk(&mut state, TalkCommand::Keep(true));
        let view = serde_json::json!({ "talk": saved(&state).unwrap() });
        let mut other = settled();
        other.take_record(&view);
        assert_eq!(other.talks.record, state.talks.record);
        other.take_record(&serde_json::json!({ "talk": 7 }));
        assert_eq!(other.talks.record, state.talks.record);
    }

    #[test]
    fn scenes_are_presented_and_the_session_comes_back() {
        let mut state = settled();
        for (event, caption) in [
            (5_000, "Tiling. It is half done.\n---\nSay why."),
            (12_000, ""),
        ] {
            state.apply(Command::Time(TimeCommand::Jump(event)));
            state.apply(Command::Scene(SceneCommand::Add));
            let last = state.scenes(SceneList::Own).len() - 1;
            state.apply(Command::Scene(SceneCommand::Caption(
                last,
                caption.to_owned(),
            )));
        }
        let before = (state.cursor(), state.runs.first.camera);
        talk(&mut state, TalkCommand::Scenes);
        let learner = &state.lessons.open.as_ref().expect("a lesson").learner;
        assert_eq!(learner.step().title, "Tiling");
        assert_eq!(learner.step().notes, ["Say why."]);
        assert_eq!(state.cursor().map(|(at, _)| at), Some(5_000));
        talk(&mut state, TalkCommand::Next);
        assert_eq!(state.cursor().map(|(at, _)| at), Some(12_000));
        talk(&mut state, TalkCommand::End);
        assert!(state.lessons.open.is_none());
        assert_eq!((state.cursor(), state.runs.first.camera), before);
        assert_eq!(state.scenes(SceneList::Own).len(), 2);
        assert!(state.verdict().is_some());
    }

    #[test]
    fn scenes_that_are_none_are_refused() {
        let mut state = settled();
        talk(&mut state, TalkCommand::Scenes);
        assert!(state.talks.open.is_none());
        let notice = &state.messages.notice.as_ref().expect("a notice").text;
        assert!(notice.contains("no scenes"), "{notice}");
    }

    #[test]
    fn a_code_is_gone_when_the_answer_comes_and_a_frame_presents_nothing() {
        let mut state = presented("survivors");
        to_question(&mut state);
        talk(&mut state, TalkCommand::Next);
        talk(&mut state, TalkCommand::ToggleCode);
        assert_eq!(open(&state).cover, Some(Cover::Code));
        talk(&mut state, TalkCommand::Next);
        assert_eq!(open(&state).cover, None);
        talk(&mut state, TalkCommand::End);
        state.window.embedding = Some(crate::embedding::Embedding::Player);
        let answer = state.ask(r#"{"do": "lesson", "act": "present"}"#);
        assert!(answer.contains("presents nothing"), "{answer}");
        assert!(state.talks.open.is_none());
    }

    #[test]
    fn answers_in_and_after_a_talk_do_not_count() {
        let mut state = presented("survivors");
        to_question(&mut state);
        for _ in 0..2 {
            let question = state.lessons.open_question().expect("a question");
            let tilescope_lessons::Key::Choice(right) = *question.key() else {
                panic!("a choice");
            };
            for command in [
                LessonCommand::Draft(DraftCommand::Choose(right)),
                LessonCommand::Answer,
            ] {
                state.apply(Command::Lesson(command));
            }
            assert!(state.lessons.open_question().is_none());
            assert!(state.lessons.results.entries.is_empty());
            talk(&mut state, TalkCommand::End);
            state.apply(Command::Lesson(LessonCommand::Go("one-of-two".to_owned())));
            state.settle();
        }
    }

    #[test]
    fn a_handout_with_answers_or_notes_is_refused_while_a_question_is_open() {
        let mut state = presented("survivors");
        to_question(&mut state);
        talk(&mut state, TalkCommand::End);
        for (answers, notes) in [(true, false), (false, true)] {
            let handout = TalkCommand::Handout {
                answers,
                notes,
                path: None,
            };
            state.apply(Command::Talk(handout));
            assert!(state.talks.handout.is_none());
        }
        let notice = &state.messages.notice.as_ref().expect("a notice").text;
        assert!(notice.contains("what comes next"), "{notice}");
    }

    /// The JSON for the notes has notes and answers; that for pages and scripts has neither.
    #[test]
    fn what_pages_are_told_holds_no_note_and_no_answer() {
        let mut state = presented("survivors");
        to_question(&mut state);
        let learner = &state.lessons.open.as_ref().unwrap().learner;
        let (note, answer) = (
            learner.step().notes[0].clone(),
            learner.right_answer().unwrap(),
        );
        let words: Vec<&str> = note.split(' ').take(3).collect();
        let told = state.talk_json();
        assert!(told["notes"].to_string().contains(&words.join(" ")));
        assert_eq!(told["answer"], answer);
        let state_told = state.to_json();
        assert_eq!(state_told["lesson"], serde_json::Value::Null);
        assert!(!state_told.to_string().contains(&words.join(" ")));
        assert!(state.link().fragment.contains("lesson=survivors"));
    }

    #[test]
    fn another_window_goes_on_where_the_first_one_was() {
        let mut state = presented("survivors");
        to_question(&mut state);
        talk(&mut state, TalkCommand::Vote("few".to_owned()));
        talk(&mut state, TalkCommand::Draw([1.0, 2.0]));
        let kept = serde_json::to_string(&state.kept_of_talk()).unwrap();
        let mut other = settled();
        other.lessons.now = 2_000.0;
        talk(&mut other, TalkCommand::Restore(kept));
        assert_eq!(other.talk_key(), state.talk_key());
        assert_eq!(other.talks.record, state.talks.record);
        assert!((open(&other).begun - 1_000.0).abs() < 1e-9);
        talk(&mut other, TalkCommand::Restore("nonsense".to_owned()));
        assert!(other.messages.notice.is_some_and(|notice| notice.is_error));
    }

    #[test]
    fn another_window_shows_what_was_revealed_as_it_was_looked_at() {
        let mut state = presented("survivors");
        to_question(&mut state);
        for _ in 0..2 {
            talk(&mut state, TalkCommand::Next);
        }
        assert!(state.lessons.open_question().is_none());
        let zoomed = ViewCommand::FlyTo([9.0, 11.0].into(), 3.0);
        state.apply(Command::View(Which::First, zoomed));
        while state.advance(0.1) {}

        let kept = state.kept_of_talk();
        let mut other = settled();
        let text = serde_json::to_string(&kept).unwrap();
        talk(&mut other, TalkCommand::Restore(text));
        assert_eq!(other.talk_key(), state.talk_key());
        assert_eq!(other.cursor(), state.cursor(), "the deciding event");
        assert!(other.lessons.open_question().is_none());
        assert_eq!(other.runs.first.camera, state.runs.first.camera);
        assert!(other.lessons.results.entries.is_empty());

        // The next step begins as ever, and its camera is its own, which is not kept.
        for state in [&mut state, &mut other] {
            talk(state, TalkCommand::Next);
            assert!(state.lessons.open_question().is_some());
            assert_eq!(state.kept_of_talk().camera, None);
        }

        // A camera that no window has is left out.
        let mut broken = kept;
        broken.camera.as_mut().unwrap().scale = -1.0;
        let text = serde_json::to_string(&broken).unwrap();
        talk(&mut other, TalkCommand::Restore(text));
        assert!(other.runs.first.camera.scale > 0.0);
        assert_eq!(other.kept_of_talk().camera, None);
    }

    #[test]
    fn a_form_takes_votes_reveals_nothing_and_keeps_the_first_vote_with_the_results() {
        let mut state = presented("before");
        to_question(&mut state);
        let concept = |state: &State| {
            let gate = state.lessons.learner()?.step().gate.as_ref()?;
            gate.concept
        };
        let first = concept(&state).expect("a question of the form");
        let question = state.lessons.open_question().expect("a question");
        let Key::Choice(right) = *question.key() else {
            panic!("a choice");
        };
        let right = tilescope_lessons::letter(right);
        let vote = |state: &mut State, text: &str| talk(state, TalkCommand::Vote(text.to_owned()));
        vote(&mut state, "A 5 B 5 C 5 D 5");
        let shares = |state: &State| {
            let votes = state.lessons.results.votes.iter();
            votes
                .map(|vote| (vote.share, vote.count))
                .collect::<Vec<_>>()
        };
        assert_eq!(shares(&state), [(0.25, Some(20))]);

        // The vote after a discussion does not count, and one that was taken back is gone.
        vote(&mut state, &format!("{right} 20"));
        assert_eq!(shares(&state), [(0.25, Some(20))]);
        talk(&mut state, TalkCommand::Unvote);
        talk(&mut state, TalkCommand::Unvote);
        assert_eq!(shares(&state), []);
        vote(&mut state, &format!("{right} 20"));
        assert_eq!(shares(&state), [(1.0, Some(20))]);

        let at = state.cursor();
        talk(&mut state, TalkCommand::Next);
        assert_eq!((state.cursor(), concept(&state)), (at, Some(first)));
        talk(&mut state, TalkCommand::Next);
        assert_ne!(concept(&state), Some(first), "the next question");
        assert!(state.lessons.results.entries.is_empty());

        // The control: votes on a lesson are not kept with the results.
        let mut state = presented("survivors");
        to_question(&mut state);
        vote(&mut state, "A 5 B 5");
        assert_eq!(shares(&state), []);
    }

    #[test]
    fn the_picture_of_the_next_step_is_drawn_and_ends_with_the_last() {
        let mut state = presented("survivors");
        let picture = state.next_picture.drawn().expect("a picture");
        let pixels = picture.pixels.as_ref().expect("pixels");
        let first = &pixels.rgba[..4];
        assert!(pixels.rgba.chunks(4).any(|pixel| pixel != first));
        while open(&state).cover != Some(Cover::Over) {
            talk(&mut state, TalkCommand::Next);
        }
        assert!(state.next_picture.drawn().is_none());
    }

    #[test]
    fn closing_both_windows_ends_the_talk() {
        let mut state = presented("survivors");
        talk(&mut state, TalkCommand::StageClosed);
        assert!(state.talks.open.is_some());
        talk(&mut state, TalkCommand::NotesClosed);
        assert!(state.talks.open.is_none() && state.lessons.open.is_some());
    }
}
