//! Why a draft cannot be run: texts that cannot be read, and errors of the core, each with the field that is at fault.

use tilescope_core::{Parameter, ParameterError, Parameters, SampleError, Variant};

use super::{Draft, RadiusBy, StippleNumber, numbers};
use crate::limits::{MAX_ON_A_PAGE, MAX_STAGED};
use crate::words::{capital, grouped, sentence};

/// A part of the form that can be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormPart {
    /// The field of a parameter.
    Field(Parameter),
    /// The number of samples that sets the radius.
    Samples,
    /// The exact number of samples of nested levels.
    Exactly,
    /// The radius as a function of x and y.
    Expression,
    /// The radius of white, of an image.
    White,
    /// A number of a stipple.
    Stipple(StippleNumber),
    /// The third side of a set in space.
    Depth,
    /// Choices that exclude each other.
    Choices,
}

impl FormPart {
    /// Returns the name beside the field; `None` for choices, whose error names them.
    #[must_use]
    pub fn name(self) -> Option<String> {
        match self {
            Self::Field(parameter) => Some(capital(parameter.row().label)),
            Self::Samples => Some("Samples".to_owned()),
            Self::Exactly => Some("Exactly".to_owned()),
            Self::Expression => Some("Formula".to_owned()),
            Self::White => Some("Of white".to_owned()),
            Self::Stipple(number) => Some(number.name().to_owned()),
            Self::Depth => Some("Depth".to_owned()),
            Self::Choices => None,
        }
    }
}

/// Why a draft cannot be run, and which part of the form that concerns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DraftRefusal {
    /// The part of the form.
    pub part: FormPart,
    /// The reason, as a sentence.
    pub reason: String,
}

impl DraftRefusal {
    /// Returns the reason with the name of its field, as it is said away from the field.
    #[must_use]
    pub fn with_name(&self) -> String {
        match self.part.name() {
            Some(name) => format!("{name}: {}", self.reason),
            None => self.reason.clone(),
        }
    }
}

impl Draft {
    /// Returns the errors, each at a field: all unreadable texts, then the first error of the core. If there are none, the draft
    /// can be run.
    #[must_use]
    pub fn refusals(&self) -> Vec<DraftRefusal> {
        let unreadable = |field| {
            let (part, reason) = (FormPart::Field(field), self.unreadable(field)?);
            Some(DraftRefusal { part, reason })
        };
        // In a field or a shape only some of the parameters are used, and others refuse nothing.
        let used = |field: &Parameter| self.uses(*field);
        let mut refusals: Vec<DraftRefusal> =
            numbers().filter(used).filter_map(unreadable).collect();
        // Only a page limits the number of samples, as a tab has little memory.
        let is_page = cfg!(target_arch = "wasm32");
        // Sets in space and on a ground get at most one refusal of the core, once all texts can be read.
        if self.is_in_space() {
            refusals.extend(self.solid_refusal().filter(|_| refusals.is_empty()));
            let part = FormPart::Field(Parameter::Radius);
            let above_limit = too_many(part, self.expected_samples(), MAX_ON_A_PAGE);
            refusals.extend(above_limit.filter(|_| is_page));
            return refusals;
        }
        if self.ground.is_asked() {
            refusals.extend(self.ground_refusal().filter(|_| refusals.is_empty()));
            // Where the form shows no radius, another field decides how many samples there are.
            let part = match self.ground.by {
                RadiusBy::Stipple => FormPart::Stipple(StippleNumber::Dots),
                RadiusBy::Expression => FormPart::Expression,
                RadiusBy::Constant | RadiusBy::Image | RadiusBy::Density => {
                    FormPart::Field(Parameter::Radius)
                }
            };
            let above_limit = too_many(part, self.expected_samples(), MAX_ON_A_PAGE);
            refusals.extend(above_limit.filter(|_| is_page));
            return refusals;
        }

        // If the number of samples cannot be read, the radius is still that of an earlier number, and not the one that is asked for.
        let part = FormPart::Samples;
        let wrong_count = self.count_refusal();
        refusals.extend(wrong_count.map(|reason| DraftRefusal { part, reason }));

        if let Err(error) = self.parameters.validate_sequential() {
            let part = part_of(&error, &self.parameters);
            // A field has only one refusal. If its text cannot be read, the core has judged an earlier value.
            if !refusals.iter().any(|refusal| refusal.part == part) {
                let reason = sentence(&error.to_string());
                refusals.push(DraftRefusal { part, reason });
            }
        } else if let Some(refusal) = self.nesting_refusal() {
            refusals.push(refusal);
        }

        // Above `MAX_STAGED` samples the staged variant keeps its result alone. Algorithm 4 as printed always keeps all
        // its stages, so that no more samples fit.
        let most = match self.parameters.variant {
            Variant::Staged => MAX_ON_A_PAGE,
            Variant::AsPrinted => MAX_STAGED,
        };
        let part = FormPart::Field(Parameter::Radius);
        let above_limit = too_many(part, self.expected_samples(), most);
        refusals.extend(above_limit.filter(|_| is_page));
        refusals
    }

