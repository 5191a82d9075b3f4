//! A moment that stands still: how samples stand when some events have happened, whatever the window shows meanwhile;
//! the sets of samples that are exported, and what files say of their run.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use tilescope_core::{Fate, Origin, Run, Stage, Standing};
use tilescope_debugger::{Status, digest, pattern_digest};
use tilescope_formats::{PointSet, Provenance};

use tilescope_session::session::Session;

/// A moment of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Still {
    /// How many events have happened, where there are events.
    pub cursor: Option<usize>,
    /// The stage that is current.
    pub stage: Stage,
}

impl Still {
    /// Returns the moment of a session with events when `cursor` of them have happened.
    #[must_use]
    pub fn at(session: &Session, cursor: usize) -> Self {
        Self {
            cursor: Some(cursor),
            stage: session.stages[session.stage_at(cursor)],
        }
    }

    /// Returns how a sample stands.
    #[must_use]
    pub fn standing(&self, session: &Session, id: u32) -> Standing {
        let run = session.run();
        let Some((recording, cursor)) = session.recording().zip(self.cursor) else {
            return run.standing(id, self.stage);
        };
        match recording.status(id, cursor) {
            Status::Absent => Standing::Absent,
            Status::Undecided => Standing::Tiled,
            Status::Kept => Standing::Valid,
            Status::Dropped => Standing::Dropped,
            Status::Eliminated => match run.samples.fates[id as usize] {
                Fate::Eliminated { by } => Standing::Eliminated { by },
                _ => Standing::Dropped,
            },
        }
    }

    /// Returns whether a sample covers its disk.
    #[must_use]
    pub fn covers(&self, session: &Session, id: u32) -> bool {
        let standing = self.standing(session, id);
        matches!(standing, Standing::Tiled | Standing::Valid)
    }

    /// Returns the sample that an eliminated one yielded to.
    #[must_use]
    pub fn yielded_to(&self, session: &Session, id: u32) -> Option<u32> {
        match self.standing(session, id) {
            Standing::Eliminated { by } => Some(by),
            _ => None,
        }
    }

    /// Returns whether a stage is whole at this moment.
    #[must_use]
    pub fn ends_stage(&self, session: &Session) -> bool {
        self.cursor
            .is_none_or(|cursor| session.stage_end(session.stage_at(cursor)) == Some(cursor))
    }

    /// Returns whether any sample covers its disk.
    #[must_use]
    pub fn has_samples(&self, session: &Session) -> bool {
        let ids = 0..session.run().samples.len() as u32;
        self.stage >= Stage::Tile && ids.into_iter().any(|id| self.covers(session, id))
    }

    /// Returns the samples that cover their disks, in the order of results.
    #[must_use]
    pub fn samples(&self, session: &Session) -> Vec<u32> {
        let points = &session.run().samples.points;
        let mut keyed: Vec<(u64, u32)> = (0..)
            .zip(points)
            .filter(|&(id, _)| self.covers(session, id))
            .map(|(id, point)| (point.canonical(), id))
            .collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|(_, id)| id).collect()
    }

    /// Returns what files say about the moment.
    #[must_use]
    pub fn description(&self, session: &Session) -> Value {
        json!({
            "stage": self.stage.to_string(),
            "cursor": self.cursor,
            "events": session.recording().map(|recording| recording.len()),
        })
    }
}

/// Returns samples of a run by id, with where each comes from.
#[must_use]
pub fn point_set(run: &Run, ids: &[u32]) -> PointSet {
    let samples = &run.samples;
    let provenance = |&id: &u32| match samples.origins[id as usize] {
        Origin::Tiled { block, pattern, .. } => Provenance::tiled(block, pattern),
        Origin::Inserted { iteration, .. } => Provenance::inserted(iteration),
    };
    debug_assert!(
        ids.iter()
            .all(|&id| samples.fates[id as usize] != Fate::Dropped)
    );
    let user = |&id: &u32| run.domain.user_from_lattice(samples.points[id as usize]);
    PointSet {
        points: ids.iter().map(user).collect(),
        provenance: Some(ids.iter().map(provenance).collect()),
    }
}

/// Returns how a session's set was made, as certificates name it.
#[must_use]
pub const fn method(session: &Session) -> &'static str {
    match session.combination {
        Some(_) => "combined",
        None => "kdrt",
    }
}

/// Returns the parameters of a session by name, for its certificate: a combination's are its layout. A pattern from a file stands there by the file's
/// name and its digest.
#[must_use]
pub fn parameter_map(session: &Session) -> BTreeMap<String, Value> {
    if let Some(combination) = &session.combination {
        return BTreeMap::from([("layout".to_owned(), combination.stated.clone())]);
    }
    let mut map: BTreeMap<String, Value> = match serde_json::to_value(session.run().parameters) {
        Ok(Value::Object(map)) => map.into_iter().collect(),
        _ => BTreeMap::new(),
    };
    if let Some(own) = &session.own {
        let path = std::path::Path::new(&own.file.path);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let pattern = json!({ "file": name, "pattern_digest": own.file.digest });
        map.insert("pattern".to_owned(), pattern);
    }
    map
}

/// Returns what pictures of a session say about it, by key: the parameters, the digests with which a run can be told
/// to be the same again, and the program.
#[must_use]
pub fn provenance(session: &Session) -> Vec<(String, String)> {
    let run = session.run();
    // A combination clips from no pattern.
    let pattern = session.combination.is_none();
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
