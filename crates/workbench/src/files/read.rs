//! Reads files that are opened: computes sessions again, makes combinations of layouts, and takes point sets as patterns or
//! measures them. The result depends on the bytes alone. Begin with [`read`].

#[cfg(not(target_arch = "wasm32"))]
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::Value;
use tilescope_analysis::Region;
use tilescope_core::Pattern;
use tilescope_core::combine::file::Layout;
use tilescope_debugger::{Debugger, PatternFile, Session as Saved, SessionError};
use tilescope_formats::CERTIFICATE_SUFFIX;
use tilescope_session::combining::{SavedCombination, make};
use tilescope_session::encoding::as_json;
use tilescope_session::ground::{MAX_RECORDED, PortableGround};
use tilescope_session::incoming::holds_combination;
use tilescope_session::jobs::Monitor;
use tilescope_session::nesting;
use tilescope_session::packing;
use tilescope_session::recipe::{self, OwnPattern, Recipe, load};
use tilescope_session::session::{Reporter, Session};
use tilescope_session::solid;
use tilescope_session::task::{SessionRef, Task};
use tilescope_session::varying;
use tilescope_session::words::last_part;
use tilescope_sets::{GrayImage, PlanarPolygon};

use super::{Incoming, NamedBytes, Purpose, gather, unpacked};
use crate::analysis::reference_file::{self, ReferenceFile};

/// The task of reading files.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct ReadTask {
    /// The purpose; `None` for dropped files, whose content decides.
    pub purpose: Option<Purpose>,
    /// Where the files come from.
    pub source: FileSource,
    /// The generation of the session, if one is read.
    pub generation: u64,
    /// The domain and the radius of the current run, in user units, for a set to be compared with it.
    pub run: Option<(Region, f64)>,
}

/// The source of files.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub enum FileSource {
    /// In memory, as chosen or dropped in a browser.
    Bytes(Vec<NamedBytes>),
    /// On the disk, natively.
    #[cfg(not(target_arch = "wasm32"))]
    Paths(Vec<PathBuf>),
}

/// The result of reading files.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct FileOutcome {
    /// The result of the one that was opened, or why it failed.
    pub done: Result<Done, String>,
    /// The files that were not opened.
    pub left: Vec<String>,
}

impl FileOutcome {
    /// Returns the result for a single file.
    #[must_use]
    pub const fn of(done: Result<Done, String>) -> Self {
        let left = Vec::new();
        Self { done, left }
    }
}

/// The result of reading or writing a file.
#[derive(serde::Serialize, serde::Deserialize)]
pub enum Done {
    /// It was written under this path.
    Saved(String),
    /// It is ready for download.
    Download(NamedBytes),
    /// A session or a combination was read.
    Opened(Box<Opened>),
    /// A set of nested levels, or one in a field or a shape, was read.
    Levels(Box<Session>),
    /// A pattern was read.
    Pattern(OwnPattern),
    /// An image was read, for the radius or the density of a set.
    Image(Box<GrayImage>),
    /// A polygon was read, in which a set is to lie.
    Shape(Box<PlanarPolygon>),
    /// A point set was read and measured.
    Against {
        /// The set that was measured.
        file: Box<ReferenceFile>,
        /// Why it is not a pattern, if it was tried as one.
        no_pattern: Option<String>,
    },
}

/// A session that was read, computed again.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Opened {
    /// The file's path or name.
    pub path: String,
    /// The saved content, apart from the run.
    #[serde(with = "as_json")]
    pub saved: SavedContent,
    /// The session, computed again.
    pub session: Session,
}

/// What a file says about the session in it.
#[derive(serde::Serialize, serde::Deserialize)]
pub enum SavedContent {
    /// The saved session of a run.
    Run(Box<Saved>),
    /// The saved session of a combination; `None` if the file is a layout.
    Combination(Option<SavedCombination>),
}

