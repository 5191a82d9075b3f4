//! `tilescope sample` with a third side: from arguments to a verified, saved set of balls.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{JudgeChoice, Number, SolidVerdict};
use tilescope_core::memory::{self, Making};
use tilescope_core::{Parameter, Stage};
use tilescope_formats::{
    Format, SolidContext, check_solid_format, export_solid, export_solid_unverified, solid_digest,
};
use tilescope_sets::{BallSize, SolidMade, SolidRecipe};

use crate::make::NO_VERDICT;
use crate::output::{self, warning_line};
use crate::paths::{InFile, named};
use crate::progress::{Stopwatch, verifying};
use crate::radius_span::TWO_RADII;
use crate::sample_arguments::{SampleArguments, SamplingMethod};
use crate::verdict_code;

use super::{check_judge, refuse, verdict};

/// Bytes a sample while a set is made, written, read back and judged, at most: measured of sets of half a million samples
/// in PLY and NPY files, and a tenth.
const VERIFIED: f64 = 520.0;

/// The parameters that a set of balls has.
pub const USED: [Parameter; 5] = [
    Parameter::Width,
    Parameter::Height,
    Parameter::Radius,
    Parameter::Boundary,
    Parameter::Seed,
];

/// Makes a set of balls, verifies it and saves it, as the arguments ask; prints the outcome.
pub fn sample(arguments: &SampleArguments) -> Result<u8> {
    let option = arguments.space.option();
    ensure!(
        arguments.window.is_none(),
        "--window: {option} makes a whole box; without it, --window of six numbers makes a part of space without end"
    );
    refuse_planar(arguments, option, &USED)?;
    let path = arguments.out.as_deref();
    // The format is checked before the set is made, which may take minutes.
    if let Some(path) = path {
        check_solid_format(Format::to_write(path, arguments.format)?).in_file(path)?;
    }

    let recipe = recipe(arguments)?;
    ask_for_memory(recipe.expected()?, arguments.no_verify)?;
    // Tries for a number of samples are part of the time, as each is a whole set.
    let mut watch = Stopwatch::start();
    let made = recipe.make(&mut watch)?;
    let seconds = watch.take();
    let outcome = finish(arguments, made, &seconds)?;
    output::report(arguments.json, || outcome.json(), || outcome.text())?;
    // A set that was not to be verified is no failure.
    Ok(verdict_code(
        outcome.verdict.as_ref().is_none_or(SolidVerdict::valid),
    ))
}

/// Fails if the system does not give the memory that the whole command takes, before the set is made: a program ends at
/// once when an allocation fails.
fn ask_for_memory(samples: f64, no_verify: bool) -> Result<()> {
    let alone = (samples * Making::Solid.bytes_a_sample()) as u64;
    let verified = (samples * VERIFIED) as u64;
    let needed = if no_verify { alone } else { verified };
    if memory::ask(needed).is_ok() {
        return Ok(());
    }

    // The verdict takes a part of the memory, so that the message also says how much is needed without one.
    let gigabytes = |bytes: u64| format!("{:.2} GB", bytes as f64 / 1e9);
    let (given, needed) = (gigabytes(memory::given_of(needed)), gigabytes(needed));
    let what = if no_verify {
        "to make"
    } else {
        "to make and verify"
    };
    let without = if no_verify {
        String::new()
    } else {
        format!(", {} to make them alone (--no-verify)", gigabytes(alone))
    };
    bail!(
        "about {needed} of memory are needed {what} some {samples:.0} samples{without}, and the system gives {given}: \
         ask for fewer samples, or for a part of space by --window"
    )
}

/// Refuses, by their names, options of planar sets and of other ways to make one. `option` is the one that makes a set in space, for
/// which the parameters `used` count.
pub(super) fn refuse_planar(
    arguments: &SampleArguments,
    option: &str,
    used: &[Parameter],
) -> Result<()> {
    let why = in_space(option);
    refuse_other_parameters(arguments.method, &arguments.run.typed, option, used)?;
    // The reference sampler takes fields and shapes in the plane, but they depend on x and y alone.
    if let Some(ground) = arguments.ground.option() {
        bail!("{ground}: {why}, with one radius in a whole box; leave {ground} out");
    }

    // Sets in space are made whole and in memory, with a corner at 0, without blocks and levels: these have no meaning.
    let given = [
        ("--levels", arguments.nested.levels.is_some()),
        ("--resume", arguments.resume),
        ("--origin", arguments.origin.is_some()),
        ("--pattern", arguments.run.pattern.is_some()),
    ];
    refuse(&given, &why)?;
    arguments.engine.check_on_cpu("the reference sampler")?;
    check_judge(&arguments.judge)
}

/// Says why options of planar sets are refused beside the option that makes a set in space.
fn in_space(option: &str) -> String {
    format!("{option} makes a set in space, by the reference sampler")
}

/// Refuses other samplers than that of sets in space, and parameters that were typed but are not among those `used`.
pub fn refuse_other_parameters(
    method: Option<SamplingMethod>,
    typed: &[Parameter],
    option: &str,
    used: &[Parameter],
) -> Result<()> {
    let why = in_space(option);
    // The reference sampler makes every set in space: to ask for it by name changes nothing.
    match method {
        None | Some(SamplingMethod::Reference) => {}
        Some(SamplingMethod::Kdrt) => bail!("--method kdrt: {why}; leave --method out"),
        Some(SamplingMethod::Exact) => bail!("--method exact: {why}; leave --method out"),
    }

    // Only a typed option is refused, as all have defaults.
    match typed.iter().find(|typed| !used.contains(typed)) {
        Some(typed) => bail!("--{name}: {why}; leave --{name} out", name = typed.key()),
        None => Ok(()),
    }
}

