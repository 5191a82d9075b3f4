//! A moment of a recorded run, and the values of expressions there. Begin with [`Scene::find`].

use std::sync::Arc;
use std::sync::atomic::Ordering;

use rhai::{Dynamic, Scope};
use tilescope_core::{R, Stage};
use tilescope_debugger::{Evaluator, Recording, State};

use crate::coinless::without_coin;
use crate::error::LessonError;
use crate::functions::{self, Now, number_of, place_of};
use crate::prose;
use crate::scene_spec::{Camera, SceneSpec};
use crate::sets::{PointSet, position, radii};
use crate::text::Text;
use crate::translation::Translation;

/// How far beyond the box a plane may be, in r, which is then put to its end. Chosen, not measured: a lesson has a few decimals.
const ROUNDED: f64 = 1e-3;

/// A moment of a run with its evaluator.
pub struct Scene {
    pub(crate) now: Arc<Now>,
    evaluator: Evaluator,
    state: State,
    pub(crate) translation: Arc<Translation>,
}

impl Scene {
    /// Returns the scene at a cursor.
    #[must_use]
    pub fn at(recording: &Arc<Recording>, cursor: usize) -> Self {
        let now = Arc::new(Now::new(Arc::clone(recording), cursor));
        let mut evaluator = Evaluator::new(Arc::clone(recording));
        functions::register(evaluator.engine_mut(), &now);
        let state = State::at(recording, cursor);
        Self {
            now,
            evaluator,
            state,
            translation: Arc::default(),
        }
    }

    /// Returns the scene of a step: the first moment at which its condition holds. None if the run has no such moment.
    ///
    /// # Errors
    ///
    /// A fault of the condition, of the density or of the plane's expression; a plane outside the box; a field of radii
    /// whose r is not 1.
    pub fn find(recording: &Arc<Recording>, spec: &SceneSpec) -> Result<Option<Self>, LessonError> {
        let mut scene = Self::at(recording, 0);
        if let Some(density) = &spec.density {
            scene = Self::at(&scene.painted(density)?, 0);
        }
        if let Some(locality) = &recording.run().locality {
            // The reader has looked at few places of the field; here its whole lattice is known.
            let r = recording.domain().radius();
            // Up to rounding, r is a power of two in every field that the reader allows. If it is not 1, it is far
            // from 1.
            if (r - 1.0).abs() > 1e-6 {
                let message = format!(
                    "r is {r} in this field: its radius is below 1 or above 2 between the places looked at"
                );
                return Err(LessonError::new(spec.line, message));
            }
            // Darts without the coin make other samples, which have a recording of their own.
            if !spec.has_coin {
                let parameters = &recording.run().parameters;
                scene = Self::at(&Arc::new(without_coin(locality, parameters)), 0);
            }
        }

        for cursor in spec.moment.cursors(&Arc::clone(scene.recording())) {
            scene.go(cursor);
            scene.cut(spec)?;
            if let Some(condition) = &spec.condition
                && !scene.truth(condition, |_| {})?
            {
                continue;
            }

            // The question has the whole budget of searches again; results computed on the way stay known.
            scene.now.renew_budget();
            return Ok(Some(scene));
        }

        Ok(None)
    }

    /// Puts the plane through a set in space where a step has it.
    fn cut(&self, spec: &SceneSpec) -> Result<(), LessonError> {
        // The expression may name the plane that follows the events.
        self.now.put_plane(None);
        let Some((text, domain)) = spec.plane.as_ref().zip(self.recording().domain_in_space())
        else {
            return Ok(());
        };

        let (place, depth) = (self.number(text)?, radii(domain.sides()[2]));
        // Authors round, and a side is a whole number of lattice units.
        if !(-ROUNDED..=depth + ROUNDED).contains(&place) {
            return Err(text.wrong(format!(
                "the plane is at {place} r; the box goes from 0 to {depth} r"
            )));
        }
        let units = (place * f64::from(R)).round() as i32;
        self.now.put_plane(Some(units.clamp(0, domain.sides()[2])));
        Ok(())
    }

    /// Returns where the plane of the step lies through a set in space, in r; `None` of planar sets.
    #[must_use]
    pub fn plane(&self) -> Option<f64> {
        self.recording()
            .is_in_space()
            .then(|| radii(self.now.plane()))
    }

