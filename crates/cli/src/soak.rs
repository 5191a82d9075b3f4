//! `tilescope soak`: compares engines, windows and verdicts at random parameters, for a given number of samples. Each
//! failure is reported with the command that makes its set.

mod definition;
mod exact;
mod nested;
mod solid;
mod varying;

use std::fmt::Write;

use anyhow::Result;
use clap::{Args, ValueEnum};
use glam::I64Vec2;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;
use tilescope_analysis::VerifyOptions;
use tilescope_core::{
    Boundary, Domain, Insertion, Key, MIN_LEAF_RADII, MIN_PATTERN_SIDE_RADII,
    MIN_SIDE_RADII_PERIODIC, Order, Parameters, Pattern, PatternSpec, Plane, Point, SampleError,
    Search, Sequential, Stream, Sweep, Unobserved, Window, WindowMaker, below,
};
use tilescope_sets::region;

use crate::engine::ThreadArguments;
use crate::options::JudgeArguments;
use crate::progress::bar;
use crate::{interrupt, output, verdict_code};

/// Arguments of `tilescope soak`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct SoakArguments {
    /// End after this number of verified samples, as soon as the rounds that have begun by then are done. A round has up to
    /// about 400,000 samples
    #[arg(long, value_name = "N", default_value_t = 10_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    samples: u64,
    /// Seed of the random parameters
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// What is made
    #[arg(long, value_enum, default_value = "kdrt")]
    method: SoakMethod,
    /// Make this round alone, from 0: a round depends on --seed and its number
    #[arg(long, value_name = "I", conflicts_with = "samples")]
    round: Option<u32>,
    #[command(flatten)]
    judge: JudgeArguments,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The methods that can be soaked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SoakMethod {
    /// Randomized tiling, by both engines, in windows, and sometimes as nested levels
    Kdrt,
    /// Exact tiling
    Exact,
    /// Sets in space: balls in a box
    Solid,
    /// Sets whose radius varies, and sets in shapes
    Varying,
}

const EXAMPLES: &str = "\
Each round switches off about half of the features, at random (a bounded domain or pattern, dihedral clips, unusual leaves
and patterns, each order, insertion and search), draws the settings that are left, samples with the sequential and with the
parallel engine, compares the two point by point, compares four windows with the set, and verifies the set. Some rounds also
make nested levels. Rounds of exact tiling also check the counts; those of up to 20,000 samples, and one in 32 of the others,
compare the samples of the first levels with the definition. Rounds of sets in space compare one thread with all threads, and
cubes with covered circles. Rounds of varying radii draw a field (a formula, an image, a density) and a shape (a polygon,
perhaps with a hole, or a mask), compare the set with the recorded one, half of them also with a window of it, and verify
both by subdivision. Exit code 1 if two sets differ, or if one is not valid.

Examples:
  tilescope soak --samples 1000000000
  tilescope soak --samples 100000000 --method exact
  tilescope soak --samples 10000000 --method solid
  tilescope soak --samples 10000000 --method varying
  tilescope soak --method varying --seed 1 --round 17";

/// The approximate smallest and largest number of samples of a round.
const ROUND_SAMPLES: [f64; 2] = [500.0, 400_000.0];

/// The most rounds that are computed at a time. Chosen, not measured.
const MAX_ROUNDS_AT_ONCE: u64 = 16;

/// The mean number of samples of a round: the logarithm of its size is uniform within [`ROUND_SAMPLES`]. Rounds of varying
/// radii and of sets in space are smaller.
const MEAN_ROUND_SAMPLES: u64 = 60_000;

/// The run ends after this many faults. Chosen, not measured.
const MAX_FAULTS: usize = 50;

/// Windows compared in a round. Chosen, not measured.
const WINDOWS: u32 = 4;

/// Totals over the rounds.
#[derive(Clone, Debug, Default, Serialize)]
struct Tally {
    rounds: u64,
    samples: u64,
    conflicts: u64,
    gaps: u64,
    /// Rounds whose engines or windows differ.
    unequal: u64,
    /// The largest covering radius of a round with the complete search.
    covering_radius_r: f64,
    /// Rounds that ended with an error.
    failed: u64,
    /// The faults, each with the command that makes its set.
    commands: Vec<String>,
}

