//! Saved sessions: parameters, cursor, breakpoints, watches and scenes as JSON, and a digest of the result. The run
//! itself is not saved. It is computed again, and the digest shows whether it is the same.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_core::{
    Locality, MAXIMAL_DENSITY, Observer, Parameters, Pattern, Run, Stage, TilingMethod, json,
};

use crate::anchor::Anchor;
use crate::listing::{LineId, Listings};
use crate::recording::Recording;

/// The newest version of sessions that this program reads, and that of exact tilings of a shape, which it writes. Programs
/// before these tilings would make them by darts.
pub const VERSION: u32 = 6;

/// The version of sessions of sets in space, which programs before exact tilings of a shape read.
pub(crate) const VERSION_OF_SPACE: u32 = 5;

/// The version of sessions of runs in a field or a shape, which programs before sets in space read.
pub(crate) const VERSION_OF_GROUND: u32 = 4;

/// The version of sessions of exact tilings, which programs before fields and shapes read.
pub(crate) const VERSION_OF_EXACT: u32 = 3;

/// The version of sessions of KDRT's runs, which programs before exact tiling read.
pub(crate) const VERSION_OF_KDRT: u32 = 2;

/// The largest budget of events in a saved session: 480 MB. On a web page, which has less memory, 120 MB.
pub const MAX_BUDGET: usize = if cfg!(target_arch = "wasm32") {
    crate::DEFAULT_BUDGET
} else {
    20_000_000
};

/// The most samples of a saved session's run. Up to 20 events of each are kept whatever the budget: 1 GB, and on a web
/// page 100 MB.
pub const MAX_SAMPLES: usize = if cfg!(target_arch = "wasm32") {
    200_000
} else {
    2_000_000
};

/// The most breakpoints, and the most watches, of a saved session: more than people set by hand.
pub const MAX_STOPS: usize = 1_000;

/// The most scenes of a saved session: more than people set by hand.
pub const MAX_SCENES: usize = 10_000;

/// The most bytes of a condition, a watch, a caption or a path: more than people type.
pub const MAX_TEXT: usize = 10_000;

/// The most bytes of a saved session. Chosen, not measured.
pub const MAX_BYTES: usize = 16_000_000;

/// A breakpoint on a line of pseudocode.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedBreakpoint {
    /// The line's stable id.
    pub line: String,
    /// The condition, if there is one.
    pub condition: Option<String>,
    /// Whether it stops a run.
    pub enabled: bool,
}

impl SavedBreakpoint {
    /// Returns the number of the line.
    pub(crate) fn line(&self) -> Result<LineId, SessionError> {
        let line = Listings::shipped().find(&self.line);
        line.ok_or_else(|| SessionError::UnknownLine {
            line: self.line.clone(),
        })
    }
}

/// A moment to come back to, with a caption and a view. It is kept when the parameters change: in the run in which it was
/// made it is a number of events, in others it is found by its anchor or by the stage that ends there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedScene {
    /// How many events have happened, in the run in which it was set.
    pub event: usize,
    /// The caption, as the user wrote it; may be empty.
    pub caption: String,
    /// The [`crate::Debugger::run_id`] of the run in which it was set. If empty, that of the session.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub run: String,
    /// The event before it; `None` at the start of a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anchor: Option<Anchor>,
    /// The stage that ends at the moment, if one does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<Stage>,
    /// The view of the moment, not read here; null if none was saved.
    #[serde(default, skip_serializing_if = "Value::is_null")]
    pub view: Value,
}

/// A file with the pattern of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PatternFile {
    /// Its path, which the pattern loader interprets.
    pub path: String,
    /// The pattern's [`pattern_digest`], as it was when the session was saved.
    pub digest: String,
}

/// A session as it is saved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// The version of its form, at most [`VERSION`].
    pub version: u32,
    /// The parameters of the run.
    pub parameters: Parameters,
    /// The budget of the tape, on which the numbers of events depend.
    pub budget: usize,
    /// The digest of the result, 16 hexadecimal digits.
    pub digest: String,
    /// The cursor: how many events have happened.
    pub cursor: usize,
    /// The breakpoints, in the user's order.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions, as they were typed.
    pub watches: Vec<String>,
    /// The scenes, in the user's order.
    pub scenes: Vec<SavedScene>,
    /// The state of the user interface, not read here; null if there is none.
    #[serde(default, skip_serializing_if = "Value::is_null")]
    pub view: Value,
    /// The file of the run's pattern, if it is not generated from the parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pattern: Option<PatternFile>,
    /// What its field and its shape are made from, not read here; null if its radius is the same everywhere in a rectangle.
    #[serde(default, skip_serializing_if = "Value::is_null")]
    pub ground: Value,
    /// The third side of the box, in user units, if it is of a set in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<f64>,
}

