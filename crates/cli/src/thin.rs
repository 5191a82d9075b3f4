//! `tilescope thin`: the points of a file that are kept so that no two are near each other.

mod space;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::{Value, json};
use tilescope_analysis::{Boundary, Region, ThinnedReport};
use tilescope_core::memory::ask;
use tilescope_formats::{
    Certificate, CertificateUse, CertifiedRadius, Format, Hint, KeptRows, certificate_path,
    destination, read_whole, write_certified,
};
use tilescope_sets::RadiusSource;
use tilescope_sets::thinning::{
    FirstValue, PointFile, ThinFileError, ThinRadius, ThinRecipe, Thinning, ThinningPriority,
};

use crate::engine::ThreadArguments;
use crate::ground::{file_name, formula, image};
use crate::options::{XY, boundaries, columns, formats, pair};
use crate::paths::{InFile, check_file, check_inputs_stay, named};
use crate::progress::{verifying, watched};
use crate::radius_span::{RadiusSpan, TWO_RADII};
use crate::{interrupt, output, verdict_code};

/// Arguments of `tilescope thin`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is an option of its own"
)]
pub struct ThinArguments {
    /// The points: a text table, PLY, NPY, JSON, `GeoJSON` or a file of psa or UTK
    input: PathBuf,
    /// Keep no two points that are closer than R; with --radius-image MIN..MAX, the radii of black and of white
    #[arg(long, value_name = "R", value_parser = RadiusSpan::parse)]
    radius: Option<RadiusSpan>,
    /// The radius of each point as a function of its x and y, such as '0.5 + 0.01*x'; `tilescope sample --help` lists the
    /// functions. Two points of radii a and b are kept if they are 2ab / (a + b) apart
    #[arg(long, value_name = "FORMULA", conflicts_with_all = ["radius", "radius_image"])]
    radius_expression: Option<String>,
    /// The radius of each point from the grey of a PNG image, whose pixels are squares and fill the domain: without --width and
    /// --height the smallest rectangle of the image's proportions that begins at the lower corner of the points and holds all
    #[arg(long, value_name = "PNG", requires = "radius")]
    radius_image: Option<PathBuf>,
    /// The radius of each point from a column or a property of the file; two points are kept as by --radius-expression
    #[arg(long, value_name = "NAME", conflicts_with_all = ["radius", "radius_expression", "radius_image"])]
    radius_column: Option<String>,
    /// In which order points are taken: `order`, that of the file; `column NAME`, by the numbers in a column or a property, the
    /// least first; `random`, as --seed draws it. Of equal ones the first in the file comes first
    #[arg(long, num_args = 1..=2, value_names = ["ORDER", "NAME"], default_value = "order")]
    priority: Vec<String>,
    /// Take the greatest value of a column first
    #[arg(long)]
    greatest_first: bool,
    /// The seed of --priority random; if not given, 1
    #[arg(long)]
    seed: Option<u64>,
    /// Thin by x and y alone, whatever z is. Without this, points of which one has a z other than 0 are thinned in space
    #[arg(long)]
    xy: bool,
    /// Write the kept points, in the format of the input and with all of their columns, and a certificate beside the file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Width of the domain, beside --height; without sides it is the rectangle around the points. With --radius-image one of the
    /// two is enough
    #[arg(long, value_name = "W")]
    width: Option<f64>,
    /// Height of the domain
    #[arg(long, value_name = "H")]
    height: Option<f64>,
    /// How the domain ends: at a periodic border, points are near points at the other side
    #[arg(long, value_parser = boundaries())]
    boundary: Option<Boundary>,
    /// The lower corner of the domain; if not given, 0 0
    #[arg(long, num_args = 2, value_names = ["X", "Y"])]
    origin: Option<Vec<f64>>,
    /// Format of the input, if neither its extension nor its content names one
    #[arg(long, value_name = "FORMAT", value_parser = formats())]
    format: Option<Format>,
    /// The columns of x and y in a text table, each by its name, or by its number from 1. A column z may then be anything
    #[arg(long, num_args = 2, value_names = ["A", "B"])]
    columns: Option<Vec<String>>,
    /// Which set of a file that holds several, from 0
    #[arg(long, value_name = "I")]
    set: Option<usize>,
    /// Take the points of a .geojson file as positions in a plane, though they may be longitudes and latitudes
    #[arg(long)]
    planar: bool,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Points are taken one by one, and each is kept unless a kept one is closer than the radius. Nothing is moved
or made; rows are copied to the byte. The result is judged: no two kept points are near each other, and each
point left out is near one that was kept earlier, which only one choice fulfils. It is the same on every
machine and for any number of threads. Distances are compared exactly: the differences of coordinates are
doubles, as subtraction rounds them, and from there nothing is rounded. Points exactly R apart both stay; of
copies the first one stays. Points of which one has a z other than 0 lie in space, with one radius and
without a domain; --xy thins them by x and y. Faces and edges of a PLY mesh are left out, other elements stay. `tilescope
verify` judges the file again, with --source against the points that it was chosen from.

Examples:
  tilescope thin cloud.ply --radius 0.5 --out thinned.ply
  tilescope thin terrain.ply --radius 0.5 --xy --out thinned.ply
  tilescope thin survey.csv --radius 2 --priority column height --greatest-first --out peaks.csv
  tilescope thin cloud.npy --radius 0.01 --priority random --seed 7 --out thinned.npy
  tilescope thin stars.csv --radius-expression '0.5 + 0.01*hypot(x, y)' --out thinned.csv
  tilescope thin trees.csv --radius-column crown --priority column height --greatest-first --out kept.csv
  tilescope thin tile.csv --radius 0.1 --width 4 --height 4 --boundary periodic --out thinned.csv
  tilescope verify thinned.ply --source cloud.ply";

/// The seed of a draw if none is given.
const SEED: u64 = 1;

pub fn run(arguments: &ThinArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    let thinned = make(arguments)?;
    output::report(arguments.json, || thinned.json(), || thinned.text())?;
    Ok(verdict_code(thinned.report.valid()))
}

/// Thins a file, has the choice judged, and writes it whatever the verdict, which the certificate states.
fn make(arguments: &ThinArguments) -> Result<ThinnedFile> {
    if let Some(path) = &arguments.out {
        // The certificate is written as well, and has to be a file that can be replaced.
        destination(&certificate_path(&destination(path)?))?;
        check_file(path)?;
        let inputs = [Some(&arguments.input), arguments.radius_image.as_ref()];
        check_inputs_stay(path, inputs.into_iter().flatten().map(PathBuf::as_path))?;
    }
    let recipe = arguments.recipe()?;
    let mut laps = Laps::start();

    let bytes = read_whole(&arguments.input)?;
    // Positions take 16 bytes for each point, as a rule no more than the file does. Memory for the rest is asked for
    // later.
    ask(bytes.len() as u64).in_file(&arguments.input)?;
    let name = file_name(&arguments.input);
    let file = match PointFile::new(&bytes, arguments.hint(&name)) {
        Ok(file) => file,
        // A third coordinate that is not 0, or a file of space alone.
        Err(planar) => {
            let file = space::read(&bytes, arguments, &name, planar).in_file(&arguments.input)?;
            return space::make(arguments, &recipe, &file, laps);
        }
    };
    // Points in a domain whose sides are given are taken for planar.
    if file.read.degrees && !arguments.planar && recipe.domain.is_none() {
        return Err(ThinFileError::Degrees).in_file(&arguments.input);
    }
    // The name is checked now, so that the command does not fail only after the work.
    if let Some(path) = &arguments.out {
        file.check_name(&file_name(path)).in_file(path)?;
    }
    // A choice needs the rank of each point in the order in which points are taken. A judge of kept points alone does
    // not.
    let with_ranks = true;
    let mut thinning = recipe
        .prepare(&file, with_ranks)
        .in_file(&arguments.input)?;
    arguments.state(&mut thinning, &name);
    laps.add("read");

    let points = file.points();
    let kept =
        watched("thin", |control| thinning.choose(points, control)).in_file(&arguments.input)?;
    laps.add("thin");

    let report = verifying(|control| thinning.judge(points, &kept, control))?;
    laps.add("verify");

    let mut written = None;
    if let Some(path) = &arguments.out {
        interrupt::check("the file was written")?;
        written = Some(write(&file, &thinning, &kept, &report, path)?);
        laps.add("write");
    }
    Ok(ThinnedFile {
        described: Described {
            radius: thinning.radius.clone(),
            region: json!(thinning.region),
            origin: json!(thinning.origin),
            domain: None,
            priority: thinning.priority().to_string(),
        },
        report,
        written,
        laps,
    })
}

/// Writes the kept points and their certificate.
fn write(
    file: &PointFile<'_>,
    thinning: &Thinning,
    kept: &[bool],
    report: &ThinnedReport,
    path: &Path,
) -> Result<Written> {
    let (name, mut rows) = (file_name(path), KeptRows::default());
    // Only points that are read back from the new bytes are certified.
    let chosen = file.keep(kept, &mut rows, &name).in_file(path)?;
    let certificate = thinning
        .certificate(file.points(), &chosen, report)
        .in_file(path)?;
    let certificate_path = write_certified(path, chosen.bytes, &certificate).in_file(path)?;
    // `chosen` borrows `rows`, whose list of left-out elements is moved out below.
    drop(chosen);
    Ok(Written {
        certificate,
        certificate_path,
        left_out: rows.left_out,
    })
}

impl ThinArguments {
    /// Returns how the input is read.
    fn hint<'a>(&'a self, name: &'a str) -> Hint<'a> {
        Hint {
            name,
            format: self.format,
            set: self.set,
            columns: columns(self.columns.as_deref()),
            certificate: CertificateUse::LeftOut,
            any_z: self.xy,
            ..Hint::default()
        }
    }