impl Tally {
    fn add(&mut self, other: Self) {
        self.rounds += other.rounds;
        self.samples += other.samples;
        self.conflicts += other.conflicts;
        self.gaps += other.gaps;
        self.unequal += other.unequal;
        self.covering_radius_r = self.covering_radius_r.max(other.covering_radius_r);
        self.failed += other.failed;
        self.commands.extend(other.commands);
    }

    const fn is_fine(&self) -> bool {
        self.conflicts == 0 && self.gaps == 0 && self.unequal == 0 && self.failed == 0
    }
}

/// Makes and checks random runs until there are enough samples, or too many faults; with `--round` makes that round
/// alone.
pub fn run(arguments: &SoakArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    let bar = bar("soak", arguments.samples);
    let mut sum = Tally::default();
    if let Some(number) = arguments.round {
        sum.add(round_or_fault(arguments, number.into()));
    }
    while arguments.round.is_none()
        && sum.samples < arguments.samples
        && sum.commands.len() < MAX_FAULTS
        && !interrupt::requested()
    {
        // Each round is seeded by its number, so that the rounds do not depend on the number of threads.
        let at_once = rounds_at_once(arguments.samples - sum.samples);
        let numbers: Vec<u64> = (sum.rounds..sum.rounds + at_once).collect();
        // Rounds differ in size by up to a factor of 800, so that threads take them one by one.
        let rounds = numbers.into_par_iter().with_max_len(1);
        let tallies: Vec<Tally> =
            (rounds.map(|number| round_or_fault(arguments, number))).collect();
        for tally in tallies {
            sum.add(tally);
        }

        bar.set_position(sum.samples);
    }

    bar.finish_and_clear();
    output::report(arguments.json, || json!(sum), || text(&sum))?;
    // The totals are printed all the same, but they are of fewer samples than were asked for.
    if interrupt::requested() {
        return Ok(crate::EXIT_INTERRUPTED);
    }
    Ok(verdict_code(sum.is_fine()))
}

/// Returns how many rounds are computed at a time where so many samples are still wanted: about as many as will have them,
/// so that a short run ends near the number that was asked for.
fn rounds_at_once(wanted: u64) -> u64 {
    let enough = wanted.div_ceil(MEAN_ROUND_SAMPLES);
    enough.clamp(1, MAX_ROUNDS_AT_ONCE)
}

/// Returns the totals in lines, with a command that repeats each fault.
fn text(sum: &Tally) -> String {
    let mut out = format!(
        "rounds             {}\n\
         samples            {}\n\
         conflicts          {}\n\
         gaps               {}\n\
         unequal engines    {}\n",
        sum.rounds, sum.samples, sum.conflicts, sum.gaps, sum.unequal
    );
    // Rounds of varying radii measure no covering radius, and those with the short search do not count it.
    if sum.covering_radius_r > 0.0 {
        let _ = writeln!(
            out,
            "covering radius    {:.9} r at most",
            sum.covering_radius_r
        );
    }

    if sum.failed > 0 {
        let _ = writeln!(out, "rounds that failed {}", sum.failed);
    }
    for command in &sum.commands {
        let _ = writeln!(out, "  {command}");
    }
    let verdict = ["NOT AS PROMISED", "as promised"][usize::from(sum.is_fine())];
    let _ = writeln!(out, "verdict            {verdict}");
    out
}

/// Random draws of a round. Each has a number of its own, so that a new one changes no other; two share a number only
/// if no round makes both.
struct Dice(Key);

/// What a round may have besides the usual settings. Each is switched off in half of the rounds, so that there are rounds with
/// few of them: where all settings are always mixed, one can hide the faults of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Feature {
    Bounded,
    BoundedPattern,
    AnyPattern,
    AnyLeaf,
    Aspect,
    Dihedral,
    Order,
    UniformInsertion,
    TwoRadii,
    Levels,
    Field,
    Image,
    Density,
    Polygon,
    Hole,
    Mask,
}

