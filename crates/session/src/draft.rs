//! The parameters as typed. Begin with [`Draft`]. The core decides which parameters are valid; [`Draft::refusals`] assigns its
//! errors to fields.

mod choice;
mod ground;
mod polygon;
mod preset;
mod refusal;
mod shared;
mod stipple;

use std::collections::{BTreeMap, BTreeSet};

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use tilescope_core::memory::Making;
use tilescope_core::{
    MAXIMAL_DENSITY, NestedRequest, Parameter, ParameterKind, Parameters, TilingMethod, Variant,
    WithinLevel, radius_estimate,
};

use crate::ground::MAX_RECORDED;
use crate::limits::MAX_STAGED;
use crate::typed;
use crate::words::{grouped, sentence};

pub use choice::Choice;
pub use ground::{GroundDraft, RadiusBy};
pub use preset::Preset;
pub use refusal::{DraftRefusal, FormPart};
pub use shared::SharedPattern;
pub use stipple::{StippleDraft, StippleNumber};

/// Returns the parameters that are typed, in the order of the panel.
pub fn numbers() -> impl Iterator<Item = Parameter> {
    Parameter::all().filter(|parameter| parameter.options().is_empty())
}

/// Reads a parameter that is typed.
pub fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Parameter, D::Error> {
    let parameter = Parameter::deserialize(deserializer)?;
    if parameter.options().is_empty() {
        return Ok(parameter);
    }
    let key = parameter.key();
    Err(D::Error::custom(format!("{key} is chosen, not typed")))
}

/// Before runs of this many samples start, the form warns of their cost. Chosen, not measured.
const MANY_SAMPLES: f64 = 2e7;
/// The memory of a run, its verdict and its picture, for each sample: 8.9 GB were measured at 10^8 samples.
const BYTES_PER_SAMPLE: f64 = 90.0;

/// The numbers of a pattern.
const OF_PATTERN: [Parameter; 2] = [Parameter::PatternSide, Parameter::PatternSeed];

/// Returns whether a number of the pattern is the usual one of such parameters.
fn is_usual(number: Parameter, parameters: &Parameters) -> bool {
    number.value(parameters) == number.value(&with_usual_pattern(parameters))
}

/// Returns the parameters with the pattern that their method and number of samples have if none is named.
fn with_usual_pattern(parameters: &Parameters) -> Parameters {
    Parameters {
        pattern: parameters.usual_pattern(),
        ..*parameters
    }
}

/// Parameters that are being edited, with the texts of their fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    /// The numbers as typed.
    texts: BTreeMap<Parameter, String>,
    /// The number of samples as typed, if the radius was given by it.
    count: Option<String>,
    /// The number of nested levels, if there are to be some.
    pub levels: Option<u32>,
    /// How many samples these are to have exactly, as typed; empty if the radius decides.
    pub exactly: String,
    /// The order of the samples within a level.
    pub within: WithinLevel,
    /// The field and the shape, if the radius depends on the place or the domain is a shape.
    pub ground: GroundDraft,
    /// The third side as typed, which makes the set one in space; empty for a planar set.
    pub depth: String,
    /// The values; a number is that of the last valid text.
    pub parameters: Parameters,
    /// The numbers of the pattern that stay when the set changes: they were typed, or are not the usual ones.
    fixed: BTreeSet<Parameter>,
}

impl Default for Draft {
    fn default() -> Self {
        Self::from_parameters(Parameters::default())
    }
}

impl Draft {
    /// Returns the draft with the texts of `parameters`.
    #[must_use]
    pub fn from_parameters(parameters: Parameters) -> Self {
        let texts = numbers().map(|parameter| (parameter, parameter.text(&parameters)));
        let fixed = OF_PATTERN.into_iter();
        Self {
            fixed: fixed
                .filter(|number| !is_usual(*number, &parameters))
                .collect(),
            texts: texts.collect(),
            count: None,
            levels: None,
            exactly: String::new(),
            within: WithinLevel::default(),
            ground: GroundDraft::default(),
            depth: String::new(),
            parameters,
        }
    }

