//! The parameters of a run in a link: writes those that differ from a base, and reads them, corrected to the nearest
//! parameters that a link may ask for.

use std::iter;

use serde_json::{Value, json};
use tilescope_core::{
    Boundary, Insertion, MAX_SIDE_RADII, MAXIMAL_DENSITY, MIN_LEAF_RADII, MIN_PATTERN_SIDE_RADII,
    MIN_SIDE_RADII_BOUNDED, MIN_SIDE_RADII_PERIODIC, NOT_OF_EXACT, Parameter, ParameterKind,
    Parameters, PatternSpec, TilingMethod, Variant,
};
use tilescope_debugger::method_refusal;
use tilescope_session::solid::expected_samples;
use tilescope_session::words::{grouped, quoted};

use super::text::{exact, finite};
use super::warnings::LinkWarnings;
use super::{MAX_PATTERN_SIDE, MAX_SAMPLES};

/// Returns the parameters in the order in which links have them: the seed first, as the part that is changed most.
pub fn in_links() -> impl Iterator<Item = Parameter> {
    let others = Parameter::all().filter(|parameter| *parameter != Parameter::Seed);
    iter::once(Parameter::Seed).chain(others)
}

/// Returns the key of a parameter in links and among the fields of the form.
#[must_use]
pub fn link_key(parameter: Parameter) -> &'static str {
    match parameter {
        // Of the pattern a link mostly says no more than the side.
        Parameter::PatternSide => "pattern",
        other => other.key(),
    }
}

/// Returns the value of a parameter as written in a link.
fn value(p: &Parameters, parameter: Parameter) -> String {
    if let Some(option) = parameter.chosen(p) {
        return option.name.to_owned();
    }
    match parameter.value(p) {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(String::new, exact),
        other => other.to_string(),
    }
}

/// Returns `base` with the pattern of `parameters` in a link that does not name one. Its side and its seed are the base's own, unless
/// the base has its usual ones: then they are the usual ones of `parameters`, which in exact tiling depend on the size of the set
/// and the seed.
fn following(base: &Parameters, parameters: &Parameters) -> Parameters {
    Parameters {
        pattern: PatternSpec {
            boundary: base.pattern.boundary,
            ..parameters.pattern_following(base)
        },
        ..*base
    }
}

/// Returns the keys and values in which `parameters` differ from `base`.
pub fn differing(
    parameters: &Parameters,
    base: &Parameters,
) -> impl Iterator<Item = (&'static str, String)> {
    let (new, old) = (*parameters, following(base, parameters));
    in_links().filter_map(move |parameter| {
        let text = value(&new, parameter);
        (text != value(&old, parameter)).then(|| (link_key(parameter), text))
    })
}

/// Returns the parameters with one of them changed; `None` if the text is no value of the parameter, or is a length in
/// user units beyond its limits. [`fit`] checks later whether the lengths can be used together.
fn changed(p: &Parameters, parameter: Parameter, text: &str) -> Option<Parameters> {
    let value = match &parameter.row().kind {
        ParameterKind::Real { unit, limits, .. } => {
            // All of these are lengths.
            let number = finite(text).filter(|number| *number > 0.0)?;
            // A length in r is corrected to the nearest limit later. The limits of lengths in user units are so far
            // away that the nearest limit would be of no use: a length beyond them is refused.
            let [least, largest] = *limits;
            let is_allowed = *unit == "r" || (least..=largest).contains(&number);
            json!(is_allowed.then_some(number)?)
        }
        ParameterKind::Whole(_) => json!(text.parse::<u64>().ok()?),
        ParameterKind::Switch { options, .. } | ParameterKind::Choice { options, .. } => {
            let option = options.iter().find(|option| option.name == text);
            parameter.value_of(option?)
        }
    };
    let mut changed = *p;
    parameter.set(&mut changed, value).ok()?;
    Some(changed)
}

