//! A recorded run: the finished run, its tape, and when each sample was born, decided and lost, so that a sample's
//! status at any cursor takes two comparisons. A recording never changes.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use glam::I64Vec2;
use tilescope_core::stages::detect::Sites;
use tilescope_core::{
    Domain, Fate, Insertion, Locality, Observer, Parameters, Pattern, PatternHistory, Point, R,
    Run, RunEvent, SampleError, SampleGrid, Sequential, Shape, TilingMethod, Verdict,
    exact_recorded, sample_recorded, varying_recorded,
};

use crate::context::{Context, NeighbourSearch};
use crate::event::{Event, NONE};
use crate::heights::Heights;
use crate::index::{BySample, Classes, Direction};
use crate::kind::EventKind;
use crate::life::{Life, Status, UNBORN, note_change};
use crate::ranks::RecordedLevels;
use crate::tally::Density;
use crate::tape::Tape;

/// Events between two stored contexts. Chosen, not measured.
pub(crate) const STRIDE: usize = 1024;

/// A number of the moment that expressions can name, such as `gaps`. This crate measures nothing: the crate `live` gives a
/// recording its numbers, so that every evaluator of that recording has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberName {
    /// Its name in expressions.
    pub name: &'static str,
    /// Its meaning, for lists of the names.
    pub meaning: &'static str,
    /// Whether its values are whole.
    pub is_count: bool,
    /// Why no condition can name it; `None` if conditions can.
    pub not_in_conditions: Option<&'static str>,
}

/// How far a number of a moment is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NumberValue {
    /// It is measured, and this is its value.
    Known(f64),
    /// It is not defined there.
    Undefined,
    /// It takes more counted steps than there were; calls that follow go on.
    Pending,
}

/// Returns a number, by its name, after the events before a cursor, in about this many counted steps at most; an error
/// where it cannot be measured. Watches are evaluated in every frame, of which they take a part; conditions wait, at
/// every breakpoint.
pub type NumberAt = Box<dyn FnMut(&str, usize, u64) -> Result<NumberValue, String> + Send>;

/// Begins to follow the numbers of a recording.
pub type FollowRecording = dyn Fn(&Recording) -> NumberAt + Send + Sync;

/// Numbers that can be had at every moment of a recording.
pub struct MomentNumbers {
    /// Their names; none of them is in [`crate::NAMES`].
    pub names: Vec<NumberName>,
    /// Begins to follow a recording. Each evaluator does so when an expression first names a number, so that two of them at
    /// different cursors do not move each other's measures.
    pub follow: Box<FollowRecording>,
}

/// A dart of an exact tiling that is to arrive: it was woken, or thrown where nothing covered it.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct ExpectedDart {
    point: Point,
    /// The event that made it expected.
    announced: u32,
    /// The event of its arrival; `NONE` if it never arrives.
    arrival: u32,
}

/// A recorded run.
///
/// It can be serialised, with its indices, for web workers that share no memory. That is not a file format: only the
/// kinds of events are checked.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Recording {
    run: Run,
    tape: Tape,
    /// Whether it was cut off within a stage.
    pub(crate) is_cut_within_stage: bool,
    pub(crate) lives: Vec<Life>,
    contexts: Vec<Context>,
    grid: SampleGrid,
    /// Of a run in space, how high its samples lie.
    pub(crate) heights: Option<Heights>,
    /// The events that made each split, block and clip.
    pub(crate) splits: Vec<u32>,
    pub(crate) leaves: Vec<u32>,
    pub(crate) clips: Vec<u32>,
    /// The events that accepted candidates, each with the candidate's sites: by sites, and then by event. Several events
    /// may have the same sites.
    gaps: Vec<(Sites, u32)>,
    /// Of exact tiling, the darts that are to arrive, by place and then by event.
    expected: Vec<ExpectedDart>,
    /// The first events of phases and iterations.
    pub(crate) begins: Vec<u32>,
    /// The counts of all events before every 1024th.
    pub(crate) tallies: Vec<Density>,
    #[serde(with = "crate::computed")]
    classes: OnceLock<Classes>,
    #[serde(with = "crate::computed")]
    by_sample: OnceLock<BySample>,
    #[serde(skip)]
    numbers: OnceLock<Arc<MomentNumbers>>,
    /// Not sent to workers: those make sessions of levels, which have no recording.
    #[serde(skip)]
    pub(crate) levels: Option<RecordedLevels>,
}

