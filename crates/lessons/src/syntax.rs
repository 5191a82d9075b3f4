//! Checks expressions when a lesson is read: that they parse, and that every name and function is known.

use std::sync::LazyLock;

use rhai::Engine;
use tilescope_debugger::{MAX_LENGTH, NAMES, words};

use crate::error::LessonError;
use crate::names::{self, PROPERTIES};
use crate::prose;

/// Words of the expression language. Its functions `abs`, `min` and `max` also pass as names, which the engine
/// refuses when it evaluates the expression.
const KEYWORDS: [&str; 8] = ["true", "false", "if", "else", "in", "abs", "min", "max"];
/// Functions of the expression language that lessons may use.
const BUILT_IN: [&str; 12] = [
    "abs", "sqrt", "round", "floor", "ceiling", "to_int", "to_float", "min", "max", "is_even",
    "is_odd", "sin",
];
/// Functions of the debugger.
const OF_DEBUGGER: [&str; 4] = ["x_of", "y_of", "distance", "block_of"];

static ENGINE: LazyLock<Engine> = LazyLock::new(|| {
    let mut engine = Engine::new_raw();
    engine.disable_symbol("eval");
    // As deep as the debugger lets expressions nest.
    engine.set_max_expr_depths(32, 32);
    engine
});

/// Checks an expression; `more` names are known besides those of every expression.
pub(crate) fn check(text: &str, line: usize, more: &[&str]) -> Result<(), LessonError> {
    let length = text.chars().count();
    if length > MAX_LENGTH {
        let message = format!("the expression has {length} characters, more than {MAX_LENGTH}");
        return Err(LessonError::new(line, message));
    }

    ENGINE
        .compile_expression(text)
        .map_err(|error| LessonError::new(line, error.to_string()))?;

    let names: Vec<&str> = NAMES
        .iter()
        .map(|(name, _)| *name)
        .chain(KEYWORDS)
        .chain(more.iter().copied())
        .collect();

    // The list of functions has them with their arguments, such as `seam(x, y)`.
    let listed = names::functions().map(|(form, _)| form.split('(').next().unwrap_or(form));
    let functions: Vec<&str> = listed.chain(BUILT_IN).chain(OF_DEBUGGER).collect();

    // The engine notices a misspelt name only when it evaluates the expression, in some run; here it is found with its
    // line. Each word comes with the characters before and after it.
    for (before, word, after) in words(text) {
        // A word behind a point is a property, or a function called as a method; one before a bracket is a function.
        match (before, after) {
            (Some('.'), _) if PROPERTIES.contains(&word) || functions.contains(&word) => {}
            (Some('.'), _) => {
                return Err(LessonError::unknown(line, "property", word, &PROPERTIES));
            }
            // A keyword such as `if` may stand before a bracket, too.
            (_, Some('(')) if functions.contains(&word) || KEYWORDS.contains(&word) => {}
            (_, Some('(')) => return Err(LessonError::unknown(line, "function", word, &functions)),
            _ if names.contains(&word) => {}
            _ => return Err(LessonError::unknown(line, "name", word, &names)),
        }
    }

    Ok(())
}

/// Checks the expressions in the braces of a text.
pub(crate) fn check_text(text: &str, line: usize) -> Result<(), LessonError> {
    let expressions =
        prose::expressions(text).map_err(|message| LessonError::new(line, message))?;
    expressions
        .iter()
        .try_for_each(|expression| check(expression, line, &[]))
}
