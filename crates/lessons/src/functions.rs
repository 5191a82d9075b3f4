//! The functions that expressions of lessons may call, besides the names and functions of the debugger. Lengths and
//! positions are in r; events are numbered from 1. Begin with [`register`]; `names.rs` says what each function gives.

mod local;
mod space;

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec2;
use rhai::{Dynamic, Engine, EvalAltResult, Map};
use tilescope_analysis::Tessellation;
use tilescope_core::stages::blocks::Axis;
use tilescope_core::stages::order::Ranking;
use tilescope_core::{
    Fate, Key as DrawKey, Origin, Parameter, Point, R, RunEvent, Sweep, Unobserved, sample,
};
use tilescope_debugger::{
    DEFAULT_BUDGET, Divergence, Event, EventKind, NONE, Query, Recording, Status, first_divergence,
    query,
};

use crate::error::LessonError;
use crate::fields::Field;
use crate::parameters::{MAX_SAMPLES, set_parameter};
use crate::sets::{self, PointSet, position, radii};

/// How many searches of the events, or computations that take as long, the expressions of one question may make: a question
/// is asked while a learner waits.
const MAX_WORK: i64 = 1_000;
/// The cost of a computation over the whole set, in searches. The costs and the limit were chosen, not measured.
const SET: i64 = 4;
/// The cost of another run, in searches.
const RUN: i64 = 80;

type Found<T> = Result<T, Box<EvalAltResult>>;

/// The run and the moment that expressions are about, and the results computed so far.
pub(crate) struct Now {
    pub recording: Arc<Recording>,
    pub cursor: AtomicUsize,
    /// Where the plane lies through a set in space, in lattice units; `None` for a plane that follows the events.
    plane: Mutex<Option<i32>>,
    left: AtomicI64,
    found: Mutex<HashMap<String, Arc<Vec<usize>>>>,
    sets: Mutex<HashMap<usize, Arc<PointSet>>>,
    runs: Mutex<HashMap<String, Arc<PointSet>>>,
    gaps: Mutex<HashMap<usize, Arc<Tessellation>>>,
    unsure: Mutex<HashMap<usize, Option<u32>>>,
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[allow(clippy::unnecessary_box_returns)] // rhai's functions return boxed errors.
fn wrong(message: impl Into<String>) -> Box<EvalAltResult> {
    message.into().into()
}

/// Returns the value of a key, computed by `make` the first time.
fn cached<K: Eq + Hash, V: Clone>(
    known: &Mutex<HashMap<K, V>>,
    key: K,
    make: impl FnOnce() -> Found<V>,
) -> Found<V> {
    if let Some(value) = lock(known).get(&key) {
        return Ok(value.clone());
    }
    let value = make()?;
    lock(known).insert(key, value.clone());
    Ok(value)
}

fn id(s: i64) -> u32 {
    u32::try_from(s).unwrap_or(NONE)
}

/// Returns a place as a value of expressions, [x, y].
pub(crate) fn place([x, y]: [f64; 2]) -> Dynamic {
    vec![Dynamic::from(x), Dynamic::from(y)].into()
}

impl Now {
    pub fn new(recording: Arc<Recording>, cursor: usize) -> Self {
        Self {
            recording,
            cursor: AtomicUsize::new(cursor),
            plane: Mutex::default(),
            left: AtomicI64::new(MAX_WORK),
            found: Mutex::default(),
            sets: Mutex::default(),
            runs: Mutex::default(),
            gaps: Mutex::default(),
            unsure: Mutex::default(),
        }
    }

    pub fn cursor(&self) -> usize {
        self.cursor.load(Ordering::Relaxed)
    }

    /// Allows as many searches and computations as for a new question.
    pub fn renew_budget(&self) {
        self.left.store(MAX_WORK, Ordering::Relaxed);
    }

    fn spend(&self, work: i64) -> Found<()> {
        if self.left.fetch_sub(work, Ordering::Relaxed) < work {
            return Err(wrong("the expressions of this question search too much"));
        }
        Ok(())
    }

    fn status(&self, s: i64) -> Status {
        self.recording.status(id(s), self.cursor())
    }

    /// Returns the events that match a query.
    pub fn events(&self, text: &str) -> Found<Arc<Vec<usize>>> {
        cached(&self.found, text.to_owned(), || {
            self.spend(1)?;
            let query = Query::parse(text).map_err(|error| wrong(error.to_string()))?;
            Ok(Arc::new(query.find_all(&self.recording, usize::MAX)))
        })
    }