    /// Returns the draft with this third side, if there is one.
    #[must_use]
    pub fn with_depth(self, depth: Option<f64>) -> Self {
        let depth = depth.map_or_else(String::new, |depth| depth.to_string());
        Self { depth, ..self }
    }

    /// Returns whether a third side is typed, whatever it is: then the set is one in space.
    #[must_use]
    pub fn is_in_space(&self) -> bool {
        !self.depth.trim().is_empty()
    }

    /// Returns the third side, if one is typed that is a number.
    #[must_use]
    pub fn depth_asked(&self) -> Option<f64> {
        typed::number(&self.depth).filter(|_| self.is_in_space())
    }

    /// Returns the draft with these nested levels, if any.
    #[must_use]
    pub fn with_nesting(self, nesting: Option<NestedRequest>) -> Self {
        let exactly = nesting.and_then(|nesting| nesting.exactly);
        Self {
            levels: nesting.map(|nesting| nesting.levels),
            exactly: exactly.map_or_else(String::new, |count| count.to_string()),
            within: nesting.map_or(self.within, |nesting| nesting.order_within),
            ..self
        }
    }

    /// Returns the nested levels that are asked for, if any. A number of samples that cannot be read is left out; it is
    /// among the refusals.
    #[must_use]
    pub fn nesting(&self) -> Option<NestedRequest> {
        Some(NestedRequest {
            levels: self.levels?,
            exactly: self.exactly_read().ok().flatten(),
            order_within: self.within,
        })
    }

    /// Returns how many samples are to be there exactly, or why the text says no number.
    fn exactly_read(&self) -> Result<Option<usize>, String> {
        let text = self.exactly.trim();
        if text.is_empty() {
            return Ok(None);
        }
        count_of(text).map(|count| usize::try_from(count).ok())
    }

    /// Returns the text of a number; it is empty for a parameter that is chosen.
    #[must_use]
    pub fn text(&self, parameter: Parameter) -> &str {
        self.texts.get(&parameter).map_or("", String::as_str)
    }

    /// Replaces the text of a number. A text that cannot be read leaves the value. A parameter that is chosen stays as it is.
    pub fn set_text(&mut self, parameter: Parameter, text: String) {
        let Some(read) = value_of(parameter, &text) else {
            return;
        };

        let before = self.parameters;
        let is_read = read.is_ok();
        // The value has the type of the parameter, so that setting it cannot fail. Limits are not checked here:
        // `refusals` names them.
        if let Ok(value) = read {
            drop(parameter.set(&mut self.parameters, value));
        }

        if OF_PATTERN.contains(&parameter) {
            // The usual number, typed, follows again. A text that cannot be read must stay until it can be.
            if is_read && is_usual(parameter, &self.parameters) {
                self.fixed.remove(&parameter);
            } else {
                self.fixed.insert(parameter);
            }
        }

        self.texts.insert(parameter, text);
        self.follow(&before);
        // A typed number of samples applied to the former parameters.
        self.count = None;
    }

    /// Changes a number by small steps: lengths by 2%, sizes in r and seeds by 1.
    pub fn nudge(&mut self, parameter: Parameter, steps: i32) {
        let text = match &parameter.row().kind {
            ParameterKind::Whole(place) => {
                let seed = *place(&mut self.parameters);
                seed.saturating_add_signed(i64::from(steps)).to_string()
            }

            // A size below its limit is refused, as one that was typed.
            ParameterKind::Real { place, unit, .. } if *unit == "r" => {
                (*place(&mut self.parameters) + f64::from(steps)).to_string()
            }

            ParameterKind::Real { place, .. } => {
                // By a factor, as lengths go over several orders of magnitude. A fiftieth was chosen, not measured.
                let scaled = *place(&mut self.parameters) * 1.02_f64.powi(steps);
                // Four digits, so that the field does not fill with the digits of a product. A written number can always be
                // read again.
                let short = format!("{scaled:.3e}").parse::<f64>();
                short.unwrap_or(scaled).to_string()
            }

            ParameterKind::Switch { .. } | ParameterKind::Choice { .. } => return,
        };

        self.set_text(parameter, text);
    }