/// The first index of the draws of features, behind those of parameters and before those of windows.
const OF_FEATURES: u32 = 60;

impl Dice {
    /// Returns whether the round has a feature.
    fn has(&self, feature: Feature) -> bool {
        self.share(OF_FEATURES + feature as u32) < 0.5
    }

    fn share(&self, index: u32) -> f64 {
        f64::from(self.0.draw(Stream::Dart, index)[0]) / f64::from(u32::MAX)
    }

    fn pick<T: Copy>(&self, index: u32, choices: &[T]) -> T {
        choices[below(self.0.draw(Stream::Order, index)[0], choices.len() as u32) as usize]
    }

    /// Returns a number between `low` and `high` whose logarithm is uniform.
    fn scale(&self, index: u32, [low, high]: [f64; 2]) -> f64 {
        low * (high / low).powf(self.share(index))
    }
}

/// The shortest side of a round's domain, in radii: that of a periodic domain and a little more, so that rounding to the lattice
/// does not lead below it.
const SHORTEST: f64 = MIN_SIDE_RADII_PERIODIC + 0.5;

const ORDERS: [Order; 4] = [
    Order::Index,
    Order::Random,
    Order::OwnBlockFirst,
    Order::PhaseGroup,
];

/// Returns the pattern of a round.
fn pattern(dice: &Dice, leaf: f64, seed: u64) -> PatternSpec {
    // A bounded pattern is made for this round alone, and making it takes longer than most rounds. So only a part of
    // the rounds that may have one do: 0.3 is chosen, not measured.
    if dice.has(Feature::BoundedPattern) && dice.share(4) < 0.3 {
        // A bounded pattern must hold every clip: a block has less than two leaves along a side, and its clip r more on
        // either side. One r is to spare. The largest side, twice the least, is chosen, not measured.
        PatternSpec {
            side: (2.0 * leaf + 3.0) * (1.0 + dice.share(5)),
            boundary: Boundary::Bounded,
            seed,
        }
    } else {
        // Mostly a few sides and seeds, whose patterns are kept: to make one takes longer than a small round. The sides
        // are chosen, not measured.
        let any = dice.scale(5, [MIN_PATTERN_SIDE_RADII, 160.0]);
        let side = if dice.has(Feature::AnyPattern) {
            // In a third of these rounds any side.
            dice.pick(10, &[20.0, 30.0, 50.0, 200.0, any, any])
        } else {
            100.0
        };

        // The side that users have unless they ask for another is tried with eight seeds.
        let is_default = (side - 100.0).abs() < 1e-9;
        PatternSpec {
            side,
            boundary: Boundary::Periodic,
            seed: if is_default { seed & 7 } else { 0 },
        }
    }
}

/// Draws the parameters of a round.
fn parameters(dice: &Dice, seed: u64) -> Parameters {
    // A maximal set has about 0.7 samples for each r^2. Aspects are chosen, not measured.
    let area = dice.scale(0, ROUND_SAMPLES) / 0.7;
    let aspect = if dice.has(Feature::Aspect) {
        dice.scale(1, [0.05, 20.0])
    } else {
        1.0
    };
    // Neither side is too short: a width of `area / SHORTEST` leaves the shortest height. The range is not empty, as
    // the smallest area is more than six times the square of the shortest side.
    let width = (area * aspect).sqrt().clamp(SHORTEST, area / SHORTEST);

    // From the shortest leaf to those for which most of these domains are a single block.
    let leaf = if dice.has(Feature::AnyLeaf) {
        dice.scale(2, [MIN_LEAF_RADII, 120.0])
    } else {
        Parameters::default().leaf
    };

    // A reach of two radii may leave gaps: an experiment of the paper, for a few rounds.
    let has_two_radii = dice.has(Feature::TwoRadii) && dice.share(9) < 0.2;
    let search = if has_two_radii {
        Search::TwoRadii
    } else {
        Search::Complete
    };

    Parameters {
        width,
        height: (area / width).max(SHORTEST),
        // The lattice depends on sides over radius alone: all lengths are in radii.
        radius: 1.0,
        boundary: Boundary::of(!dice.has(Feature::Bounded)),
        seed,
        leaf,
        pattern: pattern(dice, leaf, seed),
        dihedral: dice.has(Feature::Dihedral),
        order: if dice.has(Feature::Order) {
            dice.pick(7, &ORDERS)
        } else {
            Order::default()
        },
        insertion: if dice.has(Feature::UniformInsertion) {
            Insertion::Uniform
        } else {
            Insertion::Circumcentre
        },
        search,
        ..Parameters::default()
    }
}

