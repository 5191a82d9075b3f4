//! The parameters as typed, as text, and the check whether they can be run. The core decides what is valid;
//! this module assigns its errors to fields.

use tilescope_core::{
    Boundary, Insertion, MAXIMAL_DENSITY, Order, ParameterError, Parameters, Search, Variant,
};

use tilescope_session::limits::{MAX_ON_A_PAGE, MAX_STAGED};
use tilescope_session::words::{grouped, sentence};

/// A parameter that is typed as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Field {
    /// Width of the domain, in user units.
    Width,
    /// Height of the domain, in user units.
    Height,
    /// Poisson-disk radius, in user units.
    Radius,
    /// Seed of the run.
    Seed,
    /// Shortest edge of a block, in r.
    Leaf,
    /// Side of the pattern, in r.
    PatternSide,
    /// Seed of the pattern.
    PatternSeed,
}

/// A parameter that is chosen from a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// The boundary of the domain.
    Boundary(Boundary),
    /// The boundary of the pattern.
    PatternBoundary(Boundary),
    /// Whether the pattern is turned and mirrored.
    Dihedral(bool),
    /// Order of elimination.
    Order(Order),
    /// How gaps are filled.
    Insertion(Insertion),
    /// The search radius of detectors.
    Search(Search),
    /// The form of Algorithm 4: staged, or as printed.
    Variant(Variant),
}

/// Every typed field, in the order of the panel.
pub const FIELDS: [Field; 7] = [
    Field::Width,
    Field::Height,
    Field::Radius,
    Field::Seed,
    Field::Leaf,
    Field::PatternSide,
    Field::PatternSeed,
];

/// Parameters being edited.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    texts: [String; FIELDS.len()],
    /// The values; a number is that of the last valid text.
    pub parameters: Parameters,
}

