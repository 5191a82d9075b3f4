//! A finished run prepared for display: its stages, an index of its samples by position, and the conflicts that
//! elimination resolved. It is built once, in the background, and does not change. Begin with [`Session`]; progress and
//! errors of making one are in `session/report.rs`.

mod report;

use std::sync::{Arc, OnceLock};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use tilescope_core::{
    Fate, Insertion, Iteration, MAXIMAL_DENSITY, Origin, Parameters, PatternHistory, R, Run,
    RunEvent, SampleError, SampleGrid, Stage, Standing, Summary, Sweep, TilingMethod, Variant,
    covers_offset, exact_sample_parallel,
};
use tilescope_debugger::{Event, Outline, Recording};
use tilescope_gpu::GpuError;
use tilescope_live::{MOMENT_NUMBERS, SPACE_MOMENT_NUMBERS, Setting, moment_numbers_in};

use crate::combination::Combination;
use crate::ground::MadeGround;
use crate::index::SampleIndex;
use crate::jobs::Monitor;
use crate::layers::{Layer, Layers, SessionKind};
use crate::limits::MAX_STAGED;
use crate::nested::NestedLevels;
use crate::recipe::{OwnPattern, Recipe};
use crate::solid::MadeSolid;
use crate::stipple::MadeStipple;
use crate::units;
use crate::words::grouped;
pub use report::{MakeError, Reporter};
pub(crate) use report::{StageShare, part_done, share_of};

/// Returns whether a run is small enough to keep every stage of it. Algorithm 4 as printed always keeps them.
pub fn keeps_everything(parameters: &Parameters) -> Result<bool, SampleError> {
    let expected = parameters.validate()?.area_radii() * MAXIMAL_DENSITY;
    Ok(expected <= MAX_STAGED || parameters.variant == Variant::AsPrinted)
}

/// Returns the stage that an event begins, if it begins one.
fn begun_by(event: &Event) -> Option<Stage> {
    match event.run_event()? {
        RunEvent::Begin(stage) => Some(stage),
        RunEvent::Iteration { number, .. } => Some(Stage::Iterate(number)),
        _ => None,
    }
}

/// A run with everything that the window needs to show it.
#[derive(Serialize, Deserialize)]
pub struct Session {
    source: RunSource,
    /// Its stages, in their sequence.
    pub stages: Vec<Stage>,
    /// The first event of each stage but the first, if events were recorded.
    starts: Vec<usize>,
    /// The last iteration of a recording, which found no gap; the run does not contain it.
    last: Option<Iteration>,
    /// Of an exact tiling with events, how many samples are lost by the end of each stage.
    losses: Vec<usize>,
    /// How many samples each stage made or removed.
    pub summary: Summary,
    /// The index of all samples by position.
    pub index: SampleIndex,
    /// Pairs of tiled samples in each other's disks: the conflicts before elimination.
    pub conflicts: Vec<[u32; 2]>,
    /// The tree of its events, if they were recorded.
    pub outline: Option<Outline>,
    /// The session's number, different for every session, so that cached pictures of another one are not reused.
    pub generation: u64,
    /// The engine that made it: "CPU", or "GPU" with the adapter's name.
    pub engine: String,
    /// The pattern from a file that it was made with, if any.
    pub own: Option<OwnPattern>,
    /// The combination, if it is one; its blocks are the pieces.
    pub combination: Option<Combination>,
    /// The levels, if it has nested ones; its samples are then in their order.
    pub nested: Option<NestedLevels>,
    /// What it was made on, if its radius depends on the place or its domain is a shape.
    pub ground: Option<MadeGround>,
    /// What its samples have besides their places in the plane, if it is a set in space.
    pub solid: Option<MadeSolid>,
    /// Why the GPU run failed, if the CPU had to make the session instead; taken when the user is notified.
    #[serde(skip)]
    pub failure: Option<Failure>,
    #[serde(skip)]
    digest: OnceLock<String>,
    #[serde(skip)]
    positions_digest: OnceLock<String>,
}

