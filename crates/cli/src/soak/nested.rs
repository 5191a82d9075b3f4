//! Rounds of nested levels: windows against the whole, and the verdict on each level.

use anyhow::Result;
use tilescope_analysis::{PrefixClaim, VerifyOptions, verify_prefix};
use tilescope_core::{
    Insertion, NestedPlane, Order, ParameterError, Parameters, PatternSpec, SampleError, Search,
    Unobserved, Window,
};
use tilescope_sets::region;

use super::{Dice, Feature, Tally, command, windows_agree};
use crate::interrupt;

/// The share of the rounds with [`Feature::Levels`] that make levels. Chosen, not measured.
const SHARE: f64 = 0.5;

/// Adds a run of nested levels to some rounds, and judges it. This run has the sides, leaf, boundary, dihedral clips
/// and seed of the round's first run.
pub fn add(
    round: &mut Tally,
    parameters: &Parameters,
    dice: &Dice,
    verify: &VerifyOptions,
) -> Result<()> {
    // A run of levels takes several times as long as one of a single level. The numbers 20 and 21 are those of draws
    // that nothing else takes.
    if !dice.has(Feature::Levels) || dice.share(20) >= SHARE {
        return Ok(());
    }

    // Nested levels have one order, insertion and search, and a pattern of their own.
    let parameters = Parameters {
        order: Order::default(),
        insertion: Insertion::default(),
        search: Search::default(),
        pattern: PatternSpec::default(),
        ..*parameters
    };

    // The numbers of levels are chosen, not measured.
    let (nested_plane, levels) = plane(&parameters, dice.pick(21, &[2, 3, 4, 5, 7]))?;
    let nested = nested_plane.whole(&mut Unobserved)?;
    let domain = nested.domain();
    let samples_in = |window: &Window| {
        Ok(nested_plane
            .window(window, &mut Unobserved)?
            .points()
            .to_vec())
    };
    let differ = !windows_agree(domain, nested.points(), dice, samples_in)?;

    // The end of each level is the end of a set that is maximal for the level's own radius.
    let positions = nested.positions();
    let mut invalid_count = 0;
    let control = |_| interrupt::flow();
    for (&count, level) in nested.ends().iter().zip(0..) {
        let claim = PrefixClaim::maximal(count, nested.radius(level));
        let found = verify_prefix(&positions, region(domain), claim, verify, &control)?;
        // A sample is judged at its own level and at each finer one, and counts each time.
        round.samples += count as u64;
        round.conflicts += found.report.conflicts;
        round.gaps += found.report.gaps;
        invalid_count += u32::from(!found.valid());
    }

    round.unequal += u64::from(differ);
    let made = format!("{} --levels {levels}", command(&parameters));
    let differs = differ.then(|| format!("a window differs from the set: {made}"));
    let invalid =
        (invalid_count > 0).then(|| format!("{invalid_count} levels are not valid: {made}"));
    round.commands.extend(differs.into_iter().chain(invalid));
    Ok(())
}

/// Returns a plane of `levels` levels, or of fewer if the sides do not allow them, and their number.
fn plane(parameters: &Parameters, levels: u32) -> Result<(NestedPlane, u32), SampleError> {
    match NestedPlane::new(parameters, levels, &mut Unobserved) {
        Err(SampleError::Parameters(ParameterError::TooManyLevels { .. })) if levels > 1 => {
            plane(parameters, levels - 1)
        }
        made => made.map(|made| (made, levels)),
    }
}
