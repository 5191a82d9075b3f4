//! The provenance of exported files: parameters, digests, program.

use serde_json::json;
use tilescope_analysis::lossy;
use tilescope_debugger::{digest, pattern_digest};
use tilescope_session::ground::MadeGround;
use tilescope_session::session::Session;
use tilescope_sets::{Stated, facts_of_exact, stated};

/// Returns how a session's set was made, as certificates name it.
#[must_use]
pub fn method(session: &Session) -> &str {
    let is_tiled_shape = session.ground.as_ref().is_some_and(MadeGround::is_tiled);
    match (&session.combination, &session.nested) {
        (Some(_), _) => "combined",
        (None, Some(nested)) => &nested.method,
        (None, None) if is_tiled_shape => "exact",
        (None, None) if session.has_own_disks() => "reference",
        (None, None) if session.is_exact() => "exact",
        (None, None) => "kdrt",
    }
}

/// Returns the parameters of a session by name, for its certificate; for a combination its layout. A pattern from a
/// file is given by the file's name and digest.
pub(crate) fn parameter_map(session: &Session) -> Stated {
    if let Some(combination) = &session.combination {
        return Stated::from([("layout".to_owned(), combination.stated.clone())]);
    }

    if let Some(nested) = &session.nested {
        return nested.stated.clone();
    }

    if let Some(made) = &session.ground {
        // The run of a tiling that was made here also says how often the tiling uses each sample of its pattern.
        if session.is_exact() {
            return made.recipe().facts_of_tiling(session.run()).parameters;
        }
        // A tiling from a file has no pattern: `ground` returns what the file's certificate states, and for a set of
        // darts what its recipe states. The set was made on this ground, so that the ground is not refused here.
        return made.ground().map(|(_, stated)| stated).unwrap_or_default();
    }

    let run = session.run();
    if let Some(solid) = &session.solid {
        let asked = &solid.asked;
        let [width, height, depth] = solid.domain.size();
        let stated = json!({
            "width": width,
            "height": height,
            "depth": depth,
            "radius": asked.radius,
            "boundary": asked.boundary,
            "seed": asked.seed,
        });
        // `json!` has made an object of it.
        return stated
            .as_object()
            .cloned()
            .unwrap_or_default()
            .into_iter()
            .collect();
    }
    if session.is_exact() {
        // The facts of exact tiling leave out the parameters that it refuses, and say how often it uses each sample of
        // its pattern.
        let samples = run.result.len() as f64;
        return facts_of_exact(&run.parameters, &run.domain, &run.pattern, samples).parameters;
    }

    let mut map = stated(&run.parameters);
    if let Some(own) = &session.own {
        // The folder is left out, as it means nothing on another machine. The digest shows whether a file of this name
        // is the same.
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
    // The run of a combination or of nested levels holds no pattern that the set was clipped from. Darts need no
    // pattern.
    let has_pattern = session.kind().is_run();
    let recording = json!({
        "digest": digest(run),
        "pattern_digest": has_pattern.then(|| pattern_digest(&run.pattern)),
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
