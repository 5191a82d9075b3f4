//! The claims of equation 1 and their verdicts, from what was counted.

use super::CELL;
use super::counted::MOVED;
use super::offsets::{DensityOffset, JUDGED, SamplerUniformity, UniformityResults};
use crate::numbers::{chance, number};
use crate::outcome::{BEYOND, Claim, Verdict};
use crate::rule::Rule;

/// Deeper than this many radii lies no conflict; the second of the bands' borders.
const INTERIOR: f64 = 3.0;
/// Deviations up to this from the reference sampler's density are treated as zero, whatever the number of sets.
const NEGLIGIBLE: f64 = 0.005;
/// An interval that reaches further than this to either side contains too much to say that two densities are alike.
const TELLING: f64 = 0.02;
/// Fewer inserted samples cannot show that no rank is preferred.
const RANKED: u64 = 1000;
/// Below this probability counts are not uniform.
const UNLIKELY: f64 = 1e-3;
/// Places whose true densities vary by no more than this have a very small bias.
const EVEN: f64 = 0.01;

fn percent(share: f64) -> String {
    crate::numbers::percent(share, 3)
}

/// Returns a deviation, with its sign.
fn signed(share: f64) -> String {
    format!("{} %", crate::numbers::signed(100.0 * share, 3))
}

fn between(interval: [f64; 2]) -> String {
    format!("{} to {}", signed(interval[0]), signed(interval[1]))
}

/// Returns a deviation with its interval.
fn told(off: &DensityOffset) -> String {
    format!("{} (99 %: {})", signed(off.relative), between(off.interval))
}

fn within(off: &DensityOffset, limit: f64) -> Verdict {
    Rule::near(0.0, limit).verdict(Some(off.interval))
}

pub fn claims(found: &UniformityResults) -> Vec<Claim> {
    let UniformityResults {
        reference,
        moved,
        circumcentre,
        uniform,
        random,
        ..
    } = found;
    vec![
        everywhere(
            "insertion at circumcentres",
            [reference, moved, circumcentre],
        ),
        everywhere("uniform insertion", [reference, moved, uniform]),
        interior(reference, circumcentre),
        border("insertion at circumcentres", circumcentre),
        border("uniform insertion", uniform),
        deterministic(found),
        removes(found),
        farthest(circumcentre),
        unbiased(uniform),
        frame(reference, circumcentre),
        sides("by index, own block first", reference, circumcentre),
        sides("random order", reference, random),
    ]
}

fn claim(claim: &str, paper: &str, ours: String, verdict: Verdict, reason: String) -> Claim {
    let names = [claim, "equation 1, section 5.1", paper];
    Claim::new(names, ours, verdict, reason)
}

fn beyond(claim: &str, ours: String, verdict: Verdict, reason: String) -> Claim {
    let names = [claim, BEYOND, "not in the paper"];
    Claim::new(names, ours, verdict, reason)
}

/// Returns the verdict on all places together: bands, strips and cells of sets that need no control.
fn even(ours: &SamplerUniformity) -> Verdict {
    let cells = Rule::Within([f64::NEG_INFINITY, EVEN]).verdict(Some(ours.grid().interval));
    let places = ours.places().into_iter();
    Verdict::of_all(places.map(|(_, off)| within(&off, EVEN)).chain([cells]))
}

/// Returns the band or strip that is furthest from the sets' mean, in words.
fn worst(ours: &SamplerUniformity) -> (&'static str, String) {
    let far = |(_, off): &(&str, DensityOffset)| off.relative.abs();
    let places = ours.places().into_iter();
    let worst = places.max_by(|a, b| far(a).total_cmp(&far(b)));
    worst.map_or(("nowhere", String::new()), |(name, off)| (name, told(&off)))
}

/// Returns whether no bias is measured of sets that have no bias, neither in cells nor in any band or strip.
fn clean(reference: &SamplerUniformity) -> bool {
    let grid = reference.grid().interval;
    let even =
        |off: &DensityOffset| off.around_zero() || within(off, NEGLIGIBLE) == Verdict::Reproduced;
    (grid[0] <= 0.0 || grid[1] <= NEGLIGIBLE) && reference.places().iter().all(|(_, off)| even(off))
}

/// Places of the domain.
fn everywhere(how: &str, [reference, moved, ours]: [&SamplerUniformity; 3]) -> Claim {
    let seen = moved.grid().interval[0] > EVEN && clean(reference);
    let verdict = if seen {
        even(ours)
    } else {
        Verdict::NotComparable
    };
    let (name, worst) = worst(ours);
    let grid = ours.grid();
    claim(
        &format!("Every place of the domain is as likely to hold a sample ({how}; worst {name})"),
        "up to a very small bias",
        format!(
            "{name}: {} from the sets' mean; {} cells of about {CELL} r: bias {} (99 %: {} to {}), {} standard deviations above noise; \
             Cramer's V {}, {} for the reference sampler",
            worst,
            ours.cells.deviations.len(),
            percent(grid.rms),
            percent(grid.interval[0]),
            percent(grid.interval[1]),
            number(grid.sigmas, 2),
            number(ours.cells.chi_square.cramers_v, 3),
            number(reference.cells.chi_square.cramers_v, 3),
        ),
        verdict,
        everywhere_rule(reference, moved),
    )
}