/// A session's run, with or without its events.
#[derive(Serialize, Deserialize)]
enum RunSource {
    /// The run with all events, so that any moment of it can be shown.
    Recorded(Arc<Recording>),
    /// The run alone, whose stages can be shown at most.
    Run(Box<Run>),
}

/// A device that failed, so that the CPU had to make a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The adapter's name, as its driver gives it.
    pub name: String,
    /// The error with which the device failed.
    pub error: GpuError,
}

impl Session {
    /// Samples by the parameters and the pattern of `recipe` on the CPU and prepares the result; its levels, ground and
    /// depth are for other functions ([`crate::sampling::SampleTask`]).
    ///
    /// Fails as the engines of the core do, and when `monitor` is cancelled.
    pub fn sample(
        recipe: &Recipe,
        generation: u64,
        monitor: &Monitor,
    ) -> Result<Self, SampleError> {
        let parameters = &recipe.parameters;
        parameters.validate_sequential()?;
        recipe.check()?;
        let mut observer = Reporter { monitor };

        if keeps_everything(parameters)? {
            let recording = recipe.record(&mut observer)?;
            let made = observer.prepare(|| Self::from_recording(Arc::new(recording), generation));
            return made.map(|session| session.with(recipe));
        }

        // A run that is too large for events is made by a parallel engine, which is ten times as fast and keeps only the result.
        let run = match parameters.method {
            TilingMethod::Kdrt => {
                let pattern = recipe.pattern(&mut observer)?;
                Sweep::run(parameters, &pattern, &mut observer)?
            }
            TilingMethod::Exact => {
                let history = PatternHistory::of_spec(&parameters.pattern, &mut observer)?;
                exact_sample_parallel(parameters, &history, &mut observer)?
            }
        };

        let made = observer.prepare(|| Self::from_run(run, generation));
        made.map(|session| session.with(recipe))
    }

    /// Returns this session with the pattern file of `recipe`, if that has one.
    #[must_use]
    pub fn with(self, recipe: &Recipe) -> Self {
        Self {
            own: recipe.own.clone(),
            ..self
        }
    }

    /// Returns the recipe it was made from, if [`Self::has_recipe`].
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        if let Some(solid) = &self.solid {
            return Recipe {
                depth: Some(solid.depth()),
                ..Recipe::from(solid.asked)
            };
        }
        if let Some(ground) = &self.ground {
            let (parameters, request) = &ground.asked;
            return Recipe {
                ground: Some(Box::new(request.clone())),
                ..Recipe::from(*parameters)
            };
        }