    /// Returns the recording of the samples of nested levels whose ranks are below a density, an expression of their places x
    /// and y.
    fn painted(&self, density: &Text) -> Result<Arc<Recording>, LessonError> {
        let wrong = |message: String| density.wrong(message);
        let recording = self.recording();
        let ranks = recording.levels().map_or(&[][..], |levels| &levels.ranks);

        // The expression is parsed once for all samples.
        let parsed = self.evaluator.parse(&density.text);
        let parsed =
            parsed.map_err(|error| wrong(without_position(&error.to_string()).to_owned()))?;

        // The reader of lessons refuses a density without levels, so that there are ranks.
        let mut kept = Vec::new();
        for (sample, &rank) in (0..).zip(ranks) {
            let [x, y] = recording.point(sample).map(position).unwrap_or_default();
            let value = self.evaluator.evaluate(&parsed, &self.state, |scope| {
                scope.push_constant("x", x).push_constant("y", y);
            });
            let value =
                value.map_err(|error| wrong(without_position(&error.to_string()).to_owned()))?;
            // A density that is no number would keep nothing, and the picture would be empty without a word.
            let at = number_of(&value)
                .filter(|number| !number.is_nan())
                .ok_or_else(|| {
                    let shown = tilescope_debugger::shown(&value);
                    wrong(format!("a density must be a number, not {shown}"))
                })?;
            if rank < at {
                kept.push(sample);
            }
        }

        if kept.is_empty() {
            return Err(wrong("no sample has a rank below this density".to_owned()));
        }
        let missing = || wrong("only nested levels have ranks below a density".to_owned());
        recording.painted(&kept).map(Arc::new).ok_or_else(missing)
    }

    /// Returns a query with its values, and the events from the moment on that match it.
    pub(crate) fn coming(&self, text: &Text) -> Result<(String, Vec<usize>), LessonError> {
        let query = self.fill(text)?;
        let found = self
            .now
            .events(&query)
            .map_err(|error| text.wrong(error.to_string()))?;
        let from = found.partition_point(|&event| event < self.cursor());
        Ok((query, found[from..].to_vec()))
    }

    /// Moves to another moment of the run.
    pub(crate) fn go(&mut self, cursor: usize) {
        self.state.seek(&self.now.recording, cursor);
        self.now
            .cursor
            .store(self.state.cursor(), Ordering::Relaxed);
    }

    /// Sets the translation of its texts.
    pub(crate) fn speak(&mut self, translation: &Arc<Translation>) {
        self.translation = Arc::clone(translation);
    }

    /// Returns the samples that a text names: those of its expressions whose values are valid samples, and that do not
    /// count something.
    pub(crate) fn samples_in(&self, text: &Text) -> Result<Vec<u32>, LessonError> {
        // An expression with one of these words gives a count, or the number of an event: its value is no sample, although a
        // sample may have that number.
        const COUNTS: [&str; 15] = [
            "count",
            "below(",
            "inserted",
            "eliminated",
            "samples(",
            "conflicts",
            "gaps",
            "event",
            "turn",
            "undecided",
            "kept",
            "iteration",
            "cubes",
            "open_",
            "close_pairs",
        ];

        let mut named = Vec::new();
        let found = prose::expressions(&text.text)
            .map_err(|message| LessonError::new(text.line, message))?;

        for expression in found
            .into_iter()
            .filter(|text| !COUNTS.iter().any(|word| text.contains(word)))
        {
            let value = self.value(&Text::new(expression, text.line), |_| {})?;
            let number = value.as_int().ok();
            let sample = number.and_then(|number| u32::try_from(number).ok());

            let is_valid =
                |&sample: &u32| self.now.recording.status(sample, self.cursor()).is_valid();
            if let Some(sample) = sample.filter(is_valid)
                && !named.contains(&sample)
            {
                named.push(sample);
            }
        }

        Ok(named)
    }

    /// Returns whether a sample is an inserted one.
    pub(crate) fn is_inserted(&self, sample: u32) -> bool {
        self.now.is_inserted(i64::from(sample))
    }

    /// Returns the recording of the run.
    #[must_use]
    pub fn recording(&self) -> &Arc<Recording> {
        &self.now.recording
    }

    /// Returns how many events have happened.
    #[must_use]
    pub fn cursor(&self) -> usize {
        self.state.cursor()
    }

