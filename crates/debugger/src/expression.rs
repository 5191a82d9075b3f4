//! Expressions of conditions and watches, in the language of `rhai`, over the names that a cursor has. Operations,
//! sizes and nesting are limited, and expressions cannot access anything outside the run.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rhai::packages::{BasicMathPackage, CorePackage, Package};
use rhai::{AST, Dynamic, Engine, Scope};
use tilescope_core::R;

use crate::event::NONE;
use crate::query::{block, distance, verdict_name};
use crate::recording::{NumberAt, NumberName, NumberValue, Recording};
use crate::state::State;

/// The most operations of an evaluation. Chosen, not measured, like the limits below.
pub const MAX_OPERATIONS: u64 = 10_000;
/// The most characters of an expression.
pub const MAX_LENGTH: usize = 1_000;
/// How deep an expression may nest.
pub const MAX_DEPTH: usize = 32;

/// The first names of [`NAMES`], this many, describe the event that is about to happen; the rest describe the state
/// after the last event.
pub const NAMES_OF_NEXT: usize = 12;

/// The names in scope, each with its meaning. Lengths and positions are in r; a value that does not exist is `()`.
pub const NAMES: [(&str, &str); 26] = [
    ("event", "number of the event about to happen, from 1"),
    ("kind", "its kind, a text such as \"insert\""),
    (
        "line",
        "its line of pseudocode, a text such as \"insert.3\"",
    ),
    (
        "depth",
        "its depth: 0 phase or iteration, 1 block, 2 sample, 3 search, 4 test",
    ),
    ("block", "the block that it is about"),
    ("verdict", "what becomes of the place it examines"),
    ("a", "the first sample that it names"),
    ("b", "the second sample that it names"),
    ("distance", "from a to b"),
    ("place_x", "position of what it examines or changes"),
    ("place_y", "position of what it examines or changes"),
    (
        "place_z",
        "its position along the third axis, in a set in space",
    ),
    ("phase", "the phase, a text"),
    ("iteration", "the iteration, from 1"),
    ("p", "the current sample"),
    ("x", "its position"),
    ("y", "its position"),
    ("conflict_point", "the sample that p was last compared with"),
    ("search_radius", "of the last search"),
    ("buffer_size", "samples in the test buffer"),
    ("m", "first of the other samples of the last place tested"),
    ("n", "second of them"),
    ("undecided", "how many samples await their turn"),
    ("kept", "how many samples stay"),
    ("eliminated", "how many samples are eliminated"),
    ("inserted", "how many samples are inserted"),
];

/// The names of lengths and coordinates: their values are in r.
pub const LENGTHS: [&str; 7] = [
    "distance",
    "place_x",
    "place_y",
    "place_z",
    "x",
    "y",
    "search_radius",
];

/// Why an expression has no value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExpressionError {
    /// It is too long.
    #[error("the expression has {length} characters, more than {maximum}")]
    TooLong {
        /// How many characters it has.
        length: usize,
        /// The most it may have, [`MAX_LENGTH`].
        maximum: usize,
    },
    /// It does not parse.
    #[error("{message}")]
    Syntax {
        /// The fault, and its position.
        message: String,
    },
    /// It cannot be evaluated here.
    #[error("{message}")]
    Evaluation {
        /// The fault, in words.
        message: String,
    },
    /// A number that it names is not measured yet.
    #[error("the number \"{name}\" is being measured")]
    Pending {
        /// The number's name in expressions.
        name: &'static str,
    },
    /// A condition names a number that is for watches alone.
    #[error("a condition cannot have the number \"{name}\": {why}; watch it instead")]
    NotInConditions {
        /// The number's name in expressions.
        name: &'static str,
        /// The reason, as part of a sentence.
        why: &'static str,
    },
    /// The value of a condition is not true or false.
    #[error("a condition must be true or false, not {found}")]
    NotTruth {
        /// The type of the value.
        found: String,
    },
}

/// A parsed expression, ready to be evaluated at any cursor.
#[derive(Clone, Debug)]
pub struct Expression {
    tree: AST,
    /// The numbers of the moment that it names.
    numbers: Vec<NumberName>,
}