    /// Returns what the arguments ask for.
    fn recipe(&self) -> Result<ThinRecipe> {
        let radius = self.radius()?;
        // The pixels of an image are squares, so that one side gives the other.
        let pixels = match &radius {
            ThinRadius::Source(RadiusSource::Image { image, .. }) => Some(image.pixels()),
            ThinRadius::Source(_) | ThinRadius::Column(_) => None,
        };
        Ok(ThinRecipe {
            domain: self.domain(pixels)?,
            priority: self.priority()?,
            radius,
        })
    }

    /// Returns the domain and its lower corner, if a side is given; without a boundary it is bounded. Refuses a lone side
    /// without pixels, and other options of a domain without a side.
    fn domain(&self, pixels: Option<[usize; 2]>) -> Result<Option<(Region, [f64; 2])>> {
        let across = pixels.map(|[columns, rows]| columns as f64 / rows as f64);
        let size = match (self.width, self.height, across) {
            (Some(width), Some(height), _) => [width, height],
            (Some(width), None, Some(across)) => [width, width / across],
            (None, Some(height), Some(across)) => [height * across, height],
            (Some(_), None, None) => {
                bail!("--width needs --height; with --radius-image it follows")
            }
            (None, Some(_), None) => {
                bail!("--height needs --width; with --radius-image it follows")
            }
            (None, None, _) => {
                let why = "needs the sides of the domain: give --width and --height";
                ensure!(self.boundary.is_none(), "--boundary {why}");
                ensure!(self.origin.is_none(), "--origin {why}");
                return Ok(None);
            }
        };

        // A cloud goes around nothing unless that is asked for.
        let is_periodic = self.boundary == Some(Boundary::Periodic);
        let region = Region::new(size, is_periodic);
        Ok(Some((
            region,
            pair(self.origin.as_ref()).unwrap_or_default(),
        )))
    }

