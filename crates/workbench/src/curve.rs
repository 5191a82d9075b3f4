//! The run as a curve: a number of the catalogue over the events of a run, which the window draws above the timeline. It is made
//! in the background, once for each run and number. Begin with [`RunCurve::want`]; `tilescope_live` computes it.

mod figure;

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};
use tilescope_analysis::measures::SetNumber;
use tilescope_core::Stage;
use tilescope_debugger::Direction;
use tilescope_live::{Curve, CurveMaker, FRAME_STEPS, Setting, all_live_numbers};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::session::Session;
use tilescope_session::task::{self, SessionRef, Task};
use tilescope_session::words::sentence;

use crate::live::{course_of, refusal};
pub use figure::CurveFormat;

/// The heights that a curve can have, in screen points: that of a sparkline, and that of a chart of the analysis.
pub const HEIGHTS: [u16; 2] = [40, 200];
/// The height of a curve that was not resized. Chosen, not measured.
pub const HEIGHT: u16 = 84;
/// The counted steps between two looks at whether the curve is still wanted: those of five frames, so that another number that
/// the user chooses need not wait long.
const SLICE: u64 = 5 * FRAME_STEPS;

/// A number that can be had at every moment. It is saved by its key in the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct CurveNumber(&'static SetNumber);

impl CurveNumber {
    /// Returns every one, in the sequence of tables; those that sets in space alone have come last.
    pub fn all() -> impl Iterator<Item = Self> {
        all_live_numbers().map(Self)
    }

    /// Returns the number of this key that the run of a session has; `None` if it has none. Without a session it is that of a
    /// planar run of one radius.
    #[must_use]
    pub fn of_run(self, session: Option<&Session>) -> Option<Self> {
        setting_of(session).number(self.key()).map(Self)
    }

    /// Returns why the run of a session has no curve of it; `None` if it has one.
    #[must_use]
    pub fn refusal(self, session: Option<&Session>) -> Option<&'static str> {
        let setting = setting_of(session);
        if setting.number(self.key()).is_some() {
            return None;
        }
        let is_of_space_alone = Setting::Rectangle.number(self.key()).is_none();
        Some(match setting {
            Setting::Space => NOT_IN_SPACE,
            Setting::Shape if !is_of_space_alone => NOT_IN_A_SHAPE,
            Setting::Field if !is_of_space_alone => NOT_IN_A_FIELD,
            Setting::Rectangle | Setting::Shape | Setting::Field => NOT_IN_THE_PLANE,
        })
    }

    /// Returns the number with a key, if it can be had at every moment.
    #[must_use]
    pub fn of(key: &str) -> Option<Self> {
        Self::all().find(|number| number.key() == key)
    }

    /// Returns its key in the catalogue, by which links and files keep it.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.0.key
    }

    /// Returns its row in the catalogue.
    #[must_use]
    pub const fn row(self) -> &'static SetNumber {
        self.0
    }
}

/// Returns what the samples of a session lie in.
fn setting_of(session: Option<&Session>) -> Setting {
    session.map_or(Setting::Rectangle, Session::setting)
}

impl PartialEq for CurveNumber {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for CurveNumber {}

impl Serialize for CurveNumber {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.key().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for CurveNumber {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let unknown =
            || D::Error::custom(format!("no number \"{key}\" can be had at every moment"));
        Self::of(&key).ok_or_else(unknown)
    }
}

/// The curve that is drawn above the timeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShownCurve {
    /// Its number; `None` for no curve.
    pub number: Option<CurveNumber>,
    /// Its height, in screen points.
    pub height: u16,
}

impl Default for ShownCurve {
    fn default() -> Self {
        Self {
            number: None,
            height: HEIGHT,
        }
    }
}

impl ShownCurve {
    /// Returns the same curve with its height brought within [`HEIGHTS`].
    #[must_use]
    pub fn within_limits(self) -> Self {
        let [least, most] = HEIGHTS;
        Self {
            height: self.height.clamp(least, most),
            ..self
        }
    }

    /// Reads a curve as [`fmt::Display`] writes it.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let (key, height) = match text.split_once(':') {
            Some((key, height)) => (key, height.parse().ok()?),
            None => (text, HEIGHT),
        };
        let number = Some(CurveNumber::of(key)?);
        Some(Self { number, height }.within_limits())
    }
}

/// The key of the number, and the height if it was changed.
impl fmt::Display for ShownCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = self.number.map_or("", CurveNumber::key);
        match self.height {
            HEIGHT => f.write_str(key),
            height => write!(f, "{key}:{height}"),
        }
    }
}