impl Recording {
    /// Runs the sequential engine of the parameters' method and records it with about `budget` events at most.
    pub fn new(
        parameters: &Parameters,
        budget: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let mut tape = Tape::new(parameters, budget);
        let run = sample_recorded(parameters, observer, &mut tape)?;
        tape.seal();
        Ok(Self::of(run, tape))
    }

    /// Like [`Self::new`], with a given pattern.
    pub fn with_pattern(
        parameters: &Parameters,
        pattern: Arc<Pattern>,
        budget: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let mut tape = Tape::new(parameters, budget);
        let mut engine = Sequential::new(parameters, pattern)?;
        while engine.step_recorded(observer, &mut tape)?.is_some() {}
        tape.seal();
        Ok(Self::of(engine.finish(observer)?, tape))
    }

    /// Like [`Self::new`] by exact tiling, with a given pattern.
    pub fn with_history(
        parameters: &Parameters,
        history: &PatternHistory,
        budget: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let mut tape = Tape::new(parameters, budget);
        let whole = Shape::rectangle();
        let run = exact_recorded(parameters, history, &whole, observer, &mut tape)?;
        tape.seal();
        Ok(Self::of(run, tape))
    }

    /// Makes the set of a field of radii and a shape by darts, and records it with about `budget` events at most. Of
    /// the parameters only the seed matters to the set.
    pub fn with_locality(
        locality: &Arc<Locality>,
        parameters: &Parameters,
        budget: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        // The tape finds the lines of events by the parameters. Here their kind of insertion must say that darts are
        // thrown, and their method not that a shape is tiled.
        let parameters = &Parameters {
            method: TilingMethod::Kdrt,
            insertion: Insertion::Uniform,
            ..*parameters
        };
        let mut tape = Tape::new(parameters, budget);
        let run = varying_recorded(locality, parameters, observer, &mut tape)?;
        tape.seal();
        Ok(Self::of(run, tape))
    }

    /// Tiles a shape exactly, and records it with about `budget` events at most. The field of `locality` is one radius, that
    /// of the parameters: the result is as [`tilescope_core::exact_in_shape`] makes it.
    pub fn of_tiled_shape(
        locality: &Arc<Locality>,
        parameters: &Parameters,
        budget: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let history = PatternHistory::of_spec(&parameters.pattern, observer)?;
        let parameters = &parameters.as_exact();
        let mut tape = Tape::new(parameters, budget);
        let made = exact_recorded(parameters, &history, &locality.shape, observer, &mut tape)?;
        tape.seal();
        let run = Run {
            locality: Some(Arc::clone(locality)),
            ..made
        };
        Ok(Self::of(run, tape))
    }

    /// Returns the recording of a finished run and its sealed tape.
    #[must_use]
    pub fn of(run: Run, tape: Tape) -> Self {
        let mut grid = SampleGrid::with_capacity(run.domain, run.samples.len());
        // Dropped samples lie outside a bounded domain, where the grid has no cells. They are not in the set and cover nothing.
        for (id, (&point, &fate)) in (0..).zip(run.samples.points.iter().zip(&run.samples.fates)) {
            if fate != Fate::Dropped {
                grid.insert(id, point);
            }
        }

        let mut recording = Self {
            // All lists below are filled by `index`.
            lives: vec![UNBORN; run.samples.len()],
            // One before each stride, the last of which may be incomplete.
            contexts: Vec::with_capacity(tape.len() / STRIDE + 1),
            grid,
            heights: None,
            splits: Vec::new(),
            leaves: Vec::new(),
            clips: Vec::new(),
            gaps: Vec::new(),
            expected: Vec::new(),
            begins: Vec::new(),
            tallies: Vec::with_capacity(tape.len() / STRIDE + 1),
            classes: OnceLock::new(),
            by_sample: OnceLock::new(),
            numbers: OnceLock::new(),
            levels: None,
            run,
            tape,
            is_cut_within_stage: false,
        };

        recording.index();
        recording
    }