/// Makes a round. An error counts as a failed round; an interrupted round does not count.
fn round_or_fault(arguments: &SoakArguments, index: u64) -> Tally {
    if interrupt::requested() {
        return Tally::default();
    }
    // Nothing else is drawn from the key of the soak's seed, so that any stream serves.
    let key = Key::from_seed(arguments.seed).derive(Stream::Pattern, index as u32);
    // The two words of the round's key are also the 64 bits of its seed.
    let [low, high] = key.words();
    let dice = Dice(key);
    let drawn = parameters(&dice, u64::from(low) | u64::from(high) << 32);

    let repeating_command = || match arguments.method {
        SoakMethod::Kdrt => command(&drawn),
        SoakMethod::Exact => exact::command(&drawn),
        SoakMethod::Solid => solid::command(&drawn, &dice),
        // Its images and its polygon are in no file that a command could name.
        SoakMethod::Varying => format!(
            "tilescope soak --method varying --seed {} --round {index}",
            arguments.seed
        ),
    };
    let options = arguments.judge.options();
    // Rounds of varying radii are given their command; the others make theirs from the drawn settings.
    let made = match arguments.method {
        SoakMethod::Kdrt => round(&drawn, &dice, &options),
        SoakMethod::Exact => exact::round(&drawn, &dice, &options),
        SoakMethod::Solid => solid::round(&drawn, &dice, &options),
        SoakMethod::Varying => varying::round(&drawn, &dice, &options, &repeating_command()),
    };
    match made {
        Ok(round) => round,
        Err(_) if interrupt::requested() => Tally::default(),
        Err(error) => Tally {
            rounds: 1,
            failed: 1,
            commands: vec![format!("{error:#}: {}", repeating_command())],
            ..Tally::default()
        },
    }
}

/// Makes a run with the sequential and the parallel engine and as windows, compares the sets, and verifies that of the
/// sequential engine. Some rounds make nested levels as well.
fn round(parameters: &Parameters, dice: &Dice, verify: &VerifyOptions) -> Result<Tally> {
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
    let run =
        Sequential::new(parameters, std::sync::Arc::clone(&pattern))?.finish(&mut Unobserved)?;

    let points = run.points();
    // The points alone are compared: from which block each sample is need not be recorded.
    let sources = false;
    let (swept, summary) = Sweep::new(parameters, &pattern, sources)?.finish(&mut Unobserved)?;
    let engines_agree = swept.points == points && summary == run.summary();
    // Rounds run side by side, so that the memory of the run is given back before windows are made.
    drop(run);

    let plane = Plane::new(parameters, &pattern)?;
    let domain = *plane.domain();
    let are_windows_equal = windows_agree(&domain, &points, dice, |window| plane.window(window))?;

    let report = tilescope_analysis::verify(
        &domain.users_from_lattice(&points),
        region(&domain),
        domain.radius(),
        verify,
        &|_| interrupt::flow(),
    )?;

    let mut tally = Tally {
        rounds: 1,
        samples: report.count as u64,
        conflicts: report.conflicts,
        unequal: u64::from(!engines_agree || !are_windows_equal),
        ..Tally::default()
    };
    // A reach of two radii may leave gaps: that is the finding of an experiment, and no fault.
    if parameters.search == Search::Complete {
        tally.gaps = report.gaps;
        // The radius of a round is 1.
        tally.covering_radius_r = report.covering_radius;
    }

    let engines_differ = "--engine sequential and --engine parallel differ: ";
    let checks = [
        (engines_agree, engines_differ),
        (are_windows_equal, "a --window differs from the set: "),
        (tally.conflicts + tally.gaps == 0, "not valid: "),
    ];
    let faults = faults_of(&checks);
    if !faults.is_empty() {
        tally.commands.push(faults + command(parameters).as_str());
    }

    nested::add(&mut tally, parameters, dice, verify)?;
    Ok(tally)
}

