//! Presenter mode: starts a talk, goes on and back, takes votes and drawings, makes handouts, and draws the
//! picture of the next step. `crate::talk` has the commands and the data, `talk_told.rs` the lecturer's notes as JSON.

use std::path::PathBuf;

use tilescope_drawing::camera::Camera;
use tilescope_lessons::results::ClassVote;
use tilescope_lessons::{Lesson, Question, Vote, shipped};
use tilescope_session::language::is_english;
use tilescope_session::task;

use crate::handout::HandoutTask;
use crate::lesson_picture::{PictureKey, PictureStyle, StepPictureTask};
use crate::lessons::{LessonCommand, LessonSource};
use crate::pen::PenStroke;
use crate::room::{CanvasView, Classroom, Context, Effect, NewFile};
use crate::talk::{
    Cover, HandoutFile, Kept, RestoredStep, Talk, TalkCommand, TalkPart, TalkRecord, Tool,
};

/// The most characters that are kept of a page's address: more than such addresses have.
const MAX_ADDRESS: usize = 200;
/// Width and height of the picture of the next step, in points.
const NEXT: [f64; 2] = [440.0, 330.0];

/// Saves a handout that is made.
fn take_handout(file: HandoutFile, made: Result<String, String>, context: &mut Context) {
    match made {
        Ok(text) => context.ask(Effect::Save(NewFile {
            stem: file.stem,
            extension: "html",
            path: file.path,
            bytes: text.into_bytes(),
        })),
        Err(why) => context.tell_error(format!("There is no handout. {why}")),
    }
}

impl Classroom {
    /// Returns the key of the step that is shown, for votes and drawings; empty without a lesson.
    #[must_use]
    pub fn talk_key(&self) -> String {
        let learner = self.lessons.learner();
        let key =
            learner.map(|learner| format!("{}/{}", learner.lesson().name, learner.step().name));
        key.unwrap_or_default()
    }