/// Evaluates expressions over a recording. Functions: `x_of(s)`, `y_of(s)` (in r), `distance(s, t)` (the shortest way,
/// in r), `block_of(s)`. Names: [`NAMES`], and the numbers that the recording was given.
pub struct Evaluator {
    engine: Engine,
    recording: Arc<Recording>,
    /// The numbers of the moment, once an expression has named one.
    followed: OnceLock<Mutex<NumberAt>>,
}

impl Evaluator {
    /// Returns an evaluator of expressions over `recording`.
    #[must_use]
    pub fn new(recording: Arc<Recording>) -> Self {
        // Only arithmetic, comparisons and texts: no files, no time, no other code, as expressions come from links, too.
        let mut engine = Engine::new_raw();
        CorePackage::new().register_into_engine(&mut engine);
        BasicMathPackage::new().register_into_engine(&mut engine);
        engine.disable_symbol("eval");

        // Whatever is written, an evaluation ends soon and takes little memory. The bare numbers are chosen, not measured.
        engine.set_max_operations(MAX_OPERATIONS);
        engine.set_max_expr_depths(MAX_DEPTH, MAX_DEPTH);
        engine.set_max_string_size(MAX_LENGTH);
        engine.set_max_array_size(64);
        engine.set_max_map_size(64);
        engine.set_max_call_levels(8);

        register(&mut engine, &recording);

        Self {
            engine,
            recording,
            followed: OnceLock::new(),
        }
    }

    /// Returns the engine, to add functions to those that expressions can call.
    pub const fn engine_mut(&mut self) -> &mut Engine {
        &mut self.engine
    }

    /// Returns a parsed expression.
    pub fn parse(&self, text: &str) -> Result<Expression, ExpressionError> {
        let (length, maximum) = (text.chars().count(), MAX_LENGTH);
        if length > maximum {
            return Err(ExpressionError::TooLong { length, maximum });
        }

        let error = |e: rhai::ParseError| ExpressionError::Syntax {
            message: e.to_string(),
        };
        let tree = self
            .engine
            .compile_expression(with_signs(text))
            .map_err(error)?;

        Ok(Expression {
            tree,
            numbers: self.numbers_in(text),
        })
    }

    /// Returns a parsed condition. It is evaluated at many moments of a run, so that not every number can be in it.
    pub fn parse_condition(&self, text: &str) -> Result<Expression, ExpressionError> {
        let expression = self.parse(text)?;
        for number in &expression.numbers {
            if let Some(why) = number.not_in_conditions {
                let name = number.name;
                return Err(ExpressionError::NotInConditions { name, why });
            }
        }
        Ok(expression)
    }

    /// Returns the numbers of the moment that an expression names, each once.
    fn numbers_in(&self, text: &str) -> Vec<NumberName> {
        let Some(numbers) = self.recording.numbers() else {
            return Vec::new();
        };
        let words = words(text);
        // A word before a bracket is a function, and one after a dot a property.
        let is_named = |number: &&NumberName| {
            let names = |(before, word, after): &(Option<char>, &str, Option<char>)| {
                *word == number.name && *before != Some('.') && *after != Some('(')
            };
            words.iter().any(names)
        };
        numbers.names.iter().filter(is_named).copied().collect()
    }

    /// Returns the value of an expression at a state, as text.
    pub fn value(&self, expression: &Expression, state: &State) -> Result<String, ExpressionError> {
        Ok(shown(&self.evaluate(expression, state, |_| {})?))
    }

    /// Returns the value of an expression at a state, as text, where its numbers take no more than about `steps` of the
    /// steps that their measures count; otherwise [`ExpressionError::Pending`], and calls that follow come nearer.
    pub fn value_within(
        &self,
        expression: &Expression,
        state: &State,
        steps: u64,
    ) -> Result<String, ExpressionError> {
        Ok(shown(&self.evaluate_within(
            expression,
            state,
            steps,
            |_| {},
        )?))
    }