    /// Returns the first event of a query that is still to come, or the last one that has happened.
    fn nearest(&self, text: &str, is_next: bool) -> Found<Dynamic> {
        let (events, cursor) = (self.events(text)?, self.cursor());
        // Events are found in the order of the recording.
        let at = events.partition_point(|&event| event < cursor);
        let index = if is_next { Some(at) } else { at.checked_sub(1) };

        let event = index.and_then(|index| events.get(index));
        Ok(maybe(event.map(|&event| self.map(event))))
    }

    /// Returns an event as a map of its properties; `()` if the run has no event of this index.
    fn map(&self, index: usize) -> Dynamic {
        let mut map = Map::new();
        let mut put = |name: &str, value: Dynamic| {
            map.insert(name.into(), value);
        };

        let Some(event) = self.recording.event(index) else {
            return Dynamic::UNIT;
        };

        // Lessons count events from 1.
        put("event", (index as i64 + 1).into());
        put("kind", event.kind().name().into());

        // An event has several places for samples, with `NONE` in those that it does not use. Lessons have the first two.
        let named: Vec<u32> = event
            .samples()
            .into_iter()
            .filter(|&sample| sample != NONE)
            .collect();
        for (name, sample) in ["a", "b"].into_iter().zip(&named) {
            put(name, i64::from(*sample).into());
        }

        if let (Some(&a), Some(&b)) = (named.first(), named.get(1)) {
            put("distance", self.distance(a, b).into());
        }

        if let Some(verdict) = query::verdict_name(event) {
            put("verdict", verdict.into());
        }
        if let Some(block) = query::block(&self.recording, event) {
            put("block", i64::from(block).into());
        }
        if let Some(point) = self.recording.event_point(event) {
            put("x", radii(point.x).into());
            put("y", radii(point.y).into());
        }
        if let Some(z) = self.recording.event_height(event) {
            put("z", radii(z).into());
        }

        self.details(event, &mut put);
        map.into()
    }

    /// Puts the properties that only some kinds of events have: of nodes and blocks, of searches, of iterations, of candidates.
    fn details(&self, event: &Event, put: &mut impl FnMut(&str, Dynamic)) {
        let blocks = &self.recording.run().blocks;

        let rect = match event.run_event() {
            Some(RunEvent::Split { index, turned }) => {
                put("turned", turned.into());
                blocks.splits.get(index as usize).map(|split| {
                    put("axis", if split.axis == Axis::X { "x" } else { "y" }.into());
                    put("plane", radii(split.plane).into());
                    split.rect
                })
            }
            Some(RunEvent::Leaf { block } | RunEvent::Clip { block }) => {
                blocks.leaves.get(block as usize).map(|leaf| leaf.rect)
            }
            Some(RunEvent::Search { found, .. }) => {
                put("found", i64::from(found).into());
                None
            }
            Some(
                RunEvent::Iteration {
                    detectors: count, ..
                }
                | RunEvent::IterationEnd {
                    inserted: count, ..
                }
                | RunEvent::Rank { candidates: count },
            ) => {
                put("count", i64::from(count).into());
                None
            }
            Some(RunEvent::Candidate { sites, .. }) => {
                let ids = sites.ids().iter().map(|&id| i64::from(id).into());
                put("sites", ids.collect::<rhai::Array>().into());
                None
            }
            // Events of all other kinds have only the properties that `map` gives to every event.
            _ => None,
        };

        if let Some(rect) = rect {
            for (name, value) in [
                ("x0", rect.min.x),
                ("y0", rect.min.y),
                ("x1", rect.max.x),
                ("y1", rect.max.y),
            ] {
                put(name, radii(value).into());
            }
        }
    }

    /// Returns the distance of two samples, in r; of a set in space, with their heights.
    fn distance(&self, a: u32, b: u32) -> f64 {
        query::distance(&self.recording, a, b).unwrap_or(f64::NAN)
    }

    /// Returns the valid samples.
    pub fn set(&self) -> Found<Arc<PointSet>> {
        let cursor = self.cursor();
        cached(&self.sets, cursor, || {
            self.spend(SET)?;
            Ok(Arc::new(PointSet::at(&self.recording, cursor)))
        })
    }

