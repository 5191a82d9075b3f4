//! The default session without a window: the same run, its table, its verdict, and pictures of its
//! stages. What `tilescope` does where there is no display.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, anyhow, ensure};
use clap::Args;
use tilescope_core::{Parameters, Run, Stage, sample};
use tilescope_figures::{PictureOptions, seam_window, stage_scene, to_png};
use tilescope_formats::write_whole;

use crate::facts::Facts;
use crate::make::from_run;
use crate::output::{self, Outcome};
use crate::progress::{Stopwatch, verifying};
use crate::{interrupt, verdict_code};

/// Arguments of `tilescope headless`.
#[derive(Debug, Args)]
pub struct HeadlessArguments {
    /// The folder to write to; it is made if it is missing
    #[arg(long, value_name = "FOLDER", default_value = OUT)]
    out: PathBuf,
}

/// Width of the part that pictures of seams show, in radii.
const WINDOW_RADII: f64 = 32.0;

const OUT: &str = "tilescope-out";

/// Why there is no window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HeadlessReason {
    /// No display is announced in the environment.
    NoDisplay,
    /// The window could not be opened.
    Failed(String),
}

impl fmt::Display for HeadlessReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay => f.write_str("There is no display for a window"),
            Self::Failed(why) => write!(f, "The window could not be opened ({why})"),
        }
    }
}

/// Runs the default session headless because no window could be opened, says why and how to open
/// one, and returns the process's exit code.
#[must_use]
pub fn run_headless(reason: &HeadlessReason) -> ExitCode {
    crate::exit_code(default_session(reason))
}

fn default_session(reason: &HeadlessReason) -> Result<u8> {
    output::emit(&format!("{reason}, so this runs without one.\n\n"))?;
    let outcome = session(Path::new(OUT));
    output::emit(
        "\nTo open the window, start tilescope where a display is (DISPLAY or WAYLAND_DISPLAY set);\n\
         on a server: xvfb-run tilescope, or ssh -X. `tilescope --help` shows the command line.\n",
    )?;
    outcome
}

/// Says why a link is not shown, and returns the process's exit code: nothing but a window shows it.
#[must_use]
pub fn refuse_link(reason: &HeadlessReason) -> ExitCode {
    crate::exit_code(Err(anyhow!("{reason}, and --link needs one")))
}

pub fn run(arguments: &HeadlessArguments) -> Result<u8> {
    session(&arguments.out)
}

fn session(folder: &Path) -> Result<u8> {
    interrupt::listen();
    let mut watch = Stopwatch::start();
    let parameters = Parameters::default();
    let run = sample(&parameters, &mut watch)?;
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let mut facts = Facts::of_run(&parameters, &run.domain, None)?;
    facts.seconds = watch.take();
    let made = from_run(&run, facts);
    let path = folder.join("set.csv");
    let context = made.facts.context();
    let exported =
        verifying(|control| tilescope_formats::export(&path, &made.set, &context, control))
            .with_context(|| path.display().to_string())?;
    let outcome = Outcome {
        facts: &made.facts,
        count: made.set.len() as u64,
        report: Some(&exported.report),
        saved: Some(&exported.certificate_path),
        warnings: Vec::new(),
    };
    output::emit(&format!(
        "{}set            {}\n",
        output::text(&outcome),
        path.display()
    ))?;
    for picture in pictures(&run, folder)? {
        output::emit(&format!("picture        {}\n", picture.display()))?;
    }
    Ok(verdict_code(exported.report.valid()))
}

/// Draws every stage and returns the files.
fn pictures(run: &Run, folder: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for (number, stage) in run.stages().into_iter().enumerate() {
        let name = match stage {
            Stage::Iterate(k) => format!("iterate-{k}"),
            other => other.to_string(),
        };
        ensure!(!interrupt::requested(), "cancelled before picture {number}");
        let path = folder.join(format!("{number}-{name}.png"));
        // What happens at seams is too small to be seen in a picture of the whole domain.
        let at_seams = matches!(stage, Stage::Tile | Stage::Eliminate | Stage::Iterate(_));
        let window = at_seams.then(|| seam_window(run, WINDOW_RADII));
        let options = PictureOptions {
            window,
            ..PictureOptions::default()
        };
        let scene = stage_scene(run, stage, &options);
        write_whole(&path, &to_png(&scene, 1.0)?)?;
        paths.push(path);
    }
    Ok(paths)
}