    /// Returns the number of samples as typed, or otherwise the expected one with two significant digits; empty if that is not known.
    #[must_use]
    pub fn count_text(&self) -> String {
        let expected = || {
            let samples = self.expected_samples()?;
            // Two digits, as the number is an expectation, but whole samples.
            let step = 10_f64.powf((samples.log10().floor() - 1.0).max(0.0));
            Some(format!("{}", (samples / step).round() * step))
        };
        self.count.clone().or_else(expected).unwrap_or_default()
    }

    /// Sets the radius to that of about the number of samples in the text, if it is a number for which there is one.
    pub fn set_count(&mut self, text: String) {
        if let Ok(radius) = self.radius_of(&text) {
            self.set_text(Parameter::Radius, radius.to_string());
        }
        self.count = Some(text);
    }

    /// Returns why there is no radius for the typed number of samples, or `None` if there is one.
    #[must_use]
    pub fn count_refusal(&self) -> Option<String> {
        self.radius_of(self.count.as_ref()?).err()
    }

    /// Returns the radius of about the given number of samples, with five significant digits.
    fn radius_of(&self, text: &str) -> Result<f64, String> {
        let estimate = radius_estimate(&self.parameters, count_of(text.trim())?);
        let radius = estimate.map_err(|error| sentence(&error.to_string()))?;
        // A written number can always be read again.
        Ok(format!("{radius:.4e}").parse().unwrap_or(radius))
    }

    /// Returns whether a parameter is not that of a run.
    #[must_use]
    pub fn differs(&self, parameter: Parameter, made: &Parameters) -> bool {
        parameter.text(&self.parameters) != parameter.text(made)
            || self.unreadable(parameter).is_some()
    }

    /// Sets a value that is chosen, and what follows from it.
    pub fn choose(&mut self, choice: Choice) {
        match choice {
            // A value outside its options changes nothing; scripts with such a one are refused.
            Choice::Parameter(parameter, value) => {
                let before = self.parameters;
                drop(parameter.set(&mut self.parameters, value));
                self.follow(&before);
            }
            Choice::Levels(levels) => self.levels = levels,
            Choice::Within(within) => self.within = within,
            Choice::RadiusBy(by) => self.choose_radius_by(by),
        }
    }

    /// Changes the parameters that follow from a change. With the change to exact tiling, those without a meaning there get
    /// their defaults. The side of the pattern follows the size of the set, and its seed the seed, unless they were typed.
    fn follow(&mut self, before: &Parameters) {
        // The parameters without a meaning there are chosen, so that no text changes with them.
        if self.parameters.method == TilingMethod::Exact && before.method == TilingMethod::Kdrt {
            self.parameters = self.parameters.as_exact();
        }

        let usual = with_usual_pattern(&self.parameters);
        for number in OF_PATTERN {
            let value = number.value(&usual);
            if self.fixed.contains(&number) || value == number.value(&self.parameters) {
                continue;
            }
            // It is a value of the same parameter, so that it can be set.
            drop(number.set(&mut self.parameters, value));
            self.texts.insert(number, number.text(&usual));
        }
    }

    /// Returns the parameters, unless a text cannot be read, since the numbers are then those of an earlier text.
    fn read(&self) -> Option<&Parameters> {
        let is_readable = numbers().all(|parameter| self.unreadable(parameter).is_none());
        (is_readable && self.count_refusal().is_none()).then_some(&self.parameters)
    }