    /// Refuses to compare nested levels and sets in space with another run. The other run would have stages, and be another
    /// set than the one that is shown, whatever its parameters.
    fn refuse_comparison(&self) -> Found<()> {
        let what = match self.recording.levels() {
            Some(_) => "nested levels",
            None if self.recording.is_in_space() => "a set in space",
            None => return Ok(()),
        };
        Err(wrong(format!(
            "{what} cannot be compared with another run here"
        )))
    }

    /// Returns the result of the run with other parameters, such as `leaf=10 seed=3`.
    fn set_with(&self, changes: &str) -> Found<Arc<PointSet>> {
        self.refuse_comparison()?;
        cached(&self.runs, changes.to_owned(), || {
            self.spend(RUN)?;
            let run = sample(&self.changed(changes)?, &mut Unobserved)
                .map_err(|error| wrong(error.to_string()))?;
            Ok(Arc::new(PointSet::of_run(&run)))
        })
    }

    /// Returns the parameters of the run with changes, such as `leaf=10 seed=3`.
    fn changed(&self, changes: &str) -> Found<tilescope_core::Parameters> {
        let mut parameters = self.recording.run().parameters;
        for change in changes.split_whitespace() {
            let (key, value) = change
                .split_once('=')
                .ok_or_else(|| wrong(format!("\"{change}\" is not of the form leaf=10")))?;

            // Of a fault only the message is used, so that the line does not matter.
            let field = Field {
                key: key.to_owned(),
                value: value.to_owned(),
                line: 0,
            };

            // A misspelt name would change nothing, and the run would be compared with itself.
            let Some(parameter) = Parameter::all().find(|it| it.key() == key) else {
                let keys: Vec<&str> = Parameter::all().map(Parameter::key).collect();
                return Err(wrong(
                    LessonError::unknown(0, "parameter", key, &keys).message,
                ));
            };

            set_parameter(&mut parameters, parameter, &field)
                .map_err(|error| wrong(error.message))?;
        }

        let domain = parameters
            .validate()
            .map_err(|error| wrong(error.to_string()))?;
        // The product is about the number of samples of a maximal set. The run is made while the learner waits, so that
        // it has to be small.
        if domain.area_radii() * tilescope_core::MAXIMAL_DENSITY > MAX_SAMPLES {
            return Err(wrong(format!(
                "a run with {changes} has too many samples for a lesson"
            )));
        }

        Ok(parameters)
    }

    /// Returns the gaps of the valid samples.
    pub fn tessellation(&self) -> Found<Arc<Tessellation>> {
        if self.recording.is_in_space() {
            return Err(wrong(
                "gaps are found in planar sets: of a set in space ask open_places() or clear_above(x, y)",
            ));
        }
        cached(&self.gaps, self.cursor(), || {
            let set = self.set()?;
            self.spend(SET)?;
            let made = Tessellation::of(&set.points, set.region, 1.0);
            Ok(Arc::new(made.map_err(|error| wrong(error.to_string()))?))
        })
    }

    fn deepest_near(&self, x: f64, y: f64) -> Found<Dynamic> {
        let (set, found) = (self.set()?, self.tessellation()?);
        let distance = |at: [f64; 2]| set.distance([x, y], at);

        let deepest = found.gaps.iter().map(|gap| gap.deepest.0.into());
        let nearest = deepest.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        Ok(maybe(nearest.map(place)))
    }

    fn deepest(&self) -> Found<Dynamic> {
        let found = self.tessellation()?;
        let deepest = found.gaps.iter().map(|gap| gap.deepest);
        let largest = deepest.max_by(|a, b| a.1.total_cmp(&b.1));
        Ok(maybe(largest.map(|(at, _)| place(at.into()))))
    }

    /// Returns by how much the largest gap is deeper than every other one, in r; 1 if there is no other, 0 if there is none.
    fn clear_deepest(&self) -> Found<f64> {
        let found = self.tessellation()?;
        let mut depths: Vec<f64> = found.gaps.iter().map(|gap| gap.deepest.1).collect();
        depths.sort_by(|a, b| b.total_cmp(a));
        Ok(match depths[..] {
            [] => 0.0,
            [_] => 1.0,
            [first, second, ..] => first - second,
        })
    }