    /// Applies a command of presenter mode.
    pub fn apply_to_talk(&mut self, command: TalkCommand, context: &mut Context) {
        let key = self.talk_key();

        match command {
            TalkCommand::Lesson { from_start } => self.present_lesson(from_start, context),
            TalkCommand::First => {
                // The parts of a lecture are lessons: its first step is the first one of the first lesson.
                if self.talks.open.as_ref().is_some_and(|talk| talk.part > 0) {
                    let at_end = false;
                    self.go_to_part(0, at_end, context);
                } else {
                    self.go_in_talk(0, context);
                }
            }
            TalkCommand::Handout {
                answers,
                notes,
                path,
            } => self.make_handout(answers, notes, path, context),
            TalkCommand::Lecture => self.present_lecture(context),
            TalkCommand::Scenes => {
                // A talk of earlier scenes gives the session back as it ends, and the lesson is made of that session's
                // scenes.
                self.end_talk(context);
                context.ask(Effect::LessonOfScenes);
            }
            TalkCommand::Address(address) => {
                self.talks.address = address.trim().chars().take(MAX_ADDRESS).collect();
            }
            TalkCommand::Keep(is_kept) => self.talks.is_kept = is_kept,
            TalkCommand::End => self.end_talk(context),
            TalkCommand::Next => self.next_in_talk(context),
            TalkCommand::Previous => self.previous_in_talk(context),
            TalkCommand::Vote(text) => self.vote(&text),
            TalkCommand::Restore(kept) => self.restore_talk(&kept, context),
            TalkCommand::Draw(at) => {
                if let Some(talk) = &mut self.talks.open {
                    // The first place since the pen was lifted begins a stroke.
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
            // All other commands change nothing but the talk itself.
            _ => {
                if let Some(talk) = &mut self.talks.open {
                    talk.apply(&command);
                    // A talk without the stage and the notes has no window, and would go on unseen.
                    if !(talk.windows.stage || talk.windows.notes) {
                        self.end_talk(context);
                    }
                }
            }
        }
    }

    fn present_lesson(&mut self, from_start: bool, context: &mut Context) {
        let Some(open) = &self.lessons.open else {
            return context.tell("Open a lesson first.".to_owned());
        };
        let minutes_of_lesson = None;
        let part = TalkPart::of(open.learner.lesson(), minutes_of_lesson);
        self.begin_talk(vec![part], context);
        if from_start {
            self.enter_step(0, context);
        }
    }

    /// Begins the lecture that comes with the program.
    fn present_lecture(&mut self, context: &mut Context) {
        // On a page the lessons are loaded when they are first needed; the talk begins once they are there.
        if self.lessons.shelf.is_empty() {
            self.talks.wanted = Some(TalkCommand::Lecture);
            return;
        }

        // Tests read all parts of the lecture, so that none is left out here.
        let planned = shipped::LECTURE.iter().filter_map(|&(name, minutes)| {
            let shipped = self.lessons.shipped(name)?;
            let lesson = Lesson::read(name, &shipped.text).ok()?;
            Some(TalkPart::of(&lesson, Some(minutes)))
        });
        let parts: Vec<TalkPart> = planned.collect();

        if let Some(first) = parts.first().map(|part| part.name.clone()) {
            self.apply(LessonCommand::Open(first), context);
            self.begin_talk(parts, context);
        }
    }

    /// Presents the scenes as a lesson, which was made of them, or shows a notice with the reason why there is none. The session
    /// comes back when the talk ends.
    pub fn present_scenes(&mut self, made: Result<String, String>, context: &mut Context) {
        // Read for its part of the talk, and so that a fault is reported as one of the scenes; `open_lesson` reads the
        // text itself.
        let read = made.and_then(|text| {
            let lesson = Lesson::read("scenes", &text);
            Ok((lesson.map_err(|error| error.to_string())?, text))
        });

        match read {
            Ok((lesson, text)) => {
                self.open_lesson("scenes", &text, LessonSource::Text, context);
                // The lesson was made for this talk alone, and closes with it.
                if let Some(open) = &mut self.lessons.open {
                    open.is_of_scenes = true;
                }
                // The part takes as long as the lesson plans.
                let minutes_of_lesson = None;
                let part = TalkPart::of(&lesson, minutes_of_lesson);
                self.begin_talk(vec![part], context);
            }
            Err(why) => context.tell_error(format!("The scenes cannot be presented. {why}")),
        }
    }

    fn begin_talk(&mut self, parts: Vec<TalkPart>, context: &mut Context) {
        self.talks.open = Some(Box::new(Talk::new(parts, self.lessons.now)));
        self.begin_step();
        context.ask(Effect::CloseMenus);
        self.lessons.shows_list = false;
    }

    /// Ends the talk; the lesson stays open, except for one that was made of scenes.
    pub(crate) fn end_talk(&mut self, context: &mut Context) {
        self.talks.open = None;
        let open = self.lessons.open.as_ref();
        if open.is_some_and(|open| open.is_of_scenes) {
            self.close(context);
        }
    }

    /// Goes on by a press: to the votes, the answer, the next step, the next part, or the end.
    fn next_in_talk(&mut self, context: &mut Context) {
        let (Some(talk), Some(open)) = (&mut self.talks.open, &mut self.lessons.open) else {
            return;
        };

        // While the stage is blank, a press only shows the canvas again.
        if talk.cover == Some(Cover::Blank) {
            talk.cover = None;
            return;
        }

        let learner = &mut open.learner;
        let is_last = learner.index() + 1 == learner.lesson().steps.len();
        // A form's question stays open once it is answered (`is_taken`), and then waits for nothing.
        let awaits_answer = learner.is_open() && !learner.is_taken() && open.fault.is_none();

        if awaits_answer {
            if learner.question().is_none() {
                // There is no question yet, as its run is being made: presses are ignored.
                return;
            }

            // The first press at a question asks for votes, the second one reveals the answer.
            if !talk.is_voting {
                talk.is_voting = true;
                return;
            }

            learner.reveal();
            (open.lacking, open.hint) = (None, None);
            (talk.is_voting, talk.cover) = (false, None);
            // A form does not reveal its answer, so that this press goes on to the next step.
            if !learner.is_taken() {
                return self.show_moment(context);
            }
        }

        if !is_last {
            let index = learner.index() + 1;
            return self.go_in_talk(index, context);
        }

        let part = talk.part + 1;
        if part < talk.parts.len() {
            let at_end = false;
            return self.go_to_part(part, at_end, context);
        }

        talk.cover = Some(Cover::Over);
    }

    /// Goes back by one press: takes back the cover, the vote or the step that was shown last.
    fn previous_in_talk(&mut self, context: &mut Context) {
        let (Some(talk), Some(open)) = (&mut self.talks.open, &self.lessons.open) else {
            return;
        };

        // Each press takes one thing back: a cover, the vote, then a step. The code for phones has a command of its own that hides it.
        if matches!(talk.cover, Some(Cover::Blank | Cover::Over)) {
            talk.cover = None;
            return;
        }

        if talk.is_voting {
            talk.is_voting = false;
            return;
        }

        // Before the first step of a part comes the last one of the part before.
        let at_end = true;
        match (open.learner.index(), talk.part) {
            (0, 0) => {}
            (0, part) => self.go_to_part(part - 1, at_end, context),
            (index, _) => self.go_in_talk(index - 1, context),
        }
    }

    fn go_in_talk(&mut self, index: usize, context: &mut Context) {
        self.enter_step(index, context);
        self.begin_step();
    }

    /// Begins the time of the step that is shown, without the votes, the cover and the pointer of the one before.
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
    fn go_to_part(&mut self, part: usize, at_end: bool, context: &mut Context) {
        let Some(talk) = &mut self.talks.open else {
            return;
        };

        talk.part = part;
        let name = talk.parts[part].name.clone();
        self.apply(LessonCommand::Open(name), context);
        // A lesson opens at its first step. A step beyond the last one is the last one.
        if at_end {
            self.enter_step(usize::MAX, context);
        }

        self.begin_step();
    }

    /// Counts the votes that were typed, or shows why they cannot be read.
    fn vote(&mut self, text: &str) {
        let key = self.talk_key();
        let question = self
            .lessons
            .learner()
            .and_then(|learner| learner.question());
        // Without a question no letter is a vote.
        let options = question.map_or(0, |question| question.interaction.letters());

        let vote = Vote::read(text, options);
        // A vote that cannot be read leaves the record as it is.
        if let Some(talk) = &mut self.talks.open {
            talk.vote_fault = vote.as_ref().err().cloned();
        }

        if let Ok(vote) = vote {
            self.talks.record.vote(&key, vote);
            self.keep_vote_on_form();
        }
    }

    /// Keeps the first vote on the question of a form with the results, so that the gain of votes can be computed. It
    /// replaces the one that this talk kept before. If all votes were taken back, or if the first one tells no share of
    /// right answers, the kept one is only removed.
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

        let right = learner.question().and_then(Question::right_option);
        // The first vote counts, as the first answer of a learner does.
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

        // Votes of earlier talks stay: those of this talk are not older than its beginning.
        let (begun, name) = (talk.begun, lesson.name.clone());
        let votes = &mut self.lessons.results.votes;
        let is_of_talk = |kept: &ClassVote| kept.time >= begun && kept.lesson == name;
        votes.retain(|kept| !(is_of_talk(kept) && kept.concept == concept));
        votes.extend(vote);

        self.lessons.mark_unstored();
    }

    /// Returns everything that another window needs to continue this talk.
    #[must_use]
    pub fn kept_of_talk(&self, canvas: &CanvasView) -> Kept {
        let (Some(talk), Some(open)) = (&self.talks.open, &self.lessons.open) else {
            return Kept::default();
        };

        let name = open.learner.lesson().name.clone();
        // Another window has the program's lessons, and no others.
        let text = (open.source != LessonSource::Shipped).then(|| open.text.clone());

        Kept {
            lesson: (name, text),
            // All other talks have one part: a lesson, or scenes.
            is_lecture: talk.parts.len() > 1,
            begun: talk.begun,
            part: talk.part,
            step: open.learner.step().name.clone(),
            is_revealed: open.learner.step().gate.is_some() && !open.learner.is_open(),
            camera: self.chosen_camera(canvas),
            record: self.talks.record.clone(),
        }
    }

    /// Continues the talk of a text that [`Self::kept_of_talk`] gave; on a page, once the lessons are loaded.
    fn restore_talk(&mut self, text: &str, context: &mut Context) {
        let Ok(kept) = serde_json::from_str::<Kept>(text) else {
            let text = "The talk that the notes kept cannot be read.";
            return context.tell_error(text.to_owned());
        };

        if self.lessons.shelf.is_empty() {
            self.talks.wanted = Some(TalkCommand::Restore(text.to_owned()));
            return;
        }

        // A talk that is open in this window stays open, and takes over the kept one's beginning, votes, drawings and
        // place. Otherwise the kept one begins: a lecture, a lesson of which the text was kept, or one that comes with
        // the program.
        if self.talks.open.is_none() {
            let from_start = false;
            match &kept.lesson {
                _ if kept.is_lecture => self.present_lecture(context),
                (name, Some(text)) => {
                    self.open_lesson(name, text, LessonSource::Text, context);
                    self.present_lesson(from_start, context);
                }
                (name, None) => {
                    self.apply(LessonCommand::Open(name.clone()), context);
                    self.present_lesson(from_start, context);
                }
            }
        }

        let Some(talk) = &mut self.talks.open else {
            return;
        };

        // Without the time of its beginning, the talk counts from now.
        if kept.begun > 0.0 {
            talk.begun = kept.begun;
        }

        // A text of another version, or one that was changed by hand, may name a part that the talk lacks.
        let part = kept.part.min(talk.parts.len().saturating_sub(1));
        if part != talk.part {
            let at_end = false;
            self.go_to_part(part, at_end, context);
        }

        self.talks.record = kept.record;

        // A lesson that was changed meanwhile may lack the step, and then stays where it is.
        if let Some(index) = self.lessons.step_named(&kept.step) {
            let name = self
                .lessons
                .learner()
                .map(|learner| learner.lesson().name.as_str());
            self.talks.restored = Some(RestoredStep {
                key: format!("{}/{}", name.unwrap_or_default(), kept.step),
                is_revealed: kept.is_revealed,
                // The text comes from the store of a page, which anyone can change: the camera may be nonsense.
                camera: kept
                    .camera
                    .and_then(|kept| Camera::checked(kept.center, kept.scale)),
            });
            self.go_in_talk(index, context);
        }
    }

    /// Reveals the answer of a restored step, and sets its camera, now that its run is there. A step that was left
    /// meanwhile stays as it is.
    pub(crate) fn restore_step(&mut self, context: &mut Context) {
        // Once: a step that is entered later begins as usual.
        let restored = self.talks.restored.take();
        let Some(restored) = restored.filter(|restored| restored.key == self.talk_key()) else {
            return;
        };

        if let Some(open) = &mut self.lessons.open
            && restored.is_revealed
            && open.learner.reveal()
        {
            self.show_moment(context);
        }

        if let Some(camera) = restored.camera {
            context.ask(Effect::Look(camera));
        }
    }

    /// Ends the talk when its lesson was closed, and draws the picture of the next step for a dark or a light window.
    pub fn follow_talk(&mut self, dark: bool, context: &mut Context) {
        if self.talks.open.is_some() && self.lessons.open.is_none() {
            self.end_talk(context);
        }

        let wanted = self.next_in_picture(dark);
        if self.talks.next_picture.wants(wanted.as_ref())
            && let Some(key) = &wanted
        {
            // In the background, since the run of the step may have to be made first.
            let task = StepPictureTask {
                name: key.name.clone(),
                text: self.text_of(&key.name),
                index: key.index,
                style: key.style,
                as_svg: self.lessons.on_page,
            };
            let job = task::start(&context.wake, task);
            self.talks.next_picture.draw(wanted, job);
        }
    }

    /// Returns the key of the picture of the next step; `None` in the last step of the talk and without a talk.
    fn next_in_picture(&self, dark: bool) -> Option<PictureKey> {
        let (talk, open) = (self.talks.open.as_ref()?, self.lessons.open.as_ref()?);
        let lesson = open.learner.lesson();
        let index = open.learner.index() + 1;

        // After the last step of a part comes the first of the next part.
        let (name, index) = if index == lesson.steps.len() {
            (talk.parts.get(talk.part + 1)?.name.clone(), 0)
        } else {
            (lesson.name.clone(), index)
        };

        Some(PictureKey {
            name,
            // Only the file of the open lesson may change: a lesson of the next part comes with the program.
            hash: lesson.hash.clone(),
            index,
            style: PictureStyle { size: NEXT, dark },
        })
    }

    /// Returns the text of a lesson of the talk; empty if neither the program nor the talk has it.
    fn text_of(&self, name: &str) -> String {
        match (&self.lessons.open, self.lessons.shipped(name)) {
            (Some(open), _) if open.learner.lesson().name == name => open.text.clone(),
            (_, Some(shipped)) => shipped.text.to_string(),
            _ => String::new(),
        }
    }

    /// Starts to make a handout of the open lesson, with its answers and the speaker's notes if they are wanted.
    fn make_handout(
        &mut self,
        answers: bool,
        notes: bool,
        path: Option<PathBuf>,
        context: &mut Context,
    ) {
        let Some(open) = &self.lessons.open else {
            return context.tell("Open a lesson first.".to_owned());
        };

        let name = open.learner.lesson().name.clone();
        let shipped = self.lessons.shipped(&name);
        // Only lessons that come with the program have a translation at hand: one beside the file of a lesson is not
        // read for this.
        let translation = shipped
            .filter(|_| open.source == LessonSource::Shipped)
            .and_then(|shipped| shipped.translation(&self.lessons.language))
            .map(str::to_owned);

        let task = HandoutTask {
            name: name.clone(),
            text: open.text.clone(),
            language: self.lessons.language.clone(),
            translation,
            answers,
            notes,
            // The drawings of a talk are printed if the lecturer chose to keep them.
            record: self.saved_record().cloned(),
        };

        let file = HandoutFile {
            stem: format!("{name}-handout"),
            path,
        };
        self.talks.handout = Some((file, task::start(&context.wake, task)));
    }

    /// Saves the handout once it is made.
    pub fn follow_handout(&mut self, context: &mut Context) {
        let outcome = self.talks.handout.as_ref().and_then(|(_, job)| job.poll());

        if let Some(outcome) = outcome
            && let Some((file, _)) = self.talks.handout.take()
        {
            take_handout(file, outcome.and_then(|made| made), context);
        }
    }

    /// Waits for the picture of the next step, and for the handout.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle_talk(&mut self, dark: bool, context: &mut Context) {
        if let Some((file, job)) = self.talks.handout.take() {
            let made = job.wait().and_then(|made| made);
            take_handout(file, made, context);
        }

        self.follow_talk(dark, context);
        self.talks.next_picture.settle();
    }

