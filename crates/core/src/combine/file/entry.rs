//! A piece of a layout: its JSON form, and the source of its set.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::LayoutError;
use crate::lattice::{Boundary, Domain, Rect};
use crate::parameters::{MAXIMAL_DENSITY, Parameters};

/// A piece, as the file has it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PieceEntry {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rect: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<Map<String, Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<PieceMethod>,
    #[serde(skip_serializing_if = "Option::is_none")]
    boundary: Option<Boundary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) offset: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
enum PieceMethod {
    Kdrt,
    Reference,
}

/// The source of a piece's set.
#[derive(Clone, Debug, PartialEq)]
pub enum PieceSource {
    /// A point set in a file; values not given here are in its certificate.
    File {
        /// Its path relative to the layout's folder.
        path: String,
        /// The Poisson-disk radius of the set.
        radius: Option<f64>,
        /// Width and height of its domain.
        size: [Option<f64>; 2],
        /// How its domain ends.
        boundary: Option<Boundary>,
    },
    /// A run by randomized tiling.
    Run {
        /// The parameters of the run.
        parameters: Box<Parameters>,
        /// Whether they are given for the piece, and not derived from its rectangle.
        own: bool,
    },
    /// A set of the reference sampler.
    Reference {
        /// The seed of the set.
        seed: u64,
        /// The domain of the piece's rectangle.
        own: Domain,
    },
}

impl PieceSource {
    /// Returns how many samples are computed for this piece besides those in its rectangle.
    pub(super) fn expected_beside(&self) -> f64 {
        match self {
            Self::Run {
                parameters,
                own: true,
            } => {
                let domain = parameters.validate();
                // Never 0: the parameters were validated when the entry was read.
                domain.map_or(0.0, |domain| domain.area_radii() * MAXIMAL_DENSITY)
            }
            // A set that is made for the rectangle has no samples beside it, and that of a file is not made.
            _ => 0.0,
        }
    }
}

impl PieceEntry {
    /// Returns the source of the set for the rectangle `rect`. A set that is made has the layout's `boundary` unless
    /// the entry gives another one; for a file the certificate states what the entry does not.
    ///
    /// Fails when the piece is not one of the three kinds (a file, parameters or a seed), when it has a value that its
    /// kind has no use for, and when no set can be made with its parameters or for its rectangle.
    pub(super) fn source(
        &self,
        boundary: Boundary,
        rect: &Rect,
    ) -> Result<PieceSource, LayoutError> {
        // Values that would have no effect are refused rather than ignored.
        let has_values_of_file =
            self.radius.is_some() || self.width.is_some() || self.height.is_some();
        if self.file.is_none() && has_values_of_file {
            return Err(LayoutError::OfFile);
        }
        if self.seed.is_none() && self.method.is_some() {
            return Err(LayoutError::OfSeed);
        }

        match (&self.file, &self.parameters, self.seed) {
            (Some(file), None, None) => Ok(PieceSource::File {
                path: file.clone(),
                radius: self.radius,
                size: [self.width, self.height],
                boundary: self.boundary,
            }),
            // Given parameters state the boundary themselves, so that the entry must not state another one.
            (None, Some(_), None) if self.boundary.is_some() => Err(LayoutError::OfParameters),
            (None, Some(given), None) => Ok(PieceSource::Run {
                parameters: Box::new(parameters(boundary, rect, given)?),
                own: true,
            }),
            // The set is made for the rectangle, so that there is nothing to move.
            (None, None, Some(_)) if self.offset.is_some() => Err(LayoutError::OffsetOfSeed),
            (None, None, Some(seed)) => self.of_seed(seed, self.boundary.unwrap_or(boundary), rect),
            // No kind is named, or more than one.
            _ => Err(LayoutError::NoSource),
        }
    }

    /// Returns the source of a piece that is made from its seed, by the entry's method.
    fn of_seed(
        &self,
        seed: u64,
        boundary: Boundary,
        rect: &Rect,
    ) -> Result<PieceSource, LayoutError> {
        // A rectangle on which no domain is possible is refused here, whatever the method is. For tiling, `parameters`
        // computes the same domain once more.
        let domain = Domain::of_rect(rect, boundary)?;
        Ok(match self.method.unwrap_or(PieceMethod::Kdrt) {
            PieceMethod::Reference => PieceSource::Reference { seed, own: domain },
            // No parameter is given: the lengths are those of the rectangle, and all but the seed has its default.
            PieceMethod::Kdrt => PieceSource::Run {
                parameters: Box::new(Parameters {
                    seed,
                    ..parameters(boundary, rect, &Map::new())?
                }),
                own: false,
            },
        })
    }
}

/// Returns the parameters of a set for a rectangle. Those in `given` take precedence, over `boundary` too.
fn parameters(
    boundary: Boundary,
    rect: &Rect,
    given: &Map<String, Value>,
) -> Result<Parameters, LayoutError> {
    // Given lengths may be in any unit, but lengths of the rectangle are in radii. So all three lengths are given, or
    // none: mixed ones would have no meaning.
    let lengths = ["width", "height", "radius"].map(|name| given.contains_key(name));
    if lengths != [true; 3] && lengths != [false; 3] {
        return Err(LayoutError::Lengths);
    }

    // Given lengths replace the placeholders when they are merged below. Otherwise the set is as large as its
    // rectangle.
    let size = if lengths[0] {
        [1.0; 2]
    } else {
        Domain::of_rect(rect, given_boundary(given)?.unwrap_or(boundary))?.size()
    };

    // The domain of a rectangle has radius 1.
    let base = Parameters {
        width: size[0],
        height: size[1],
        radius: 1.0,
        boundary,
        ..Parameters::default()
    };

    let form = |error| LayoutError::ParameterForm {
        name: "parameters",
        error,
    };
    let mut all = serde_json::to_value(base).map_err(form)?;

    // Values are merged by name, so that a part of the pattern can be given without the rest.
    for (name, value) in given {
        let Some(known) = all.get_mut(name) else {
            let name = name.clone();
            return Err(LayoutError::UnknownParameter { name });
        };

        match (known.as_object_mut(), value.as_object()) {
            (Some(known), Some(value)) => known.extend(value.clone()),
            _ => *known = value.clone(),
        }
    }

    let merged: Parameters = serde_json::from_value(all).map_err(form)?;
    // The set of a piece is held in memory as a whole, and so has the limit of samples of a set by the sequential
    // engine (`Pattern::of_run` asks for it, too).
    merged.validate_sequential()?;
    Ok(merged)
}

/// Returns the boundary that parameters give, if they do.
fn given_boundary(given: &Map<String, Value>) -> Result<Option<Boundary>, LayoutError> {
    let boundary = given.get("boundary").cloned();
    let read = boundary.map(serde_json::from_value).transpose();
    read.map_err(|error| LayoutError::ParameterForm {
        name: "parameters: boundary",
        error,
    })
}