    /// Returns the deepest place of the largest gap that is at least a distance away from the border of the domain.
    fn deepest_inside(&self, distance: f64) -> Found<Dynamic> {
        let found = self.tessellation()?;
        let deepest = found.gaps.iter().map(|gap| gap.deepest);
        let inside = deepest.filter(|(at, _)| self.border((*at).into()) >= distance);
        let largest = inside.max_by(|a, b| a.1.total_cmp(&b.1));
        Ok(maybe(largest.map(|(at, _)| place(at.into()))))
    }

    /// Returns the largest distance from the edges of their blocks of samples of the run that a condition names; 0 of none.
    fn reach_of(&self, is_meant: impl Fn(i64) -> bool) -> Found<f64> {
        self.spend(SET)?;
        let all = 0..self.recording.run().samples.points.len() as i64;
        let reaches = all.filter(|&s| is_meant(s)).map(|s| self.seam_of(s));
        Ok(reaches.fold(0.0, f64::max))
    }

    /// Returns the largest distance of a gap detector of elimination from the lost sample nearest to it; 0 without any.
    fn reach_of_detectors(&self) -> Found<f64> {
        self.spend(SET)?;
        let all = 0..self.recording.run().samples.points.len() as i64;
        let (lost, others): (Vec<i64>, Vec<i64>) = all.partition(|&s| self.is_lost(s));

        let detectors = others.into_iter().filter(|&s| self.is_marked(s));
        let reaches = detectors.map(|s| {
            let to_lost = lost.iter().map(|&other| self.distance(id(s), id(other)));
            to_lost.fold(f64::INFINITY, f64::min)
        });
        Ok(reaches.fold(0.0, f64::max))
    }

    fn is_lost(&self, s: i64) -> bool {
        matches!(self.fate(s), Some(Fate::Eliminated { .. }))
    }

    pub(crate) fn is_inserted(&self, s: i64) -> bool {
        matches!(self.origin(s), Some(Origin::Inserted { .. }))
    }

    fn is_marked(&self, s: i64) -> bool {
        let life = self.recording.life(id(s));
        life.is_some_and(|life| life.marked != NONE)
    }

    /// Returns how far a place is from the border of the domain, negative outside.
    fn border(&self, [x, y]: [f64; 2]) -> f64 {
        let domain = self.recording.domain();
        let [width, height] = [domain.width(), domain.height()].map(radii);
        x.min(width - x).min(y).min(height - y)
    }

    /// Returns how many samples of the result there are per r^2, at places nearer to an edge of a block than `distance` if
    /// `is_near`, otherwise at places farther away.
    fn density(&self, distance: f64, is_near: bool) -> Found<f64> {
        // A look at all samples counts in the budget of the question.
        self.spend(SET)?;
        let run = self.recording.run();
        let leaves = &run.blocks.leaves;

        // The nearest edge to a place is one of its own block. Places near an edge therefore are the frames of the blocks, and
        // the others are the rectangles inside the frames.
        let is_counted = |at: &Point| {
            let own = leaves.iter().find(|leaf| leaf.rect.contains(*at));
            own.is_some_and(|leaf| (radii(leaf.rect.depth(*at)) < distance) == is_near)
        };
        let count = run.points().iter().filter(|at| is_counted(at)).count() as f64;

        // A block narrower than two distances has no inside.
        let areas = leaves.iter().map(|leaf| {
            let [width, height] = [leaf.rect.width(), leaf.rect.height()].map(radii);
            let inside = (width - 2.0 * distance).max(0.0) * (height - 2.0 * distance).max(0.0);
            if is_near {
                width * height - inside
            } else {
                inside
            }
        });

        let area: f64 = areas.sum();
        if area > 0.0 {
            return Ok(count / area);
        }

        let side = if is_near { "nearer to" } else { "farther from" };
        Err(wrong(format!(
            "no place is {side} an edge of a block than {distance} r"
        )))
    }

    /// Returns the valid samples closer than r to a sample, by number.
    fn conflicts_with(&self, s: i64) -> Vec<u32> {
        let Some(point) = self.recording.point(id(s)) else {
            return Vec::new();
        };

        let near = self.recording.valid_near(point, R, self.cursor());
        let mut others: Vec<u32> = near.into_iter().filter(|&other| other != id(s)).collect();
        // `valid_near` includes samples at a distance of exactly r, which are no conflicts.
        others.retain(|&other| self.distance(id(s), other) < 1.0);

        others.sort_unstable();
        others
    }

    fn conflict(&self, s: i64, k: i64) -> Dynamic {
        let index = usize::try_from(k).unwrap_or(usize::MAX);
        sample_or_unit(self.conflicts_with(s).get(index).copied())
    }

