//! A finished run made ready to be looked at: its stages, an index of its samples by place, the
//! conflicts that elimination resolved. Immutable once built; it is built in the background.

mod report;

use std::sync::{Arc, OnceLock};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use tilescope_core::{
    Fate, Insertion, Iteration, MAXIMAL_DENSITY, Origin, Parameters, R, Run, RunEvent, SampleError,
    SampleGrid, Stage, Standing, Summary, Sweep, Variant, covers_offset,
};
use tilescope_debugger::{Outline, Recording};
use tilescope_gpu::GpuError;

use crate::combination::Combination;
use crate::index::SampleIndex;
use crate::jobs::Monitor;
use crate::limits::MAX_STAGED;
use crate::recipe::{OwnPattern, Recipe};
use crate::units;
pub use report::MakeError;
pub use report::Reporter;

/// Returns whether a run is small enough to keep every stage of it; Algorithm 4 as printed always does.
pub fn keeps_everything(parameters: &Parameters) -> Result<bool, SampleError> {
    let expected = parameters.validate()?.area_radii() * MAXIMAL_DENSITY;
    Ok(expected <= MAX_STAGED || parameters.variant == Variant::AsPrinted)
}

/// A run and what the window needs to show it.
#[derive(Serialize, Deserialize)]
pub struct Session {
    source: RunSource,
    /// Its stages, in their sequence.
    pub stages: Vec<Stage>,
    /// The event that begins each stage but the first, where there are events.
    starts: Vec<usize>,
    /// The iteration that found nothing, which ends a run with events. The run does not keep it.
    last: Option<Iteration>,
    /// Its counts.
    pub summary: Summary,
    /// All samples by place.
    pub index: SampleIndex,
    /// Pairs of tiled samples that cover one another: the conflicts before elimination.
    pub conflicts: Vec<[u32; 2]>,
    /// The tree of its events, where they were kept.
    pub outline: Option<Outline>,
    /// Changes with every session, so that pictures made from an old one are not reused.
    pub generation: u64,
    /// Who made it: "CPU", or "GPU" with the adapter's name.
    pub engine: String,
    /// The pattern of one's own that it was made with.
    pub own: Option<OwnPattern>,
    /// What it was glued from, if it is a combination: its blocks are the pieces.
    pub combination: Option<Combination>,
    /// What befell the GPU that was to make it, until somebody has been told.
    #[serde(skip)]
    pub failure: Option<Failure>,
    #[serde(skip)]
    digest: OnceLock<String>,
    #[serde(skip)]
    positions_digest: OnceLock<String>,
}

/// Where a session's run is kept.
#[derive(Serialize, Deserialize)]
enum RunSource {
    /// With every event of it.
    Recorded(Arc<Recording>),
    /// The run alone.
    Run(Box<Run>),
}

/// A device that failed, so that the CPU had to make a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The adapter's name.
    pub name: String,
    /// What befell it.
    pub error: GpuError,
}

impl Session {
    /// Samples by `recipe` on the CPU and prepares the result.
    ///
    /// Fails as the engines of the core, and when the monitor's owner cancels.
    pub fn sample(
        recipe: &Recipe,
        generation: u64,
        monitor: &Monitor,
    ) -> Result<Self, SampleError> {
        let parameters = &recipe.parameters;
        parameters.validate_sequential()?;
        let mut observer = Reporter { monitor };
        if keeps_everything(parameters)? {
            let recording = recipe.record(&mut observer)?;
            let made = observer.prepare(|| Self::from_recording(Arc::new(recording), generation));
            return made.map(|session| session.with(recipe));
        }
        let pattern = recipe.pattern(&mut observer)?;
        let run = Sweep::run(parameters, &pattern, &mut observer)?;
        let made = observer.prepare(|| Self::from_run(run, generation));
        made.map(|session| session.with(recipe))
    }

    /// Returns the session with the pattern of one's own that it was made with.
    #[must_use]
    pub fn with(self, recipe: &Recipe) -> Self {
        Self {
            own: recipe.own.clone(),
            ..self
        }
    }