/// Returns why a run of a method, by its name on the command line, cannot be visited step by step, if so.
#[must_use]
pub fn method_refusal(method: &str) -> Option<&'static str> {
    match method {
        "kdrt" | "exact" => None,
        "reference" => Some(
            "the steps of the reference sampler are not shown; `tilescope sample --method reference` makes its sets",
        ),
        _ => Some("there is no such method; kdrt and exact are those whose steps can be visited"),
    }
}

/// Why a session cannot be restored.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The text does not parse as a session.
    #[error("this is not a saved session: {0}")]
    Corrupt(#[from] serde_json::Error),
    /// It was written by a newer version of the program.
    #[error("the session has version {found}; this program reads versions up to {VERSION}")]
    Newer {
        /// The version that the session has.
        found: u32,
    },
    /// It is of a method whose runs have no steps.
    #[error("the session names a method whose steps are not shown: {why}")]
    OtherMethod {
        /// Why that cannot be visited.
        why: &'static str,
    },
    /// A breakpoint is on an unknown line.
    #[error("the session has a breakpoint on line \"{line}\", which there is not")]
    UnknownLine {
        /// The line's id as it was saved.
        line: String,
    },
    /// The result of the run differs from the saved one.
    #[error("the run has digest {found}, the saved one had {expected}: it is not the same run")]
    Different {
        /// The digest in the session.
        expected: String,
        /// The digest of the run.
        found: String,
    },
    /// The cursor or a scene is past the end.
    #[error("the session names event {event}; the run has {events}")]
    NoSuchEvent {
        /// The number that is past the end.
        event: usize,
        /// How many there are.
        events: usize,
    },
    /// It exceeds a limit for saved sessions.
    #[error("the session has {found} {what}; at most {limit} are taken")]
    TooMuch {
        /// The quantity that exceeds the limit.
        what: &'static str,
        /// How much there is.
        found: usize,
        /// The most there may be.
        limit: usize,
    },
    /// The pattern's file cannot be loaded.
    #[error("the session's pattern {path} cannot be loaded: {reason}")]
    PatternGone {
        /// The path of the file.
        path: String,
        /// Why it cannot be loaded, in words.
        reason: String,
    },
    /// The file holds another pattern.
    #[error("the pattern {path} has digest {found}, the saved one had {expected}: it has changed")]
    PatternChanged {
        /// The path of the file.
        path: String,
        /// The digest in the session.
        expected: String,
        /// The digest of the pattern in the file.
        found: String,
    },
    /// Its radius depends on the place, or its domain is a shape.
    #[error(
        "the session is of a run whose radius depends on the place, or in a shape; it can be opened in the window"
    )]
    Ground,
    /// It is of a set in space.
    #[error("the session is of a set in space; it can be opened in the window")]
    InSpace,
    /// Its field or its shape cannot be made.
    #[error("the session's field or shape cannot be made: {0}")]
    NoGround(String),
    /// The run cannot be computed.
    #[error(transparent)]
    Run(#[from] tilescope_core::SampleError),
}

/// Read before the rest, so that what this program cannot do is reported as such.
#[derive(Deserialize)]
struct Head {
    version: u32,
    /// The method, if the session names it beside the parameters. Sessions that this program writes have it among the
    /// parameters. Parameters without a method stand for KDRT, so that without this field another method would be
    /// taken for KDRT.
    method: Option<String>,
}

impl Session {
    /// Parses a session. Fails if the text is no session, if its version is newer, if the steps of its method are not
    /// shown, if a breakpoint's line is unknown, or if a limit is exceeded.
    pub fn from_json(text: &str) -> Result<Self, SessionError> {
        within("bytes", text.len(), MAX_BYTES)?;
        // The size, the version and the method come first: what follows may be unreadable for reasons that they explain.
        let Head { version, method } = json::from_text(text)?;
        if version > VERSION {
            return Err(SessionError::Newer { found: version });
        }

        if let Some(why) = method.as_deref().and_then(method_refusal) {
            return Err(SessionError::OtherMethod { why });
        }

        let mut session: Self = json::from_text(text)?;
        // A method that stands beside the parameters, not among them, counts as well. KDRT needs nothing: it is
        // the method of parameters without one.
        if method.as_deref() == Some("exact") {
            session.parameters.method = TilingMethod::Exact;
        }

        // Before exact tilings of a shape, all sets in a field or a shape were made by darts, whatever the method.
        if session.version < VERSION && !session.ground.is_null() {
            session.parameters.method = TilingMethod::Kdrt;
        }

        for breakpoint in &session.breakpoints {
            breakpoint.line()?;
        }
        session.check()?;
        Ok(session)
    }

