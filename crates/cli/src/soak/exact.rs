//! Rounds of exact tiling: the definition, the engine by windows, the counts, and the verdict.

use anyhow::Result;
use tilescope_analysis::{VerifyOptions, verify};
use tilescope_core::{
    ExactPlane, Parameters, PatternHistory, Run, Unobserved, WindowMaker, exact_sample,
    exact_sample_parallel,
};
use tilescope_sets::region;

use super::definition::agrees;
use super::{Dice, Tally, common_command, faults_of, windows_agree};
use crate::interrupt;

/// The index of the draw of whether a large set is compared with the definition.
const OF_DEFINITION: u32 = 600_000;

/// Sets of up to so many samples are always compared with the definition: rather more than half of all rounds.
const ALWAYS_DEFINED: usize = 20_000;

/// The part of the larger sets that is compared, too. All of its darts are thrown and ordered, which takes 3.5 times as long as
/// the rest of a round.
const ALSO_DEFINED: f64 = 1.0 / 32.0;

/// Makes a round of the sides, leaf, boundaries, pattern and seed that were drawn; the rest has no meaning here.
pub fn round(parameters: &Parameters, dice: &Dice, options: &VerifyOptions) -> Result<Tally> {
    let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
    let run = exact_sample(parameters, &history, &mut Unobserved)?;
    // `agrees` makes the first two levels anew, from all of their darts.
    let is_compared =
        run.result.len() <= ALWAYS_DEFINED || dice.share(OF_DEFINITION) < ALSO_DEFINED;
    let is_defined = counts_add_up(&run) && (!is_compared || agrees(&run, &history));
    let by_windows = exact_sample_parallel(parameters, &history, &mut Unobserved)?;
    let engines_agree = by_windows.samples == run.samples && by_windows.summary() == run.summary();

    let (domain, points) = (run.domain, run.points());
    let plane = ExactPlane::new(parameters, &history)?;
    let are_windows_equal = windows_agree(&domain, &points, dice, |window| plane.window(window))?;

    // The verifier shares no lattice with the sampler: it takes positions in user units.
    let positions = domain.users_from_lattice(&points);
    let control = |_| interrupt::flow();
    let report = verify(
        &positions,
        region(&domain),
        domain.radius(),
        options,
        &control,
    )?;

    let checks = [
        (is_defined, "--method exact differs from its definition: "),
        (engines_agree, "--method exact on all threads differs: "),
        (are_windows_equal, "a --window differs from the set: "),
        (report.valid(), "not valid: "),
    ];
    let faults = faults_of(&checks);

    let command = || format!("{faults}{}", command(parameters));
    Ok(Tally {
        rounds: 1,
        samples: report.count as u64,
        conflicts: report.conflicts,
        // Unlike KDRT with a short reach, exact tiling may never leave a gap: all count as faults.
        gaps: report.gaps,
        // The radius of a round is 1, so that lengths are in radii.
        covering_radius_r: report.covering_radius,
        unequal: u64::from(!(is_defined && engines_agree && are_windows_equal)),
        commands: (!faults.is_empty()).then(command).into_iter().collect(),
        ..Tally::default()
    })
}

/// Returns whether the tiled samples, less the eliminated and plus the inserted, make up the set.
fn counts_add_up(run: &Run) -> bool {
    let counts = run.summary();
    let inserted: usize = counts.inserted.iter().sum();
    counts.tiled - counts.eliminated + inserted == counts.count && counts.count == run.result.len()
}

/// Returns the command that makes the set of a round.
pub fn command(parameters: &Parameters) -> String {
    format!("{} --method exact", common_command(parameters))
}

#[cfg(test)]
mod tests {
    use tilescope_core::{Boundary, Origin, PatternSpec};

    use super::*;

    /// The definition holds of patterns that turn, repeat within blocks, and end; it is found where it does not hold.
    #[test]
    fn the_definition_holds_and_is_looked_at() {
        let spec = |side: f64, boundary| PatternSpec {
            side,
            boundary,
            seed: 3,
        };
        let patterns = [
            (spec(17.5, Boundary::Periodic), true),
            (spec(40.0, Boundary::Bounded), true),
            (spec(100.0, Boundary::Periodic), false),
        ];
        for (pattern, dihedral) in patterns {
            let parameters = Parameters {
                radius: 0.02,
                leaf: 9.0,
                pattern,
                dihedral,
                ..Parameters::default()
            };
            let history = PatternHistory::of_spec(&pattern, &mut Unobserved).unwrap();
            let run = exact_sample(&parameters, &history, &mut Unobserved).unwrap();
            assert!(counts_add_up(&run) && agrees(&run, &history), "{pattern:?}");

            let mut fewer = run.clone();
            fewer.result.pop();
            assert!(!counts_add_up(&fewer));
            let is_tiled = |origin: &Origin| matches!(origin, Origin::Tiled { .. });
            let tiled = run.samples.origins.iter().position(is_tiled).unwrap();
            let mut moved = run;
            moved.samples.points[tiled].x += 1;
            assert!(!agrees(&moved, &history));
        }
    }
}
