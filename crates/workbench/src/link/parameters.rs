//! The parameters of a run in a link: those that differ from others, and the nearest ones that may be sampled. What a run
//! must be is the core's business.

use tilescope_core::{
    Boundary, Insertion, MAX_SIDE_RADII, MAXIMAL_DENSITY, MIN_LEAF_RADII, MIN_PATTERN_SIDE_RADII,
    MIN_SIDE_RADII_BOUNDED, MIN_SIDE_RADII_PERIODIC, Order, Parameters, SIDE_LIMITS, Search,
    Variant,
};
use tilescope_session::words::grouped;

use super::said::{LinkWarnings, quoted};
use super::text::{exact, finite, name, named};
use super::{MAX_PATTERN_SIDE, MAX_SAMPLES};

/// The keys, in the sequence in which they are written.
pub const KEYS: [&str; 13] = [
    "seed",
    "width",
    "height",
    "radius",
    "boundary",
    "leaf",
    "pattern",
    "pattern-boundary",
    "pattern-seed",
    "dihedral",
    "order",
    "insertion",
    "search",
];
/// The last one: what it may be depends on the insertion.
pub const VARIANT: &str = "variant";

const BOUNDARIES: [Boundary; 2] = [Boundary::Periodic, Boundary::Bounded];
const ORDERS: [Order; 4] = [
    Order::Index,
    Order::Random,
    Order::OwnBlockFirst,
    Order::PhaseGroup,
];
const INSERTIONS: [Insertion; 2] = [Insertion::Circumcentre, Insertion::Uniform];
const SEARCHES: [Search; 2] = [Search::Complete, Search::TwoRadii];
const VARIANTS: [Variant; 2] = [Variant::Staged, Variant::AsPrinted];
const SWITCH: [&str; 2] = ["no", "yes"];

/// Returns the key's value as a link has it.
fn value(p: &Parameters, key: &str) -> String {
    match key {
        "seed" => p.seed.to_string(),
        "width" => exact(p.width),
        "height" => exact(p.height),
        "radius" => exact(p.radius),
        "boundary" => name(&p.boundary),
        "leaf" => exact(p.leaf),
        "pattern" => exact(p.pattern.side),
        "pattern-boundary" => name(&p.pattern.boundary),
        "pattern-seed" => p.pattern.seed.to_string(),
        "dihedral" => SWITCH[usize::from(p.dihedral)].to_owned(),
        "order" => name(&p.order),
        "insertion" => name(&p.insertion),
        "search" => name(&p.search),
        _ => name(&p.variant),
    }
}

/// Returns the keys and values in which `parameters` differ from `base`.
pub fn differing(
    parameters: &Parameters,
    base: &Parameters,
) -> impl Iterator<Item = (&'static str, String)> {
    let (new, old) = (*parameters, *base);
    KEYS.into_iter().chain([VARIANT]).filter_map(move |key| {
        let text = value(&new, key);
        (text != value(&old, key)).then_some((key, text))
    })
}

/// Takes up what a key says; returns whether it can be meant. Sizes count for themselves only.
fn take(p: &mut Parameters, key: &str, text: &str) -> bool {
    fn put<T>(place: &mut T, read: Option<T>) -> bool {
        let is_there = read.is_some();
        if let Some(read) = read {
            *place = read;
        }
        is_there
    }
    let positive = || finite(text).filter(|&number| number > 0.0);
    let side = || finite(text).filter(|side| (SIDE_LIMITS[0]..=SIDE_LIMITS[1]).contains(side));
    match key {
        "seed" => put(&mut p.seed, text.parse().ok()),
        "width" => put(&mut p.width, side()),
        "height" => put(&mut p.height, side()),
        "radius" => put(&mut p.radius, positive()),
        "boundary" => put(&mut p.boundary, named(&BOUNDARIES, text)),
        "leaf" => put(&mut p.leaf, positive()),
        "pattern" => put(&mut p.pattern.side, positive()),
        "pattern-boundary" => put(&mut p.pattern.boundary, named(&BOUNDARIES, text)),
        "pattern-seed" => put(&mut p.pattern.seed, text.parse().ok()),
        "dihedral" => put(
            &mut p.dihedral,
            SWITCH.iter().position(|s| *s == text).map(|k| k == 1),
        ),
        "order" => put(&mut p.order, named(&ORDERS, text)),
        "insertion" => put(&mut p.insertion, named(&INSERTIONS, text)),
        "search" => put(&mut p.search, named(&SEARCHES, text)),
        _ => put(&mut p.variant, named(&VARIANTS, text)),
    }
}

/// Returns the parameters of which a link says `texts`, and otherwise `base`, brought within the limits. `run` names the
/// run behind its parameters: nothing, or " of run B".
pub fn read<'a>(
    texts: impl Fn(&str) -> Option<&'a str>,
    base: &Parameters,
    run: &str,
    said: &mut LinkWarnings,
) -> Parameters {
    let mut parameters = *base;
    for key in KEYS.into_iter().chain([VARIANT]) {
        if let Some(text) = texts(key)
            && !take(&mut parameters, key, text)
        {
            let (text, used) = (quoted(text), value(base, key));
            said.say(format!(
                "The link asked for {}{run} {text}; {used} is used instead.",
                told(key)
            ));
        }
    }
    fit(&mut parameters, run, said);
    parameters
}