    /// Begins the talk that waited for the lessons.
    pub(crate) fn begin_wanted_talk(&mut self, context: &mut Context) {
        if let Some(command) = self.talks.wanted.take() {
            self.apply_to_talk(command, context);
        }
    }

    /// Returns the address that leads a phone to the step, or to the voting card for a step with a question; empty if no address is
    /// known. `page` is the address of the page, if the window is on one; an address that the lecturer has set is taken
    /// in its place. `fragment` is the link to the moment that is shown.
    #[must_use]
    pub fn talk_address(&self, page: Option<&str>, fragment: &str) -> String {
        let address = match (page, self.talks.address.as_str()) {
            (Some(page), "") => page,
            (_, address) => address,
        };

        let base = address.split('#').next().unwrap_or_default();
        match (base, self.lessons.open_question()) {
            ("", _) => String::new(),
            // As in links to lessons, English is not named, so that readers of other languages get theirs.
            (base, Some(_)) if is_english(&self.lessons.language) => format!("{base}#card"),
            (base, Some(_)) => format!("{base}#card&language={}", self.lessons.language),
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
    #[must_use]
    pub fn saved_record(&self) -> Option<&TalkRecord> {
        let record = &self.talks.record;
        (self.talks.is_kept && *record != TalkRecord::default()).then_some(record)
    }

    /// Takes the votes and drawings that were saved with a session.
    pub fn take_record(&mut self, view: &serde_json::Value) {
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

    /// Applies a command that concerns the talk's windows, tools and covers alone.
    fn apply(&mut self, command: &TalkCommand) {
        match *command {
            TalkCommand::Blank => self.toggle_cover(Cover::Blank),
            TalkCommand::ToggleNotes => self.windows.notes = !self.windows.notes,
            TalkCommand::NotesClosed => self.windows.notes = false,
            TalkCommand::StageClosed => self.windows.stage = false,
            TalkCommand::OpenStage => self.windows.stage = true,
            TalkCommand::Swap => self.windows.are_swapped = !self.windows.are_swapped,
            TalkCommand::Tool(tool) => {
                // The tool that is in the hand is put down by its own key.
                self.tool = if self.tool == tool { Tool::Hand } else { tool };
                (self.pointer, self.is_drawing) = (None, false);
            }
            TalkCommand::NextColor => self.color = (self.color + 1) % PenStroke::COLORS,
            TalkCommand::Point(at) => self.pointer = at,
            TalkCommand::Lift => self.is_drawing = false,
            TalkCommand::ToggleCode => self.toggle_cover(Cover::Code),
            // `Classroom::apply_to_talk` carries out all others.
            _ => {}
        }
    }
}
