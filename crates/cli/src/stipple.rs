//! `tilescope stipple`: dots as dense as an image is dark, in exactly the number that is asked for.

use std::path::PathBuf;

use anyhow::{Context, Result, anyhow, ensure};
use clap::{Args, ValueEnum};
use serde_json::json;
use tilescope_analysis::VaryingRegion;
use tilescope_core::{Parameters, grouped};
use tilescope_figures::{FigureError, on_paper, to_png_controlled};
use tilescope_formats::{Drawing, ExportContext, Format, Precision, write_whole};
use tilescope_sets::{
    DEFAULT_WHITE, Made, Stipple, StippleLook, StippleRecipe, Tone, VaryingError, color_of,
};

use crate::engine::ThreadArguments;
use crate::ground::image;
use crate::interrupt;
use crate::make::Worked;
use crate::options::{PRECISIONS, formats, named};
use crate::output::{self, Outcome, Work};
use crate::paths::{check_file, check_inputs_stay, check_target_beside, extension};
use crate::progress::Stopwatch;

/// Arguments of `tilescope stipple`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct StippleArguments {
    /// The image: JPEG or PNG
    image: PathBuf,
    /// How many dots there are to be: exactly so many
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    dots: u64,
    /// The picture or the point set to write: .svg is both, .png a picture alone, and other extensions are point sets
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Seed of the dots; the same one gives the same dots
    #[arg(long, value_name = "SEED", default_value_t = Parameters::default().seed)]
    seed: u64,
    #[command(flatten)]
    tone: ToneArguments,
    #[command(flatten)]
    look: LookArguments,
    /// Make dots beyond the frame, too, and drop them: at a border there are a few more dots otherwise. Places at the frame
    /// are then covered less well, as the certificate says
    #[arg(long)]
    run_on: bool,
    /// Width of the image in the units of the dots' positions and radii; if not given its width in pixels
    #[arg(long, value_name = "W")]
    width: Option<f64>,
    /// Format of the file, if its extension does not name one
    #[arg(long, value_name = "FORMAT", value_parser = formats(), requires = "out")]
    format: Option<Format>,
    /// Number type, for formats that leave the choice: f32 or f64
    #[arg(long, value_parser = named::<Precision>(&PRECISIONS), default_value = "f64", requires = "out")]
    precision: Precision,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// How dark the places of an image are.
#[derive(Debug, Args)]
#[command(next_help_heading = "Tone")]
struct ToneArguments {
    /// Raise the light of pixels to this power: 2.2 gives dots by the light that a screen sends, which is darker
    #[arg(long, value_name = "G", default_value_t = 1.0)]
    gamma: f64,
    /// Multiply differences from half grey by this
    #[arg(long, value_name = "C", default_value_t = 1.0)]
    contrast: f64,
    /// Dots where the image is light. Paper is then black and ink white, unless they are given
    #[arg(long)]
    invert: bool,
    /// No dots at all where the image is lighter than this share of black: white stays clean. 0 leaves nothing out
    #[arg(long, value_name = "D", default_value_t = DEFAULT_WHITE)]
    white: f64,
}

/// How pictures look.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures")]
struct LookArguments {
    /// Colour of the paper, as #rrggbb
    #[arg(long, value_name = "COLOR", value_parser = color_of)]
    paper: Option<[u8; 3]>,
    /// Colour of the ink, as #rrggbb
    #[arg(long, value_name = "COLOR", value_parser = color_of)]
    ink: Option<[u8; 3]>,
    /// How large dots are
    #[arg(long, value_enum, default_value = "constant")]
    dot_size: DotSize,
    /// Radius of a dot where the image is black, in the units of --width; if not given, such that all dots together have
    /// as much ink as the image is dark
    #[arg(long, value_name = "R")]
    dot_radius: Option<f64>,
    /// Width of a PNG picture in pixels
    #[arg(long, value_name = "PX", default_value_t = 1600)]
    size: u32,
}

/// The extension of pictures without points.
const PICTURE: &str = "png";

/// How large dots are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DotSize {
    /// All the same: darkness is the number of dots
    Constant,
    /// The darker the larger: more contrast
    Darkness,
}

const EXAMPLES: &str = "\
The set is the first N dots of a larger one, and certified as such: no two dots are near each other, and every place
is within the stated factor of its radius, as it was measured. `tilescope verify` says \"prefix\", not \"maximal\", and
needs the image.

Examples:
  tilescope stipple photo.jpg --dots 50000 --out photo.svg
  tilescope verify photo.svg --density-image photo.jpg
  tilescope stipple photo.jpg --dots 20000 --gamma 1.5 --contrast 1.2 --dot-size darkness --out photo.png --size 3000
  tilescope stipple moon.png --dots 30000 --invert --run-on --out moon.svg
  tilescope stipple photo.jpg --dots 50000 --width 200 --out plotter.csv";

/// Makes a set of dots from an image, writes it and prints its report.
pub fn run(arguments: &StippleArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    // The dots take longest, so that the options of the file and of the picture are checked before.
    arguments.check_out()?;
    arguments.look.check()?;
    let recipe = arguments.recipe()?;

    let mut watch = Stopwatch::start();
    let made = recipe.make(&mut watch);
    let stipple = made.map_err(|error| of_dots(error, arguments.dots))?;
    let drawing = arguments.look.drawing(&stipple, arguments.tone.invert);
    let remarks = remarks(&stipple);
    let found = json!({
        "made": stipple.made.facts.made,
        "runs": stipple.runs,
        "black_radius": stipple.black,
        "capped_pixels": stipple.capped,
    });
    let worked = Worked {
        made: stipple.made,
        work: Work::on_cpu(&mut watch),
    };

    let mut outcome = arguments.saved(worked, drawing)?;
    outcome.warnings.extend(remarks);
    output::report(
        arguments.json,
        || to_json(&outcome, &found),
        || outcome.text(),
    )?;
    Ok(outcome.code())
}