/// Returns a key as sentences have it.
fn told(key: &str) -> &str {
    match key {
        "pattern" => "the pattern side",
        "pattern-boundary" => "the pattern boundary",
        "pattern-seed" => "the pattern seed",
        key => key,
    }
}

/// Brings parameters that each make sense to the nearest ones that may be sampled because a link says so.
fn fit(p: &mut Parameters, run: &str, said: &mut LinkWarnings) {
    if p.leaf < MIN_LEAF_RADII {
        said.say(format!(
            "The link asked for leaf{run} {}; {MIN_LEAF_RADII} is the least and is used instead.",
            exact(p.leaf)
        ));
        p.leaf = MIN_LEAF_RADII;
    }
    let side = p
        .pattern
        .side
        .clamp(MIN_PATTERN_SIDE_RADII, MAX_PATTERN_SIDE);
    if exact(side) != exact(p.pattern.side) {
        said.say(format!(
            "The link asked for a pattern{run} of {} r; {side} r is used instead.",
            exact(p.pattern.side)
        ));
        p.pattern.side = side;
    }
    if p.variant == Variant::AsPrinted && p.insertion == Insertion::Uniform {
        said.say(format!(
            "The link asked for uniform insertion{run} in Algorithm 4 as printed, which inserts circumcentres."
        ));
        p.insertion = Insertion::Circumcentre;
    }
    fit_radius(p, run, said);
    if let Err(error) = p.validate_sequential() {
        said.say(format!(
            "The link's parameters{run} cannot be sampled: {error}. Those of the default session are used instead."
        ));
        *p = Parameters::default();
    }
}

/// Returns what a link to a run with these parameters would not bring back, as it would ask for more than a link may.
#[must_use]
pub fn excess(p: &Parameters) -> Vec<String> {
    let domain = p.validate_sequential();
    let samples = domain.map_or(0.0, |domain| domain.area_radii() * MAXIMAL_DENSITY);
    let mut excess = Vec::new();
    if samples > MAX_SAMPLES {
        let most = grouped(MAX_SAMPLES as usize);
        excess.push(format!(
            "the radius, as a link asks for at most {most} samples"
        ));
    }
    if p.pattern.side > MAX_PATTERN_SIDE {
        let most = MAX_PATTERN_SIDE;
        excess.push(format!(
            "the pattern's side, as a link asks for at most {most} r"
        ));
    }
    excess
}

/// Returns the least and the largest radius that a domain may have.
fn radii(p: &Parameters) -> [f64; 2] {
    let shortest = match p.boundary {
        Boundary::Periodic => MIN_SIDE_RADII_PERIODIC,
        Boundary::Bounded => MIN_SIDE_RADII_BOUNDED,
    };
    // Sides are up to 1e30, so that their product is no infinity.
    let crowded = (MAXIMAL_DENSITY * p.width * p.height / MAX_SAMPLES).sqrt();
    let least = crowded.max(p.width.max(p.height) / MAX_SIDE_RADII);
    [least, p.width.min(p.height) / shortest]
}

fn fit_radius(p: &mut Parameters, run: &str, said: &mut LinkWarnings) {
    let [least, largest] = radii(p);
    if up(least) > down(largest) {
        let (width, height) = (exact(p.width), exact(p.height));
        said.say(format!(
            "The link asked for a domain{run} of {width} by {height}, for which there is no radius; 1 by 1 is used instead."
        ));
        (p.width, p.height) = (1.0, 1.0);
    }
    let [least, largest] = radii(p);
    let asked = exact(p.radius);
    if p.radius < least {
        p.radius = up(least);
        said.say(format!(
            "The link asked for radius{run} {asked}, which makes more than the {} samples that a link may ask for or a domain that is too long; {} is used instead.",
            grouped(MAX_SAMPLES as usize),
            exact(p.radius)
        ));
    } else if p.radius > largest {
        p.radius = down(largest);
        said.say(format!(
            "The link asked for radius{run} {asked}, which is too large for its domain; {} is used instead.",
            exact(p.radius)
        ));
    }
}

/// Returns the next number of three digits above.
fn up(number: f64) -> f64 {
    three_digits(number, 1.000_001)
}

/// Returns the next number of three digits below.
fn down(number: f64) -> f64 {
    three_digits(number, 0.999_999)
}