    /// Returns what it was made from.
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        Recipe {
            parameters: self.run().parameters,
            own: self.own.clone(),
        }
    }

    /// Prepares a run of the GPU. Where all its stages are kept, the CPU makes the same run with its events; what the
    /// GPU made is shown as it is, without events, if the two differ.
    pub fn of_gpu(
        run: Run,
        recipe: &Recipe,
        generation: u64,
        observer: &mut Reporter<'_>,
    ) -> Result<Self, SampleError> {
        if run.counted.is_none() {
            let recording = recipe.record(observer)?;
            let twin = recording.run();
            if twin.samples == run.samples && twin.result == run.result {
                let made =
                    observer.prepare(|| Self::from_recording(Arc::new(recording), generation));
                return made.map(|session| session.with(recipe));
            }
        }
        let made = observer.prepare(|| Self::from_run(run, generation));
        made.map(|session| session.with(recipe))
    }

    /// Returns the run.
    #[must_use]
    pub fn run(&self) -> &Run {
        match &self.source {
            RunSource::Recorded(recording) => recording.run(),
            RunSource::Run(run) => run,
        }
    }

    /// Returns the digest of the result's positions in user units, as certificates have it: computed once, when it is
    /// first asked for.
    #[must_use]
    pub fn positions_digest(&self) -> &str {
        let digest = || tilescope_formats::positions_digest(&self.run().positions());
        self.positions_digest.get_or_init(digest)
    }

    /// Returns the digest of the result, 16 hexadecimal digits: computed once, when it is first asked for.
    #[must_use]
    pub fn digest(&self) -> &str {
        self.digest
            .get_or_init(|| tilescope_debugger::digest(self.run()))
    }

    /// Returns the events of the run, where they were kept.
    #[must_use]
    pub const fn recording(&self) -> Option<&Arc<Recording>> {
        match &self.source {
            RunSource::Recorded(recording) => Some(recording),
            RunSource::Run(_) => None,
        }
    }

    /// Returns the place of a stage in the list, else of the last one before it.
    #[must_use]
    pub fn place_of(&self, stage: Stage) -> usize {
        let place = self.stages.iter().rposition(|&other| other <= stage);
        place.unwrap_or(0)
    }

    /// Returns the stage, as its place in the list, that is current when `cursor` events have happened.
    #[must_use]
    pub fn stage_at(&self, cursor: usize) -> usize {
        self.starts.partition_point(|&start| start < cursor)
    }

    /// Returns the cursor behind the last event of the stage at `place`, where there are events.
    #[must_use]
    pub fn stage_end(&self, place: usize) -> Option<usize> {
        let recording = self.recording()?;
        let next = self.starts.get(place).copied();
        Some(next.unwrap_or_else(|| recording.len()))
    }

    /// Returns whether every sample's fate was kept, so that every stage can be visited.
    #[must_use]
    pub fn has_stages(&self) -> bool {
        self.run().counted.is_none()
    }

    /// Prepares a finished run of the CPU, without events.
    #[must_use]
    pub fn from_run(run: Run, generation: u64) -> Self {
        Self::of(RunSource::Run(Box::new(run)), generation)
    }

    /// Prepares a recorded run.
    #[must_use]
    pub fn from_recording(recording: Arc<Recording>, generation: u64) -> Self {
        Self::of(RunSource::Recorded(recording), generation)
    }

    /// Prepares a combination. It clips from no common pattern, so that its first stage is that of its pieces.
    #[must_use]
    pub fn from_combination(run: Run, combination: Combination, generation: u64) -> Self {
        let mut session = Self::from_run(run, generation);
        session.stages.retain(|&stage| stage != Stage::Pattern);
        session.combination = Some(combination);
        session
    }

    fn of(source: RunSource, generation: u64) -> Self {
        let run = match &source {
            RunSource::Recorded(recording) => recording.run(),
            RunSource::Run(run) => run,
        };
        let (mut stages, mut starts, mut last, mut outline) =
            (run.stages(), Vec::new(), None, None);
        if let RunSource::Recorded(recording) = &source {
            // Now, in the background, rather than with the first search.
            recording.prepare();
            last = last_iteration(recording);
            if last.is_some() {
                let number = run.iterations.len() as u32 + 1;
                let behind = stages.partition_point(|&stage| stage < Stage::Iterate(number));
                stages.insert(behind, Stage::Iterate(number));
            }
            starts = stage_starts(recording, &stages);
            outline = Some(Outline::new(recording));
        }
        let conflicts = match run.counted {
            Some(_) => Vec::new(),
            None => tiled_conflicts(run),
        };
        Self {
            stages,
            summary: run.summary(),
            index: SampleIndex::new(&run.domain, &run.samples.points),
            conflicts,
            starts,
            last,
            outline,
            generation,
            engine: "CPU".to_owned(),
            own: None,
            combination: None,
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

    /// Returns where sample `id` lies, in r.
    #[must_use]
    pub fn place(&self, id: u32) -> DVec2 {
        units::place(self.run().samples.points[id as usize])
    }

    /// Returns where the nearest image of sample `id` to `place` lies, in r.
    #[must_use]
    pub fn image_near(&self, id: u32, place: DVec2) -> DVec2 {
        let there = self.place(id);
        if !self.run().domain.is_periodic() {
            return there;
        }
        let size = self.size_radii();
        there - ((there - place) / size).round() * size
    }

    /// Returns iteration `k`, from 1; the one that found nothing, too, where there are events.
    #[must_use]
    pub fn iteration(&self, k: u32) -> Option<&Iteration> {
        let place = (k as usize).checked_sub(1)?;
        let kept = &self.run().iterations;
        let last = || self.last.as_ref().filter(|_| place == kept.len());
        kept.get(place).or_else(last)
    }

    /// Returns how many samples are valid (or, before elimination, tiled) after the stage at `place`.
    #[must_use]
    pub fn count_after(&self, place: usize) -> usize {
        let summary = &self.summary;
        match self.stages[place] {
            Stage::Pattern => self.run().pattern.samples().len(),
            Stage::Blocks => 0,
            Stage::Tile => summary.tiled,
            Stage::Eliminate => summary.tiled - summary.eliminated + self.inserted_at_once(),
            Stage::Iterate(k) => {
                let inserted: usize = summary.inserted.iter().take(k as usize).sum();
                summary.tiled - summary.eliminated + inserted
            }
            Stage::Regions | Stage::Finish => summary.count,
        }
    }

    /// Returns how many samples elimination itself inserts: Algorithm 4 as printed fills gaps at once.
    #[must_use]
    pub fn inserted_at_once(&self) -> usize {
        match self.run().parameters.variant {
            Variant::AsPrinted => self.summary.inserted.first().copied().unwrap_or(0),
            Variant::Staged => 0,
        }
    }
}

/// Returns the iteration behind those that the run keeps, if the recording has one: it found nothing.
fn last_iteration(recording: &Recording) -> Option<Iteration> {
    let run = recording.run();
    let number = run.iterations.len() as u32 + 1;
    let begins = |event: &tilescope_debugger::Event| matches!(event.run_event(), Some(RunEvent::Iteration { number: other, .. }) if other == number);
    recording
        .tape()
        .before(recording.len())
        .find(|(_, event)| begins(event))?;
    let all = 0..run.samples.len() as u32;
    let stays = |id: &u32| run.samples.fates[*id as usize] == Fate::Kept;
    let is_marked = |id: &u32| {
        recording
            .life(*id)
            .is_some_and(|life| life.marked != tilescope_debugger::NONE)
    };
    let detectors = match (run.parameters.insertion, run.parameters.variant) {
        (Insertion::Uniform, Variant::Staged) => Vec::new(),
        // Samples that were inserted in the iteration before look for what is left.
        (_, Variant::Staged) => match run.iterations.last() {
            Some(before) => before.inserted.clone().collect(),
            None => all.clone().filter(stays).filter(is_marked).collect(),
        },
        // Marks are never taken back.
        (_, Variant::AsPrinted) => {
            let inserted =
                |id: &u32| matches!(run.samples.origins[*id as usize], Origin::Inserted { .. });
            let looks = |id: &u32| inserted(id) || stays(id) && is_marked(id);
            all.clone().filter(looks).collect()
        }
    };
    Some(Iteration {
        detectors,
        inserted: all.end..all.end,
        ..Iteration::default()
    })
}

/// Returns the event that begins each of `stages` but the first.
fn stage_starts(recording: &Recording, stages: &[Stage]) -> Vec<usize> {
    let mut starts = Vec::with_capacity(stages.len());
    for (index, event) in recording.tape().from(0) {
        let begun = match event.run_event() {
            Some(RunEvent::Begin(stage)) => stage,
            Some(RunEvent::Iteration { number, .. }) => Stage::Iterate(number),
            _ => continue,
        };
        if stages.get(starts.len() + 1) == Some(&begun) {
            starts.push(index);
        }
    }
    starts
}

/// Returns every pair of tiled samples inside the domain that cover one another.
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
            if near.id > id && covers_offset(near.offset.0, near.offset.1) {
                conflicts.push([id, near.id]);
            }
            false
        });
    }
    conflicts
}
