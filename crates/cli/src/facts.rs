//! What is to be told of a set, apart from its points: in the output, and in the certificate of a file.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use serde_json::{Value, json};
use tilescope_analysis::Region;
use tilescope_core::{Domain, Parameters, Stage, Summary};
use tilescope_formats::{ExportContext, bytes_digest, read_whole};

use crate::engine::Told;
use crate::options::region;
use crate::parameters::RunArguments;

/// What is to be told of a set, apart from its points.
pub struct Facts {
    pub method: &'static str,
    /// Who computed it, where there is a choice.
    pub engine: Option<Told>,
    pub parameters: BTreeMap<String, Value>,
    pub region: Region,
    pub radius: f64,
    pub summary: Option<Summary>,
    pub seconds: Vec<(Stage, f64)>,
}

impl Facts {
    /// Returns what is to be told of a run by randomized tiling.
    pub fn of_run(
        parameters: &Parameters,
        domain: &Domain,
        arguments: Option<&RunArguments>,
    ) -> Result<Self> {
        let mut stated = described(parameters)?;
        if let Some(path) = arguments.and_then(|arguments| arguments.pattern.as_ref()) {
            stated.insert("pattern".into(), named_by_content(path)?);
        }
        Ok(Self {
            method: "kdrt",
            engine: None,
            parameters: stated,
            region: region(domain),
            radius: domain.radius(),
            summary: None,
            seconds: Vec::new(),
        })
    }

    /// Returns what an export of the set states.
    pub fn context(&self) -> ExportContext {
        let mut context = ExportContext::new(self.region, self.radius);
        "tilescope".clone_into(&mut context.program);
        env!("CARGO_PKG_VERSION").clone_into(&mut context.program_version);
        self.method.clone_into(&mut context.method);
        context.parameters.clone_from(&self.parameters);
        context
    }
}

/// Returns every parameter by name.
fn described(parameters: &Parameters) -> Result<BTreeMap<String, Value>> {
    Ok(serde_json::from_value(serde_json::to_value(parameters)?)?)
}

/// Returns a file's name without folders, and its digest: a set from a file is named by its content.
pub fn named_by_content(path: &Path) -> Result<Value> {
    let bytes = read_whole(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok(json!({ "file": name, "digest": bytes_digest(&bytes) }))
}