/// Returns the parameters of a link: `base` changed by `texts`, corrected to the limits. `run` is appended to the names
/// of parameters in warnings: "" or " of run B".
pub fn read<'a>(
    texts: impl Fn(&str) -> Option<&'a str>,
    base: &Parameters,
    run: &str,
    warnings: &mut LinkWarnings,
) -> Parameters {
    let mut parameters = *base;
    for parameter in in_links() {
        // The usual pattern may depend on the seed and on the size of the set, which come earlier in this order.
        if parameter == Parameter::PatternSide {
            parameters.pattern = following(base, &parameters).pattern;
        }

        let Some(text) = texts(link_key(parameter)) else {
            continue;
        };

        let new = changed(&parameters, parameter, text);
        if new.is_none() {
            // The value stays as it is, which for the pattern's side need not be the base's.
            let used = value(&parameters, parameter);
            let (shown, name) = (quoted(text), name_of(parameter));
            // Some names are methods of the command line that are no tiling, and the warning says so.
            let refusal = match parameter {
                Parameter::Method => method_refusal(&shown.to_lowercase()),
                _ => None,
            };
            let why = refusal.map_or_else(String::new, |why| format!(": {why}"));
            warnings.add(format!(
                "The link asked for {name}{run} {shown}; {used} is used instead{why}."
            ));
        }
        parameters = new.unwrap_or(parameters);
    }

    fit(&mut parameters, run, warnings);
    // Lengths that were corrected may have another usual side. The default session, in the place of what cannot be sampled, is not exact.
    let names_no_side = texts(link_key(Parameter::PatternSide)).is_none();
    if names_no_side && parameters.method == TilingMethod::Exact {
        parameters.pattern.side = following(base, &parameters).pattern.side;
    }
    parameters
}

/// Returns the name of a parameter in sentences.
fn name_of(parameter: Parameter) -> String {
    match parameter.key() {
        // The article shows where a name of two words begins.
        key if key.contains('-') => format!("the {}", key.replace('-', " ")),
        key => key.to_owned(),
    }
}

/// Corrects parameters to the nearest ones that a link may ask for. Where the corrected ones cannot be used together,
/// all become the default ones.
fn fit(p: &mut Parameters, run: &str, warnings: &mut LinkWarnings) {
    // A leaf has no upper limit: a leaf longer than the domain makes a single block.
    if p.leaf < MIN_LEAF_RADII {
        warnings.add(format!(
            "The link asked for leaf{run} {}; {MIN_LEAF_RADII} is the least and is used instead.",
            exact(p.leaf)
        ));
        p.leaf = MIN_LEAF_RADII;
    }

    let side = p
        .pattern
        .side
        .clamp(MIN_PATTERN_SIDE_RADII, MAX_PATTERN_SIDE);
    // The sides are compared as a warning writes them, which must name two different ones.
    if exact(side) != exact(p.pattern.side) {
        warnings.add(format!(
            "The link asked for a pattern{run} of {} r; {side} r is used instead.",
            exact(p.pattern.side)
        ));
        p.pattern.side = side;
    }

    if p.method == TilingMethod::Exact && *p != p.as_exact() {
        let exact = p.as_exact();
        for parameter in NOT_OF_EXACT {
            let (asked, used) = (value(p, parameter), value(&exact, parameter));
            if asked != used {
                let name = parameter.key();
                warnings.add(format!(
                    "Exact tiling{run} keeps whatever arrived first and has no {name}: {asked} is left out."
                ));
            }
        }
        *p = exact;
    }

    if p.variant == Variant::AsPrinted && p.insertion == Insertion::Uniform {
        warnings.add(format!(
            "The link asked for uniform insertion{run} in Algorithm 4 as printed, which inserts circumcentres."
        ));
        p.insertion = Insertion::Circumcentre;
    }

    fit_radius(p, run, warnings);
    // By now each parameter is within its limits, but some cannot be used together.
    if let Err(error) = p.validate_sequential() {
        warnings.add(format!(
            "The link's parameters{run} cannot be sampled: {error}. Those of the default session are used instead."
        ));
        *p = Parameters::default();
    }
}

/// Returns the parameters that a link to a run cannot reproduce, because they exceed the limits of links.
pub(crate) fn excess(p: &Parameters, depth: Option<f64>) -> Vec<String> {
    // Parameters that are not valid make no samples, and so exceed no limit.
    let samples = match depth {
        Some(depth) => expected_samples(p, depth).unwrap_or(0.0),
        None => {
            (p.validate_sequential()).map_or(0.0, |domain| domain.area_radii() * MAXIMAL_DENSITY)
        }
    };

    let mut excess = Vec::new();
    if samples > MAX_SAMPLES {
        let most = grouped(MAX_SAMPLES as usize);
        // If a link asks for too many samples, the program that opens it enlarges the radius of a planar run, and
        // leaves out the depth of a box.
        let what = if depth.is_some() { "depth" } else { "radius" };
        excess.push(format!(
            "the {what}, as a link asks for at most {most} samples"
        ));
    }
    // A set in space has no pattern.
    if p.pattern.side > MAX_PATTERN_SIDE && depth.is_none() {
        let most = MAX_PATTERN_SIDE;
        excess.push(format!(
            "the pattern's side, as a link asks for at most {most} r"
        ));
    }

    excess
}