    /// Returns the names of the parameters that differ from `made`.
    #[must_use]
    pub fn differences(&self, made: &Parameters) -> Vec<&'static str> {
        // Typed numbers come first, as in each part of the form.
        let chosen = Parameter::all().filter(|parameter| !parameter.options().is_empty());
        // A parameter that the next run does not use makes no difference.
        let differing = numbers()
            .chain(chosen)
            .filter(|parameter| self.uses(*parameter) && self.differs(*parameter, made));
        differing.map(|parameter| parameter.row().label).collect()
    }

    /// Returns the expected number of samples of a run; `None` if a text cannot be read or the parameters are refused.
    #[must_use]
    pub fn expected_samples(&self) -> Option<f64> {
        if self.is_in_space() {
            let depth = self.depth_asked()?;
            return crate::solid::expected_samples(&self.parameters, depth).ok();
        }
        if self.ground.is_asked() {
            return self.ground_samples();
        }
        let domain = self.read()?.validate_sequential().ok()?;
        if let Some(count) = self.nesting().and_then(|nesting| nesting.exactly) {
            return Some(count as f64);
        }
        Some(domain.area_radii() * MAXIMAL_DENSITY)
    }

    /// Returns whether so large a run keeps its result without its steps.
    #[must_use]
    pub fn keeps_result_only(&self) -> bool {
        let most = if self.ground.is_asked() || self.is_in_space() {
            MAX_RECORDED
        } else {
            MAX_STAGED
        };
        let samples = self.expected_samples().filter(|samples| *samples > most);
        // Algorithm 4 as printed always records its events, and any prefix of nested levels and of a stipple is shown without
        // events.
        let has_prefixes = self.levels.is_some() || self.ground.by == RadiusBy::Stipple;
        let has_steps = self.parameters.variant == Variant::AsPrinted || has_prefixes;
        samples.is_some() && !has_steps
    }

    /// Returns a sentence on the memory that a run needs, if that is a lot: `None` for runs that any computer can make.
    #[must_use]
    pub fn memory_needed(&self) -> Option<String> {
        let samples = self.expected_samples()?;
        // The cubes that throw darts take more memory than the samples.
        let bytes_per_sample = if self.is_in_space() {
            Making::Solid.bytes_a_sample()
        } else {
            BYTES_PER_SAMPLE
        };
        let needed = samples * bytes_per_sample / 1e9;
        (samples >= MANY_SAMPLES).then(|| {
            let count = grouped((samples / 1e6).round() as usize * 1_000_000);
            format!("About {count} samples need about {needed:.0} GB of memory, and minutes.")
        })
    }

    /// Returns the smallest side of a pattern that does not repeat within a block, if the present one does.
    #[must_use]
    pub fn side_without_repeats(&self) -> Option<f64> {
        self.read()?.side_without_repeats()
    }

    /// Returns why the text of a parameter is no value of it, if so.
    fn unreadable(&self, parameter: Parameter) -> Option<String> {
        value_of(parameter, self.text(parameter))?.err()
    }
}

/// Returns the value that a text says of a number, or why it says none; `None` for a parameter that is chosen.
fn value_of(parameter: Parameter, text: &str) -> Option<Result<Value, String>> {
    let (value, what) = match parameter.row().kind {
        ParameterKind::Whole(_) => {
            let most = tilescope_core::grouped(u64::MAX);
            let what = format!("a whole number from 0 to {most}");
            (typed::whole(text).map(Value::from), what)
        }

        ParameterKind::Real { .. } => {
            let value = typed::number(text).map(Value::from);
            (value, "a number".to_owned())
        }
        ParameterKind::Switch { .. } | ParameterKind::Choice { .. } => return None,
    };

    Some(value.ok_or_else(|| format!("\"{}\" is not {what}.", text.trim())))
}