type Made = Result<Done, String>;

impl Task for ReadTask {
    type Outcome = FileOutcome;
    const NAME: &'static str = "read";

    fn run(self, monitor: &Monitor) -> FileOutcome {
        read(self, monitor)
    }

    fn cancelled(_: &Monitor) -> Option<FileOutcome> {
        Some(FileOutcome::of(Err(
            "cancelled: nothing was opened".to_owned()
        )))
    }

    fn keep(outcome: FileOutcome) {
        match outcome.done {
            Ok(Done::Opened(opened)) => SessionRef::keep::<()>(Ok(opened.session)),
            Ok(Done::Levels(session)) => SessionRef::keep::<()>(Ok(*session)),
            // Nothing else has a session.
            _ => {}
        }
    }
}

/// Reads the files of a task.
#[must_use]
pub fn read(task: ReadTask, monitor: &Monitor) -> FileOutcome {
    let ReadTask {
        purpose,
        source,
        generation,
        run,
    } = task;

    let gathered = match source {
        FileSource::Bytes(files) => gather(files).ok_or_else(|| "there is no file".to_owned()),
        #[cfg(not(target_arch = "wasm32"))]
        FileSource::Paths(paths) => super::disk::gather_paths(&paths, purpose, monitor),
    };

    // A download may be an archive of a set and its certificate, which is opened like the set.
    let (incoming, left) = match gathered.and_then(opened) {
        Ok(gathered) => gathered,
        Err(why) => return FileOutcome::of(Err(why)),
    };

    // A dropped or opened image or polygon becomes the field or the shape of the next run. The other purposes ask for
    // another kind of file, and refuse it below.
    let ground = match purpose {
        None | Some(Purpose::Open) => ground_file(&incoming),
        Some(Purpose::Combination | Purpose::Pattern | Purpose::Against | Purpose::Save) => None,
    };
    if let Some(done) = ground {
        return FileOutcome { done, left };
    }
    // A set that was made in a field or a shape is opened as a session. It is neither a pattern nor compared with a
    // run, as those have one radius.
    if let (None | Some(Purpose::Open), Some(session)) =
        (purpose, varying::of_file(&incoming, generation))
    {
        let done = session.map(|session| Done::Levels(Box::new(session)));
        return FileOutcome { done, left };
    }

    let done = match purpose {
        None => dropped(&incoming, generation, run, monitor),
        Some(Purpose::Open) => open(&incoming, generation, monitor),
        Some(Purpose::Combination) => combination(&incoming, generation, monitor),
        Some(Purpose::Pattern) => load(&incoming).map(Done::Pattern),
        Some(Purpose::Against) => against(&incoming, run, monitor),
        Some(Purpose::Save) => Err("a save sheet reads no file".to_owned()),
    };
    FileOutcome { done, left }
}

/// Unpacks an archive into the one of its files that is to be opened, with the others beside it. Other files
/// are returned unchanged.
fn opened(gathered: (Incoming, Vec<String>)) -> Result<(Incoming, Vec<String>), String> {
    let (incoming, mut left) = gathered;
    if !incoming.is_archive() {
        return Ok((incoming, left));
    }
    let archive = NamedBytes::new(incoming.name, incoming.bytes);
    let (inner, others) =
        gather(unpacked(&archive)?).ok_or_else(|| format!("{} is empty", archive.name))?;
    left.extend(others);
    Ok((inner, left))
}

/// Reads an image or a polygon; `None` for other files.
fn ground_file(incoming: &Incoming) -> Option<Made> {
    let (name, bytes) = (last_part(&incoming.name), &incoming.bytes);
    if GrayImage::is_image(bytes) {
        let image = GrayImage::read(name, bytes).map_err(|error| error.to_string());
        return Some(image.map(|image| Done::Image(Box::new(image))));
    }

    let value: Value = serde_json::from_slice(bytes).ok()?;
    holds_polygon(&value).then(|| {
        // GeoJSON has corners in degrees, unless its writer meant lengths in a plane. The file does not say which, so
        // that corners that may be degrees are refused; the error says what to do.
        let is_surely_planar = false;
        let polygon = PlanarPolygon::from_geojson(name, bytes, is_surely_planar)
            .map_err(|error| error.to_string())?;
        Ok(Done::Shape(Box::new(polygon)))
    })
}

