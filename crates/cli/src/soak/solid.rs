//! Rounds of sets in space: both schedules, the verdict of both judges, and the covering radius.

use anyhow::Result;
use serde_json::json;
use tilescope_analysis::{Region, VerifyOptions, measure_solid};
use tilescope_core::{
    Boundary, Parameters, SolidDomain, Unobserved, solid_arrivals, solid_arrivals_parallel,
};
use tilescope_formats::in_space;

use super::{Dice, Tally, faults_of};
use crate::interrupt;

/// The smallest and the largest volume of a round in cubed radii, the least one little more than that of the smallest box:
/// up to 30,000 samples, which take a second to make and to judge.
const VOLUMES: [f64; 2] = [70.0, 40_000.0];

/// The shortest side that a box may have, in radii.
const SHORTEST: f64 = 4.0;
/// The lengths of two sides of a round over the third. Chosen, not measured.
const ASPECTS: [f64; 2] = [0.2, 5.0];

/// Returns the sides that a round draws, in radii.
fn sides(dice: &Dice) -> [f64; 3] {
    let volume = dice.scale(0, VOLUMES);
    let [across, up] = [dice.scale(1, ASPECTS), dice.scale(2, ASPECTS)];
    let deep = (volume / (across * up)).cbrt();
    [across * deep, up * deep, deep].map(|side| side.max(SHORTEST))
}

/// Makes a round of the boundary and the seed that were drawn. The radius is 1 in every round, so that lengths in radii
/// are lengths of the domain; the other parameters have no meaning here.
pub fn round(parameters: &Parameters, dice: &Dice, options: &VerifyOptions) -> Result<Tally> {
    let (size, radius) = (sides(dice), parameters.radius);
    let (boundary, seed) = (parameters.boundary, parameters.seed);
    let domain = SolidDomain::from_size(size, radius, boundary)?;
    // The definition of the samples is the engine of one thread. All threads have an engine of their own, by parcels.
    // Both are to give the same samples in the same order, and at the same levels.
    let made = solid_arrivals(domain, seed, &mut Unobserved)?;
    let on_threads = solid_arrivals_parallel(domain, seed, &mut Unobserved)?;
    let schedules_agree = made == on_threads;

    let base = Region::new([size[0], size[1]], boundary == Boundary::Periodic);
    let positions = domain.users_from_lattice(&made.places);
    let (region, control) = (in_space(base, size[2]), |_| interrupt::flow());
    // A side is divided into a whole number of lattice units, each at least as long as the radius over R.
    // The shorter the side, the longer its units may be. In a box with a short side the covering radius may therefore
    // exceed the tolerance of certificates by a hair. The domain's own bound is computed from the units that it has.
    let options = VerifyOptions {
        covering_tolerance: domain.covering_bound() / radius - 1.0,
        ..options.clone()
    };
    // The judges and the search for the covering radius have to agree; otherwise the outcome is an error.
    let is_prefix = false;
    let verdict = measure_solid(&positions, region, radius, is_prefix, &options, &control)?;

    // Each fault is named before the command that makes its set.
    let report = &verdict.report;
    let checks = [
        (schedules_agree, "one thread and all threads differ: "),
        (verdict.valid(), "not valid: "),
    ];
    let faults = faults_of(&checks);
    let with_faults = || format!("{faults}{}", command(parameters, dice));
    Ok(Tally {
        rounds: 1,
        samples: report.count as u64,
        conflicts: report.conflicts,
        gaps: report.gaps,
        covering_radius_r: verdict.covering_radius / radius,
        unequal: u64::from(!schedules_agree),
        commands: (!faults.is_empty()).then(with_faults).into_iter().collect(),
        ..Tally::default()
    })
}

/// Returns the command that makes the set of a round.
pub fn command(parameters: &Parameters, dice: &Dice) -> String {
    let [width, height, depth] = sides(dice);
    let boundary = json!(parameters.boundary);
    format!(
        "tilescope sample --size {width}x{height}x{depth} --radius {} --boundary {} --seed {}",
        parameters.radius,
        boundary.as_str().unwrap_or_default(),
        parameters.seed
    )
}