    fn fate(&self, s: i64) -> Option<Fate> {
        let fates = &self.recording.run().samples.fates;
        fates.get(id(s) as usize).copied()
    }

    fn lost_to(&self, s: i64) -> Option<u32> {
        match self.fate(s)? {
            Fate::Eliminated { by } => Some(by),
            _ => None,
        }
    }

    fn origin(&self, s: i64) -> Option<&Origin> {
        self.recording.run().samples.origins.get(id(s) as usize)
    }

    fn conflicts(&self) -> Found<i64> {
        let set = self.set()?;
        let ids = set.ids.iter();
        // Each pair is counted from both of its ends.
        let both: usize = ids.map(|&s| self.conflicts_with(s.into()).len()).sum();
        Ok(both as i64 / 2)
    }

    /// Returns the rank of a sample of nested levels, or `()`.
    fn rank(&self, s: i64) -> Dynamic {
        let levels = self.recording.levels();
        let rank = levels.and_then(|levels| levels.ranks.get(id(s) as usize));
        maybe(rank.map(|&rank| rank.into()))
    }

    /// Returns the valid sample nearest to a place, of those of nested levels with ranks from `low` to below `high`; `()` if there
    /// is none.
    fn ranked(&self, to: [f64; 2], low: f64, high: f64) -> Found<Dynamic> {
        let Some(levels) = self.recording.levels() else {
            return Ok(Dynamic::UNIT);
        };

        let set = self.set()?;
        let all = set.ids.iter().zip(&set.points);
        let meant =
            all.filter(|(sample, _)| (low..high).contains(&levels.ranks[**sample as usize]));
        let near = meant.map(|(&sample, &at)| (sample, set.distance(at, to)));
        let nearest = near.min_by(|a, b| a.1.total_cmp(&b.1));
        Ok(sample_or_unit(nearest.map(|(sample, _)| sample)))
    }

    /// Returns how many samples of nested levels have ranks below a number.
    fn below(&self, rank: f64) -> i64 {
        let levels = self.recording.levels();
        levels.map_or(0, |levels| levels.below(rank) as i64)
    }

    /// Returns the position of a sample.
    fn point(&self, s: i64) -> Option<[f64; 2]> {
        self.recording.point(id(s)).map(position)
    }

    fn far(&self, s: i64, to: [f64; 2]) -> Found<f64> {
        let set = self.set()?;
        Ok(self.point(s).map_or(f64::NAN, |at| set.distance(at, to)))
    }

    fn apart(&self, a: rhai::Array, b: rhai::Array) -> Found<f64> {
        let read = |place: rhai::Array| place_of(&Dynamic::from(place)).map_err(wrong);
        Ok(self.set()?.distance(read(a)?, read(b)?))
    }

    /// Returns whether a valid sample is at most r away from a place.
    fn is_covered(&self, at: [f64; 2]) -> Found<bool> {
        if self.recording.is_in_space() {
            return Ok(self.covers_in_space(self.lattice(at)));
        }
        let nearest = self.set()?.nearest(at);
        Ok(nearest.is_some_and(|(_, distance)| distance <= 1.0))
    }

    fn within(&self, x: f64, y: f64, d: f64) -> Found<i64> {
        let set = self.set()?;
        let is_near = |point: &&[f64; 2]| set.distance(**point, [x, y]) < d;
        Ok(set.points.iter().filter(is_near).count() as i64)
    }

    fn seam_of(&self, s: i64) -> f64 {
        let point = self.point(s).map(DVec2::from);
        point.map_or(f64::NAN, |point| self.seam(point).1)
    }

    fn block_size(&self, b: i64) -> Dynamic {
        let leaf = self.recording.run().blocks.leaves.get(id(b) as usize);
        let size = leaf.map(|leaf| [leaf.rect.width(), leaf.rect.height()]);
        maybe(size.map(|size| place(size.map(radii))))
    }

    fn parameter(&self, name: &str) -> Found<Dynamic> {
        let all = serde_json::to_value(self.recording.run().parameters).unwrap_or_default();
        match all.get(name) {
            Some(serde_json::Value::Number(number)) => {
                Ok(number.as_f64().unwrap_or(f64::NAN).into())
            }
            Some(serde_json::Value::String(text)) => Ok(text.clone().into()),
            _ => Err(wrong(format!("there is no parameter \"{name}\""))),
        }
    }