    /// Returns whether a condition holds at a state.
    pub fn holds(&self, expression: &Expression, state: &State) -> Result<bool, ExpressionError> {
        let value = self.evaluate(expression, state, |_| {})?;
        let not_truth = |found: &str| ExpressionError::NotTruth {
            found: found.to_owned(),
        };
        value.as_bool().map_err(not_truth)
    }

    /// Returns the value of an expression at a state; `add` puts more names into scope.
    pub fn evaluate(
        &self,
        expression: &Expression,
        state: &State,
        add: impl FnOnce(&mut Scope<'static>),
    ) -> Result<Dynamic, ExpressionError> {
        self.evaluate_within(expression, state, u64::MAX, add)
    }

    /// Returns the value of an expression at a state. Numbers of the moment may take about `steps` of the steps that their
    /// measures count; `add` adds names to the scope.
    fn evaluate_within(
        &self,
        expression: &Expression,
        state: &State,
        steps: u64,
        add: impl FnOnce(&mut Scope<'static>),
    ) -> Result<Dynamic, ExpressionError> {
        let mut names = scope(&self.recording, state);
        for number in &expression.numbers {
            let value = self.number(number, state.cursor(), steps)?;
            names.push_constant_dynamic(number.name, value);
        }
        add(&mut names);
        let error = |e: Box<rhai::EvalAltResult>| ExpressionError::Evaluation {
            message: e.to_string(),
        };
        self.engine
            .eval_ast_with_scope(&mut names, &expression.tree)
            .map_err(error)
    }

    /// Returns the value of a number of the moment at a cursor: `()` where it is not defined, or if the recording was given
    /// no numbers. A value that takes more than about `steps` steps, as its measure counts them, is
    /// [`ExpressionError::Pending`].
    fn number(
        &self,
        number: &NumberName,
        cursor: usize,
        steps: u64,
    ) -> Result<Dynamic, ExpressionError> {
        let Some(numbers) = self.recording.numbers() else {
            return Ok(Dynamic::UNIT);
        };

        // Following the run costs time and memory, and most expressions name no number: it begins with the first that does.
        let followed = self
            .followed
            .get_or_init(|| Mutex::new((numbers.follow)(&self.recording)));
        // A panic in another evaluation does not keep this one from the numbers.
        let mut value_at = followed.lock().unwrap_or_else(PoisonError::into_inner);

        let name = number.name;
        let value = value_at(name, cursor, steps).map_err(|why| ExpressionError::Evaluation {
            message: format!("the number \"{name}\": {why}"),
        })?;

        match value {
            // A count becomes an integer, which is shown without decimals.
            NumberValue::Known(count) if number.is_count => Ok((count as i64).into()),
            NumberValue::Known(value) => Ok(value.into()),
            NumberValue::Undefined => Ok(Dynamic::UNIT),
            NumberValue::Pending => Err(ExpressionError::Pending { name }),
        }
    }
}

/// Returns the names in an expression, each with the nearest characters before and after it that are not spaces; texts in
/// quotes are skipped.
#[must_use]
pub fn words(text: &str) -> Vec<(Option<char>, &str, Option<char>)> {
    let mut words = Vec::new();
    let mut quote_end = 0;
    let mut start: Option<usize> = None;

    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';

    // A space is added behind the text: it ends a word that reaches up to the end.
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        // Nothing in a text in quotes is a name.
        if at < quote_end {
            continue;
        }

        if is_part(c) {
            start = start.or(Some(at));
            continue;
        }

        if let Some(from) = start.take() {
            let word = &text[from..at];
            // A word that begins with a digit is a number such as 1e5, and its letters are no name.
            if !word.starts_with(|c: char| c.is_ascii_digit()) {
                let before = text[..from].trim_end().chars().next_back();
                let after = text[at..].trim_start().chars().next();
                words.push((before, word, after));
            }
        }

        if let Some(length) = quoted_length(&text[at..]) {
            quote_end = at + length;
        }
    }
    words
}

/// Returns the length of the text in quotes with which a text begins, with both signs, in bytes; `None` if it begins with none.
/// One without an end reaches to the end of the text.
fn quoted_length(text: &str) -> Option<usize> {
    let first = text.chars().next();
    let sign = first.filter(|first| matches!(first, '"' | '\'' | '`'))?;

    // It ends with the sign that began it; the other signs of quotation are a part of it.
    let mut is_escaped = false;
    let is_end = |c: char| {
        let ends = c == sign && !is_escaped;
        // In the language of `rhai` a backslash between backquotes is a character like all others.
        is_escaped = c == '\\' && !is_escaped && sign != '`';
        ends
    };

    // All three signs have one byte.
    let end = text[1..].find(is_end);
    Some(end.map_or(text.len(), |at| at + 2))
}

/// Returns an expression with the signs `&&` and `||` for the words `and` and `or`, which queries have, too. Texts in quotes
/// stay, and so do the positions of all other characters, which errors name.
fn with_signs(text: &str) -> String {
    // All letters count, those that names cannot have, too: `and` beside one of them is no word of its own.
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut signs = String::with_capacity(text.len());
    let mut rest = text;

    while let Some(first) = rest.chars().next() {
        // A text in quotes or a word as far as it goes, otherwise a single sign.
        let length = quoted_length(rest)
            .or_else(|| rest.find(|c| !is_of_name(c)))
            .unwrap_or(rest.len());
        let (word, after) = rest.split_at(length.max(first.len_utf8()));
        signs.push_str(match word {
            // A blank makes the sign as long as the word, so that places in error messages stay right.
            "and" => "&& ",
            "or" => "||",
            word => word,
        });
        rest = after;
    }
    signs
}

/// Returns a value as text.
#[must_use]
pub fn shown(value: &Dynamic) -> String {
    match value.as_float() {
        Ok(number) => format!("{number:.6}"),
        Err(_) if value.is_unit() => "none".to_owned(),
        Err(_) => value.to_string(),
    }
}

fn radii(units: impl Into<f64>) -> f64 {
    units.into() / f64::from(R)
}

fn maybe<T: Into<Dynamic>>(value: Option<T>) -> Dynamic {
    value.map_or(Dynamic::UNIT, Into::into)
}

fn sample(id: u32) -> Option<i64> {
    (id != NONE).then_some(i64::from(id))
}

/// Registers the functions that [`Evaluator`] lists. A number that is no sample's id gives `()` instead of an error.
/// Lessons evaluate one expression for many samples in turn, and an error at one of them would end the evaluation for
/// all.
fn register(engine: &mut Engine, recording: &Arc<Recording>) {
    // A number that cannot be an id becomes `NONE`, which no sample has.
    let id = |s: i64| u32::try_from(s).unwrap_or(NONE);

    let run = Arc::clone(recording);
    engine.register_fn("x_of", move |s: i64| {
        maybe(run.point(id(s)).map(|p| radii(p.x)))
    });

    let run = Arc::clone(recording);
    engine.register_fn("y_of", move |s: i64| {
        maybe(run.point(id(s)).map(|p| radii(p.y)))
    });

    let run = Arc::clone(recording);
    engine.register_fn("distance", move |s: i64, t: i64| {
        maybe(distance(&run, id(s), id(t)))
    });

    let run = Arc::clone(recording);
    engine.register_fn("block_of", move |s: i64| {
        // A sample belongs to the block of the event that tiled or inserted it.
        let birth = run
            .life(id(s))
            .and_then(|life| run.event(life.born as usize));
        maybe(birth.and_then(|event| block(&run, event)).map(i64::from))
    });
}

/// Returns everything in [`NAMES`] as it is at a state.
fn scope(recording: &Recording, state: &State) -> Scope<'static> {
    let mut scope = Scope::new();
    event_scope(recording, state, &mut scope);