    /// Returns why the set in space that is asked for cannot be made.
    fn solid_refusal(&self) -> Option<DraftRefusal> {
        let refused = |part, reason: String| Some(DraftRefusal { part, reason });
        let Some(depth) = self.depth_asked() else {
            let text = self.depth.trim();
            let reason = format!("\"{text}\" is not a number; without one the set is planar.");
            return refused(FormPart::Depth, reason);
        };

        // Balls have one radius and fill a box, and their darts have no levels.
        if self.levels.is_some() || self.ground.is_asked() {
            let what = "A set in space has one radius in a box: choose a constant radius, no shape and no nested levels, or leave the depth empty.";
            return refused(FormPart::Depth, what.to_owned());
        }

        let error = crate::solid::expected_samples(&self.parameters, depth).err()?;
        let SampleError::Parameters(of_parameters) = &error else {
            return refused(FormPart::Depth, sentence(&error.to_string()));
        };
        let part = match of_parameters {
            // `part_of` judges sides as those of a planar domain, which has no depth. An error of the depth stays at
            // its field.
            ParameterError::Side { name: "depth", .. }
            | ParameterError::SideTooShort { name: "depth", .. }
            | ParameterError::SideTooLong { name: "depth", .. } => FormPart::Depth,
            ParameterError::Volume { .. } => FormPart::Field(Parameter::Radius),
            other => part_of(other, &self.parameters),
        };
        refused(part, sentence(&error.to_string()))
    }

    /// Returns whether the next run uses a parameter: in a field there is no tiling, a shape is tiled only exactly, and a formula
    /// and the dots of a stipple give the radius themselves.
    #[must_use]
    pub fn uses(&self, parameter: Parameter) -> bool {
        let has_number = !matches!(self.ground.by, RadiusBy::Expression | RadiusBy::Stipple);
        // A set in space is made by darts, too.
        let is_tiled = !self.ground.is_asked() && !self.is_in_space();
        match parameter {
            Parameter::Width | Parameter::Height | Parameter::Boundary | Parameter::Seed => true,
            Parameter::Radius => has_number,
            // A shape of one radius is tiled exactly or made by darts, as the method says.
            Parameter::Method => {
                is_tiled || self.ground.is_shape_of_one_radius() && !self.is_in_space()
            }
            Parameter::Leaf
            | Parameter::PatternSide
            | Parameter::PatternSeed
            | Parameter::PatternBoundary
            | Parameter::Dihedral => is_tiled || self.tiles_shape(),
            _ => is_tiled,
        }
    }

    /// Returns why the nested levels cannot be made with these parameters, if some are asked for.
    fn nesting_refusal(&self) -> Option<DraftRefusal> {
        let request = self.nesting()?;
        if let Err(reason) = self.exactly_read() {
            let part = FormPart::Exactly;
            return Some(DraftRefusal { part, reason });
        }
        let error = request.check(&self.parameters).err()?;
        let part = match error {
            ParameterError::Count { .. }
            | ParameterError::OneLevel { .. }
            | ParameterError::TooFewForLevels { .. } => FormPart::Exactly,
            // Other errors are about how levels and parameters go together.
            _ => FormPart::Choices,
        };
        let reason = sentence(&error.to_string());
        Some(DraftRefusal { part, reason })
    }
}

/// Returns the part of the form that an error is about.
pub(super) fn part_of(error: &ParameterError, parameters: &Parameters) -> FormPart {
    FormPart::Field(match error {
        // The limits of sides are in r: if the side suits the default radius, the radius is at fault.
        ParameterError::SideTooShort { .. } | ParameterError::SideTooLong { .. }
            if suits_default_radius(parameters) =>
        {
            Parameter::Radius
        }
        ParameterError::Radius { .. } | ParameterError::TooManySamples { .. } => Parameter::Radius,
        ParameterError::Side { name, .. }
        | ParameterError::SideTooShort { name, .. }
        | ParameterError::SideTooLong { name, .. } => match *name {
            "height" => Parameter::Height,
            // The width: `solid_refusal` takes the errors of the depth itself.
            _ => Parameter::Width,
        },
        ParameterError::Leaf { .. } => Parameter::Leaf,
        ParameterError::PatternSide { .. } => Parameter::PatternSide,
        // The other errors are about choices, or about several fields at once.
        _ => return FormPart::Choices,
    })
}

/// Returns whether the sides would be allowed with the default radius; other errors do not count.
fn suits_default_radius(parameters: &Parameters) -> bool {
    let radius = Parameters::default().radius;
    let domain = Parameters {
        radius,
        ..*parameters
    }
    .validate_sequential();
    !matches!(
        domain,
        Err(ParameterError::SideTooShort { .. } | ParameterError::SideTooLong { .. })
    )
}

/// Returns the refusal of more samples than a page can have, at the part of the form that decides on their number.
pub(super) fn too_many(part: FormPart, expected: Option<f64>, most: f64) -> Option<DraftRefusal> {
    let expected = expected.filter(|expected| *expected > most)?;
    let [expected, most] = [expected, most].map(|count| grouped(count as usize));
    Some(DraftRefusal {
        part,
        reason: format!(
            "A run would have about {expected} samples; in a browser at most {most} are possible, in the native program more."
        ),
    })
}