/// Returns whether a document is `GeoJSON` with a polygon. One of points alone is a point set.
fn holds_polygon(value: &Value) -> bool {
    let any = |list: &Value| {
        let mut parts = list.as_array().into_iter().flatten();
        parts.any(holds_polygon)
    };
    match value["type"].as_str() {
        Some("Polygon" | "MultiPolygon") => true,
        Some("FeatureCollection") => any(&value["features"]),
        Some("GeometryCollection") => any(&value["geometries"]),
        Some("Feature") => holds_polygon(&value["geometry"]),
        _ => false,
    }
}

/// Reads a session and computes its run again, or reads a combination, from a session or a layout, and makes
/// it. Also opens a point set of nested levels; any other point set is refused.
fn open(incoming: &Incoming, generation: u64, monitor: &Monitor) -> Made {
    let set = (!incoming.is_document()).then(|| incoming.point_set());
    if let Some(Ok(set)) = set {
        if let Some(session) = nesting::of_file(&set, &incoming.name, generation) {
            return session.map(|session| Done::Levels(Box::new(session)));
        }
        let hint = "is a point set, not a saved session; drop it on the window to use it";
        return Err(format!("{} {hint}", incoming.name));
    }
    // A file that is neither a point set nor JSON is refused as a session that cannot be read.
    match serde_json::from_str(incoming.text()?) {
        Ok(value) if holds_combination(&value) => combination(incoming, generation, monitor),
        _ => session(incoming, generation, monitor),
    }
}

/// Makes the combination of a layout, or of a session that shows one.
fn combination(incoming: &Incoming, generation: u64, monitor: &Monitor) -> Made {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", incoming.name);
    let text = incoming.text()?;
    // A text that is no JSON goes on as null, and `Layout::from_json` refuses it with a message.
    let value = serde_json::from_str::<Value>(text).unwrap_or_default();
    // A saved session has a cursor, and a layout has none.
    if value.get("cursor").is_some() && !holds_combination(&value) {
        let name = &incoming.name;
        return Err(format!(
            "{name} is the saved session of a run, not a combination"
        ));
    }

    // The saved session of a combination has this field, and a layout has its pieces instead.
    let saved = value
        .get("combination")
        .map(|_| SavedCombination::from_json(text))
        .transpose()
        .map_err(|error| named(&error))?;
    let layout = match &saved {
        Some(saved) => saved.layout().map_err(|error| named(&error))?,
        None => Layout::from_json(text.as_bytes()).map_err(|error| named(&error))?,
    };

    // A layout may name files beside it. The saved session of a combination must not name any, so that it gets none.
    let around = saved.is_none().then_some(incoming);
    let session = match make(layout, around, generation, monitor) {
        Ok(session) => session,
        Err(error) if error.cancelled().is_some() => {
            return Err("cancelled: the combination was not made".to_owned());
        }
        Err(error) => return Err(named(&error)),
    };

    if let Some(saved) = &saved {
        // The saved digest shows whether this is the combination that was saved.
        saved.prove(&session).map_err(|error| named(&error))?;
    }

    Ok(Done::Opened(Box::new(Opened {
        path: incoming.name.clone(),
        saved: SavedContent::Combination(saved),
        session,
    })))
}

