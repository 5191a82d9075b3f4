//! Rounds of nested levels: windows against the whole, and the verdict on each level.

use anyhow::Result;
use tilescope_analysis::{PrefixClaim, VerifyOptions, verify_prefix};
use tilescope_core::{
    Insertion, NestedPlane, Order, ParameterError, Parameters, PatternSpec, Point, SampleError,
    Search, Unobserved,
};

use super::{Dice, Tally, WINDOWS, command, random_window, shows};
use crate::interrupt;
use crate::options::region;

/// The share of rounds that also make levels.
const SHARE: f64 = 0.25;

/// Adds to some rounds a run of nested levels with the same sides, leaf, boundary and seed.
pub fn add(
    round: &mut Tally,
    parameters: &Parameters,
    dice: &Dice,
    verify: &VerifyOptions,
) -> Result<()> {
    if dice.share(20) >= SHARE {
        return Ok(());
    }
    let parameters = Parameters {
        order: Order::default(),
        insertion: Insertion::default(),
        search: Search::default(),
        pattern: PatternSpec::default(),
        ..*parameters
    };
    let (plane, levels) = plane(&parameters, dice.pick(21, &[2, 3, 4, 5, 7]))?;
    let nested = plane.whole(&mut Unobserved)?;
    let domain = nested.domain();
    let mut differ = false;
    for index in 0..WINDOWS {
        let Some(window) = random_window(domain, dice, index) else {
            continue;
        };
        let found = plane.window(&window, &mut Unobserved)?;
        let shown = |p: &&Point| shows(&window, domain, **p);
        differ |= !nested.points().iter().filter(shown).eq(found.points());
    }
    let positions = nested.positions();
    let mut invalid = 0;
    for (&count, level) in nested.ends().iter().zip(0..) {
        let claim = PrefixClaim::maximal(count, nested.radius(level));
        let found = verify_prefix(&positions, region(domain), claim, verify, &|_| {
            interrupt::flow()
        })?;
        round.samples += count as u64;
        round.conflicts += found.report.conflicts;
        round.gaps += found.report.gaps;
        invalid += u32::from(!found.valid());
    }
    round.unequal += u64::from(differ);
    let made = format!("{} --levels {levels}", command(&parameters));
    if differ {
        round
            .commands
            .push(format!("a window differs from the set: {made}"));
    }
    if invalid > 0 {
        round
            .commands
            .push(format!("{invalid} levels are not valid: {made}"));
    }
    Ok(())
}

/// Returns a plane of so many levels, or of as many as the sides allow, and how many these are.
fn plane(parameters: &Parameters, levels: u32) -> Result<(NestedPlane, u32), SampleError> {
    match NestedPlane::new(parameters, levels, &mut Unobserved) {
        Err(SampleError::Parameters(ParameterError::TooManyLevels { .. })) if levels > 1 => {
            plane(parameters, levels - 1)
        }
        made => made.map(|made| (made, levels)),
    }
}