/// Why a draft cannot be run, and which field that concerns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DraftRefusal {
    /// The field it belongs to; `None` for a combination of choices.
    pub field: Option<Field>,
    /// The reason, as a sentence.
    pub reason: String,
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
        let p = &parameters;
        let texts = [
            p.width.to_string(),
            p.height.to_string(),
            p.radius.to_string(),
            p.seed.to_string(),
            p.leaf.to_string(),
            p.pattern.side.to_string(),
            p.pattern.seed.to_string(),
        ];
        Self { texts, parameters }
    }

    /// Returns the text of a field.
    #[must_use]
    pub fn text(&self, field: Field) -> &str {
        &self.texts[field as usize]
    }

    /// Replaces the text of a field.
    pub fn set_text(&mut self, field: Field, text: String) {
        let value = text.trim();
        let p = &mut self.parameters;
        match field {
            Field::Width => assign(&mut p.width, value),
            Field::Height => assign(&mut p.height, value),
            Field::Radius => assign(&mut p.radius, value),
            Field::Seed => assign(&mut p.seed, value),
            Field::Leaf => assign(&mut p.leaf, value),
            Field::PatternSide => assign(&mut p.pattern.side, value),
            Field::PatternSeed => assign(&mut p.pattern.seed, value),
        }
        self.texts[field as usize] = text;
    }

    /// Makes a choice.
    pub fn choose(&mut self, choice: Choice) {
        let p = &mut self.parameters;
        match choice {
            Choice::Boundary(boundary) => p.boundary = boundary,
            Choice::PatternBoundary(boundary) => p.pattern.boundary = boundary,
            Choice::Dihedral(dihedral) => p.dihedral = dihedral,
            Choice::Order(order) => p.order = order,
            Choice::Insertion(insertion) => p.insertion = insertion,
            Choice::Search(search) => p.search = search,
            Choice::Variant(variant) => p.variant = variant,
        }
    }

    /// Returns all errors, field by field: unreadable texts first, then what the core refuses. If empty, the draft can
    /// be run.
    #[must_use]
    pub fn refusals(&self) -> Vec<DraftRefusal> {
        let mut refusals: Vec<DraftRefusal> = FIELDS
            .into_iter()
            .filter_map(|field| {
                let reason = self.unreadable(field)?;
                Some(DraftRefusal {
                    field: Some(field),
                    reason,
                })
            })
            .collect();
        if let Err(error) = self.parameters.validate_sequential() {
            let field = field_of(&error);
            if !refusals.iter().any(|refusal| refusal.field == field) {
                let reason = sentence(&error.to_string());
                refusals.push(DraftRefusal { field, reason });
            }
        }
        // Algorithm 4 as printed always records events, which limits its size.
        let most = match self.parameters.variant {
            Variant::Staged => MAX_ON_A_PAGE,
            Variant::AsPrinted => MAX_STAGED,
        };
        let too_many = too_many(self.expected_samples(), most);
        refusals.extend(too_many.filter(|_| cfg!(target_arch = "wasm32")));
        refusals
    }

    /// Returns the parameters, unless a text cannot be read, since the numbers are then those of an earlier text.
    fn read(&self) -> Option<&Parameters> {
        let is_readable = |field| self.unreadable(field).is_none();
        FIELDS
            .into_iter()
            .all(is_readable)
            .then_some(&self.parameters)
    }

    /// Returns the names of the parameters that differ from `made`.
    #[must_use]
    pub fn differences(&self, made: &Parameters) -> Vec<&'static str> {
        let p = &self.parameters;
        let [typed, run] = [*p, *made].map(Self::from_parameters);
        let names = [
            "width",
            "height",
            "radius",
            "seed",
            "smallest block",
            "pattern size",
            "pattern seed",
        ];
        let differs =
            |field: Field| typed.text(field) != run.text(field) || self.unreadable(field).is_some();
        let fields = FIELDS.into_iter().zip(names);
        let typed = fields.filter(|(field, _)| differs(*field));
        let chosen = [
            ("boundary", p.boundary != made.boundary),
            (
                "pattern border",
                p.pattern.boundary != made.pattern.boundary,
            ),
            ("orientation", p.dihedral != made.dihedral),
            ("who wins", p.order != made.order),
            ("insertion", p.insertion != made.insertion),
            ("gap search", p.search != made.search),
            ("Algorithm 4", p.variant != made.variant),
        ];
        let chosen = chosen
            .into_iter()
            .filter_map(|(name, differs)| differs.then_some(name));
        typed.map(|(_, name)| name).chain(chosen).collect()
    }

    /// Returns the expected number of samples of a run.
    #[must_use]
    pub fn expected_samples(&self) -> Option<f64> {
        let domain = self.read()?.validate_sequential().ok()?;
        Some(domain.area_radii() * MAXIMAL_DENSITY)
    }

    /// Returns whether so large a run keeps its result without its steps.
    #[must_use]
    pub fn keeps_result_only(&self) -> bool {
        let is_staged = self.parameters.variant == Variant::Staged;
        is_staged
            && self
                .expected_samples()
                .is_some_and(|samples| samples > MAX_STAGED)
    }

    /// Returns the smallest side of a pattern that does not repeat within a block, if the present one does.
    #[must_use]
    pub fn side_without_repeats(&self) -> Option<f64> {
        self.read()?.side_without_repeats()
    }

    fn unreadable(&self, field: Field) -> Option<String> {
        let text = self.text(field).trim();
        match field {
            Field::Seed | Field::PatternSeed => text
                .parse::<u64>()
                .err()
                .map(|_| format!("\"{text}\" is not a whole number from 0 to {}.", u64::MAX)),
            _ => decimal(text)
                .parse::<f64>()
                .err()
                .map(|_| format!("\"{text}\" is not a number.")),
        }
    }
}

/// Returns a number with a point where it was typed with a decimal comma.
fn decimal(text: &str) -> String {
    let is_decimal = text.matches(',').count() == 1 && !text.contains('.');
    if is_decimal {
        text.replace(',', ".")
    } else {
        text.to_owned()
    }
}

fn assign<T: std::str::FromStr>(value: &mut T, text: &str) {
    if let Ok(read) = decimal(text).parse() {
        *value = read;
    }
}

