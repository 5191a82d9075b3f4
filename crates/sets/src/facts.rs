//! How a set was made, as output and certificates state it.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;
use serde_json::{Value, json};
use tilescope_analysis::{PrefixClaim, Region};
use tilescope_core::{Domain, Parameter, Summary};
use tilescope_formats::{ExportContext, VaryingDomain};
#[cfg(not(target_arch = "wasm32"))]
use tilescope_formats::{FormatError, bytes_digest, read_whole};

use crate::domain::region;

/// Parameters by their names, as certificates state them.
pub type Stated = BTreeMap<String, Value>;

/// Returns the fields of parameters by their names; no fields for a value without any. The method is stated beside them.
pub fn stated(parameters: &impl Serialize) -> Stated {
    let mut stated: Stated = match json!(parameters) {
        Value::Object(fields) => fields.into_iter().collect(),
        _ => Stated::new(),
    };
    stated.remove(Parameter::Method.key());
    stated
}

/// How a set was made, apart from its points, and what a verdict on it is about.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The method, as certificates name it.
    pub method: &'static str,
    /// Every parameter that the method uses.
    pub parameters: Stated,
    /// The region of the positions.
    pub region: Region,
    /// The Poisson-disk radius, in user units.
    pub radius: f64,
    /// The claims on the samples to the end of each level, if it has nested levels.
    pub levels: Vec<PrefixClaim>,
    /// The rank of each sample, if it has nested levels in an order that gives them.
    pub ranks: Arc<[f64]>,
    /// Where the lower corner of the region lies, for a shape or an expression in coordinates of their own.
    pub origin: [f64; 2],
    /// What the set is judged in, if its radius varies or it covers a shape.
    pub varying: Option<Arc<VaryingDomain>>,
    /// How many samples were made, if the set is the first of those.
    pub made: Option<u64>,
    /// How many pixels of a density are too light for the largest radius that is possible, and have that radius.
    pub capped: usize,
    /// The counts of the run, once it is made and if its method has them.
    pub summary: Option<Summary>,
}

impl Facts {
    /// Returns the facts of a set before it is made.
    #[must_use]
    pub fn new(method: &'static str, parameters: Stated, domain: &Domain) -> Self {
        Self {
            method,
            parameters,
            region: region(domain),
            radius: domain.radius(),
            levels: Vec::new(),
            ranks: Arc::default(),
            origin: [0.0; 2],
            varying: None,
            made: None,
            capped: 0,
            summary: None,
        }
    }

    /// Returns what the certificate of an export is to state.
    #[must_use]
    pub fn context(&self) -> ExportContext {
        ExportContext {
            method: self.method.to_owned(),
            parameters: self.parameters.clone(),
            levels: self.levels.clone(),
            ranks: Arc::clone(&self.ranks),
            origin: self.origin,
            varying: self.varying.clone(),
            made: self.made,
            ..ExportContext::new(self.region, self.radius)
        }
    }
}

/// Returns a file's name without folders, and its digest: certificates name a set from a file by its content.
///
/// # Errors
///
/// [`FormatError`] when the file cannot be read.
#[cfg(not(target_arch = "wasm32"))]
pub fn named_by_content(path: &std::path::Path) -> Result<Stated, FormatError> {
    let bytes = read_whole(path)?;
    let name = tilescope_analysis::lossy(path.file_name().unwrap_or_default());
    Ok(Stated::from([
        ("file".to_owned(), name.into()),
        ("digest".to_owned(), bytes_digest(&bytes).into()),
    ]))
}