impl StippleArguments {
    /// Refuses a file that could not be written at its end, or that is the image.
    fn check_out(&self) -> Result<()> {
        let Some(path) = &self.out else {
            return Ok(());
        };
        if self.is_picture() {
            check_file(path)?;
        } else {
            check_target_beside(path, self.format, "--format", &[PICTURE])?;
        }
        check_inputs_stay(path, [self.image.as_path()])
    }

    /// Returns whether the output is a picture without points, which has no certificate.
    fn is_picture(&self) -> bool {
        let is_png = |path: &PathBuf| extension(path) == PICTURE;
        self.format.is_none() && self.out.as_ref().is_some_and(is_png)
    }

    /// Returns what the arguments ask for.
    fn recipe(&self) -> Result<StippleRecipe> {
        let tone = Tone {
            gamma: self.tone.gamma,
            contrast: self.tone.contrast,
            is_inverted: self.tone.invert,
        };
        Ok(StippleRecipe {
            image: image(&self.image, "IMAGE")?.toned(tone)?,
            white: self.tone.white,
            dots: self.dots,
            width: self.width,
            runs_on: self.run_on,
            seed: self.seed,
        })
    }

    /// Verifies a stipple and writes it, if it is to be written.
    fn saved(&self, worked: Worked, drawing: Drawing) -> Result<Outcome> {
        let context = ExportContext {
            format: self.format,
            precision: self.precision,
            drawing: Some(drawing),
            ..worked.made.facts.context()
        };
        let picture_path = self.out.as_deref().filter(|_| self.is_picture());
        let Some(path) = picture_path else {
            return worked.finish(self.out.as_deref(), &context);
        };

        // `finish` consumes the set, so that the picture is drawn before. The picture is written only when there is a
        // verdict.
        let picture = picture(&worked.made, &context, self.look.size)?;
        let outcome = worked.finish(None, &context)?;
        interrupt::check("the picture")?;
        write_whole(path, &picture)?;
        Ok(outcome)
    }
}

impl LookArguments {
    /// Refuses dots that no picture can show.
    fn check(&self) -> Result<()> {
        if let Some(radius) = self.dot_radius {
            ensure!(
                radius > 0.0 && radius.is_finite(),
                "--dot-radius is {radius}; it must be above 0"
            );
        }
        Ok(())
    }

    /// Returns how pictures show a stipple.
    fn drawing(&self, stipple: &Stipple, is_inverted: bool) -> Drawing {
        let look = StippleLook {
            paper: self.paper,
            ink: self.ink,
            by_darkness: self.dot_size == DotSize::Darkness,
            dot_radius: self.dot_radius,
        };
        let judged = &stipple.ground.varying.judged;
        look.drawing(stipple.black, judged, &stipple.made.set.points, is_inverted)
    }
}

/// Names the option that a radius follows from, where the radius is refused.
fn of_dots(error: VaryingError, dots: u64) -> anyhow::Error {
    match error {
        VaryingError::Domain(_) => anyhow!(error).context(format!("--dots {dots} are too few")),
        VaryingError::Fine { .. } => anyhow!(error).context(format!("--dots {dots} are too many")),
        _ => error.into(),
    }
}

/// Returns the radius at each dot; nothing for a set of one radius, which a stipple never is.
fn radii(made: &Made) -> Vec<f64> {
    let judged = made.facts.varying.as_ref().map(|varying| &varying.judged);
    let points = judged.map(|judged| (judged, &made.set.points));
    let of = |(judged, points): (&VaryingRegion, &Vec<[f64; 2]>)| {
        points
            .iter()
            .map(|&point| judged.radius_at(point))
            .collect()
    };
    points.map(of).unwrap_or_default()
}

/// Returns the picture of a stipple as a PNG file.
fn picture(made: &Made, context: &ExportContext, columns: u32) -> Result<Vec<u8>> {
    let drawing = (context.drawing.as_ref()).context("no colours are chosen")?;
    let dots = (made.set.points.iter().copied()).zip(radii(made));
    let dots = dots.map(|(at, own)| (at, drawing.dots.radius(own)));
    let colors = [drawing.paper, drawing.ink];
    let scene = on_paper(context.region.size(), columns, colors, dots);
    // The scene is laid out in pixels already.
    let scale = 1.0;
    match to_png_controlled(&scene, scale, &mut |_, _| interrupt::flow()) {
        // Only a request to end cancels the picture. The caller checks for it before it writes, and reports it.
        Err(FigureError::Cancelled) => Ok(Vec::new()),
        drawn => Ok(drawn?),
    }
}

/// Returns the notes on a stipple.
fn remarks(stipple: &Stipple) -> Vec<String> {
    let kept = grouped(stipple.made.set.len() as u64);
    // A stipple's facts always have this number; those of other sets do not.
    let made = stipple.made.facts.made.map(grouped).unwrap_or_default();
    let mut remarks = vec![format!(
        "note: the dots are the first {kept} of {made}, by their arrival; {} runs were made",
        stipple.runs
    )];
    if stipple.capped > 0 {
        let capped = grouped(stipple.capped as u64);
        remarks.push(format!(
            "note: {capped} pixels are too light for the largest radius, 64 times the least at most, and have that radius: \
             dots are denser there than the image is dark; --white leaves light places out"
        ));
    }
    remarks
}

/// Returns the report on a stipple, with the numbers that only stipples have.
fn to_json(outcome: &Outcome, found: &serde_json::Value) -> serde_json::Value {
    let mut object = outcome.json();
    for (name, value) in found.as_object().into_iter().flatten() {
        object[name] = value.clone();
    }
    object
}