/// Reads the saved session of a run, and makes the run again.
fn session(incoming: &Incoming, generation: u64, monitor: &Monitor) -> Made {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", incoming.name);
    let saved = Saved::from_json(incoming.text()?).map_err(|error| named(&error))?;

    if !saved.ground.is_null() {
        return session_on_ground(incoming, saved, generation, monitor);
    }

    if let Some(depth) = saved.depth {
        return session_in_space(incoming, saved, depth, generation, monitor);
    }

    let mut own = None;
    // The recording needs the pattern alone; the session also keeps the file that it came from.
    let mut loader = |file: &PatternFile| {
        let pattern = find_pattern(file, incoming, monitor)?;
        own = Some(pattern.clone());
        Ok(Pattern::clone(&pattern.pattern))
    };

    let mut observer = Reporter { monitor };
    let recording = match saved.record(&mut loader, &mut observer) {
        Ok(recording) => Arc::new(recording),
        Err(SessionError::Run(tilescope_core::SampleError::Cancelled { .. })) => {
            return Err("cancelled: the session was not opened".to_owned());
        }
        Err(error) => return Err(named(&error)),
    };

    // Whether the session fits the recording is checked here, as this runs in the background.
    Debugger::resume(&saved, Arc::clone(&recording)).map_err(|error| named(&error))?;

    let parameters = saved.parameters;
    let recipe = Recipe {
        own,
        ..Recipe::from(parameters)
    };
    let session = Session::from_recording(recording, generation).with(&recipe);

    Ok(Done::Opened(Box::new(Opened {
        path: incoming.name.clone(),
        saved: SavedContent::Run(Box::new(saved)),
        session,
    })))
}

/// Makes the set in space of a saved session again.
fn session_in_space(
    incoming: &Incoming,
    mut saved: Saved,
    depth: f64,
    generation: u64,
    monitor: &Monitor,
) -> Made {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", incoming.name);
    let expected =
        solid::expected_samples(&saved.parameters, depth).map_err(|error| named(&error))?;
    // Larger sets have no events, so that none is saved.
    if expected > MAX_RECORDED {
        return Err(named(&SessionError::TooMuch {
            what: "expected samples",
            found: expected as usize,
            limit: MAX_RECORDED as usize,
        }));
    }

    // Older files may name exact tiling.
    let recipe = Recipe {
        depth: Some(depth),
        ..Recipe::from(saved.parameters)
    }
    .with_its_method();
    saved.parameters = recipe.parameters;
    let session = match packing::sample(&recipe, depth, generation, monitor) {
        Ok(session) => session,
        Err(error) if error.cancelled().is_some() => {
            return Err("cancelled: the session was not opened".to_owned());
        }
        Err(error) => return Err(named(&error)),
    };
    // Another set than the saved one is refused here, and a saved moment beyond the end of this one.
    if let Some(recording) = session.recording() {
        Debugger::resume(&saved, Arc::clone(recording)).map_err(|error| named(&error))?;
    }

    Ok(Done::Opened(Box::new(Opened {
        path: incoming.name.clone(),
        saved: SavedContent::Run(Box::new(saved)),
        session,
    })))
}