/// A number over the events of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurvePoints {
    /// How many events have happened at each moment, rising from 0 to all.
    pub events: Vec<usize>,
    /// The stage of each moment.
    pub stages: Vec<Stage>,
    /// Whether iterations are levels, as in exact tilings.
    pub has_levels: bool,
    /// The number at each moment; NaN where it is not defined.
    pub values: Vec<f64>,
}

impl CurvePoints {
    /// Returns the index of the last moment at or before a cursor.
    #[must_use]
    pub fn at(&self, cursor: usize) -> usize {
        let after = self.events.partition_point(|event| *event <= cursor);
        after.saturating_sub(1)
    }

    /// Returns the least and the largest value; `None` if none is defined.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        let mut defined = self.values.iter().filter(|value| value.is_finite());
        let first = *defined.next()?;
        Some(defined.fold([first; 2], |[low, high], value| {
            [low.min(*value), high.max(*value)]
        }))
    }

    /// Returns the cursor of the next moment behind `cursor`, or backwards of the last one before it, at which the
    /// value has risen since the moment before; `None` if there is none.
    #[must_use]
    pub fn rise(&self, cursor: usize, direction: Direction) -> Option<usize> {
        // A value that is not defined is NaN: it is above no other value, and no other value is above it.
        let is_rise = |index: &usize| self.values[*index] > self.values[*index - 1];
        let index = match direction {
            Direction::Forwards => {
                let next = self.events.partition_point(|event| *event <= cursor);
                // The first moment is left out: it has no moment before it to rise from.
                (next.max(1)..self.events.len()).find(is_rise)
            }
            Direction::Backwards => {
                let end = self.events.partition_point(|event| *event < cursor);
                (1..end).rev().find(is_rise)
            }
        };
        index.map(|index| self.events[index])
    }
}

/// Makes the curve of a number.
#[derive(Serialize, Deserialize)]
pub struct CurveTask {
    session: SessionRef,
    number: CurveNumber,
}

impl Task for CurveTask {
    /// The curve, or why there is none.
    type Outcome = Result<CurvePoints, String>;
    const NAME: &'static str = "curve";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let course = Arc::new(course_of(&self.session)?);
        let at_all_moments = None;
        let mut maker = CurveMaker::new(course, &[self.number.row()], at_all_moments)
            .map_err(|error| error.to_string())?;

        // The work goes in slices, because it can be cancelled only between two of them.
        loop {
            if maker.proceed(SLICE).map_err(|error| error.to_string())? {
                break;
            }

            let [done, all] = maker.progress();
            monitor.set_fraction(done as f32 / all as f32);
            if monitor.is_cancelled() {
                return Err("the curve is no longer wanted".to_owned());
            }
        }

        // One number was asked for, so that there is one column.
        let curve = maker.finish();
        Ok(CurvePoints {
            events: curve.events,
            stages: curve.stages,
            has_levels: curve.has_levels,
            values: curve.columns.into_iter().next().unwrap_or_default(),
        })
    }
}

/// How far the curve is.
#[derive(Default)]
enum Making {
    #[default]
    Nothing,
    Begun(Job<Result<CurvePoints, String>>),
    Done(Arc<CurvePoints>),
    Failed(String),
}

/// The curve of a run, as far as one is wanted.
#[derive(Default)]
pub struct RunCurve {
    /// The generation of the session, and the number.
    of: Option<(u64, CurveNumber)>,
    making: Making,
}

impl RunCurve {
    /// Returns the curve, once it is made.
    #[must_use]
    pub fn points(&self) -> Option<&Arc<CurvePoints>> {
        match &self.making {
            Making::Done(points) => Some(points),
            Making::Nothing | Making::Begun(_) | Making::Failed(_) => None,
        }
    }

    /// Returns the number and the curve as CSV, once it is made.
    #[must_use]
    pub fn csv(&self) -> Option<(CurveNumber, String)> {
        let ((_, number), points) = (self.of?, self.points()?);
        let curve = Curve {
            numbers: vec![number.row()],
            events: points.events.clone(),
            stages: points.stages.clone(),
            has_levels: points.has_levels,
            columns: vec![points.values.clone()],
        };
        Some((number, curve.csv()))
    }

    /// Returns the number, if one is wanted.
    #[must_use]
    pub fn number(&self) -> Option<CurveNumber> {
        self.of.map(|(_, number)| number)
    }

    /// Returns the fraction done, from 0 to 1, while the curve is made.
    #[must_use]
    pub fn progress(&self) -> Option<f32> {
        match &self.making {
            Making::Begun(job) => Some(job.fraction()),
            Making::Nothing | Making::Done(_) | Making::Failed(_) => None,
        }
    }