        let asked = self.nested.as_ref().and_then(|nested| nested.asked);
        Recipe {
            parameters: asked.map_or(self.run().parameters, |(parameters, _)| parameters),
            own: self.own.clone(),
            nested: asked.map(|(_, request)| request),
            ground: None,
            depth: None,
        }
    }

    /// Returns whether it was made from a recipe, not from a layout, a file, or a wrong process of a lesson.
    #[must_use]
    pub fn has_recipe(&self) -> bool {
        let is_made = |nested: &NestedLevels| nested.asked.is_some();
        let is_as_asked = |ground: &MadeGround| ground.is_as_asked;
        let is_of_recipe = self.nested.as_ref().is_none_or(is_made)
            && self.ground.as_ref().is_none_or(is_as_asked);
        self.combination.is_none() && is_of_recipe
    }

    /// Returns what the stipple became, if it is one.
    #[must_use]
    pub fn stipple(&self) -> Option<&MadeStipple> {
        self.ground.as_ref()?.stipple.as_ref()
    }

    /// Returns whether its moments are prefixes, of nested levels or of a stipple: a cursor is then a number of samples.
    #[must_use]
    pub fn has_prefixes(&self) -> bool {
        self.nested.is_some() || self.stipple().is_some()
    }

    /// Returns the session of a set in a field as a stipple: the end is its only stage.
    #[must_use]
    pub fn as_stipple(mut self, made: MadeStipple) -> Self {
        self.stages = vec![Stage::Finish];
        if let Some(ground) = &mut self.ground {
            ground.stipple = Some(made);
        }
        self
    }

    /// Returns the session of projections as that of a set in space. Without events the end is its only stage.
    #[must_use]
    pub(crate) fn in_space(mut self, solid: MadeSolid) -> Self {
        if self.recording().is_none() {
            self.stages = vec![Stage::Finish];
        }
        self.solid = Some(solid);
        self
    }

    /// Returns how many cubes are active in a throw of a set in space, and how many of them a plane cuts; `None` at other stages,
    /// of other sets, and in a throw within which the recording was cut off.
    #[must_use]
    pub fn active_cubes(&self, stage: Stage, plane: i32) -> Option<[usize; 2]> {
        let solid = self.solid.as_ref()?;
        let Stage::Iterate(throw) = stage else {
            return None;
        };
        let cells = &self.iteration(throw)?.cells;
        // All cubes of a throw have one side, and each throw has some.
        let side = cells.first()?.side;
        Some([cells.len(), solid.cubes_cut(throw, side, plane).count()])
    }

    /// Returns "1,992 active in all, 3 in this plane" of a throw of a set in space; `None` where [`Self::active_cubes`] is.
    #[must_use]
    pub fn active_in_plane(&self, stage: Stage, plane: i32) -> Option<String> {
        // Cubes may be active although this plane cuts none of them.
        let counts = self.active_cubes(stage, plane)?;
        let [all, cut] = counts.map(grouped);
        Some(format!("{all} active in all, {cut} in this plane"))
    }

    /// Returns how high the place of the last event before a cursor lies that has one, in lattice units; `None` of planar
    /// sets, and before the first such event.
    #[must_use]
    pub fn event_height(&self, cursor: usize) -> Option<i32> {
        self.recording()?.height_before(cursor)
    }

    /// Returns whether the disks of its samples may differ in radius: where radii depend on the place, and where a plane cuts
    /// balls. Darts made all of these sets, not tiles.
    #[must_use]
    pub fn has_own_disks(&self) -> bool {
        self.is_in_field() || self.solid.is_some()
    }

    /// Returns whether it is a set in a field or a shape that is shown without tiles: one that darts made, or of which a file
    /// has the samples alone.
    #[must_use]
    pub fn is_in_field(&self) -> bool {
        self.ground.is_some() && !self.is_exact()
    }

    /// Returns its kind, which decides the layers and their names.
    #[must_use]
    pub fn kind(&self) -> SessionKind {
        match (&self.combination, &self.nested) {
            (Some(_), _) => SessionKind::Combination,
            (None, Some(_)) => SessionKind::Nested,
            (None, None) if self.solid.is_some() => SessionKind::Solid,
            (None, None) if self.is_in_field() => SessionKind::Varying,
            (None, None) if self.is_exact() => SessionKind::Exact,
            (None, None) => SessionKind::Run,
        }
    }

    /// Returns those of the layers that can be drawn of it.
    #[must_use]
    pub fn drawable(&self, layers: Layers) -> Layers {
        // The dots of a stipple need not cover every place. With few dots, gaps would be drawn over most of the image.
        let layers = match self.stipple() {
            Some(_) => layers.without(Layer::Gaps),
            None => layers,
        };
        match self.kind() {
            kind @ (SessionKind::Nested | SessionKind::Varying | SessionKind::Solid) => {
                layers.of_kind(kind)
            }
            // Exposed arcs are measured in a rectangle.
            SessionKind::Exact if self.ground.is_some() => layers.without(Layer::CoveredCircles),
            SessionKind::Run | SessionKind::Exact | SessionKind::Combination => layers,
        }
    }

    /// Prepares a run of the GPU. If it is small enough to keep every stage, the CPU records the same run with its
    /// events. If the two differ, the GPU's run is shown as it is, without events.
    pub fn of_gpu(
        run: Run,
        recipe: &Recipe,
        generation: u64,
        observer: &mut Reporter<'_>,
    ) -> Result<Self, SampleError> {
        // A GPU reports no events. Those of the CPU are taken if its run is the same, as it must be. A run without
        // `counted` has all its stages to compare. Of an exact tiling the GPU keeps only the result, so that `counted`
        // does not tell how large the run is: `keeps_everything` decides, and the results are compared.
        let is_exact = run.parameters.method == TilingMethod::Exact;
        let has_stages = run.counted.is_none();
        if has_stages || is_exact && keeps_everything(&run.parameters)? {
            let recording = recipe.record(observer)?;
            let twin = recording.run();
            let is_same = if is_exact {
                twin.points() == run.points() && twin.summary() == run.summary()
            } else {
                twin.samples == run.samples && twin.result == run.result
            };
            if is_same {
                let made =
                    observer.prepare(|| Self::from_recording(Arc::new(recording), generation));
                return made.map(|session| session.with(recipe));
            }
        }

        let made = observer.prepare(|| Self::from_run(run, generation));
        made.map(|session| session.with(recipe))
    }

    /// Returns the run that it shows.
    #[must_use]
    pub fn run(&self) -> &Run {
        match &self.source {
            RunSource::Recorded(recording) => recording.run(),
            RunSource::Run(run) => run,
        }
    }

    /// Returns the digest of the result's positions in user units, as in certificates. Computed at the first call.
    #[must_use]
    pub fn positions_digest(&self) -> &str {
        let digest = || match &self.solid {
            Some(solid) => tilescope_formats::solid_digest(&solid.positions(self.run())),
            None => tilescope_formats::positions_digest(&self.run().positions()),
        };
        self.positions_digest.get_or_init(digest)
    }

    /// Returns the digest of the result, 16 hexadecimal digits. Computed at the first call.
    #[must_use]
    pub fn digest(&self) -> &str {
        let digest = || match &self.solid {
            Some(solid) => solid.digest(self.run()),
            None => tilescope_debugger::digest(self.run()),
        };
        self.digest.get_or_init(digest)
    }

    /// Returns the events of the run, if they were recorded. Expressions over them can name numbers of the moment.
    #[must_use]
    pub fn recording(&self) -> Option<&Arc<Recording>> {
        match &self.source {
            RunSource::Recorded(recording) => {
                // Here, as a session that was sent to a worker lacks them.
                self.give_numbers(recording);
                Some(recording)
            }
            RunSource::Run(_) => None,
        }
    }

    /// Lets expressions over a recording of this session name numbers of the moment, if it has them.
    fn give_numbers(&self, recording: &Recording) {
        if let Some(ground) = &self.ground {
            recording.give_numbers(|| {
                // The field is made again only where an expression names a number.
                let ground = ground.clone();
                Arc::new(moment_numbers_in(move || ground.live()))
            });
        } else if recording.is_in_space() {
            recording.give_numbers(|| Arc::clone(&SPACE_MOMENT_NUMBERS));
        } else if recording.run().locality.is_none() {
            // A session in a field or a shape gets its ground after it is made, and its numbers then.
            recording.give_numbers(|| Arc::clone(&MOMENT_NUMBERS));
        }
    }

    /// Returns what the samples lie in.
    #[must_use]
    pub fn setting(&self) -> Setting {
        match &self.ground {
            Some(ground) => Setting::of_ground(!ground.varies()),
            None => Setting::of_box(self.solid.is_some()),
        }
    }

    /// Returns the index of a stage; if the run lacks it, of the last stage before it, or of the first if there is none.
    #[must_use]
    pub fn stage_index(&self, stage: Stage) -> usize {
        let index = self.stages.iter().rposition(|&other| other <= stage);
        index.unwrap_or(0)
    }

    /// Returns the index of the stage that is current when `cursor` events have happened.
    #[must_use]
    pub fn stage_at(&self, cursor: usize) -> usize {
        self.starts.partition_point(|&start| start < cursor)
    }

    /// Returns the cursor after the last event of the stage at `index`, if events were recorded; of nested levels and
    /// of a stipple the number of samples.
    #[must_use]
    pub fn stage_end(&self, index: usize) -> Option<usize> {
        if self.has_prefixes() {
            return Some(self.summary.count);
        }
        let recording = self.recording()?;
        let next = self.starts.get(index).copied();
        Some(next.unwrap_or_else(|| recording.len()))
    }

    /// Returns the cursors at which its stages end, if events were recorded; of nested levels those at which levels
    /// end, and of a stipple the number of samples alone.
    #[must_use]
    pub fn ends(&self) -> Vec<usize> {
        match &self.nested {
            Some(nested) => nested.ends().collect(),
            None => (0..self.stages.len())
                .map_while(|index| self.stage_end(index))
                .collect(),
        }
    }

    /// Returns whether the recording was cut off at a cursor, as before an open question of a lesson: later events of the
    /// run were left out.
    #[must_use]
    pub fn is_cut_off_at(&self, cursor: usize) -> bool {
        let here = self
            .recording()
            .filter(|recording| recording.len() == cursor);
        // A recording that was cut off has no result.
        here.is_some_and(|recording| recording.run().result.is_empty())
    }

    /// Returns whether every sample's fate was kept, so that every stage can be shown.
    #[must_use]
    pub fn has_stages(&self) -> bool {
        self.run().counted.is_none()
    }

    /// Prepares a finished run of the CPU, without events.
    #[must_use]
    pub fn from_run(run: Run, generation: u64) -> Self {
        Self::of(RunSource::Run(Box::new(run)), generation)
    }

    /// Prepares a recorded run. Recorded levels become a session of levels, whose moments are prefixes.
    #[must_use]
    pub fn from_recording(recording: Arc<Recording>, generation: u64) -> Self {
        if let Some(levels) = recording.levels() {
            let run = recording.run();
            let nested = NestedLevels::of_recorded(run, levels);
            let points = run.samples.points.clone();
            let arranged = Run::of_points(run.parameters, run.domain, points);
            return Self::from_levels(arranged, nested, generation);
        }
        Self::of(RunSource::Recorded(recording), generation)
    }

    /// Prepares a combination. Its first stage is that of its pieces, since they have no common pattern.
    #[must_use]
    pub fn from_combination(run: Run, combination: Combination, generation: u64) -> Self {
        let mut session = Self::from_run(run, generation);
        session.stages.retain(|&stage| stage != Stage::Pattern);
        session.combination = Some(combination);
        session
    }

    /// Prepares nested levels, whose samples are in the order of the run's result. The end is their only stage.
    #[must_use]
    pub fn from_levels(run: Run, levels: NestedLevels, generation: u64) -> Self {
        let mut session = Self::from_run(run, generation);
        session.stages = vec![Stage::Finish];
        session.nested = Some(levels);
        session
    }

    /// Prepares a run with or without events. Sessions of other kinds replace the parts that differ.
    fn of(source: RunSource, generation: u64) -> Self {
        let run = match &source {
            RunSource::Recorded(recording) => recording.run(),
            RunSource::Run(run) => run,
        };

        let (mut stages, mut starts, mut last, mut outline) =
            (run.stages(), Vec::new(), None, None);
        // A run in a field, a shape or space has no pattern, unless it is tiled, and its first throw is its first stage.
        let is_in_space = matches!(&source, RunSource::Recorded(made) if made.is_in_space());
        let is_tiled = run.parameters.method == TilingMethod::Exact;
        if run.locality.is_some() && !is_tiled || is_in_space {
            stages.retain(|&stage| stage != Stage::Pattern);
        }
        let mut losses = Vec::new();
        if let RunSource::Recorded(recording) = &source {
            // This builds the index for searches, here in the background rather than at the first search.
            recording.prepare();

            // A recording that was cut off has no result. It has all stages that it began, also the one in which it ends.
            if run.result.is_empty() {
                stages = begun_stages(recording, stages);
            }

            // The first throw is the first stage, also before its first event.
            if stages.is_empty() {
                stages.push(Stage::Iterate(1));
            }

            // The run keeps only iterations that found a gap. The events also have the last one, which found none. It may be among the
            // stages that were begun, so that it is taken out before it is put in.
            last = last_iteration(recording);
            if last.is_some() {
                let number = run.iterations.len() as u32 + 1;
                stages.retain(|&stage| stage != Stage::Iterate(number));
                let behind = stages.partition_point(|&stage| stage < Stage::Iterate(number));
                stages.insert(behind, Stage::Iterate(number));
            }

            starts = stage_starts(recording, &stages);
            if recording.is_exact() {
                losses = losses_by_stage(recording, &starts);
            }
            outline = Some(Outline::new(recording));
        }

        // A run that kept only its result no longer has the samples that were in conflict.
        let conflicts = match run.counted {
            Some(_) => Vec::new(),
            None => tiled_conflicts(run),
        };

        Self {
            stages,
            summary: run.summary(),
            index: SampleIndex::new(&run.domain, &run.samples.points),
            conflicts,
            losses,
            starts,
            last,
            outline,
            generation,
            engine: "CPU".to_owned(),
            own: None,
            combination: None,
            nested: None,
            ground: None,
            solid: None,
            failure: None,
            digest: OnceLock::new(),
            positions_digest: OnceLock::new(),
            source,
        }
    }

    /// Returns the domain's sides in r.
    #[must_use]
    pub fn size_radii(&self) -> DVec2 {
        units::size(&self.run().domain)
    }

    /// Returns the sides of the area that a stage shows, in r: of the domain, or of the pattern at the stage that makes it.
    #[must_use]
    pub fn size_at(&self, stage: Option<Stage>) -> DVec2 {
        if stage == Some(Stage::Pattern) {
            units::size(self.run().pattern.domain())
        } else {
            self.size_radii()
        }
    }

    /// Returns where sample `id` lies, in r.
    #[must_use]
    pub fn position(&self, id: u32) -> DVec2 {
        units::position(self.run().samples.points[id as usize])
    }

    /// Returns whether sample `id` covers a place, in r. Where the radius depends on the place, or the domain is a shape, none
    /// covers a place outside.
    #[must_use]
    pub fn covers_place(&self, id: u32, at: DVec2) -> bool {
        let run = self.run();
        let Some(locality) = &run.locality else {
            return self.image_near(id, at).distance(at) <= 1.0;
        };
        // A field has a radius at each place of the lattice.
        let place = run.domain.wrap(units::lattice(at));
        place.is_some_and(|place| {
            locality.inside(place) && locality.is_near(place, run.samples.points[id as usize])
        })
    }

    /// Returns whether it is a stipple of an inverted image, which has dots where the image is light.
    #[must_use]
    pub fn is_inverted(&self) -> bool {
        let request = self
            .ground
            .as_ref()
            .and_then(|made| made.asked.1.stipple.as_ref());
        request.is_some_and(|request| request.tone.is_inverted)
    }

    /// Returns whether its radius depends on the place.
    #[must_use]
    pub fn radius_varies(&self) -> bool {
        let locality = self.run().locality.as_ref();
        locality.is_some_and(|locality| {
            let [least, greatest] = locality.field.extremes();
            least < greatest
        })
    }

    /// Returns whether its domain is a shape.
    #[must_use]
    pub fn has_shape(&self) -> bool {
        let locality = self.run().locality.as_ref();
        locality.is_some_and(|locality| !locality.shape.is_rectangle())
    }

    /// Returns the radius of a sample, in r: 1 unless the radius depends on the place.
    #[must_use]
    pub fn radius_of(&self, id: u32) -> f64 {
        let run = self.run();
        let locality = run.locality.as_ref();
        locality.map_or(1.0, |locality| {
            units::radii(locality.radius_at(run.samples.points[id as usize]))
        })
    }

    /// Returns the largest radius of a place, in r: 1 unless the radius depends on the place.
    #[must_use]
    pub fn largest_radius(&self) -> f64 {
        let locality = self.run().locality.as_ref();
        locality.map_or(1.0, |locality| units::radii(locality.field.extremes()[1]))
    }

    /// Returns a radius between the least and the largest, in r, by which symbols of samples are sized: 1 unless the radius
    /// depends on the place.
    #[must_use]
    pub fn usual_radius(&self) -> f64 {
        let locality = self.run().locality.as_ref();
        locality.map_or(1.0, |locality| {
            let [least, greatest] = locality.field.extremes().map(units::radii);
            // In a stipple, larger symbols would run together where the image is dark, which is what it shows.
            if self.stipple().is_some() {
                return least;
            }
            // The geometric mean suits small and large ones alike.
            (least * greatest).sqrt()
        })
    }

    /// Returns where the nearest image of sample `id` to `position` lies, in r.
    #[must_use]
    pub fn image_near(&self, id: u32, position: DVec2) -> DVec2 {
        let there = self.position(id);
        if !self.run().domain.is_periodic() {
            return there;
        }
        let size = self.size_radii();
        // The nearest image is a whole number of periods away.
        there - ((there - position) / size).round() * size
    }

    /// Returns iteration `k`, counted from 1; with events also the last one, which found no gap.
    #[must_use]
    pub fn iteration(&self, k: u32) -> Option<&Iteration> {
        let index = (k as usize).checked_sub(1)?;
        let kept = &self.run().iterations;
        let last = || self.last.as_ref().filter(|_| index == kept.len());
        kept.get(index).or_else(last)
    }

    /// Returns the number of samples that are valid (or, before elimination, tiled) after the stage at `index`; after
    /// that of the pattern, those of the pattern.
    #[must_use]
    pub fn count_after(&self, index: usize) -> usize {
        let summary = &self.summary;
        match self.stages[index] {
            Stage::Pattern => self.run().pattern.samples().len(),
            Stage::Blocks => 0,
            Stage::Tile => summary.tiled,
            Stage::Eliminate => summary.tiled - summary.eliminated + self.inserted_at_once(),

            // An exact tiling loses samples in its iterations, too, so that losses are counted up to this one.
            Stage::Iterate(k) => {
                let inserted: usize = summary.inserted.iter().take(k as usize).sum();
                summary.tiled - self.lost_by(index) + inserted
            }

            Stage::Regions | Stage::Finish => summary.count,
        }
    }

    /// Returns how many samples are lost in the stage at `index`, which is an iteration.
    #[must_use]
    pub fn lost_in(&self, index: usize) -> usize {
        let before = index.checked_sub(1);
        self.lost_by(index) - before.map_or(0, |before| self.lost_by(before))
    }

    /// Returns how many samples are lost by the end of the iteration at `index`: in other runs than exact tilings all are
    /// before the first.
    fn lost_by(&self, index: usize) -> usize {
        let lost = self.losses.get(index).copied();
        lost.unwrap_or(self.summary.eliminated)
    }

    /// Returns whether it is an exact tiling.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.run().parameters.method == TilingMethod::Exact
    }

    /// Returns the number of samples that elimination itself inserts: Algorithm 4 as printed fills gaps at once.
    #[must_use]
    pub fn inserted_at_once(&self) -> usize {
        match self.run().parameters.variant {
            // Without iterations nothing was inserted.
            Variant::AsPrinted => self.summary.inserted.first().copied().unwrap_or(0),
            Variant::Staged => 0,
        }
    }
}