/// Returns a number of three digits on the side of `number` on which `toward` times the number is.
fn three_digits(number: f64, toward: f64) -> f64 {
    let exponent = number.log10().floor() as i32 - 2;
    let unit = 10_f64.powi(exponent.abs());
    let scaled = if exponent < 0 {
        number * unit
    } else {
        number / unit
    } * toward;
    let digits = if toward > 1.0 {
        scaled.ceil()
    } else {
        scaled.floor()
    };
    // Read as text, so that it is the number that is shown.
    format!("{digits}e{exponent}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pairs: &[(&str, &str)]) -> (Parameters, LinkWarnings) {
        let mut said = LinkWarnings::default();
        let texts = |key: &str| pairs.iter().find(|(k, _)| *k == key).map(|(_, v)| *v);
        let read = read(texts, &Parameters::default(), "", &mut said);
        (read, said)
    }

    #[test]
    fn every_parameter_comes_back_exactly() {
        let mut p = Parameters {
            width: 1.0 / 3.0,
            height: 0.7,
            radius: 0.012_345_678_901_234_5,
            boundary: Boundary::Bounded,
            seed: u64::MAX,
            leaf: 1e300,
            dihedral: true,
            order: Order::PhaseGroup,
            search: Search::TwoRadii,
            variant: Variant::AsPrinted,
            ..Parameters::default()
        };
        (p.pattern.side, p.pattern.seed) = (33.3, 7);
        p.pattern.boundary = Boundary::Bounded;
        let pairs: Vec<_> = differing(&p, &Parameters::default()).collect();
        assert_eq!(pairs.len(), 13, "all but the insertion: {pairs:?}");
        let pairs: Vec<_> = pairs.iter().map(|(k, v)| (*k, v.as_str())).collect();
        let (read, said) = of(&pairs);
        assert_eq!((read, said.text().as_str()), (p, ""));
        let uniform = of(&[("insertion", "uniform")]).0;
        assert_eq!(uniform.insertion, Insertion::Uniform);
    }

    #[test]
    fn the_defaults_of_version_1_stay() {
        // What a link does not say is this, for as long as there are links of version 1.
        let text = format!("{:?}", Parameters::default());
        assert_eq!(
            text,
            "Parameters { width: 1.0, height: 1.0, radius: 0.00836, boundary: Periodic, seed: 1, leaf: 30.0, \
             pattern: PatternSpec { side: 100.0, boundary: Periodic, seed: 0 }, dihedral: false, order: OwnBlockFirst, \
             insertion: Circumcentre, search: Complete, variant: Staged }"
        );
    }

    #[test]
    fn what_cannot_be_sampled_becomes_the_nearest_that_can() {
        for (pairs, part) in [
            (&[("radius", "NaN")][..], "radius NaN; 0.00836 is used"),
            (&[("radius", "-1")], "radius -1; 0.00836"),
            (&[("radius", "inf")], "radius inf; 0.00836"),
            (&[("radius", "1e-300")], "radius 1e-300, which makes more"),
            (&[("radius", "1e308")], "radius 1e308, which is too large"),
            (&[("radius", "0.3")], "too large for its domain; 0.099 is"),
            (&[("leaf", "1")], "leaf 1; 6 is the least"),
            (&[("pattern", "10000")], "a pattern of 10000 r; "),
            (&[("pattern", "0.1")], "a pattern of 0.1 r; 10 r"),
            (&[("seed", "-1")], "seed -1; 1 is"),
            (
                &[("seed", "18446744073709551616")],
                "seed 18446744073709551616; 1",
            ),
            (&[("width", "1e31")], "width 1e31; 1 is"),
            (
                &[("width", "1e30"), ("height", "1e-30")],
                "no radius; 1 by 1",
            ),
            (&[("width", "1e30")], "no radius; 1 by 1"),
            (&[("width", "1000")], "radius 0.00836, which makes more"),
            (&[("boundary", "torus")], "boundary torus; periodic"),
            (&[("dihedral", "maybe")], "dihedral maybe; no"),
            (
                &[("variant", "as-printed"), ("insertion", "uniform")],
                "uniform insertion",
            ),
        ] {
            let (p, said) = of(pairs);
            assert!(said.text().contains(part), "{pairs:?}: {}", said.text());
            let domain = p.validate_sequential().expect("parameters to sample");
            assert!(domain.area_radii() * MAXIMAL_DENSITY <= MAX_SAMPLES);
            assert!(p.pattern.side <= MAX_PATTERN_SIDE);
            // What is nearest needs no correction.
            let pairs: Vec<_> = differing(&p, &Parameters::default()).collect();
            let pairs: Vec<_> = pairs.iter().map(|(k, v)| (*k, v.as_str())).collect();
            let (again, said) = of(&pairs);
            assert_eq!((again, said), (p, LinkWarnings::default()));
        }
    }

    #[test]
    fn a_key_that_says_nothing_changes_nothing_and_is_named() {
        for key in KEYS.into_iter().chain([VARIANT]) {
            let (p, said) = of(&[(key, "?")]);
            assert_eq!(p, Parameters::default(), "{key}");
            let asked = format!("asked for {} ?;", told(key));
            assert!(said.text().contains(&asked), "{key}: {}", said.text());
        }
    }

    #[test]
    fn numbers_of_three_digits_lie_on_the_side_that_was_asked_for() {
        for number in [1e-30, 0.001_867_6, 0.1, 1.0, 123.456, 9.999_9, 4e29] {
            let (below, above) = (down(number), up(number));
            assert!(below < number && number < above, "{below} {number} {above}");
            assert!(above - below < 0.05 * number, "{below} {number} {above}");
        }
    }
}