/// Returns the smallest and the largest radius allowed for a domain.
fn radii(p: &Parameters) -> [f64; 2] {
    let shortest = match p.boundary {
        Boundary::Periodic => MIN_SIDE_RADII_PERIODIC,
        Boundary::Bounded => MIN_SIDE_RADII_BOUNDED,
    };
    // Sides are at most 1e30, so their product is finite.
    let crowded = (MAXIMAL_DENSITY * p.width * p.height / MAX_SAMPLES).sqrt();
    let least = crowded.max(p.width.max(p.height) / MAX_SIDE_RADII);
    [least, p.width.min(p.height) / shortest]
}

/// Corrects the radius to the limits of the domain. A domain for which no radius is allowed becomes 1 by 1.
fn fit_radius(p: &mut Parameters, run: &str, warnings: &mut LinkWarnings) {
    let [least, largest] = radii(p);
    // A corrected radius has three digits. It is rounded away from the limit that was exceeded, and must still keep the
    // other limit.
    if up(least) > down(largest) {
        let (width, height) = (exact(p.width), exact(p.height));
        warnings.add(format!(
            "The link asked for a domain{run} of {width} by {height}, for which there is no radius; 1 by 1 is used instead."
        ));
        (p.width, p.height) = (1.0, 1.0);
    }

    // The domain may have changed, and its limits with it.
    let [least, largest] = radii(p);
    let asked = exact(p.radius);

    if p.radius < least {
        p.radius = up(least);
        warnings.add(format!(
            "The link asked for radius{run} {asked}, which makes more than the {} samples that a link may ask for or a domain that is too long; {} is used instead.",
            grouped(MAX_SAMPLES as usize),
            exact(p.radius)
        ));
    } else if p.radius > largest {
        p.radius = down(largest);
        warnings.add(format!(
            "The link asked for radius{run} {asked}, which is too large for its domain; {} is used instead.",
            exact(p.radius)
        ));
    }
}

/// Returns the next larger number of three digits.
fn up(number: f64) -> f64 {
    three_digits(number, 1.000_001)
}

/// Returns the next smaller number of three digits.
fn down(number: f64) -> f64 {
    three_digits(number, 0.999_999)
}