    /// Returns the value of an expression; `add` puts more names into scope.
    pub(crate) fn value(
        &self,
        text: &Text,
        add: impl FnOnce(&mut Scope<'static>),
    ) -> Result<Dynamic, LessonError> {
        let parsed = self.evaluator.parse(&text.text);
        let value = parsed.and_then(|parsed| self.evaluator.evaluate(&parsed, &self.state, add));
        value.map_err(|error| text.wrong(without_position(&error.to_string())))
    }

    /// Returns the items for which an expression holds; `s` is the item.
    pub(crate) fn filter(&self, text: &Text, items: &[u32]) -> Result<Vec<u32>, LessonError> {
        let wrong =
            |error: &dyn std::fmt::Display| text.wrong(without_position(&error.to_string()));
        // The expression is parsed once for all items.
        let parsed = self
            .evaluator
            .parse(&text.text)
            .map_err(|error| wrong(&error))?;

        let mut found = Vec::new();
        for &item in items {
            let value = self.evaluator.evaluate(&parsed, &self.state, |scope| {
                scope.push_constant("s", i64::from(item));
            });
            if as_truth(&value.map_err(|error| wrong(&error))?).map_err(|why| text.wrong(why))? {
                found.push(item);
            }
        }

        Ok(found)
    }

    /// Returns whether an expression is true.
    pub(crate) fn truth(
        &self,
        text: &Text,
        add: impl FnOnce(&mut Scope<'static>),
    ) -> Result<bool, LessonError> {
        as_truth(&self.value(text, add)?).map_err(|message| text.wrong(message))
    }

    /// Returns the number that an expression gives.
    pub(crate) fn number(&self, text: &Text) -> Result<f64, LessonError> {
        let value = self.value(text, |_| {})?;
        let number = number_of(&value).filter(|number| number.is_finite());
        number.ok_or_else(|| {
            let shown = tilescope_debugger::shown(&value);
            text.wrong(format!("this must give a number, not {shown}"))
        })
    }

    /// Returns the place that an expression gives: [x, y], or a sample's.
    pub(crate) fn place(&self, text: &Text) -> Result<[f64; 2], LessonError> {
        let value = self.value(text, |_| {})?;
        let place = match value.as_int() {
            Ok(sample) => self.position(sample),
            Err(_) => place_of(&value),
        };
        place.map_err(|message| text.wrong(message))
    }

    /// Returns the places that an expression gives: one, which may be a sample's, or an array of them. In an array a
    /// number is a coordinate, and so no sample.
    pub(crate) fn places(&self, text: &Text) -> Result<Vec<[f64; 2]>, LessonError> {
        let value = self.value(text, |_| {})?;

        // One place is an array, too: of two numbers.
        let several = value.read_lock::<rhai::Array>().and_then(|array| {
            array
                .iter()
                .all(Dynamic::is_array)
                .then(|| array.iter().map(place_of).collect::<Result<Vec<_>, _>>())
        });

        match several {
            Some(places) => places.map_err(|message| text.wrong(message)),
            None => Ok(vec![self.place(text)?]),
        }
    }

    fn position(&self, sample: i64) -> Result<[f64; 2], String> {
        let id = u32::try_from(sample).ok();
        let point = id.and_then(|id| self.now.recording.point(id));
        point
            .map(position)
            .ok_or_else(|| format!("there is no sample {sample}"))
    }

    /// Returns the point set of a name: `set` is the valid samples, `white` is as many random ones, and `jittered` is
    /// about as many, one in each cell of a grid. `tiled`, `eliminated` and `result` are the samples at the end of
    /// tiling, of elimination and of the run.
    pub(crate) fn set(&self, text: &Text, seed: u64) -> Result<PointSet, LessonError> {
        let name = self
            .value(text, |_| {})?
            .into_string()
            .map_err(|_| text.wrong("this must give a text"))?;

        let recording = &self.now.recording;
        // Evaluated only for the name that is asked for: each looks at all samples.
        let here = || PointSet::at(recording, self.cursor());
        // A run that lacks the stage, such as one of darts, has no samples of it.
        let after = |stage| PointSet::at(recording, recording.end_of(stage).unwrap_or(0));

        Ok(match name.as_str() {
            "set" => here(),
            "white" => here().white(seed),
            "jittered" => here().jittered(seed),
            "tiled" => after(Stage::Tile),
            "eliminated" => after(Stage::Eliminate),
            "result" => PointSet::at(recording, recording.len()),
            _ => {
                let known = ["set", "white", "jittered", "tiled", "eliminated", "result"];
                return Err(LessonError::unknown(text.line, "point set", &name, &known));
            }
        })
    }

    /// Returns a text with the values of its expressions. Numbers that are not whole have two decimals, after the
    /// sign of the translation's language.
    pub(crate) fn fill(&self, text: &Text) -> Result<String, LessonError> {
        let value = |expression: &str| {
            let expression = Text::new(expression, text.line);
            let value = self
                .value(&expression, |_| {})
                .map_err(|error| error.message)?;

            Ok(match value.as_float() {
                Ok(number) if number.fract() == 0.0 => format!("{number:.0}"),
                Ok(number) => self.translation.number(format!("{number:.2}")),
                Err(_) => tilescope_debugger::shown(&value),
            })
        };

        let filled = prose::filled(self.translation.of(&text.text), value);
        filled.map_err(|message| text.wrong(message))
    }

    /// Returns where the camera of a step looks, and how many r it shows; none for the whole domain.
    ///
    /// # Errors
    ///
    /// A fault of its expression.
    pub fn camera(&self, camera: &Camera) -> Result<Option<([f64; 2], f64)>, LessonError> {
        match camera {
            Camera::Fit => Ok(None),
            Camera::At(place, radii) => Ok(Some((self.place(place)?, *radii))),
        }
    }
}

fn as_truth(value: &Dynamic) -> Result<bool, String> {
    let shown = || tilescope_debugger::shown(value);
    let wrong = |_| format!("this must be true or false, not {}", shown());
    value.as_bool().map_err(wrong)
}

/// Returns a message without the line and column within the expression, which a reader would take for those of the file.
fn without_position(message: &str) -> &str {
    message.split(" (line ").next().unwrap_or(message)
}