/// Returns the words of the checks that a round has failed; empty if it passed all.
fn faults_of(checks: &[(bool, &str)]) -> String {
    let failed = checks.iter().filter(|(is_fine, _)| !is_fine);
    failed.map(|(_, fault)| *fault).collect()
}

/// Returns whether windows of random sizes, which `made` makes, have the samples of the whole set. Windows that the
/// domain refuses are left out.
fn windows_agree(
    domain: &Domain,
    points: &[Point],
    dice: &Dice,
    made: impl Fn(&Window) -> Result<Vec<Point>, SampleError>,
) -> Result<bool, SampleError> {
    let windows = (0..WINDOWS).filter_map(|index| random_window(domain, dice, index));
    for window in windows {
        // A window has its samples in the order of the set.
        let inside = points.iter().filter(|p| shows(&window, domain, **p));
        if !made(&window)?.iter().eq(inside) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Returns a window of random size and place; `None` if the domain refuses it, such as one without an area or one
/// beyond the border of a bounded domain.
fn random_window(domain: &Domain, dice: &Dice, index: u32) -> Option<Window> {
    let sides = domain.size();
    // Room for ten draws of each window, behind those of the parameters.
    let share = |k: u32| dice.share(100 + 10 * index + k);
    // Windows may begin up to a fifth of a side outside: a periodic domain goes on there, and a bounded one cuts them
    // at its border.
    let corner = [share(0), share(1)].map(|s| 1.4 * s - 0.2);
    let low = [corner[0] * sides[0], corner[1] * sides[1]];
    // Products of two draws make small windows more frequent.
    let size = [
        share(2) * share(3) * sides[0],
        share(4) * share(5) * sides[1],
    ];
    let high = [low[0] + size[0], low[1] + size[1]];
    domain.window(low, high).ok()
}

/// Returns whether a window shows a sample.
fn shows(window: &Window, domain: &Domain, p: Point) -> bool {
    let [min, max] = [window.min, window.max].map(I64Vec2::from);
    let mut at = I64Vec2::from(p) - min;
    // In a periodic domain, of the images of a sample the one that follows the window's corner counts: a window, at
    // most as long as the domain, holds no other.
    if let (true, Some(wrapped)) = (domain.is_periodic(), domain.wrap(at)) {
        at = wrapped.into();
    }
    (at.cmpge(I64Vec2::ZERO) & at.cmplt(max - min)).all()
}

/// Returns the command that makes the set of a round of KDRT.
fn command(p: &Parameters) -> String {
    // Options take the names that JSON has, but for the reach, which is a number of radii.
    let names = json!([p.order, p.insertion]);
    let [order, insertion] = [0, 1].map(|k| names[k].as_str().unwrap_or(""));
    let search = if p.search == Search::TwoRadii { 2 } else { 4 };
    format!(
        "{} --order {order} --insertion {insertion} --search {search}",
        common_command(p)
    )
}

/// Returns a command with the options that have a meaning for every method that tiles.
fn common_command(p: &Parameters) -> String {
    let Parameters {
        radius,
        width,
        height,
        seed,
        leaf,
        pattern,
        ..
    } = p;
    // Options take the names that JSON has, which are texts.
    let names = json!([p.boundary, pattern.boundary]);
    let [boundary, of_pattern] = [0, 1].map(|k| names[k].as_str().unwrap_or_default());
    let dihedral = if p.dihedral { " --dihedral" } else { "" };
    format!(
        "tilescope sample --radius {radius} --width {width} --height {height} --boundary {boundary} \
         --seed {seed} --leaf {leaf} --pattern-side {} --pattern-boundary {of_pattern} --pattern-seed {}{dihedral}",
        pattern.side, pattern.seed
    )
}
