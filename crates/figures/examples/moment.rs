//! Pictures of moments of a small run: `cargo run --release -p tilescope-figures --example moment FOLDER`.

use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;

use tilescope_core::{Moment, Parameters, PatternSpec, Unobserved, Verdict};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_figures::animation::{write_apng, write_gif};
use tilescope_figures::{MomentOptions, Palette, moment_scene, to_pixels, to_png, to_svg};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let folder = std::env::args().nth(1).ok_or("usage: moment FOLDER")?;
    let folder = PathBuf::from(folder);
    let parameters = Parameters {
        radius: 1.0 / 24.0,
        leaf: 6.0,
        seed: 5,
        pattern: PatternSpec {
            side: 20.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved)?;
    let eliminated = nth(&recording, 30, |m| matches!(m, Moment::Eliminate { .. }));
    let accepted = |m: &Moment| {
        matches!(
            m,
            Moment::Candidate {
                verdict: Verdict::Accepted,
                ..
            }
        )
    };
    let rejected = |m: &Moment| {
        matches!(
            m,
            Moment::Candidate {
                verdict: Verdict::Covered { .. },
                ..
            }
        )
    };
    for (name, cursor) in [
        (
            "tiled",
            nth(&recording, 300, |m| matches!(m, Moment::Tiled { .. })),
        ),
        ("eliminated", eliminated),
        ("accepted", nth(&recording, 5, accepted)),
        ("rejected", nth(&recording, 5, rejected)),
        (
            "inserted",
            nth(&recording, 3, |m| matches!(m, Moment::Insert { .. })),
        ),
    ] {
        let scene = moment_scene(
            &recording,
            cursor,
            &MomentOptions::around(&recording, cursor, 11.0),
        );
        fs::write(folder.join(format!("{name}.png")), to_png(&scene, 1.0)?)?;
        fs::write(folder.join(format!("{name}.svg")), to_svg(&scene)?)?;
    }
    let options = MomentOptions {
        size: [480.0, 480.0],
        scale: 42.0,
        palette: Palette::DARK,
        ..MomentOptions::around(&recording, eliminated, 11.0)
    };
    let start = eliminated.saturating_sub(12);
    let frames = || {
        (start..start + 24)
            .map(|cursor| to_pixels(&moment_scene(&recording, cursor, &options), 1.0))
    };
    let metadata = [("seed".to_owned(), parameters.seed.to_string())];
    let mut go_on = |_, _| ControlFlow::Continue(());
    let gif = fs::File::create(folder.join("steps.gif"))?;
    write_gif(frames(), 50, &metadata, gif, &mut go_on)?;
    let apng = fs::File::create(folder.join("steps.png"))?;
    write_apng(frames(), 50, &metadata, apng, &mut go_on)?;
    Ok(())
}

/// The cursor behind the event that fulfils a condition for the `n`-th time, or behind all.
fn nth(recording: &Recording, n: usize, fulfils: impl Fn(&Moment) -> bool) -> usize {
    let found = recording
        .tape()
        .from(0)
        .filter(|(_, event)| event.moment().is_some_and(|m| fulfils(&m)));
    found
        .map(|(index, _)| index + 1)
        .nth(n)
        .unwrap_or(recording.len())
}