fn everywhere_rule(reference: &SamplerUniformity, moved: &SamplerUniformity) -> String {
    let (name, worst) = worst(reference);
    format!(
        "Judged by eight bands and strips along borders, not narrower than 1 r, and by the root mean square deviation of cells \
         without the noise that the spread between sets predicts; the {JUDGED} intervals hold together with 99 % confidence. \
         Reproduced if all lie within {even}, not reproduced if one lies beyond. Needs a set that is {} denser in the middle to be \
         told apart by its cells (bias {}), and intervals of the reference sampler that contain zero or end within {} (cells {}; \
         {name}: {}).",
        percent(MOVED),
        percent(moved.grid().rms),
        percent(NEGLIGIBLE),
        percent(reference.grid().rms),
        worst,
        even = percent(EVEN),
    )
}

/// The border of a periodic domain.
fn frame(reference: &SamplerUniformity, ours: &SamplerUniformity) -> Claim {
    let [here, control] = [ours, reference].map(SamplerUniformity::frame);
    beyond(
        "A periodic domain has no special places",
        format!(
            "density within 1 r of the domain's border: {} from the reference sampler's",
            told(&here)
        ),
        if control.around_zero() {
            there(&[here]).opposite()
        } else {
            Verdict::NotComparable
        },
        format!(
            "Confirmed if the interval contains zero, as it must for the reference sampler ({}), and reaches no further than {} \
             to either side; refuted if it does not contain zero. The KD tree begins with the domain, so that its border \
             is a border of blocks in every run; other places are one only in some runs.",
            between(control.interval),
            percent(TELLING)
        ),
    )
}

/// Which side of the border of a periodic domain has more samples.
fn sides(order: &str, reference: &SamplerUniformity, ours: &SamplerUniformity) -> Claim {
    let even = |subject: &SamplerUniformity| {
        let [after, before] = subject.sides();
        after.interval[0] <= before.interval[1] && before.interval[0] <= after.interval[1]
    };
    let [after, before] = ours.sides();
    let telling = after.tells(TELLING) && before.tells(TELLING);
    beyond(
        &format!("Both sides of a border have as many samples ({order})"),
        format!(
            "density within 1 r after the domain's border (the lowest x and y): {} from the reference sampler's; before it: {}",
            told(&after),
            told(&before)
        ),
        Verdict::if_known(even(reference) && (telling || !even(ours)), even(ours)),
        format!(
            "Confirmed if the two intervals meet, as they must for the reference sampler, and reach no further than {} to either side; refuted \
             if they do not meet. By index, of two samples in conflict the one of the block with the lower index stays; indices rise with \
             the coordinates in every split.",
            percent(TELLING)
        ),
    )
}

/// Where no clip overlaps.
fn interior(reference: &SamplerUniformity, ours: &SamplerUniformity) -> Claim {
    let [.., deep] = ours.bands();
    let [.., control] = reference.bands();
    let clean = control.around_zero() || within(&control, NEGLIGIBLE) == Verdict::Reproduced;
    claim(
        "The method is biased in the conflict area only",
        "bias in the conflict area",
        format!(
            "density deeper than {INTERIOR} r in a block: {} from the reference sampler's",
            told(&deep)
        ),
        if clean {
            within(&deep, NEGLIGIBLE)
        } else {
            Verdict::NotComparable
        },
        format!(
            "Reproduced if the interval lies within {limit}, not reproduced if it lies beyond. Needs an interval of the reference sampler, which \
             knows no blocks, that contains zero or lies within {limit} ({}). Clips overlap up to 1 r from a border; \
             elimination and insertion reach a little further.",
            signed(control.relative),
            limit = percent(NEGLIGIBLE)
        ),
    )
}

/// Where clips overlap.
fn border(how: &str, ours: &SamplerUniformity) -> Claim {
    let [near, middle, _] = ours.bands().map(|band| band.among(2, ours.sets));
    let worst = ours.worst_block_class();
    claim(
        &format!("Borders of blocks leave a bias in the density ({how})"),
        "bias in the conflict area, bounded",
        format!(
            "density within 1 r of a border: {} from the reference sampler's; from 1 r to {INTERIOR} r: {}; at most {} in any \
             class",
            told(&near),
            told(&middle),
            signed(worst)
        ),
        there(&[near, middle]),
        format!(
            "Reproduced if one of the two intervals does not contain zero; both hold together with 99 % confidence (99.5 % each). Not \
             reproduced if both contain it and reach no further than {} to either side.",
            percent(TELLING)
        ),
    )
}