    /// Returns why this run has no such curve.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        match &self.making {
            Making::Failed(why) => Some(why),
            Making::Nothing | Making::Begun(_) | Making::Done(_) => None,
        }
    }

    /// Takes a finished curve, and starts that of `number` unless it is known or at work; `None` stops the work.
    pub fn want(&mut self, session: &Arc<Session>, number: Option<CurveNumber>, wake: &Wake) {
        // Some numbers have one variant for the plane and one for space: this run's variant is followed. A number that
        // this run lacks stays, and `refused` says why there is no curve of it.
        let of_run = |asked: CurveNumber| asked.of_run(Some(session)).unwrap_or(asked);
        let number = number.map(of_run);
        let wanted = number.map(|number| (session.generation, number));
        if self.of != wanted {
            self.of = wanted;
            // A session without measurable moments is refused here, before any work begins.
            self.making = match (number, refused(session, number)) {
                (None, _) => Making::Nothing,
                (Some(_), Some(why)) => Making::Failed(why),
                (Some(number), None) => {
                    let session = SessionRef(Arc::clone(session));
                    Making::Begun(task::start(wake, CurveTask { session, number }))
                }
            };
        }

        if let Making::Begun(job) = &self.making
            && let Some(outcome) = job.poll()
        {
            self.take(outcome);
        }
    }

    fn take(&mut self, outcome: Result<Result<CurvePoints, String>, String>) {
        self.making = match outcome.and_then(|made| made) {
            Ok(points) => Making::Done(Arc::new(points)),
            Err(why) => Making::Failed(sentence(&why)),
        };
    }

    /// Waits for the curve.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        if let Making::Begun(job) = &self.making {
            let outcome = job.wait();
            self.take(outcome);
        }
    }
}

/// Why a run in space has no curve of a number.
pub const NOT_IN_SPACE: &str = "This number is not followed in space. Those of curves there are samples, density, smallest distance, conflicts, relative radius and active cubes; open places are judged at the end, and the spectrum is measured at rest.";

/// Why a planar run has no curve of a number.
pub const NOT_IN_THE_PLANE: &str =
    "This number is followed in space alone, where cubes are active.";

/// Why a run in a shape has no curve of a number.
pub const NOT_IN_A_SHAPE: &str = "This number is not followed in a shape: subdivision finds out whether places are covered, and not how far they are from their samples.";

/// Why a run in a field has no curve of a number.
pub const NOT_IN_A_FIELD: &str = "This number compares with one radius, which a field does not have. Those of curves there are samples, density, conflicts, open places and spectral slope.";

/// Returns why a session has no curve of a number.
fn refused(session: &Session, number: Option<CurveNumber>) -> Option<String> {
    let of_number = number.and_then(|number| number.refusal(Some(session)));
    of_number.map(str::to_owned).or_else(|| refusal(session))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> CurvePoints {
        CurvePoints {
            events: vec![0, 10, 20, 30, 40],
            stages: vec![Stage::Tile; 5],
            has_levels: false,
            values: vec![f64::NAN, 3.0, 5.0, 2.0, 4.0],
        }
    }

    #[test]
    fn rises_are_found_on_both_sides_of_a_cursor_and_nothing_rises_from_undefined() {
        let found = |direction: Direction| {
            [0, 10, 19, 20, 39, 40].map(|cursor| points().rise(cursor, direction))
        };
        let expected = [Some(20), Some(20), Some(20), Some(40), Some(40), None];
        assert_eq!(found(Direction::Forwards), expected);
        let expected = [None, None, None, None, Some(20), Some(20)];
        assert_eq!(found(Direction::Backwards), expected);
        assert_eq!(points().rise(50, Direction::Backwards), Some(40));
    }

    #[test]
    fn the_moment_of_a_cursor_is_the_last_one_before_it() {
        assert_eq!(
            [0, 9, 10, 45].map(|cursor| points().at(cursor)),
            [0, 0, 1, 4]
        );
        assert_eq!(points().range(), Some([2.0, 5.0]));
    }

    #[test]
    fn curves_are_read_as_they_are_written_and_corrected_to_their_limits() {
        for text in ["conflicts", "gaps:120"] {
            assert_eq!(ShownCurve::read(text).unwrap().to_string(), text);
        }
        assert_eq!(ShownCurve::read("gaps:9000").unwrap().height, HEIGHTS[1]);
        for text in ["", "oscillation", "gaps:", "gaps:-1", ":90"] {
            assert_eq!(ShownCurve::read(text), None, "{text}");
        }
    }

    #[test]
    fn numbers_are_saved_by_their_keys_and_those_of_whole_sets_alone_are_refused() {
        for number in CurveNumber::all() {
            let text = serde_json::to_string(&number).unwrap();
            assert_eq!(serde_json::from_str::<CurveNumber>(&text).unwrap(), number);
        }
        for text in ["\"oscillation\"", "\"speed\"", "7"] {
            assert!(serde_json::from_str::<CurveNumber>(text).is_err(), "{text}");
        }
    }
}