    let (context, counts) = (state.context(), state.counts());
    let mut put = |name: &'static str, value: Dynamic| {
        scope.push_constant_dynamic(name, value);
    };

    put("phase", maybe(context.phase.map(|phase| phase.to_string())));
    put("iteration", i64::from(context.iteration).into());
    put("p", maybe(context.sample.map(i64::from)));

    let at = context.sample.and_then(|sample| recording.point(sample));
    put("x", maybe(at.map(|p| radii(p.x))));
    put("y", maybe(at.map(|p| radii(p.y))));

    put("conflict_point", maybe(context.other.map(i64::from)));
    put(
        "search_radius",
        maybe(context.search.map(|search| radii(search.radius))),
    );
    put(
        "buffer_size",
        maybe(context.search.map(|search| i64::from(search.found))),
    );

    // The detector is one of a candidate's sites; m and n are the names of the other two in Algorithm 3.
    let [m, n] = context
        .examined
        .map_or([NONE; 2], |examined| others(&examined));
    put("m", maybe(sample(m)));
    put("n", maybe(sample(n)));

    for (name, count) in [
        ("undecided", counts.undecided),
        ("kept", counts.kept),
        ("eliminated", counts.eliminated),
        ("inserted", counts.inserted),
    ] {
        put(name, (count as i64).into());
    }

    scope
}