/// Returns how many samples are lost by the end of each stage; `starts` has the first event of each stage but the first.
fn losses_by_stage(recording: &Recording, starts: &[usize]) -> Vec<usize> {
    let ids = 0..recording.run().samples.len() as u32;
    let lives = ids.filter_map(|id| recording.life(id));
    let mut losses: Vec<usize> = lives.map(|life| life.lost as usize).collect();
    // Samples that are never lost have the largest number, and so are in no count.
    losses.sort_unstable();
    // A stage ends where the next one starts, and the last one with the recording.
    let ends = starts.iter().copied().chain([recording.len()]);
    ends.map(|end| losses.partition_point(|&lost| lost < end))
        .collect()
}

/// Returns the iteration after those that the run keeps, if the recording has one; it found no gap.
fn last_iteration(recording: &Recording) -> Option<Iteration> {
    let run = recording.run();
    let number = run.iterations.len() as u32 + 1;

    // Its beginning is near the end of the tape, so that it is searched backwards.
    let mut events = recording.tape().before(recording.len());
    events.find(|(_, event)| begun_by(event) == Some(Stage::Iterate(number)))?;

    let all = 0..run.samples.len() as u32;
    let stays = |id: &u32| run.samples.fates[*id as usize] == Fate::Kept;
    let is_marked = |id: &u32| {
        recording
            .life(*id)
            .is_some_and(|life| life.marked != tilescope_debugger::NONE)
    };

    let detectors = match (run.parameters.insertion, run.parameters.variant) {
        // Uniform insertion has no detectors.
        (Insertion::Uniform, Variant::Staged) => Vec::new(),

        // The detectors are the samples inserted in the iteration before.
        (_, Variant::Staged) => match run.iterations.last() {
            Some(before) => before.inserted.clone().collect(),
            // No iteration found a gap, so that this is the first one, whose detectors are the marked survivors.
            None => all.clone().filter(stays).filter(is_marked).collect(),
        },

        // In Algorithm 4 as printed, samples stay marked: every inserted one and every marked survivor looks for gaps again.
        (_, Variant::AsPrinted) => {
            let inserted =
                |id: &u32| matches!(run.samples.origins[*id as usize], Origin::Inserted { .. });
            let looks = |id: &u32| inserted(id) || stays(id) && is_marked(id);
            all.clone().filter(looks).collect()
        }
    };

    Some(Iteration {
        detectors,
        // An iteration that inserted nothing has an empty range, and no candidates. Its open cells, if it has some, are
        // not kept.
        inserted: all.end..all.end,
        ..Iteration::default()
    })
}