/// Makes the run of a saved session in a field or a shape again.
fn session_on_ground(
    incoming: &Incoming,
    mut saved: Saved,
    generation: u64,
    monitor: &Monitor,
) -> Made {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", incoming.name);
    let refused = |why: String| named(&SessionError::NoGround(why));

    // The file may come from anywhere: its formula and its corners are checked like those of the form.
    let portable: PortableGround =
        serde_json::from_value(saved.ground.clone()).map_err(|error| refused(error.to_string()))?;
    let asked = portable
        .request()
        .map_err(|error| refused(error.to_string()))?;
    let request = asked.ok_or_else(|| refused("it asks for neither".to_owned()))?;

    // Older files may name exact tiling where darts make the set.
    let recipe = Recipe {
        ground: Some(Box::new(request.clone())),
        ..Recipe::from(saved.parameters)
    }
    .with_its_method();
    saved.parameters = recipe.parameters;
    let locality = varying::locality(&request.recipe(&saved.parameters))
        .map_err(|error| refused(error.to_string()))?;

    // The same darts as before: `resume` compares the digest of the set with the saved one below.
    let mut observer = Reporter { monitor };
    let recording = match saved.record_in(&locality, &mut observer) {
        Ok(recording) => recording,
        Err(SessionError::Run(tilescope_core::SampleError::Cancelled { .. })) => {
            return Err("cancelled: the session was not opened".to_owned());
        }
        Err(error) => return Err(named(&error)),
    };
    let session = varying::prepared(recording, &recipe, &request, generation, &mut observer)
        .map_err(|error| named(&error))?;
    // Another set than the saved one is refused here, and a saved moment beyond the end of this one.
    if let Some(recording) = session.recording() {
        Debugger::resume(&saved, Arc::clone(recording)).map_err(|error| named(&error))?;
    }

    Ok(Done::Opened(Box::new(Opened {
        path: incoming.name.clone(),
        saved: SavedContent::Run(Box::new(saved)),
        session,
    })))
}

/// Reads a session's pattern from the files that came with the session, otherwise from the session's folder or
/// the saved path.
#[cfg_attr(
    target_arch = "wasm32",
    allow(unused_variables, reason = "there is no folder to read from")
)]
fn find_pattern(
    file: &PatternFile,
    incoming: &Incoming,
    monitor: &Monitor,
) -> Result<OwnPattern, String> {
    if let Some(found) = incoming.companion(&file.path) {
        return load(&found);
    }
    #[cfg(not(target_arch = "wasm32"))]
    if let Some(folder) = &incoming.folder {
        return super::disk::find_pattern(file, folder, monitor);
    }
    let missing =
        "it did not come with the session; open both at once, and the pattern's certificate";
    Err(missing.to_owned())
}

/// Measures a point set on the domain of the run.
fn against(incoming: &Incoming, run: Option<(Region, f64)>, monitor: &Monitor) -> Made {
    let (region, radius) = run.ok_or("there is no run to compare a file with")?;
    let set = incoming.point_set()?;
    let no_pattern = set.refused.clone();
    let file = reference_file::of(set, &incoming.name, region, radius, monitor)?;
    Ok(Done::Against {
        file: Box::new(file),
        no_pattern,
    })
}

/// Reads dropped files: a session or a combination if it is one; a point set with its levels if its certificate states
/// some, as a pattern if it can be one, otherwise to compare the run with it.
fn dropped(
    incoming: &Incoming,
    generation: u64,
    run: Option<(Region, f64)>,
    monitor: &Monitor,
) -> Made {
    let name = &incoming.name;
    // A certificate says how its set was made, but has no samples.
    if name.ends_with(CERTIFICATE_SUFFIX) {
        return Err(format!(
            "{name} is a certificate; drop it together with its point set"
        ));
    }

    if incoming.is_document() {
        return open(incoming, generation, monitor);
    }

    let set = incoming.point_set()?;
    if let Some(session) = nesting::of_file(&set, name, generation) {
        return session.map(|session| Done::Levels(Box::new(session)));
    }

    // Only a maximal set can be a pattern, but any set can be compared with a run: the use that is possible less often comes first.
    let no_pattern = match recipe::pattern_of(&set, name) {
        Ok(own) => return Ok(Done::Pattern(own)),
        Err(why) => why,
    };

    let Some((region, radius)) = run else {
        return Err(no_pattern);
    };

    match reference_file::of(set, name, region, radius, monitor) {
        Ok(file) => Ok(Done::Against {
            file: Box::new(file),
            no_pattern: Some(no_pattern),
        }),
        // After the user stopped the comparison, it need not be said why the set is no pattern.
        Err(why) if monitor.is_cancelled() => Err(why),
        Err(why) => Err(format!(
            "{no_pattern}. It cannot be compared with this run either: {why}"
        )),
    }
}