/// Puts the names of the event about to happen into scope: the first [`NAMES_OF_NEXT`] of [`NAMES`].
fn event_scope(recording: &Recording, state: &State, scope: &mut Scope<'static>) {
    let event = recording.event(state.cursor());
    let lines = crate::listing::Listings::shipped();

    let mut put = |name: &'static str, value: Dynamic| {
        scope.push_constant_dynamic(name, value);
    };

    // The event at the cursor is about to happen. Users count events from 1.
    put("event", (state.cursor() as i64 + 1).into());

    // At the end of a run no event is about to happen: the names below then have no value.
    put("kind", maybe(event.map(|event| event.kind().name())));
    let line = event.and_then(|event| lines.line(event.line()));
    put("line", maybe(line.map(|line| line.id.clone())));
    put("depth", maybe(event.map(|event| i64::from(event.depth()))));
    put(
        "block",
        maybe(
            event
                .and_then(|event| block(recording, event))
                .map(i64::from),
        ),
    );
    put("verdict", maybe(event.and_then(verdict_name)));

    // Of the four samples that an event may name, expressions have the first two.
    let [a, b, ..] = event.map_or([NONE; 4], crate::event::Event::samples);
    put("a", maybe(sample(a)));
    put("b", maybe(sample(b)));
    put("distance", maybe(distance(recording, a, b)));

    let point = event.and_then(|event| recording.event_point(event));
    put("place_x", maybe(point.map(|p| radii(p.x))));
    put("place_y", maybe(point.map(|p| radii(p.y))));
    let height = event.and_then(|event| recording.event_height(event));
    put("place_z", maybe(height.map(radii)));
}

fn others(examined: &crate::context::Examined) -> [u32; 2] {
    let mut others = examined.sites.ids().iter().copied();
    let mut next = || others.find(|&id| id != examined.detector).unwrap_or(NONE);
    [next(), next()]
}

#[cfg(test)]
mod tests {
    use super::with_signs;

    #[test]
    fn words_join_conditions_as_signs_do() {
        for (text, signs) in [
            ("a == 1 and b == 2", "a == 1 &&  b == 2"),
            ("a or b", "a || b"),
            ("operand and_more", "operand and_more"),
            (
                "kind == \"this and that\" and p",
                "kind == \"this and that\" &&  p",
            ),
            ("`so and so` or 'x' and p", "`so and so` || 'x' &&  p"),
            ("\"it's\" and p", "\"it's\" &&  p"),
            // A backslash escapes the sign behind it, but not between backquotes.
            (r#""a\" and b" and c"#, r#""a\" and b" &&  c"#),
            (r#""a\\" and b"#, r#""a\\" &&  b"#),
            (r"`a\` and b", r"`a\` &&  b"),
            ("\"without an end and p", "\"without an end and p"),
            ("a && b", "a && b"),
            ("\u{e4}nd and \u{e4}", "\u{e4}nd &&  \u{e4}"),
        ] {
            assert_eq!(with_signs(text), signs);
        }
    }
}