/// Returns the stages of a recording that was cut off: `stages`, and those that have begun but changed nothing yet.
fn begun_stages(recording: &Recording, mut stages: Vec<Stage>) -> Vec<Stage> {
    let events = recording.tape().iter().filter(|event| event.depth() == 0);
    for begun in events.filter_map(begun_by) {
        // Its first iteration is a part of elimination, and so no stage.
        let is_part =
            recording.run().parameters.variant == Variant::AsPrinted && begun == Stage::Iterate(1);
        if !stages.contains(&begun) && !is_part {
            stages.push(begun);
        }
    }

    stages.sort();
    stages
}

/// Returns the first event of each of `stages` but the first.
fn stage_starts(recording: &Recording, stages: &[Stage]) -> Vec<usize> {
    let mut starts = Vec::with_capacity(stages.len());
    for (index, event) in recording.tape().from(0) {
        let begun = begun_by(event);
        if begun.is_some() && stages.get(starts.len() + 1).copied() == begun {
            starts.push(index);
        }
    }
    starts
}

/// Returns all pairs of tiled samples inside the domain that lie in each other's disks.
fn tiled_conflicts(run: &Run) -> Vec<[u32; 2]> {
    let is_tiled = |id: u32| run.standing(id, Stage::Tile) == Standing::Tiled;
    let points = &run.samples.points;
    let mut grid = SampleGrid::with_capacity(run.domain, points.len());

    let tiled = || (0..points.len() as u32).filter(|&id| is_tiled(id));
    for id in tiled() {
        grid.insert(id, points[id as usize]);
    }

    let mut conflicts = Vec::new();
    for id in tiled() {
        grid.any_near(points[id as usize], R, |near| {
            // Each pair is listed once, from the sample with the lower id.
            if near.id > id && covers_offset(near.offset) {
                conflicts.push([id, near.id]);
            }
            // The search goes on, as all conflicts are wanted.
            false
        });
    }
    conflicts
}