/// Returns the number of samples or of dots that a text says, or why it says none.
fn count_of(text: &str) -> Result<u64, String> {
    let count = typed::whole(text).filter(|count| *count > 0);
    let wrong = || format!("\"{text}\" is not a whole number from 1 on.");
    count.ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::refusal::too_many;
    use super::*;

    #[test]
    fn the_default_draft_is_the_default_session() {
        let draft = Draft::default();
        assert_eq!(draft.refusals(), []);
        assert_eq!(draft.parameters, Parameters::default());
        assert_eq!(draft.text(Parameter::Radius), "0.00836");
    }

    #[test]
    fn a_choice_of_a_script_is_a_field_with_its_value() {
        for text in [
            r#"{"dihedral":true}"#,
            r#"{"pattern-boundary":"bounded"}"#,
            r#"{"search":"two-radii"}"#,
            r#"{"levels":4}"#,
            r#"{"levels":null}"#,
            r#"{"within":"farthest"}"#,
            r#"{"radius-by":"expression"}"#,
        ] {
            let choice: Choice = serde_json::from_str(text).expect(text);
            assert_eq!(serde_json::to_string(&choice).expect(text), text);
        }
        for (text, part) in [
            (r#"{"dihedral":"maybe"}"#, "expected a boolean"),
            (r#"{"order":"best"}"#, "unknown variant `best`"),
            (r#"{"seed":7}"#, "unknown choice `seed`"),
            (r#"{"order":"index","search":"complete"}"#, "one field"),
            ("{}", "one field"),
        ] {
            let error = serde_json::from_str::<Choice>(text).expect_err(text);
            assert!(error.to_string().contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn a_run_too_large_for_a_page_is_refused_with_both_numbers() {
        let part = FormPart::Field(Parameter::Radius);
        assert_eq!(too_many(part, Some(2e6), 2e6), None);
        assert_eq!(too_many(part, None, 2e6), None);
        let refusal = too_many(part, Some(1e9), 2e6).unwrap();
        assert_eq!(refusal.part, part);
        assert!(refusal.reason.contains("1,000,000,000") && refusal.reason.contains("2,000,000"));
    }

    #[test]
    fn one_rule_reads_the_commas_of_the_whole_form() {
        let mut draft = Draft::default();
        draft.set_text(Parameter::Radius, "0,01".to_owned());
        assert_eq!((draft.refusals(), draft.parameters.radius), (vec![], 0.01));
        // Thousands are thousands in every field: a side of 1,000 is not a side of 1.
        draft.set_text(Parameter::Width, "1,000".to_owned());
        draft.set_text(Parameter::Height, "1 000".to_owned());
        draft.set_text(Parameter::Radius, "20".to_owned());
        draft.set_text(Parameter::Seed, "1,000".to_owned());
        let p = &draft.parameters;
        assert_eq!(draft.refusals(), []);
        assert_eq!((p.width, p.height, p.seed), (1000.0, 1000.0, 1000));
        draft.set_count("1,000".to_owned());
        assert_eq!(draft.refusals(), []);
        for text in ["0,0,1", "1.000,5", ","] {
            draft.set_text(Parameter::Radius, text.to_owned());
            let part = FormPart::Field(Parameter::Radius);
            assert_eq!(draft.refusals()[0].part, part, "{text}");
        }
    }

    #[test]
    fn a_wrong_field_of_any_kind_refuses_the_run_by_its_name() {
        type Spoil = fn(&mut Draft);
        let wrong_exactly = |draft: &mut Draft| {
            (draft.levels, draft.exactly) = (Some(3), "abc".to_owned());
        };
        let spoil: [(&str, Spoil); 3] = [
            ("Samples", |draft| draft.set_count("abc".to_owned())),
            ("Radius", |draft| {
                draft.set_text(Parameter::Radius, "abc".to_owned());
            }),
            ("Exactly", wrong_exactly),
        ];
        for (name, spoil) in spoil {
            let mut draft = Draft::default();
            assert_eq!(draft.refusals(), []);
            spoil(&mut draft);
            let said = draft.refusals().first().map(DraftRefusal::with_name);
            let said = said.unwrap_or_default();
            let begins = format!("{name}: \"abc\" is not a ");
            assert!(said.starts_with(&begins), "{said}");
        }
    }

    #[test]
    fn too_few_samples_for_the_levels_are_not_told_to_change_the_radius() {
        let draft = Draft {
            levels: Some(4),
            exactly: "100".to_owned(),
            ..Draft::default()
        };
        let refusals = draft.refusals();
        assert_eq!(refusals.len(), 1, "{refusals:?}");
        assert_eq!(refusals[0].part, FormPart::Exactly);
        let reason = &refusals[0].reason;
        assert!(
            reason.contains("more samples") && !reason.contains("radius"),
            "{reason}"
        );
    }

    #[test]
    fn refusals_name_their_field() {
        for (field, text, part) in [
            (Parameter::Radius, "0", "above 0"),
            (Parameter::Radius, "one", "\"one\" is not a number"),
            (Parameter::Radius, "NaN", "NaN"),
            (Parameter::Radius, "0.00002", "at most"),
            (Parameter::Radius, "0.5", "choose a smaller radius"),
            (Parameter::Radius, "1e-12", "at most"),
            (Parameter::Width, "0.01", "width"),
            (Parameter::Width, "-1", "width"),
            (Parameter::Height, "0.01", "height"),
            (Parameter::Seed, "-1", "whole number"),
            (Parameter::Leaf, "2", "at least 6 r"),
            (Parameter::PatternSide, "3", "between 10 r"),
            (Parameter::PatternSeed, "", "whole number"),
        ] {
            let mut draft = Draft::default();
            draft.set_text(field, text.to_owned());
            let refusals = draft.refusals();
            assert_eq!(refusals.len(), 1, "{field:?} {text}");
            assert_eq!(refusals[0].part, FormPart::Field(field));
            assert!(refusals[0].reason.contains(part), "{}", refusals[0].reason);
        }
    }

    #[test]
    fn an_unreadable_text_prevents_estimates() {
        for field in numbers() {
            let mut draft = Draft::default();
            draft.set_text(Parameter::Leaf, "80".to_owned());
            assert!(draft.expected_samples().is_some() && draft.side_without_repeats().is_some());
            draft.set_text(field, "abc".to_owned());
            assert_eq!(draft.expected_samples(), None, "{field:?}");
            assert_eq!(draft.side_without_repeats(), None, "{field:?}");
        }
    }

    #[test]
    fn texts_are_read_back_as_numbers() {
        let mut draft = Draft::default();
        draft.set_text(Parameter::Seed, " 77 ".to_owned());
        draft.set_text(Parameter::Leaf, "12.5".to_owned());
        assert_eq!(draft.parameters.seed, 77);
        assert!((draft.parameters.leaf - 12.5).abs() < f64::EPSILON);
    }

    /// A number of the pattern that was typed stays, whatever the usual one is meanwhile.
    #[test]
    fn a_pattern_follows_the_set_but_for_what_was_typed() {
        let choose = |draft: &mut Draft, method: &str| {
            draft.choose(Choice::Parameter(Parameter::Method, method.into()));
        };
        let type_all = |draft: &mut Draft, texts: &[(Parameter, &str)]| {
            for &(parameter, text) in texts {
                draft.set_text(parameter, text.to_owned());
            }
        };
        let pattern = |draft: &Draft| {
            let numbers = OF_PATTERN.map(|number| draft.text(number).to_owned());
            assert_eq!(draft.refusals(), []);
            numbers
        };

        let mut draft = Draft::default();
        choose(&mut draft, "exact");
        type_all(&mut draft, &[(Parameter::Seed, "9")]);
        assert_eq!(pattern(&draft), ["200", "9"]);
        choose(&mut draft, "kdrt");
        assert_eq!(pattern(&draft), ["100", "0"]);

        // 200 r is the usual side of exact tiling, and 100 r that of KDRT.
        type_all(&mut draft, &[(Parameter::PatternSide, "200")]);
        choose(&mut draft, "exact");
        choose(&mut draft, "kdrt");
        assert_eq!(pattern(&draft), ["200", "0"]);
        choose(&mut draft, "exact");
        type_all(&mut draft, &[(Parameter::PatternSide, "100")]);
        choose(&mut draft, "kdrt");
        choose(&mut draft, "exact");
        assert_eq!(pattern(&draft), ["100", "9"]);

        // A seed passes the typed one of the pattern while it is typed.
        type_all(
            &mut draft,
            &[(Parameter::PatternSeed, "4"), (Parameter::Seed, "4")],
        );
        type_all(&mut draft, &[(Parameter::Seed, "42")]);
        assert_eq!(pattern(&draft), ["100", "4"]);
        // The usual one, typed, follows again.
        type_all(
            &mut draft,
            &[(Parameter::PatternSeed, "42"), (Parameter::Seed, "5")],
        );
        assert_eq!(pattern(&draft), ["100", "5"]);

        // A text that cannot be read stays until it can be.
        type_all(
            &mut draft,
            &[(Parameter::PatternSide, "5x"), (Parameter::Seed, "6")],
        );
        assert_eq!(draft.text(Parameter::PatternSide), "5x");
        assert!(!draft.refusals().is_empty());
        assert_eq!(draft.text(Parameter::PatternSeed), "6");
    }

    #[test]
    fn a_number_of_samples_sets_the_radius_and_the_radius_the_number() {
        let mut draft = Draft::default();
        assert_eq!(draft.count_text(), "10000");
        for (text, count) in [
            ("200000", 200_000.0),
            ("5,000", 5_000.0),
            (" 750 ", 750.0),
            ("1e6", 1e6),
            ("1 000 000", 1e6),
            ("1'000'000", 1e6),
        ] {
            draft.set_count(text.to_owned());
            assert_eq!(draft.count_text(), text);
            assert_eq!(draft.count_refusal(), None);
            let expected = draft.expected_samples().unwrap();
            assert!((expected / count - 1.0).abs() < 0.05, "{text}: {expected}");
        }
        // A count that no radius gives leaves the radius as it is.
        let radius = draft.parameters.radius;
        for text in ["", "many", "0", "-5", "1e-6", "99999999999999999"] {
            draft.set_count(text.to_owned());
            let refusal = draft.count_refusal().expect(text);
            assert!(refusal.ends_with('.'), "{refusal}");
            assert!(draft.parameters.radius.to_bits() == radius.to_bits());
        }
        draft.set_text(Parameter::Radius, "0.02".to_owned());
        assert_eq!(
            (draft.count_refusal(), &*draft.count_text()),
            (None, "1700")
        );
    }

    #[test]
    fn a_nudge_and_its_opposite_lead_back() {
        for field in numbers() {
            let mut draft = Draft::default();
            for steps in [3, 1, -4] {
                let before = draft.text(field).to_owned();
                draft.nudge(field, steps);
                // A seed is never below 0.
                let is_least = before == "0" && steps < 0;
                assert!(draft.text(field) != before || is_least, "{field:?}");
                assert_eq!(draft.refusals(), [], "{field:?}");
            }
            let (now, first) = (draft.text(field), Draft::default());
            let number = |text: &str| text.parse::<f64>().expect("a number");
            let ratio = number(now) - number(first.text(field));
            assert!(
                ratio.abs() <= 2e-3 * number(now).max(1e-9),
                "{field:?}: {now}"
            );
        }
    }

    #[test]
    fn large_runs_say_how_much_memory_they_need() {
        let mut draft = Draft::default();
        assert_eq!(draft.memory_needed(), None);
        draft.set_count("1e8".to_owned());
        let said = draft.memory_needed().unwrap();
        assert!(
            said.contains("100,000,000 samples") && said.contains("9 GB"),
            "{said}"
        );
        draft.set_count("abc".to_owned());
        assert_eq!(draft.memory_needed(), None);
    }

    #[test]
    fn every_preset_can_be_run() {
        for preset in Preset::all() {
            let draft = Draft::from_parameters(preset.parameters());
            let ground = preset.ground();
            let varies = matches!(
                preset,
                Preset::Ramp | Preset::Star | Preset::StillLife | Preset::Landscape
            );
            assert_eq!(ground.is_some(), varies, "{}", preset.name());
            let draft = draft
                .with_nesting(preset.nesting())
                .with_ground(ground.as_ref());
            assert_eq!(draft.refusals(), [], "{}", preset.name());
            let repeats = draft.side_without_repeats().is_some();
            assert_eq!(repeats, preset == Preset::LargeBlocks);
            assert_eq!(draft.keeps_result_only(), preset == Preset::Million);
        }
    }
}