    /// Fills the lists that follow from the events, in one walk along the tape.
    fn index(&mut self) {
        let (mut context, mut tally) = (Context::default(), Density::default());
        // `note` changes the recording while its tape is read. The tape is therefore taken out meanwhile, and an
        // empty tape stands in for it.
        let tape = std::mem::replace(&mut self.tape, Tape::new(&self.run.parameters, 0));

        for (index, event) in (0..).zip(tape.iter()) {
            // The cursor of this number stands before the event, so that both are stored before the event is applied.
            if (index as usize).is_multiple_of(STRIDE) {
                self.contexts.push(context);
                self.tallies.push(tally);
            }

            context.apply(event, index);
            tally.add(event);
            // A notice that events were left out has no run event, and changes no list.
            if let Some(run_event) = event.run_event() {
                self.note(run_event, index);
            }
        }

        self.tape = tape;

        // `gap` finds the sites by a binary search, and then the last event before a cursor: the order is by both.
        self.gaps.sort_unstable();

        // The list is for `expected` and `waiting`, which are about exact tilings alone.
        if self.is_exact() {
            self.expect_darts();
        }
    }

    /// Fills the list of the darts that are to arrive.
    fn expect_darts(&mut self) {
        let mut arrived = Vec::new();
        for (index, event) in (0..).zip(self.tape.iter()) {
            // A dart becomes expected when it is woken, or thrown at an open place. It arrives with its event that has a rank.
            match event.run_event() {
                Some(
                    RunEvent::Wake { point, .. }
                    | RunEvent::Dart {
                        point,
                        ranked: false,
                        verdict: Verdict::Accepted,
                        ..
                    },
                ) => self.expected.push(ExpectedDart {
                    point,
                    announced: index,
                    arrival: NONE,
                }),
                Some(RunEvent::Dart {
                    point,
                    ranked: true,
                    ..
                }) => arrived.push((point, index)),
                // All other events neither announce a dart nor are its arrival.
                _ => {}
            }
        }

        // `expected_at` searches by place and then by event. Of several darts at one place, an arrival belongs to the one
        // that became expected last before it.
        self.expected
            .sort_unstable_by_key(|dart| (dart.point.row_major(), dart.announced));
        for (point, index) in arrived {
            if let Some(expected) = self.expected_at(point, index as usize) {
                self.expected[expected].arrival = index;
            }
        }
    }

    /// Returns the index of the last expected dart at a place, of those that an event before `end` made expected.
    fn expected_at(&self, point: Point, end: usize) -> Option<usize> {
        let key = (point.row_major(), end as u32);
        let is_before = |dart: &ExpectedDart| (dart.point.row_major(), dart.announced) < key;
        let last = self.expected.partition_point(is_before).checked_sub(1)?;
        (self.expected[last].point == point).then_some(last)
    }

    /// Adds an event to the lists that find events of its kind.
    fn note(&mut self, run_event: RunEvent, index: u32) {
        match run_event {
            RunEvent::Begin(_) | RunEvent::Iteration { .. } => self.begins.push(index),
            RunEvent::Split { .. } => self.splits.push(index),
            RunEvent::Leaf { .. } => self.leaves.push(index),
            RunEvent::Clip { .. } => self.clips.push(index),

            RunEvent::Candidate {
                sites,
                verdict: Verdict::Accepted,
                ..
            } => self.gaps.push((sites, index)),

            RunEvent::Mark { sample, .. } => self.lives[sample as usize].marked = index,
            // The other events change the status of a sample, or nothing that is listed.
            _ => note_change(&mut self.lives, run_event, index),
        }
    }

    /// Returns the finished run.
    #[must_use]
    pub const fn run(&self) -> &Run {
        &self.run
    }