/// Returns the next number of three digits after `toward` times `number`: the next larger one if `toward` is above 1,
/// otherwise the next smaller one. `toward` differs from 1 by more than rounding does, so that the result is surely on
/// that side of `number`; a number that has three digits is therefore not returned itself.
fn three_digits(number: f64, toward: f64) -> f64 {
    let exponent = number.log10().floor() as i32 - 2;
    // Powers of ten from 1 to 1e22 are exact, and those below 1 are not. So the unit is never below 1, and small
    // numbers are multiplied by it instead of divided.
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
    // Parse the text, so that the number is exactly the one shown. A written number can always be read again.
    format!("{digits}e{exponent}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use tilescope_core::{Order, Search};

    use super::*;

    fn of(pairs: &[(&str, &str)]) -> (Parameters, LinkWarnings) {
        let mut warnings = LinkWarnings::default();
        let texts = |key: &str| pairs.iter().find(|(k, _)| *k == key).map(|(_, v)| *v);
        let read = read(texts, &Parameters::default(), "", &mut warnings);
        (read, warnings)
    }

    #[test]
    fn every_parameter_is_read_exactly_as_written() {
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
        let (read, warnings) = of(&pairs);
        assert_eq!((read, warnings.text().as_str()), (p, ""));
        let uniform = of(&[("insertion", "uniform")]).0;
        assert_eq!(uniform.insertion, Insertion::Uniform);
    }

    /// Without values of its own in the link, the pattern of an exact tiling follows from the size and the seed. A link names
    /// each value that differs from those.
    #[test]
    fn exact_tilings_are_read_as_written_with_their_usual_pattern_or_another() {
        let (asked, warnings) = of(&[("method", "exact"), ("seed", "7"), ("radius", "0.004")]);
        assert_eq!(warnings.text(), "");
        let expected = PatternSpec {
            side: 400.0,
            seed: 7,
            ..PatternSpec::default()
        };
        assert_eq!(
            (asked.method, asked.pattern),
            (TilingMethod::Exact, expected)
        );

        let mut other = asked;
        other.pattern.side = 100.0;
        let kdrt = Parameters {
            method: TilingMethod::Kdrt,
            ..other
        };
        // An own seed beside the usual side, in a bounded pattern; and the next seed with its pattern.
        let mut own_seed = asked;
        own_seed.pattern.seed = 4;
        own_seed.pattern.boundary = Boundary::Bounded;
        let mut next = Parameters { seed: 8, ..other };
        next.pattern.seed = 8;
        let first = Parameters::default();
        for (run, base) in [
            (asked, first),
            (other, first),
            (first.as_exact(), first),
            (kdrt, asked),
            (first, other),
            (own_seed, first),
            (own_seed, other),
            (own_seed, asked),
            (next, other),
        ] {
            let pairs: Vec<_> = differing(&run, &base).collect();
            let texts = |key: &str| {
                let mut pairs = pairs.iter();
                pairs
                    .find(|(other, _)| *other == key)
                    .map(|(_, value)| value.as_str())
            };
            let mut warnings = LinkWarnings::default();
            assert_eq!(
                read(texts, &base, " of run B", &mut warnings),
                run,
                "{pairs:?}"
            );
            assert_eq!(warnings.text(), "");
        }
        assert_eq!(differing(&asked, &first).count(), 3);

        let (read, warnings) = of(&[("method", "exact"), ("order", "index")]);
        assert_eq!(read.order, Order::default());
        assert!(warnings.text().contains("keeps whatever arrived first"));
    }

    #[test]
    fn the_defaults_of_version_1_never_change() {
        // Links of version 1 rely on these values for all parameters that they leave out.
        let text = format!("{:?}", Parameters::default());
        assert_eq!(
            text,
            "Parameters { width: 1.0, height: 1.0, radius: 0.00836, boundary: Periodic, seed: 1, method: Kdrt, leaf: 30.0, \
             pattern: PatternSpec { side: 100.0, boundary: Periodic, seed: 0 }, dihedral: false, order: OwnBlockFirst, \
             insertion: Circumcentre, search: Complete, variant: Staged }"
        );
    }

    #[test]
    fn parameters_that_cannot_be_sampled_are_corrected() {
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
            let (p, warnings) = of(pairs);
            assert!(
                warnings.text().contains(part),
                "{pairs:?}: {}",
                warnings.text()
            );
            let domain = p.validate_sequential().expect("parameters to sample");
            assert!(domain.area_radii() * MAXIMAL_DENSITY <= MAX_SAMPLES);
            assert!(p.pattern.side <= MAX_PATTERN_SIDE);
            // The corrected parameters need no further correction.
            let pairs: Vec<_> = differing(&p, &Parameters::default()).collect();
            let pairs: Vec<_> = pairs.iter().map(|(k, v)| (*k, v.as_str())).collect();
            let (again, warnings) = of(&pairs);
            assert_eq!((again, warnings), (p, LinkWarnings::default()));
        }
    }

    #[test]
    fn an_invalid_value_changes_nothing_and_is_named() {
        for parameter in in_links() {
            let (p, warnings) = of(&[(link_key(parameter), "?")]);
            assert_eq!(p, Parameters::default(), "{parameter:?}");
            let asked = format!("asked for {} ?;", name_of(parameter));
            assert!(
                warnings.text().contains(&asked),
                "{parameter:?}: {}",
                warnings.text()
            );
        }
    }

    #[test]
    fn numbers_of_three_digits_are_rounded_to_the_requested_side() {
        for number in [1e-30, 0.001_867_6, 0.1, 1.0, 123.456, 9.999_9, 4e29] {
            let (below, above) = (down(number), up(number));
            assert!(below < number && number < above, "{below} {number} {above}");
            assert!(above - below < 0.05 * number, "{below} {number} {above}");
        }
    }
}