    /// Computes the session's run again, with its events. If the pattern comes from a file, `pattern_loader` reads it;
    /// its digest must be the saved one. A session in a field or a shape is refused: [`Self::record_in`] computes its run. So is
    /// one of a set in space, which [`Recording::in_space`] makes.
    pub fn record(
        &self,
        pattern_loader: &mut dyn FnMut(&PatternFile) -> Result<Pattern, String>,
        observer: &mut dyn Observer,
    ) -> Result<Recording, SessionError> {
        self.check()?;

        if !self.ground.is_null() {
            return Err(SessionError::Ground);
        }
        if self.depth.is_some() {
            return Err(SessionError::InSpace);
        }
        let Some(file) = &self.pattern else {
            return Ok(Recording::new(&self.parameters, self.budget, observer)?);
        };

        let path = || file.path.clone();
        let pattern = pattern_loader(file).map_err(|reason| SessionError::PatternGone {
            path: path(),
            reason,
        })?;

        let found = pattern_digest(&pattern);
        // Another pattern gives another run. The digest of the result would show it, too, but only after the whole run.
        if found != file.digest {
            return Err(SessionError::PatternChanged {
                path: path(),
                expected: file.digest.clone(),
                found,
            });
        }

        let pattern = Arc::new(pattern);
        Ok(Recording::with_pattern(
            &self.parameters,
            pattern,
            self.budget,
            observer,
        )?)
    }

    /// Computes the run of a session in a field or a shape again, with its events; `locality` is made from [`Self::ground`].
    /// The method of the parameters makes it: exact tiling, which needs one radius, or the darts of the reference sampler.
    pub fn record_in(
        &self,
        locality: &Arc<Locality>,
        observer: &mut dyn Observer,
    ) -> Result<Recording, SessionError> {
        self.check()?;
        let make = match self.parameters.method {
            TilingMethod::Exact => Recording::of_tiled_shape,
            TilingMethod::Kdrt => Recording::with_locality,
        };
        Ok(make(locality, &self.parameters, self.budget, observer)?)
    }

    /// Fails when the session exceeds a limit. Makes no run.
    pub fn check(&self) -> Result<(), SessionError> {
        within("events of budget", self.budget, MAX_BUDGET)?;
        within("breakpoints", self.breakpoints.len(), MAX_STOPS)?;
        within("watches", self.watches.len(), MAX_STOPS)?;
        within("scenes", self.scenes.len(), MAX_SCENES)?;

        let conditions = self
            .breakpoints
            .iter()
            .filter_map(|b| b.condition.as_deref());
        longest("bytes in a condition", conditions)?;
        longest("bytes in a watch", self.watches.iter().map(String::as_str))?;
        longest(
            "bytes in a caption",
            self.scenes.iter().map(|scene| scene.caption.as_str()),
        )?;
        longest(
            "bytes in a scene's run",
            self.scenes.iter().map(|scene| scene.run.as_str()),
        )?;
        longest(
            "bytes in a path",
            self.pattern.iter().map(|p| p.path.as_str()),
        )?;

        // A maximal set in the plane has about this many samples. For a run in a field or a shape this is the number
        // for the whole rectangle at the parameters' radius. For a set in space it is the number for the base of its
        // box; the window, which opens such sets, limits the number of their balls. Faults of the parameters are left
        // to the run, which reports them.
        if let Ok(domain) = self.parameters.validate() {
            let samples = MAXIMAL_DENSITY * domain.area_radii();
            within("expected samples", samples as usize, MAX_SAMPLES)?;
        }
        Ok(())
    }

    /// Returns the session as text.
    pub fn to_json(&self) -> Result<String, SessionError> {
        Ok(serde_json::to_string_pretty(self)?)
    }
}

fn within(what: &'static str, found: usize, limit: usize) -> Result<(), SessionError> {
    if found > limit {
        return Err(SessionError::TooMuch { what, found, limit });
    }
    Ok(())
}

fn longest<'a>(
    what: &'static str,
    mut texts: impl Iterator<Item = &'a str>,
) -> Result<(), SessionError> {
    texts.try_for_each(|text| within(what, text.len(), MAX_TEXT))
}

/// Returns the digest of a run's result: FNV-1a, 64 bits, over the lattice points in canonical order. It distinguishes
/// runs, but does not protect against forgery.
#[must_use]
pub fn digest(run: &Run) -> String {
    let points = run.points();
    hash(points.iter().flat_map(|point| [point.x, point.y]))
}

/// Returns the digest of a pattern: like [`digest`], over its width, height, whether it is periodic, and its samples.
#[must_use]
pub fn pattern_digest(pattern: &Pattern) -> String {
    let domain = pattern.domain();
    let head = [
        domain.width(),
        domain.height(),
        i32::from(domain.is_periodic()),
    ];
    let samples = pattern.samples().iter();
    hash(
        head.into_iter()
            .chain(samples.flat_map(|point| [point.x, point.y])),
    )
}

/// Returns the 64-bit FNV-1a hash of the bytes of numbers, in hexadecimal digits. Both constants are those of FNV-1a.
pub(crate) fn hash(numbers: impl Iterator<Item = i32>) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in numbers.flat_map(i32::to_le_bytes) {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    format!("{hash:016x}")
}