    /// Returns whether it is an exact tiling.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.run.parameters.method == TilingMethod::Exact
    }

    /// Returns the last event before `end` of an exact tiling that said that a dart at this place is to arrive: that it was
    /// woken, or thrown at a place that nothing covered.
    pub(crate) fn expected(&self, point: Point, end: usize) -> Option<u32> {
        let dart = self.expected_at(point, end)?;
        Some(self.expected[dart].announced)
    }

    /// Returns the places of the darts of an exact tiling that have been woken or thrown before a cursor, and arrive later.
    pub fn waiting(&self, cursor: usize) -> impl Iterator<Item = Point> {
        let waits = move |dart: &&ExpectedDart| {
            (dart.announced as usize) < cursor && dart.arrival as usize >= cursor
        };
        self.expected.iter().filter(waits).map(|dart| dart.point)
    }

    /// Returns the darts that events of an exact tiling refuse, each with its first blocker.
    pub fn refused(&self, events: Range<usize>) -> impl Iterator<Item = (Point, u32)> {
        let within = self.tape.from(events.start).take(events.len());
        within.filter_map(|(_, event)| match event.run_event()? {
            RunEvent::Dart {
                point,
                verdict: Verdict::Covered { by },
                ..
            } => Some((point, by)),
            _ => None,
        })
    }

    /// Returns the events in the form in which they were recorded.
    #[must_use]
    pub const fn tape(&self) -> &Tape {
        &self.tape
    }

    /// Returns the number of events. A cursor may be before each of them or after the last.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.tape.len()
    }

    /// Returns whether there are no events.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.tape.is_empty()
    }

    /// Returns the event of an index, from 0; `None` beyond the last.
    #[must_use]
    pub fn event(&self, index: usize) -> Option<&Event> {
        self.tape.get(index)
    }

    /// Returns the domain of the run, on the lattice.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.run.domain
    }

    /// Returns the position of a sample, or `None` for an unknown id.
    #[must_use]
    pub fn point(&self, sample: u32) -> Option<Point> {
        self.run.samples.points.get(sample as usize).copied()
    }

    /// Returns the events that changed a sample.
    #[must_use]
    pub fn life(&self, sample: u32) -> Option<Life> {
        self.lives.get(sample as usize).copied()
    }

    /// Returns the status of a sample after the events before `cursor`.
    #[must_use]
    pub fn status(&self, sample: u32, cursor: usize) -> Status {
        self.life(sample)
            .map_or(Status::Absent, |life| self.status_of(&life, sample, cursor))
    }

    /// Returns the status of a sample, which has this life, after the events before `cursor`.
    pub(crate) fn status_of(&self, life: &Life, sample: u32, cursor: usize) -> Status {
        let before = |event: u32| (event as usize) < cursor;

        // A life has at most one event of each kind, so that comparisons with the cursor suffice. `NONE` is never
        // before it.
        if !before(life.born) {
            Status::Absent
        } else if before(life.lost) {
            match self.run.samples.fates[sample as usize] {
                Fate::Dropped => Status::Dropped,
                _ => Status::Eliminated,
            }
        } else if before(life.kept) {
            Status::Kept
        } else {
            Status::Undecided
        }
    }

    /// Returns the context after the events before `cursor`. Reads at most 1024 events.
    #[must_use]
    pub fn context(&self, cursor: usize) -> Context {
        // A tape of whole strides has no context stored at its end: that before its last stride serves.
        let key = (cursor.min(self.len()) / STRIDE).min(self.contexts.len().saturating_sub(1));

        // An empty tape has no context stored.
        let mut context = self.contexts.get(key).copied().unwrap_or_default();
        // From the last stored context on, fewer than a stride of events is applied.
        let count = cursor.saturating_sub(key * STRIDE);
        for (index, event) in self.tape.from(key * STRIDE).take(count) {
            context.apply(event, index as u32);
        }
        context
    }

    /// Returns the samples of a search, by id: those within its radius that were valid when it was made.
    #[must_use]
    pub fn test_buffer(&self, search: &NeighbourSearch) -> Vec<u32> {
        let Some(centre) = self.point(search.centre) else {
            return Vec::new();
        };
        self.valid_near(centre, search.radius, search.event as usize)
    }

    /// Returns the samples within `radius` units of a point that are valid at `cursor`, by id.
    #[must_use]
    pub fn valid_near(&self, point: Point, radius: i32, cursor: usize) -> Vec<u32> {
        let mut found = self.ever_near(point, radius);
        found.retain(|&id| self.status(id, cursor).is_valid());
        found
    }

    /// Returns all samples that ever were within `radius` units of a point, by id.
    #[must_use]
    pub fn ever_near(&self, point: Point, radius: i32) -> Vec<u32> {
        let limit = i64::from(radius) * i64::from(radius);
        let mut found = Vec::new();

        self.grid.any_near(point, radius, |near| {
            // The grid finds a square; the disk lies in it.
            if near.offset.as_i64vec2().length_squared() <= limit {
                found.push(near.id);
            }
            false
        });
        found.sort_unstable();
        found
    }

    /// Returns all samples that ever covered a place, by id: those within r, or near it where the radius depends on the place.
    #[must_use]
    pub fn ever_covering(&self, place: Point) -> Vec<u32> {
        let Some(locality) = &self.run.locality else {
            return self.ever_near(place, R);
        };

        // Samples within `sight`, twice the place's radius, may be near it; whether one is depends on both radii.
        let mut found = self.ever_near(place, locality.sight(place));
        let points = &self.run.samples.points;
        found.retain(|&id| locality.is_near(points[id as usize], place));
        found
    }

    /// Returns the first of the samples that cover a place after the events before a cursor.
    #[must_use]
    pub fn covering(&self, place: Point, cursor: usize) -> Option<u32> {
        // Ids of inserted samples follow their arrival, and the list is by id.
        let mut found = self.ever_covering(place).into_iter();
        found.find(|&id| self.status(id, cursor).is_valid())
    }

    /// Returns the point that an event examines or changes. `None` if it has none, or a candidate's would lie outside a bounded
    /// domain; a dart keeps its place there.
    #[must_use]
    pub fn event_point(&self, event: &Event) -> Option<Point> {
        match event.run_event()? {
            RunEvent::Candidate {
                detector, offset, ..
            } => {
                // The offset of a centre may lead across a periodic border, or out of a closed one, where there is no point.
                let at = I64Vec2::from(self.point(detector)?);
                self.domain().wrap(at + offset.as_i64vec2())
            }
            RunEvent::Pass { point, .. }
            | RunEvent::Wake { point, .. }
            | RunEvent::Dart { point, .. } => Some(point),
            // A cell is named by its lowest point.
            RunEvent::Cut { cell, .. } => Some(cell),
            // Other events are where the first sample is that they name, if they name one.
            _ => self.point(event.samples()[0]),
        }
    }

    /// Returns the last event before `end` that accepted the candidate made by `sites`. Takes time logarithmic in the
    /// number of candidates.
    #[must_use]
    pub fn gap(&self, sites: Sites, end: usize) -> Option<usize> {
        let first = self.gaps.partition_point(|(other, _)| *other < sites);
        let same = self.gaps[first..]
            .iter()
            .take_while(|(other, _)| *other == sites);

        let before = same
            .map(|&(_, event)| event as usize)
            .filter(|&event| event < end);
        before.last()
    }

    /// Returns whether an event accepts a point as lying in a gap.
    #[must_use]
    pub fn is_gap(event: &Event) -> bool {
        match event.run_event() {
            Some(RunEvent::Candidate { verdict, .. }) => verdict == Verdict::Accepted,
            Some(RunEvent::Dart {
                ranked, verdict, ..
            }) => ranked && verdict == Verdict::Accepted,
            _ => false,
        }
    }

    /// Returns the last event before `end` of the given kind.
    pub(crate) fn last_of(&self, kind: EventKind, end: usize) -> Option<usize> {
        self.classes()
            .nearest(end, Direction::Backwards, |event| event.kind() == kind)
    }

    /// Lets expressions over this recording name numbers of the moment. Evaluators that are made before have none; numbers that
    /// were given before stay.
    pub fn give_numbers(&self, numbers: impl FnOnce() -> Arc<MomentNumbers>) {
        self.numbers.get_or_init(numbers);
    }

    /// Returns the numbers of the moment that expressions can name, if it was given any.
    #[must_use]
    pub fn numbers(&self) -> Option<&MomentNumbers> {
        self.numbers.get().map(AsRef::as_ref)
    }

    /// Makes the indices of events by sample, line and kind now, instead of at the first search. Takes some hundred
    /// milliseconds for five million events.
    pub fn prepare(&self) {
        let _ = (self.classes(), self.by_sample());
    }

    /// Returns the events that name a sample, in sequence.
    #[must_use]
    pub fn events_of(&self, sample: u32) -> &[u32] {
        self.by_sample().of(sample)
    }

    pub(crate) fn classes(&self) -> &Classes {
        self.classes.get_or_init(|| Classes::new(&self.tape))
    }

    fn by_sample(&self) -> &BySample {
        let count = self.lives.len();
        self.by_sample
            .get_or_init(|| BySample::new(&self.tape, count))
    }
}
