//! Writes a picture of every step of lessons, of a question open and closed, with all texts of its frame, for people who read them:
//! `cargo run -p tilescope-app --example gates -- FOLDER [WIDTHxHEIGHT] [LANGUAGE] [LESSON ...]`.

use std::path::PathBuf;

use egui_kittest::Harness;
use tilescope_app::{App, frame_texts};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_workbench::Command;

type Fault = Box<dyn std::error::Error>;

fn main() -> Result<(), Fault> {
    let mut arguments = std::env::args().skip(1);
    let folder: PathBuf = arguments
        .next()
        .ok_or("usage: gates FOLDER [WIDTHxHEIGHT] [LANGUAGE] [LESSON ...]")?
        .into();
    let size = arguments.next().unwrap_or_else(|| "1280x720".to_owned());
    let (width, height) = size
        .split_once('x')
        .ok_or("a size is of the form 1280x720")?;
    let size = [width.parse::<f32>()?, height.parse()?];
    let language = arguments.next().unwrap_or_else(|| "en".to_owned());
    let wanted: Vec<String> = arguments.collect();
    std::fs::create_dir_all(&folder)?;

    let mut harness: Harness<'_, App> = Harness::builder()
        .with_size(size)
        .with_max_steps(50_000)
        .wgpu()
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    let shelf = &harness.state().state.lessons().shelf;
    let names: Vec<String> = shelf.iter().map(|lesson| lesson.name.to_string()).collect();
    for name in names {
        if !wanted.is_empty() && !wanted.contains(&name) {
            continue;
        }
        send(&mut harness, LessonCommand::Open(name.clone()));
        send(&mut harness, LessonCommand::Language(language.clone()));
        let open = harness.state().state.lessons().open.as_ref();
        let lesson = open.ok_or("no lesson is open")?.learner.lesson().clone();
        for (number, step) in lesson.steps.iter().enumerate() {
            send(&mut harness, LessonCommand::Go(step.name.clone()));
            let file = folder.join(format!("{name}-{:02}", number + 1));
            keep(&mut harness, &file.with_extension("open"))?;

            if step.gate.is_none() {
                continue;
            }
            // The second click shows the answer; a trace has one for each event.
            while harness.state().state.lessons().open_question().is_some() {
                send(&mut harness, LessonCommand::GiveUp);
            }
            keep(&mut harness, &file.with_extension("closed"))?;
        }
        send(&mut harness, LessonCommand::Leave);
    }
    Ok(())
}

fn send(harness: &mut Harness<'_, App>, command: LessonCommand) {
    harness.state_mut().state.apply(Command::Lesson(command));
    // The run of a step may need several rounds of work in the background.
    for _ in 0..3 {
        harness.state_mut().state.settle();
        harness.run();
    }
}

/// Writes FILE.png, a picture of the window, and FILE.txt, all its texts.
fn keep(harness: &mut Harness<'_, App>, file: &std::path::Path) -> Result<(), Fault> {
    let named = |ending: &str| {
        let mut name = file.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    harness.render()?.save(named(".png"))?;
    let texts = frame_texts::texts_of(harness.output());
    let texts: Vec<String> = texts.into_iter().collect();
    std::fs::write(named(".txt"), texts.join("\n"))?;
    Ok(())
}