    fn measure(&self, name: &str, changes: Option<&str>) -> Found<f64> {
        let number = sets::named(name).map_err(wrong)?;
        let set = match changes {
            Some(changes) => self.set_with(changes)?,
            None => self.set()?,
        };
        self.spend(SET)?;
        match self.recording.domain_in_space() {
            Some(domain) => space::number(&set, &domain, number),
            None => set.number(number).map_err(wrong),
        }
    }

    /// Returns whether the fate of a sample is open after a first round in which each sample is kept if all its
    /// conflicts have later turns, and lost if one of them is kept.
    fn unsure(&self, s: i64) -> bool {
        let run = self.recording.run();
        let key = DrawKey::from_seed(run.parameters.seed);
        let ranking = Ranking::new(run.parameters.order, &run.domain, key);

        // Turns go by rank; the ids of samples decide between equal ranks.
        let turn = |s: u32| {
            let own = matches!(
                run.samples.origins.get(s as usize),
                Some(Origin::Tiled { own: true, .. })
            );
            let point = self.recording.point(s).unwrap_or_default();
            (ranking.rank(point, own), s)
        };

        let earlier = |s: u32| -> Vec<u32> {
            let mut others = self.conflicts_with(s.into());
            others.retain(|&other| turn(other) < turn(s));
            others
        };

        let before = earlier(id(s));
        // The first round keeps a sample without earlier conflicts, and loses one that conflicts with such a sample. All
        // others stay open.
        !before.is_empty() && !before.iter().any(|&t| earlier(t).is_empty())
    }

    fn first_unsure(&self) -> Found<Dynamic> {
        let found = cached(&self.unsure, self.cursor(), || {
            let set = self.set()?;
            self.spend(SET)?;

            let mut ids = set.ids.clone();
            ids.sort_unstable();
            Ok(ids.into_iter().find(|&s| self.unsure(s.into())))
        });
        found.map(sample_or_unit)
    }

    /// Returns the event at which elimination takes a sample, or at which the sample arrives in exact tiling; `None` if
    /// the sample has no such event.
    fn turn_of(&self, s: u32) -> Option<usize> {
        let is_exact = self.recording.is_exact();
        let takes = |event: &usize| {
            let event = self.recording.event(*event);
            event.is_some_and(|event| {
                // Elimination keeps an uncontested sample without taking it: the turn of that sample is the event
                // `Keep`. Exact tiling takes no samples. There a sample arrives by the event that keeps, eliminates
                // or inserts it.
                matches!(event.kind(), EventKind::Take | EventKind::Keep)
                    || is_exact && matches!(event.kind(), EventKind::Eliminate | EventKind::Insert)
            })
        };
        let mut events = self
            .recording
            .events_of(s)
            .iter()
            .map(|&event| event as usize);
        events.find(takes)
    }

    /// Returns the nearest place on an edge of a block, and its distance, in r; without blocks the place itself,
    /// infinitely far.
    fn seam(&self, at: DVec2) -> (DVec2, f64) {
        let leaves = &self.recording.run().blocks.leaves;
        let mut nearest = (at, f64::INFINITY);

        for leaf in leaves {
            let corners = [leaf.rect.min, leaf.rect.max];
            let [min, max] = corners.map(|corner| DVec2::from(position(corner)));
            // Moved into the block, the place has the nearest place of each edge straight above it, below it or beside it.
            let inside = at.clamp(min, max);

            for place in [
                inside.with_x(min.x),
                inside.with_x(max.x),
                inside.with_y(min.y),
                inside.with_y(max.y),
            ] {
                let offset = place - at;
                let distance = offset.x.hypot(offset.y);
                if distance < nearest.1 {
                    nearest = (place, distance);
                }
            }
        }
        nearest
    }

    fn same_points(&self, engine: &str) -> Found<bool> {
        self.refuse_comparison()?;
        if engine != "parallel" {
            return Err(wrong(format!(
                "there is no engine \"{engine}\" to compare with; there is parallel"
            )));
        }

        self.spend(RUN)?;
        let run = self.recording.run();
        let other = Sweep::run(&run.parameters, &run.pattern, &mut Unobserved);
        Ok(other.map_err(|error| wrong(error.to_string()))?.points() == run.points())
    }

