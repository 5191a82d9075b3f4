//! A piece of a layout: its form, and the source that it means. It makes no set.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use tilescope_core::{Boundary, Domain, MAXIMAL_DENSITY, Parameters, Rect};

/// A piece, as the file has it.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rect: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<Map<String, Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<Method>,
    #[serde(skip_serializing_if = "Option::is_none")]
    boundary: Option<Boundary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Method {
    Kdrt,
    Reference,
}

/// Where a piece's set comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A point set; what is not given is its certificate's.
    File {
        path: PathBuf,
        radius: Option<f64>,
        size: [Option<f64>; 2],
        boundary: Option<Boundary>,
    },
    /// A run by randomized tiling.
    Run(Box<Parameters>),
    /// The reference sampler.
    Reference { seed: u64, own: Domain },
}

impl Entry {
    /// Returns where the set comes from; files are relative to `folder`. What is not given suits a layout of `boundary`.
    ///
    /// Fails when the piece is not one of the three kinds, or its parameters cannot be sampled.
    pub fn source(&self, boundary: Boundary, rect: &Rect, folder: &Path) -> Result<Source> {
        let of_file = self.radius.is_some() || self.width.is_some() || self.height.is_some();
        if self.file.is_none() {
            ensure!(
                !of_file,
                "\"radius\", \"width\" and \"height\" belong to a \"file\""
            );
        }
        if self.seed.is_none() {
            ensure!(self.method.is_none(), "\"method\" belongs to a \"seed\"");
        }
        match (&self.file, &self.parameters, self.seed) {
            (Some(file), None, None) => Ok(Source::File {
                path: folder.join(file),
                radius: self.radius,
                size: [self.width, self.height],
                boundary: self.boundary,
            }),
            (None, Some(given), None) => {
                ensure!(
                    self.boundary.is_none(),
                    "the \"boundary\" of a set by \"parameters\" is one of these"
                );
                Ok(Source::Run(Box::new(parameters(boundary, rect, given)?)))
            }
            (None, None, Some(seed)) => {
                ensure!(
                    self.offset.is_none(),
                    "a set by \"seed\" is made for its rectangle and has no \"offset\""
                );
                self.of_seed(seed, self.boundary.unwrap_or(boundary), rect)
            }
            _ => bail!("a piece is one of \"file\", \"parameters\" and \"seed\""),
        }
    }

    /// Returns how many samples are made for this piece beside those of its rectangle.
    pub fn expected_beside(&self, source: &Source) -> Result<f64> {
        match (source, &self.parameters) {
            (Source::Run(parameters), Some(_)) => {
                Ok(parameters.validate()?.area_radii() * MAXIMAL_DENSITY)
            }
            _ => Ok(0.0),
        }
    }

    fn of_seed(&self, seed: u64, boundary: Boundary, rect: &Rect) -> Result<Source> {
        let own = Domain::of_rect(rect, boundary)?;
        Ok(match self.method.unwrap_or(Method::Kdrt) {
            Method::Reference => Source::Reference { seed, own },
            Method::Kdrt => Source::Run(Box::new(Parameters {
                seed,
                ..parameters(boundary, rect, &Map::new())?
            })),
        })
    }
}

/// Returns the parameters of a set for a rectangle, those that are given before all others.
fn parameters(boundary: Boundary, rect: &Rect, given: &Map<String, Value>) -> Result<Parameters> {
    let lengths = ["width", "height", "radius"].map(|name| given.contains_key(name));
    ensure!(
        lengths == [true; 3] || lengths == [false; 3],
        "width, height and radius must be given together, or not at all"
    );
    let size = if lengths[0] {
        [1.0; 2]
    } else {
        Domain::of_rect(rect, given_boundary(given)?.unwrap_or(boundary))?.size()
    };
    let base = Parameters {
        width: size[0],
        height: size[1],
        radius: 1.0,
        boundary,
        ..Parameters::default()
    };
    let mut all = serde_json::to_value(base)?;
    for (name, value) in given {
        let known = all.get_mut(name);
        let known = known.with_context(|| format!("there is no parameter \"{name}\""))?;
        match (known.as_object_mut(), value.as_object()) {
            (Some(known), Some(value)) => known.extend(value.clone()),
            _ => *known = value.clone(),
        }
    }
    let parameters: Parameters = serde_json::from_value(all).context("parameters")?;
    parameters.validate_sequential()?;
    Ok(parameters)
}

fn given_boundary(given: &Map<String, Value>) -> Result<Option<Boundary>> {
    let boundary = given.get("boundary").cloned();
    let boundary = boundary.map(serde_json::from_value).transpose();
    boundary.context("parameters: boundary")
}

impl Source {
    /// Returns how it is told of.
    pub fn json(&self) -> Value {
        match self {
            Self::File { path, .. } => json!({ "file": path.display().to_string() }),
            Self::Run(parameters) => json!({ "method": "kdrt", "seed": parameters.seed }),
            Self::Reference { seed, .. } => json!({ "method": "reference", "seed": seed }),
        }
    }
}
