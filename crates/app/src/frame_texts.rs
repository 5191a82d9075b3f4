//! All texts of a frame, and the search of a lesson's frames for texts that give an answer away. The window is drawn without
//! a screen, so that this works on every machine.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Context, FullOutput, RawInput, Rect, Shape, pos2, vec2};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_lessons::{LessonError, Question, leak};
use tilescope_workbench::Command;

use crate::App;

/// The window in which questions are shown, in points.
const SIZE: [f32; 2] = [1280.0, 720.0];
/// The number of seeds whose runs show a question, besides the run of its step. Few suffice, since the texts of the window
/// differ between runs in numbers alone.
const SEEDS: u64 = 2;
/// The frames until a panel that has opened is laid out.
const FRAMES: usize = 3;
/// The most waits for work until a run has the moment of a question: more than the seeds that practice tries for it.
const MAX_RUNS: usize = 60;

/// Returns all texts of a frame: those that are drawn, and those of the accessibility tree if it is on.
#[must_use]
pub fn texts_of(output: &FullOutput) -> BTreeSet<String> {
    let mut texts = BTreeSet::new();
    for clipped in &output.shapes {
        add_drawn(&clipped.shape, &mut texts);
    }

    let update = output.platform_output.accesskit_update.iter();
    // A text that only screen readers say may give an answer away as well.
    for (_, node) in update.flat_map(|update| &update.nodes) {
        let said = [
            node.label(),
            node.value(),
            node.description(),
            node.tooltip(),
        ];
        texts.extend(said.into_iter().flatten().map(str::to_owned));
    }
    texts
}

fn add_drawn(shape: &Shape, texts: &mut BTreeSet<String>) {
    match shape {
        Shape::Text(text) => {
            texts.insert(text.galley.text().to_owned());
        }
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| add_drawn(shape, texts)),
        _ => {}
    }
}

/// A window without a screen.
struct Unseen {
    context: Context,
    app: App,
}

impl Unseen {
    fn new() -> Self {
        let context = Context::default();
        context.enable_accesskit();
        let app = App::new(&context);
        Self { context, app }
    }

    /// Sends a command, and waits for its work.
    fn send(&mut self, command: LessonCommand) {
        self.app.state.apply(Command::Lesson(command));
        for _ in 0..MAX_RUNS {
            self.app.state.settle();
            let open = self.app.state.lessons().open.as_ref();
            // While a learner practises, a run that lacks the question's moment is followed by the run of another seed.
            if open.is_none_or(|open| open.fault.is_some() || open.learner.scene().is_some()) {
                break;
            }
        }
    }

    /// Returns all texts of the window as it is now.
    fn texts(&mut self) -> BTreeSet<String> {
        let [width, height] = SIZE;
        let mut texts = BTreeSet::new();
        // A panel that opens is laid out only in later frames.
        for _ in 0..FRAMES {
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height))),
                ..RawInput::default()
            };
            let app = &mut self.app;
            let output = self.context.run_ui(input, |ui| app.show(ui));
            self.app.state.settle();
            texts = texts_of(&output);
        }
        texts
    }
}

/// The texts of the window while a question is open, in one run.
pub struct Asked {
    /// The line of the question in the lesson's file.
    pub line: usize,
    /// The question that is open.
    pub question: Question,
    /// All texts of the frame.
    pub texts: BTreeSet<String>,
}

/// Shows each question of a lesson in a window without a screen, in its own run and in a few of practice, and returns all
/// texts of each frame.
///
/// # Errors
///
/// Why the lesson cannot be shown.
pub fn asked(name: &str, text: &str) -> Result<Vec<Asked>, String> {
    let mut window = Unseen::new();
    window.send(LessonCommand::Read(name.to_owned(), text.to_owned()));
    let open = window.app.state.lessons().open.as_ref();
    let lesson = open
        .map(|open| Arc::clone(open.learner.lesson()))
        .ok_or_else(|| format!("the window cannot show the lesson {name}"))?;

    let mut all = Vec::new();
    for (step, gate) in lesson.gates() {
        // Only a question with practice has runs of other seeds.
        let practised = gate.practice.as_ref().map_or(0, |_| SEEDS);
        let mut commands = vec![LessonCommand::Go(step.name.clone())];
        commands.extend((0..practised).map(LessonCommand::Practise));
        for command in commands {
            window.send(command);
            let texts = window.texts();
            let open = window.app.state.lessons().open.as_ref();
            let question = open.and_then(|open| open.learner.question().cloned());
            // A run that lacks the question's moment opens no question. Another check names that as a fault.
            all.extend(question.map(|question| Asked {
                line: gate.line,
                question,
                texts,
            }));
        }
    }
    Ok(all)
}

/// Returns the faults of a lesson's questions whose answer a text on the screen gives away, one for each question.
///
/// # Errors
///
/// Those of [`asked`].
pub fn leaks(name: &str, text: &str) -> Result<Vec<LessonError>, String> {
    let asked = asked(name, text)?;
    let leaking = asked.iter().filter_map(|asked| {
        let why = leak(&asked.question, &asked.texts)?;
        let message = format!("the window gives the answer away: {why}");
        Some(LessonError::new(asked.line, message))
    });
    let mut faults: Vec<LessonError> = leaking.collect();
    faults.dedup_by_key(|fault| fault.line);
    Ok(faults)
}