    /// Returns where the radii come from.
    fn radius(&self) -> Result<ThinRadius> {
        // Clap takes a column without any other radius.
        match &self.radius_column {
            Some(name) => Ok(ThinRadius::Column(name.clone())),
            None => self.source().map(ThinRadius::Source),
        }
    }

    /// Returns the radius of all points, or the field that has those of places.
    fn source(&self) -> Result<RadiusSource> {
        // Clap takes a formula only without --radius and an image.
        if let Some(text) = &self.radius_expression {
            return formula(text);
        }
        let span = self.radius.context(
            "give --radius R, or --radius-expression, --radius-image or --radius-column for radii that vary",
        )?;
        // The greys of an image lie between two radii, and without an image nothing has a use for a second one. A
        // single radius is the span's `least`.
        match (&self.radius_image, span.greatest) {
            (None, None) => Ok(RadiusSource::Constant(span.least)),
            (None, Some(_)) => bail!(TWO_RADII),
            (Some(_), None) => {
                bail!("--radius-image needs --radius MIN..MAX, the radii of black and of white")
            }
            (Some(path), Some(greatest)) => Ok(RadiusSource::Image {
                image: image(path, "--radius-image")?,
                radii: [span.least, greatest],
            }),
        }
    }

    /// Returns the order in which points are taken.
    fn priority(&self) -> Result<ThinningPriority> {
        // Clap takes one word or two, and does not read them.
        let words: Vec<&str> = self.priority.iter().map(String::as_str).collect();
        let priority = match words[..] {
            ["order"] => ThinningPriority::Order,
            ["random"] => ThinningPriority::Random {
                seed: self.seed.unwrap_or(SEED),
            },
            ["column", column] => ThinningPriority::Column {
                column: column.to_owned(),
                first: if self.greatest_first {
                    FirstValue::Greatest
                } else {
                    FirstValue::Least
                },
            },
            _ => bail!(
                "--priority {}: give order, random, or column with the name of a column",
                words.join(" ")
            ),
        };

        // An option without effect is refused, since the user expects one.
        let is_drawn = matches!(priority, ThinningPriority::Random { .. });
        ensure!(
            is_drawn || self.seed.is_none(),
            "--seed is that of --priority random; leave it out"
        );
        let is_column = matches!(priority, ThinningPriority::Column { .. });
        ensure!(
            is_column || !self.greatest_first,
            "--greatest-first is for --priority column NAME; leave it out"
        );
        Ok(priority)
    }