/// Whether there is a deviation: intervals that contain zero deny it only if they are not wide.
fn there(each: &[DensityOffset]) -> Verdict {
    let nowhere = |off: &DensityOffset| {
        let there = Rule::NotZero(TELLING).verdict(Some(off.interval));
        there.opposite()
    };
    Verdict::of_all(each.iter().map(nowhere)).opposite()
}

/// What the place of an inserted sample adds to the bias in density.
fn deterministic(found: &UniformityResults) -> Claim {
    let pair = &found.paired;
    claim(
        "Deterministic insertion introduces bias (density near borders, against uniform insertion)",
        "bias by deterministic insertion",
        format!(
            "density within 1 r of a block's border: {} at circumcentres less that by uniform insertion, {} standard deviations \
             of a pair; {} sets each",
            told(&pair.difference),
            number(pair.effect, 3),
            found.circumcentre.sets
        ),
        there(&[pair.difference]),
        format!(
            "Reproduced if the interval of the paired difference does not contain zero: same seeds, patterns and blocks, of which only \
             the insertion differs; not reproduced if it contains it and reaches no further than {} to either side. In shares of the reference \
             sampler's density.",
            percent(TELLING)
        ),
    )
}

/// Whether there is a bias without deterministic insertion.
fn removes(found: &UniformityResults) -> Claim {
    let [with, without] = [&found.circumcentre, &found.uniform].map(|subject| subject.bands()[0]);
    let removed = &found.paired.removed;
    beyond(
        "Uniform insertion removes the bias in density near borders",
        format!(
            "density within 1 r of a block's border: {} from the reference sampler's by uniform insertion, {} at circumcentres; \
             removed: {} % of it (99 %: {} to {})",
            told(&without),
            told(&with),
            number(100.0 * removed.relative, 2),
            number(100.0 * removed.interval[0], 2),
            number(100.0 * removed.interval[1], 2),
        ),
        within(&without, NEGLIGIBLE),
        format!(
            "Confirmed if the interval of uniform insertion lies within {even}, refuted if it lies beyond {even}. What is left comes \
             from resolving conflicts, which both have in common.",
            even = percent(NEGLIGIBLE)
        ),
    )
}

fn farthest(ours: &SamplerUniformity) -> Claim {
    let (probability, effect) = ours.ranks();
    beyond(
        "Within gaps, circumcentres are the farthest places (by construction)",
        rank_words(ours),
        Verdict::of(probability < UNLIKELY),
        format!(
            "By construction: a circumcentre is the farthest place of its part of a gap, so that this checks the program and says \
             nothing new; shown as a picture. Confirmed if uniform ranks had a probability below {UNLIKELY} (it is {}); the \
             effect is V = {}, of at most 1.",
            chance(probability),
            number(effect, 3)
        ),
    )
}

fn unbiased(ours: &SamplerUniformity) -> Claim {
    let (probability, effect) = ours.ranks();
    beyond(
        "Uniform insertion has no bias within gaps",
        rank_words(ours),
        Verdict::if_known(
            probability < UNLIKELY || ours.rank_count() >= RANKED,
            probability >= UNLIKELY,
        ),
        format!(
            "Confirmed if uniform ranks of at least {RANKED} samples have a probability of at least {UNLIKELY} (it is {}); the effect is V = {}.",
            chance(probability),
            number(effect, 3)
        ),
    )
}

fn rank_words(ours: &SamplerUniformity) -> String {
    let [low, high] = ours.extreme_ranks();
    format!(
        "of {} inserted samples {} are among the tenth of their gap nearest to other samples, {} among the farthest",
        ours.rank_count(),
        percent(low),
        percent(high)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_intervals_around_zero_deny_nothing() {
        let off = |relative: f64, reach: f64| DensityOffset {
            relative,
            interval: [relative - reach, relative + reach],
        };
        assert_eq!(
            there(&[off(0.03, 0.02), off(0.0, 0.1)]),
            Verdict::Reproduced
        );
        assert_eq!(
            there(&[off(0.001, 0.01), off(0.0, 0.01)]),
            Verdict::NotReproduced
        );
        assert_eq!(
            there(&[off(0.001, 0.01), off(0.0, 0.1)]),
            Verdict::NotComparable
        );
    }

    #[test]
    fn deviations_have_signs_and_small_chances_words() {
        assert_eq!(signed(0.0242), "+2.42 %");
        assert_eq!(signed(-0.0242), "\u{2212}2.42 %");
        assert_eq!(signed(0.0), "0 %");
        assert_eq!(chance(0.0), "below 1e-300");
        assert_eq!(chance(0.25), "0.25");
    }
}
