//! Facts about a set, apart from its points, for output and certificates.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use serde_json::{Value, json};
use tilescope_analysis::{Region, lossy};
use tilescope_core::{Domain, Parameters, Stage, Summary};
use tilescope_formats::{ExportContext, bytes_digest, read_whole};
use tilescope_gpu::Backend;

use crate::options::region;

/// Facts about a set for the output and the certificate: method, engine, parameters, domain, summary and times.
pub struct Facts {
    pub method: &'static str,
    /// The engine that computed it, if several can.
    pub backend: Option<Backend>,
    /// Every parameter by its name.
    pub parameters: BTreeMap<String, Value>,
    pub region: Region,
    pub radius: f64,
    pub summary: Option<Summary>,
    pub seconds: Vec<(Stage, f64)>,
}

impl Facts {
    /// Returns the facts of a set before it is made.
    pub fn new(method: &'static str, parameters: BTreeMap<String, Value>, domain: &Domain) -> Self {
        Self {
            method,
            backend: None,
            parameters,
            region: region(domain),
            radius: domain.radius(),
            summary: None,
            seconds: Vec::new(),
        }
    }

    /// Returns the facts of a run by randomized tiling.
    pub fn of_run(parameters: &Parameters, domain: &Domain) -> Result<Self> {
        let parameters = serde_json::from_value(serde_json::to_value(parameters)?)?;
        Ok(Self::new("kdrt", parameters, domain))
    }

    /// Returns the statements of an export's certificate.
    pub fn context(&self) -> ExportContext {
        ExportContext {
            method: self.method.to_owned(),
            parameters: self.parameters.clone(),
            ..ExportContext::new(self.region, self.radius)
        }
    }
}

/// Returns a file's name without folders, and its digest: a set from a file is named by its content.
pub fn named_by_content(path: &Path) -> Result<Value> {
    let bytes = read_whole(path)?;
    let name = lossy(path.file_name().unwrap_or_default());
    Ok(json!({ "file": name, "digest": bytes_digest(&bytes) }))
}