/// Returns what the arguments ask for.
fn recipe(arguments: &SampleArguments) -> Result<SolidRecipe> {
    let asked = &arguments.run.asked;
    let size = arguments
        .space
        .size([asked.width, asked.height])
        .context("a set in space has three sides")?;

    // Clap refuses two of --exactly, --count and --radius together. The one exception, a radius beside a count with
    // --radius-image, was refused by `refuse_planar`.
    let balls = match (arguments.nested.exactly, arguments.run.count) {
        (Some(count), _) => BallSize::Exactly(count as u64),
        (None, Some(count)) => BallSize::Count(count),
        (None, None) => BallSize::Radius(asked.radius),
    };
    // In space there is one radius: `greatest` is the second of MIN..MAX.
    ensure!(arguments.run.greatest.is_none(), TWO_RADII);
    Ok(SolidRecipe {
        size,
        boundary: asked.boundary,
        seed: asked.seed,
        balls,
    })
}

/// Verifies a set and saves it, as the arguments ask.
fn finish(
    arguments: &SampleArguments,
    made: SolidMade,
    seconds: &[(Stage, f64)],
) -> Result<SolidOutcome> {
    let mut context = made.context();
    context.planar.format = arguments.format;
    context.planar.shuffle_seed = arguments.shuffle;
    context.planar.precision = arguments.precision;
    context.planar.verify = arguments.judge.options();

    // The digest is that of the positions as they were made. A file may round or shuffle them.
    let digest = solid_digest(&made.points);
    let outcome = SolidOutcome {
        digest,
        asked: arguments.judge.choice(),
        seconds: seconds.iter().map(|(_, seconds)| seconds).sum(),
        verdict: None,
        certificate: None,
        warnings: Vec::new(),
        made,
    };
    // A saved set is judged as the file holds it, unless --no-verify is given, and any other as it is in memory. A file
    // without a verdict has no certificate.
    match arguments.out.as_deref() {
        Some(path) if arguments.no_verify => {
            let note = export_solid_unverified(path, &outcome.made.points, &context);
            let warnings: Vec<String> = (note.in_file(path)?.into_iter())
                .map(|note| note.to_string())
                .collect();
            Ok(SolidOutcome {
                warnings,
                ..outcome
            })
        }
        Some(path) => saved(outcome, path, &context),
        None => {
            let options = arguments.judge.options();
            let verdict = verifying(|control| outcome.made.judge(&options, control));
            Ok(SolidOutcome {
                verdict: Some(verdict.context(NO_VERDICT)?),
                ..outcome
            })
        }
    }
}

/// Saves a set with its certificate.
fn saved(outcome: SolidOutcome, path: &Path, context: &SolidContext) -> Result<SolidOutcome> {
    let points = &outcome.made.points;
    let exported =
        verifying(|control| export_solid(path, points, context, control)).in_file(path)?;
    let warnings = exported.warnings.iter().map(ToString::to_string);
    Ok(SolidOutcome {
        verdict: Some(exported.verdict),
        certificate: Some(exported.certificate_path),
        warnings: warnings.collect(),
        ..outcome
    })
}

/// A set of balls that was made, with its verdict and its file.
struct SolidOutcome {
    made: SolidMade,
    /// The digest of its positions as they were made.
    digest: String,
    seconds: f64,
    /// The judges that were chosen.
    asked: JudgeChoice,
    /// The verdict; nothing, of a set that was not verified.
    verdict: Option<SolidVerdict>,
    /// The path of the certificate; nothing without a file or a verdict.
    certificate: Option<PathBuf>,
    warnings: Vec<String>,
}

impl SolidOutcome {
    /// Returns the outcome for programs.
    fn json(&self) -> Value {
        let made = &self.made;
        let mut object = json!({
            "method": SolidMade::METHOD,
            "parameters": made.parameters(),
            "radius": made.domain.radius(),
            // How many samples were made, where only the first of them were taken: null for a whole set.
            "made": made.made,
            // Each stage of making a set in space throws darts, so that one entry has the seconds of all.
            "seconds": [{ "stage": "throw darts", "seconds": self.seconds }],
            "positions_digest": self.digest,
            "certificate": self.certificate.as_ref().map(|path| path.display().to_string()),
            "warnings": self.warnings,
        });
        // Without a verdict the number of samples is all that is known.
        let verdict = match &self.verdict {
            Some(verdict) => verdict::json(verdict),
            None => json!({ "count": made.points.len(), "verified": false }),
        };
        output::add(&mut object, verdict);
        object
    }

    /// Returns the outcome in lines.
    fn text(&self) -> String {
        let made = &self.made;
        let region = verdict::box_text(&made.region());
        let radius = Number(made.domain.radius());
        let count = made.points.len();
        // `made.made` is there only if more samples were made than the set has: those that came first were taken.
        let beginning = made.made.map_or_else(String::new, |made| {
            format!("   the first {count} of {made} samples by their arrival\n")
        });
        let judged = match &self.verdict {
            Some(verdict) => verdict::text(verdict, self.asked),
            None => format!("samples        {count}\nverdict        none: not verified\n"),
        };

        let mut out = format!(
            "{} on {region}, r = {radius}\n\n  {:<12} {:>9.1} ms{beginning}\n\n{judged}",
            SolidMade::METHOD,
            "throw darts",
            self.seconds * 1e3,
        );
        out.extend(self.warnings.iter().map(|warning| warning_line(warning)));
        if let Some(path) = &self.certificate {
            let _ = writeln!(out, "certificate    {}", named(path));
        }
        out
    }
}