fn field_of(error: &ParameterError) -> Option<Field> {
    match error {
        ParameterError::Radius { .. } | ParameterError::TooManySamples { .. } => {
            Some(Field::Radius)
        }
        ParameterError::Side { name, .. }
        | ParameterError::SideTooShort { name, .. }
        | ParameterError::SideTooLong { name, .. } => Some(match *name {
            "height" => Field::Height,
            _ => Field::Width,
        }),
        ParameterError::Leaf { .. } => Some(Field::Leaf),
        ParameterError::PatternSide { .. } => Some(Field::PatternSide),
        _ => None,
    }
}

fn too_many(expected: Option<f64>, most: f64) -> Option<DraftRefusal> {
    let expected = expected.filter(|expected| *expected > most)?;
    let [expected, most] = [expected, most].map(|count| grouped(count as usize));
    Some(DraftRefusal {
        field: Some(Field::Radius),
        reason: format!(
            "A run would have about {expected} samples; in a browser at most {most} are possible, in the native program more."
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_draft_is_the_default_session() {
        let draft = Draft::default();
        assert_eq!(draft.refusals(), []);
        assert_eq!(draft.parameters, Parameters::default());
        assert_eq!(draft.text(Field::Radius), "0.00836");
    }

    #[test]
    fn a_run_too_large_for_a_page_is_refused_with_both_numbers() {
        assert_eq!(too_many(Some(2e6), 2e6), None);
        assert_eq!(too_many(None, 2e6), None);
        let refusal = too_many(Some(1e9), 2e6).unwrap();
        assert_eq!(refusal.field, Some(Field::Radius));
        assert!(refusal.reason.contains("1,000,000,000") && refusal.reason.contains("2,000,000"));
    }

    #[test]
    fn a_decimal_comma_is_read_as_a_point() {
        let mut draft = Draft::default();
        draft.set_text(Field::Radius, "0,01".to_owned());
        assert_eq!((draft.refusals(), draft.parameters.radius), (vec![], 0.01));
        for text in ["0,0,1", "1,000.5", ","] {
            draft.set_text(Field::Radius, text.to_owned());
            assert_eq!(draft.refusals()[0].field, Some(Field::Radius), "{text}");
        }
    }

    #[test]
    fn refusals_name_their_field() {
        for (field, text, part) in [
            (Field::Radius, "0", "above 0"),
            (Field::Radius, "one", "\"one\" is not a number"),
            (Field::Radius, "NaN", "NaN"),
            (Field::Radius, "0.00002", "at most"),
            (Field::Width, "-1", "width"),
            (Field::Height, "0.01", "height"),
            (Field::Seed, "-1", "whole number"),
            (Field::Leaf, "2", "at least 6 r"),
            (Field::PatternSide, "3", "between 10 r"),
            (Field::PatternSeed, "", "whole number"),
        ] {
            let mut draft = Draft::default();
            draft.set_text(field, text.to_owned());
            let refusals = draft.refusals();
            assert_eq!(refusals.len(), 1, "{field:?} {text}");
            assert_eq!(refusals[0].field, Some(field));
            assert!(refusals[0].reason.contains(part), "{}", refusals[0].reason);
        }
    }

    #[test]
    fn an_unreadable_text_prevents_estimates() {
        for field in FIELDS {
            let mut draft = Draft::default();
            draft.set_text(Field::Leaf, "80".to_owned());
            assert!(draft.expected_samples().is_some() && draft.side_without_repeats().is_some());
            draft.set_text(field, "abc".to_owned());
            assert_eq!(draft.expected_samples(), None, "{field:?}");
            assert_eq!(draft.side_without_repeats(), None, "{field:?}");
        }
    }

    #[test]
    fn texts_are_read_back_as_numbers() {
        let mut draft = Draft::default();
        draft.set_text(Field::Seed, " 77 ".to_owned());
        draft.set_text(Field::Leaf, "12.5".to_owned());
        assert_eq!(draft.parameters.seed, 77);
        assert!((draft.parameters.leaf - 12.5).abs() < f64::EPSILON);
    }
}