    fn parts_at(&self, changes: &str) -> Found<Dynamic> {
        self.refuse_comparison()?;
        self.spend(RUN)?;
        let parameters = self.changed(changes)?;
        let other = Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved)
            .map_err(|error| wrong(error.to_string()))?;
        Ok(match first_divergence(&self.recording, &other) {
            Divergence::Events { a: event, .. } | Divergence::Ends { event, .. } => {
                (event as i64 + 1).into()
            }
            // Equal runs have no such event, and runs in other domains are not compared event by event.
            _ => Dynamic::UNIT,
        })
    }
}

/// Registers functions about a moment: the name, the arguments, and the value.
macro_rules! functions {
    ($engine:ident, $now:ident; $($name:literal: |$of:ident $(, $argument:ident: $type:ty)*| $value:expr;)*) => {$(
        let now = Arc::clone($now);
        $engine.register_fn($name, move |$($argument: $type),*| { let $of = &now; $value });
    )*};
}

/// Registers the functions about `now` for expressions.
pub(crate) fn register(engine: &mut Engine, now: &Arc<Now>) {
    engine.register_fn("min", |a: i64, b: i64| a.min(b));
    engine.register_fn("max", |a: i64, b: i64| a.max(b));
    engine.register_fn("min", |a: f64, b: f64| a.min(b));
    engine.register_fn("max", |a: f64, b: f64| a.max(b));
    engine.register_fn("exists", |value: Dynamic| !value.is_unit());

    register_events(engine, now);
    register_samples(engine, now);
    register_sets(engine, now);
}

/// Registers what expressions ask of events and of the run.
fn register_events(engine: &mut Engine, now: &Arc<Now>) {
    functions! { engine, now;
        "next": |now, query: &str| now.nearest(query, true);
        "previous": |now, query: &str| now.nearest(query, false);
        "count": |now, query: &str| now.events(query).map(|events| events.len() as i64);
        "odd_run": |now| now.recording.run().parameters.seed % 2 == 1;
        "parameter": |now, name: &str| now.parameter(name);
        "parts_at": |now, changes: &str| now.parts_at(changes);
    }
}

/// Registers what became of a sample, named by its number.
fn register_samples(engine: &mut Engine, now: &Arc<Now>) {
    functions! { engine, now;
        "valid": |now, s: i64| now.status(s).is_valid();
        "lost": |now, s: i64| now.is_lost(s);
        "lost_to": |now, s: i64| sample_or_unit(now.lost_to(s));
        "kept": |now, s: i64| now.fate(s) == Some(Fate::Kept);
        "inserted": |now, s: i64| now.is_inserted(s);
        "own": |now, s: i64| matches!(now.origin(s), Some(Origin::Tiled { own: true, .. }));
        "marked": |now, s: i64| now.is_marked(s);
        // Lessons count events from 1. A sample that no event takes has the number -1, so that turns can be compared.
        "turn": |now, s: i64| now.turn_of(id(s)).map_or(-1, |event| event as i64 + 1);
        "first_unsure": |now| now.first_unsure();
        "unsure": |now, s: i64| now.unsure(s);
        "rank": |now, s: i64| now.rank(s);
        "position": |now, s: i64| maybe(now.point(s).map(place));
        "far": |now, s: i64, x: f64, y: f64| now.far(s, [x, y]);
        "seam_of": |now, s: i64| now.seam_of(s);
        "conflicts_of": |now, s: i64| now.conflicts_with(s).len() as i64;
        "conflict": |now, s: i64, k: i64| now.conflict(s, k);
        "radius_of": |now, s: i64| now.point(s).map_or(f64::NAN, |at| now.radius_at(at));
        "refuses": |now, s: i64, x: f64, y: f64| now.refuses(id(s), now.lattice([x, y]));

        "above": |now, s: i64| now.above(s);
        "disk": |now, s: i64| now.disk(s);
        "far_in_space": |now, s: i64, x: f64, y: f64| now.far_in_space(s, [x, y]);
    }
}