    /// States how the input was read, which is needed to read the result.
    fn state(&self, thinning: &mut Thinning, name: &str) {
        thinning.state("file", name.into());
        if self.xy {
            thinning.state(XY, true.into());
        }
        if let Some(columns) = &self.columns {
            thinning.state(COLUMNS, json!(columns));
        }
        if let Some(set) = self.set {
            thinning.state(SET, set.into());
        }
    }
}

/// The parameters of a certificate that say how its file is read.
pub const COLUMNS: &str = "columns";
pub const SET: &str = "set";

/// The seconds of each part of the work.
struct Laps {
    last: Instant,
    seconds: Vec<(&'static str, f64)>,
}

impl Laps {
    fn start() -> Self {
        Self {
            last: Instant::now(),
            seconds: Vec::new(),
        }
    }

    fn add(&mut self, name: &'static str) {
        let now = Instant::now();
        self.seconds.push((name, (now - self.last).as_secs_f64()));
        self.last = now;
    }
}

/// A file that was written.
struct Written {
    certificate: Certificate,
    certificate_path: PathBuf,
    /// The names of the elements of a PLY file that are not written, as they number vertices: faces and edges.
    left_out: Vec<String>,
}

/// By what a file was thinned.
struct Described {
    radius: CertifiedRadius,
    region: Value,
    origin: Value,
    /// The box of points in space, in words.
    domain: Option<String>,
    priority: String,
}

/// The set that was kept, and how it was judged.
struct ThinnedFile {
    described: Described,
    report: ThinnedReport,
    written: Option<Written>,
    laps: Laps,
}

impl ThinnedFile {
    /// Returns the report for programs. Fields of a file are null if none was written.
    fn json(&self) -> Value {
        let (written, described) = (self.written.as_ref(), &self.described);
        let seconds = self.laps.seconds.iter();
        let mut object = json!({
            "radius": described.radius,
            "region": described.region,
            "origin": described.origin,
            "priority": described.priority,
            "certificate": written.map(|file| file.certificate_path.display().to_string()),
            "positions_digest": written.map(|file| &file.certificate.positions_digest),
            "left_out": written.map(|file| &file.left_out),
            "seconds": seconds.map(|(name, time)| json!({ "stage": name, "seconds": time })).collect::<Value>(),
        });
        output::add(&mut object, report_json(&self.report));
        object
    }

    /// Returns the report in lines.
    fn text(&self) -> String {
        let Described {
            radius,
            domain,
            priority,
            ..
        } = &self.described;
        let radius = output::radius_text(radius);
        // Clouds of a plane are the usual ones; those in space are named as such.
        let space = domain
            .as_ref()
            .map_or_else(String::new, |domain| format!(" in space, {domain}"));

        let laps = self.laps.seconds.iter();
        let stages = laps.map(|(name, time)| format!("  {name:<12} {:>9.1} ms\n", time * 1e3));
        let mut out = format!(
            "thinned to r = {radius}{space}, taken by: {priority}\n\n{}\n{}",
            stages.collect::<String>(),
            report_text(&self.report)
        );
        if let Some(file) = &self.written {
            // Faces and edges number vertices by their places in the file, which the kept ones no longer have.
            for element in &file.left_out {
                let warning = format!("{element} numbers vertices, and is left out");
                out += &output::warning_line(&warning);
            }
            let _ = writeln!(out, "certificate    {}", named(&file.certificate_path));
        }
        out
    }
}

/// Returns the fields of a verdict on a thinned set.
pub fn report_json(report: &ThinnedReport) -> Value {
    json!({
        "given": report.given,
        "count": report.kept,
        "conflicts": report.conflicts,
        "uncovered": report.uncovered,
        "valid": report.valid(),
    })
}

/// Returns the verdict on a thinned set in a few lines.
pub fn report_text(report: &ThinnedReport) -> String {
    let mut out = format!(
        "given          {}\n\
         kept           {}\n\
         conflict-free  {}\n\
         covering       {}\n",
        report.given,
        report.kept,
        output::conflicts_answer(report.conflicts),
        output::answer(report.uncovered == 0, report.uncovered),
    );

    // The points are those of the file, by their numbers there, whether kept or not.
    for [first, second] in &report.conflicting {
        let _ = writeln!(
            out,
            "  conflict: points {first} and {second} given are both kept"
        );
    }
    for point in &report.uncovered_points {
        let _ = writeln!(
            out,
            "  point {point} given is left out, and near no earlier kept one"
        );
    }
    let _ = writeln!(out, "verdict        {}", output::validity(report.valid()));
    out
}

#[cfg(test)]
mod tests;
