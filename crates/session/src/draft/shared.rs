//! What the pattern that the blocks of an exact tiling share means for the set and its time, and the way to the reference
//! sampler, which makes no pattern.

use tilescope_core::{MAXIMAL_DENSITY, Parameter, TilingMethod};
use tilescope_sets::{exact_seconds, independent_samples, reference_seconds};

use super::{Choice, Draft, RadiusBy};

/// The pattern that the blocks of an exact tiling share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedPattern {
    /// About how many samples the set will have.
    pub samples: f64,
    /// About how many samples the pattern has.
    pub of_pattern: f64,
    /// Whether it repeats within the largest blocks.
    pub repeats_within_blocks: bool,
    /// Whether it is a shape, of which no times were measured.
    pub is_shape: bool,
    /// About how many seconds the pattern takes, with its tables.
    pub of_making: f64,
    /// About how many seconds exact tiling of a rectangle takes from nothing, on one thread.
    pub seconds: f64,
    /// The same of the reference sampler.
    pub of_reference: f64,
}

impl SharedPattern {
    /// Returns of how many independent samples averages over the set are worth.
    #[must_use]
    pub fn independent(&self) -> f64 {
        independent_samples(self.samples, self.of_pattern)
    }

    /// Returns whether the pattern takes more time than it saves, as far as that was measured.
    #[must_use]
    pub fn is_slower(&self) -> bool {
        !self.is_shape && self.seconds > self.of_reference
    }
}

impl Draft {
    /// Returns the pattern that the blocks of the next run share; `None` unless that is an exact tiling whose parameters are
    /// valid.
    #[must_use]
    pub fn shared_pattern(&self) -> Option<SharedPattern> {
        let is_shape = self.tiles_shape();
        let is_rectangle = !self.ground.is_asked() && !self.is_in_space() && self.levels.is_none();
        if self.parameters.method != TilingMethod::Exact || !(is_shape || is_rectangle) {
            return None;
        }

        let (samples, side) = (self.expected_samples()?, self.parameters.pattern.side);
        Some(SharedPattern {
            samples,
            of_pattern: MAXIMAL_DENSITY * side * side,
            repeats_within_blocks: self.parameters.side_without_repeats().is_some(),
            is_shape,
            of_making: exact_seconds(0.0, side),
            seconds: exact_seconds(samples, side),
            of_reference: reference_seconds(samples),
        })
    }

    /// Takes the reference sampler in the place of exact tiling: the domain, its boundary, the radius and the seed stay.
    pub fn take_reference(&mut self) {
        let method = Choice::Parameter(Parameter::Method, "kdrt".into());
        self.choose(method);
        // A shape has darts unless it is tiled. A rectangle has them if its radius is a formula, and here the formula is the
        // number.
        if !self.ground.is_asked() {
            let boundary = self.parameters.boundary;
            self.ground.expression = self.parameters.radius.to_string();
            // The first formula of a form makes its domain bounded, as most formulas differ at opposite sides.
            self.choose_radius_by(RadiusBy::Expression);
            self.parameters.boundary = boundary;
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use tilescope_core::Boundary;

    use super::*;

    fn exact(radius: &str) -> Draft {
        let mut draft = Draft::default();
        draft.choose(Choice::Parameter(Parameter::Method, json!("exact")));
        draft.set_text(Parameter::Radius, radius.to_owned());
        draft
    }

    #[test]
    fn small_sets_say_that_their_pattern_does_not_pay_and_large_ones_do_not() {
        // About 17,000 samples, of a pattern of 200 r.
        let small = exact("0.0064").shared_pattern().expect("a pattern");
        assert!((16_000.0..18_000.0).contains(&small.samples), "{small:?}");
        assert!(
            (27_500.0..28_200.0).contains(&small.of_pattern),
            "{small:?}"
        );
        assert!(
            (10_000.0..11_000.0).contains(&small.independent()),
            "{small:?}"
        );
        assert!(small.is_slower(), "{small:?}");

        // About 700,000, of one of 400 r: it pays.
        let large = exact("0.001").shared_pattern().expect("a pattern");
        assert!(
            !large.is_slower() && large.of_pattern > 111_000.0,
            "{large:?}"
        );
        assert!(large.independent() < large.of_pattern, "{large:?}");
        // A larger pattern takes longer.
        let mut patterned = exact("0.001");
        patterned.set_text(Parameter::PatternSide, "2000".to_owned());
        let slow = patterned.shared_pattern().expect("a pattern");
        assert!(slow.is_slower() && !slow.repeats_within_blocks, "{slow:?}");
        // One of 30 r repeats within blocks, which may be 60 r long.
        patterned.set_text(Parameter::PatternSide, "30".to_owned());
        let narrow = patterned.shared_pattern().expect("a pattern");
        assert!(narrow.repeats_within_blocks, "{narrow:?}");

        // Negative controls: other methods and unreadable numbers have no such pattern.
        assert_eq!(Draft::default().shared_pattern(), None);
        assert_eq!(exact("none").shared_pattern(), None);
    }

    #[test]
    fn the_reference_sampler_keeps_domain_radius_and_seed() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let mut draft = exact("0.01");
            draft.choose(Choice::Parameter(Parameter::Boundary, json!(boundary)));
            draft.set_text(Parameter::Seed, "7".to_owned());
            let before = draft.parameters;
            draft.take_reference();

            assert_eq!(draft.shared_pattern(), None);
            assert_eq!(draft.refusals(), []);
            assert_eq!(
                (draft.ground.by, draft.ground.expression.as_str()),
                (RadiusBy::Expression, "0.01")
            );
            let after = draft.parameters;
            assert_eq!(
                (after.boundary, after.seed, after.width),
                (boundary, 7, before.width)
            );
            let [asked, made] = [
                before.validate().unwrap().area_radii() * MAXIMAL_DENSITY,
                draft.expected_samples().unwrap(),
            ];
            assert!((made / asked - 1.0).abs() < 0.02, "{made} {asked}");
        }
    }
}
