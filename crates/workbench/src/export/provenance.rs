//! The samples that are exported, and the provenance of exported files: parameters, digests, program.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use tilescope_analysis::lossy;
use tilescope_core::{Fate, Run, Source};
use tilescope_debugger::{digest, pattern_digest};
use tilescope_formats::PointSet;
use tilescope_session::layers::SessionKind;
use tilescope_session::session::Session;

/// Returns samples of a run by id, with their origins.
pub(crate) fn point_set(run: &Run, ids: &[u32]) -> PointSet {
    let samples = &run.samples;
    let has_sources = !run.blocks.leaves.is_empty();
    let provenance = |&id: &u32| Source::from(samples.origins[id as usize]).row().into();
    debug_assert!(
        ids.iter()
            .all(|&id| samples.fates[id as usize] != Fate::Dropped)
    );
    let user = |&id: &u32| run.domain.user_from_lattice(samples.points[id as usize]);
    PointSet {
        points: ids.iter().map(user).collect(),
        provenance: has_sources.then(|| ids.iter().map(provenance).collect()),
    }
}

/// Returns how a session's set was made, as certificates name it.
#[must_use]
pub fn method(session: &Session) -> &str {
    match (&session.combination, &session.nested) {
        (Some(_), _) => "combined",
        (None, Some(nested)) => &nested.method,
        (None, None) => "kdrt",
    }
}

/// Returns the parameters of a session by name, for its certificate; for a combination its layout. A pattern from a
/// file is given by the file's name and digest.
pub(crate) fn parameter_map(session: &Session) -> BTreeMap<String, Value> {
    if let Some(combination) = &session.combination {
        return BTreeMap::from([("layout".to_owned(), combination.stated.clone())]);
    }
    if let Some(nested) = &session.nested {
        return nested.stated.clone();
    }
    let mut map: BTreeMap<String, Value> = match serde_json::to_value(session.run().parameters) {
        Ok(Value::Object(map)) => map.into_iter().collect(),
        _ => BTreeMap::new(),
    };
    if let Some(own) = &session.own {
        let path = std::path::Path::new(&own.file.path);
        let name = lossy(path.file_name().unwrap_or_default());
        let pattern = json!({ "file": name, "pattern_digest": own.file.digest });
        map.insert("pattern".to_owned(), pattern);
    }
    map
}

/// Returns the metadata of a session's pictures: its parameters, the digests by which a run can be recognised, and the
/// program.
#[must_use]
pub fn provenance(session: &Session) -> Vec<(String, String)> {
    let run = session.run();
    // Combinations and nested levels clip from no pattern of this kind.
    let pattern = session.kind() == SessionKind::Run;
    let recording = json!({
        "digest": digest(run),
        "pattern_digest": pattern.then(|| pattern_digest(&run.pattern)),
        "samples": run.result.len(),
        "events": session.recording().map(|recording| recording.len()),
        "engine": session.engine,
    });
    let parameters = json!(parameter_map(session));
    [
        (
            "Version",
            format!("tilescope {}", env!("CARGO_PKG_VERSION")),
        ),
        ("Parameters", parameters.to_string()),
        ("Recording", recording.to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .to_vec()
}
