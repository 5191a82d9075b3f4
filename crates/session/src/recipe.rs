//! The input of a session: its parameters, and the pattern, if that comes from a file. The core checks
//! patterns.

use std::sync::Arc;

use tilescope_core::{
    NestedRequest, Observer, ParameterError, Parameters, Pattern, SampleError, TilingMethod,
};
use tilescope_debugger::{DEFAULT_BUDGET, PatternFile, Recording, pattern_digest};
use tilescope_formats::ReadSet;
use tilescope_sets::KnownDomain;

use crate::encoding::as_json;
use crate::ground::GroundRequest;
use crate::incoming::Incoming;

/// A pattern that was read from a file.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub struct OwnPattern {
    /// The file, and the digest of its content.
    pub file: PatternFile,
    /// The pattern itself, conflict-free and maximal.
    pub pattern: Arc<Pattern>,
}

impl std::fmt::Debug for OwnPattern {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.file.fmt(f)
    }
}

impl PartialEq for OwnPattern {
    fn eq(&self, other: &Self) -> bool {
        self.file == other.file
    }
}

/// The input of a session.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Recipe {
    /// The parameters of the run or of the levels.
    pub parameters: Parameters,
    /// The pattern to use instead of the one that the parameters describe.
    pub own: Option<OwnPattern>,
    /// The levels, if nested ones are wanted instead of a run.
    #[serde(with = "as_json")]
    pub nested: Option<NestedRequest>,
    /// The field and the shape, if the radius depends on the place or the domain is a shape.
    pub ground: Option<Box<GroundRequest>>,
    /// The third side in user units, if a set in space is wanted.
    pub depth: Option<f64>,
}

impl From<Parameters> for Recipe {
    fn from(parameters: Parameters) -> Self {
        Self {
            parameters,
            own: None,
            nested: None,
            ground: None,
            depth: None,
        }
    }
}

impl Recipe {
    /// Refuses exact tiling with an own pattern.
    pub fn check(&self) -> Result<(), ParameterError> {
        match (self.parameters.method, &self.own) {
            (TilingMethod::Exact, Some(_)) => Err(ParameterError::ExactOfSamples),
            (TilingMethod::Kdrt, _) | (TilingMethod::Exact, None) => Ok(()),
        }
    }

    /// Returns the recipe with the method that makes it. No [`TilingMethod`] stands for the darts that make sets in space, in
    /// fields and in shapes that are not tiled: their parameters name the default one, whose pattern is not used.
    #[must_use]
    pub fn with_its_method(mut self) -> Self {
        let tiles = |ground: &GroundRequest| ground.is_tiled(&self.parameters);
        let is_tiled = self.depth.is_none() && self.ground.as_deref().is_none_or(tiles);
        if !is_tiled {
            let asked = self.parameters;
            self.parameters.method = TilingMethod::Kdrt;
            self.parameters.pattern = self.parameters.pattern_following(&asked);
        }
        self
    }

    /// Returns the pattern: the own one, otherwise the one that the parameters describe.
    pub fn pattern(&self, observer: &mut dyn Observer) -> Result<Arc<Pattern>, SampleError> {
        match &self.own {
            Some(own) => Ok(Arc::clone(&own.pattern)),
            None => Pattern::of_spec(&self.parameters.pattern, observer),
        }
    }

    /// Samples on the CPU and keeps every event.
    pub fn record(&self, observer: &mut dyn Observer) -> Result<Recording, SampleError> {
        match &self.own {
            Some(own) => Recording::with_pattern(
                &self.parameters,
                Arc::clone(&own.pattern),
                DEFAULT_BUDGET,
                observer,
            ),
            None => Recording::new(&self.parameters, DEFAULT_BUDGET, observer),
        }
    }
}

/// Reads a pattern from a point set that was exported with its certificate.
///
/// Fails when the file cannot be read, has no certificate, or is not a maximal set.
pub fn load(incoming: &Incoming) -> Result<OwnPattern, String> {
    pattern_of(&incoming.point_set()?, &incoming.name)
}

/// Makes a pattern of the point set of a file called `name`.
///
/// Fails when the set has no certificate or one that was refused, and when it has conflicts or is not maximal.
pub fn pattern_of(read: &ReadSet, name: &str) -> Result<OwnPattern, String> {
    let certificate = read
        .certificate
        .as_ref()
        .ok_or_else(|| match &read.refused {
            // There is a certificate, which was refused. To say that there is none would be wrong, so that the reason is said.
            Some(why) => {
                format!("{name}: {why}, so nothing says how large its domain and its radius are")
            }
            None => format!(
                "{name} has no certificate, which says how large its domain and its radius are"
            ),
        })?;

    let set = KnownDomain::from(certificate).set(&read.set.points);
    let pattern = set.map_err(|error| format!("{name}: {error}"))?.pattern;

    Ok(OwnPattern {
        file: PatternFile {
            path: name.to_owned(),
            digest: pattern_digest(&pattern),
        },
        pattern,
    })
}
