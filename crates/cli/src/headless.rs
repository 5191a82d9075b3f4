//! `tilescope headless`: the run of the default session with its table, its verdict and pictures of its stages. It also
//! runs if the window cannot open.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, anyhow};
use clap::Args;
use tilescope_core::{Parameters, Run, Stage, sample};
use tilescope_drawing::picture::{MomentView, PictureView, scene};
use tilescope_figures::to_png;
use tilescope_formats::write_whole;
use tilescope_session::Session;
use tilescope_session::moment::Moment;
use tilescope_sets::{Facts, Made, stated};

use crate::interrupt;
use crate::make::Worked;
use crate::output::{self, Work};
use crate::paths::named;
use crate::progress::Stopwatch;

/// Arguments of `tilescope headless`.
#[derive(Debug, Args)]
pub struct HeadlessArguments {
    /// The folder to write to; it is made if it is missing
    #[arg(long, value_name = "FOLDER", default_value = OUT)]
    out: PathBuf,
}

/// The side of a picture's frame in points, and the pixels of a point.
const SIDE: f64 = 640.0;
const SCALE: f64 = 2.0;

const OUT: &str = "tilescope-out";

/// Why there is no window.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HeadlessReason {
    /// No display is announced in the environment.
    #[error("There is no display for a window")]
    NoDisplay,
    /// The program was built without the window.
    #[error("This build has no window")]
    NotBuilt,
    /// The window could not be opened.
    #[error("The window could not be opened ({0})")]
    Failed(String),
}

/// Runs the default session without a window, prints why there is none and how to open one, and returns the process's
/// exit code.
#[must_use]
pub fn run_headless(reason: &HeadlessReason) -> ExitCode {
    crate::exit_code(default_session(reason))
}

/// Runs the default session without a window, and says how to open one.
fn default_session(reason: &HeadlessReason) -> Result<u8> {
    output::emit(&format!("{reason}, so this runs without one.\n\n"))?;
    // A failure is returned only at the end, since the advice is most useful where nothing works.
    let outcome = session(Path::new(OUT));
    let advice = match reason {
        HeadlessReason::NotBuilt => {
            "To open the window, build tilescope with its feature window, which is on by default."
        }
        HeadlessReason::NoDisplay | HeadlessReason::Failed(_) => {
            "To open the window, start tilescope where a display is (DISPLAY or WAYLAND_DISPLAY set);\n\
             on a server: xvfb-run tilescope, or ssh -X."
        }
    };
    output::emit(&format!(
        "\n{advice} `tilescope --help` shows the command line.\n"
    ))?;
    outcome
}

/// Reports that a link needs a window, and returns the process's exit code.
#[must_use]
pub fn refuse_link(reason: &HeadlessReason) -> ExitCode {
    crate::exit_code(Err(anyhow!("{reason}, and --link needs one")))
}

/// Reports that a file that was to be opened needs a window, and returns the process's exit code.
#[must_use]
pub fn refuse_file(file: &Path, reason: &HeadlessReason) -> ExitCode {
    let file = file.display();
    crate::exit_code(Err(anyhow!("{reason}, and {file} is opened in one")))
}

pub fn run(arguments: &HeadlessArguments) -> Result<u8> {
    session(&arguments.out)
}

/// Makes the default set, and writes it with its certificate and a picture of each stage into a folder.
fn session(folder: &Path) -> Result<u8> {
    interrupt::listen();
    let mut watch = Stopwatch::start();
    let parameters = Parameters::default();
    let run = sample(&parameters, &mut watch)?;
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", named(folder)))?;

    // The pictures need the run itself, not only its set.
    let made = Made::of_run(&run, Facts::new("kdrt", stated(&parameters), &run.domain));
    let context = made.facts.context();
    let work = Work::on_cpu(&mut watch);
    let path = folder.join("set.csv");
    let mut outcome = Worked { made, work }.finish(Some(&path), &context)?;
    // Notes on the limits of CSV would distract from a first look.
    outcome.warnings.clear();
    let (text, file) = (outcome.text(), named(&path));
    output::emit(&format!("{text}set            {file}\n"))?;
    for picture in pictures(run, folder)? {
        output::emit(&format!("picture        {}\n", named(&picture)))?;
    }
    Ok(outcome.code())
}

/// Draws every stage and returns the files.
fn pictures(run: Run, folder: &Path) -> Result<Vec<PathBuf>> {
    // Sessions are numbered where one follows another, as in the window; here there is one.
    let session = Session::from_run(run, 0);
    let mut paths = Vec::new();
    // The number comes first in a name, so that lists of the folder have the stages in their order.
    for (number, &stage) in session.stages.iter().enumerate() {
        let name = match stage {
            Stage::Iterate(k) => format!("iterate-{k}"),
            other => other.to_string(),
        };
        interrupt::check("the next picture")?;

        let shown = MomentView {
            moment: Moment::after(&session, number),
            view: PictureView::of_stage(&session, stage, SIDE),
        };
        let path = folder.join(format!("{number}-{name}.png"));
        // No sample is chosen whose causes the picture could show.
        let causes = None;
        write_whole(&path, &to_png(&scene(&session, &shown, causes), SCALE)?)?;
        paths.push(path);
    }
    Ok(paths)
}