/// Registers what expressions ask of the set at the moment: conflicts, gaps, places and measures. Lengths are in r, and
/// a place on the edge of a disk is covered. Disks and gaps are those of r, even in a field of radii; `refusers`,
/// `packed` and `open_places` go by the radius of the field. Places of a set in space lie in its plane.
fn register_sets(engine: &mut Engine, now: &Arc<Now>) {
    functions! { engine, now;
        "samples": |now| now.set().map(|set| set.points.len() as i64);
        "conflicts": |now| now.conflicts();
        "covered": |now, x: f64, y: f64| now.is_covered([x, y]);
        "nearest": |now, x: f64, y: f64| now.set().map(|set| {
            sample_or_unit(set.nearest([x, y]).map(|(sample, _)| sample))
        });
        "ranked": |now, x: f64, y: f64, low: f64, high: f64| now.ranked([x, y], low, high);
        "below": |now, rank: f64| now.below(rank);
        "apart": |now, a: rhai::Array, b: rhai::Array| now.apart(a, b);

        "gaps": |now| now.tessellation().map(|found| found.gaps.len() as i64);
        "deepest": |now| now.deepest();
        "deepest_inside": |now, d: f64| now.deepest_inside(d);
        "reach_of_losses": |now| now.reach_of(|s| now.is_lost(s));
        "reach_of_insertions": |now| now.reach_of(|s| now.is_inserted(s));
        "reach_of_conflicts": |now| now.reach_of(|s| now.status(s).is_valid() && !now.conflicts_with(s).is_empty());
        "reach_of_detectors": |now| now.reach_of_detectors();
        "clear_deepest": |now| now.clear_deepest();

        "border": |now, x: f64, y: f64| now.border([x, y]);
        // The second argument says whether places near an edge are meant, or those farther away.
        "density_near": |now, d: f64| now.density(d, true);
        "density_far": |now, d: f64| now.density(d, false);
        "deepest_near": |now, x: f64, y: f64| now.deepest_near(x, y);
        "seam": |now, x: f64, y: f64| now.seam(DVec2::new(x, y)).1;
        "on_seam": |now, x: f64, y: f64| place(now.seam(DVec2::new(x, y)).0.into());
        "within": |now, x: f64, y: f64, d: f64| now.within(x, y, d);

        "radius_at": |now, x: f64, y: f64| now.radius_at([x, y]);
        "cell_side": |now, x: f64, y: f64| now.cell_side([x, y]);
        "refusers": |now, x: f64, y: f64| now.refusers([x, y]);
        "packed": |now, low: f64, high: f64| now.packed(low, high);
        "open_places": |now| now.open_places();

        "plane": |now| radii(now.plane());
        "dot": |now, x: f64, y: f64, k: i64| now.dot([x, y], k);
        "dots_apart": |now, s: i64, t: i64| now.dots_apart(s, t);
        "clear_above": |now, x: f64, y: f64| now.clear_above([x, y]);
        "first_above": |now, x: f64, y: f64| now.first_above([x, y]);
        "open_within": |now, t: f64| now.open_within(t);
        "close_pairs": |now, t: f64| now.close_pairs(t);
        "active_cubes": |now| now.active_cubes();
        "cubes_in_plane": |now| now.cubes_in_plane();
        "cube_side": |now| now.cube_side();
        "planes_cut": |now| now.planes_cut();

        "block_size": |now, b: i64| now.block_size(b);
        // `None` leaves the parameters as they are.
        "measure": |now, name: &str| now.measure(name, None);
        "measure_with": |now, name: &str, changes: &str| now.measure(name, Some(changes));
        "same_points": |now, engine: &str| now.same_points(engine);
    }
}

/// Returns a value, or `()` if there is none.
fn maybe(value: Option<Dynamic>) -> Dynamic {
    value.unwrap_or(Dynamic::UNIT)
}

fn sample_or_unit(sample: Option<u32>) -> Dynamic {
    maybe(sample.map(|sample| i64::from(sample).into()))
}

/// Returns a number, whole or not.
pub(crate) fn number_of(value: &Dynamic) -> Option<f64> {
    let whole = || value.as_int().map(|whole| whole as f64);
    value.as_float().or_else(|_| whole()).ok()
}

/// Returns the place of a value [x, y].
pub(crate) fn place_of(value: &Dynamic) -> Result<[f64; 2], String> {
    let read = || {
        let array = value.read_lock::<rhai::Array>()?;
        match &array[..] {
            [x, y] => Some([number_of(x)?, number_of(y)?]),
            _ => None,
        }
    };

    // Infinite coordinates and those that are no numbers are no place.
    let place = read().filter(|place| place.iter().all(|number| number.is_finite()));
    place.ok_or_else(|| {
        format!(
            "this must give a place [x, y], not {}",
            tilescope_debugger::shown(value)
        )
    })
}
