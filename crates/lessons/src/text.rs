//! Parts of a lesson file that are texts: paragraphs, expressions, options and known wrong answers, each with its line.

use crate::error::LessonError;
use crate::prose;
use crate::syntax;

/// The most bytes of a lesson file, and of a translation.
pub const MAX_BYTES: usize = 200_000;

/// A text of the file with its line: a paragraph or an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// The text as the file has it.
    pub text: String,
    /// Its line in the file, from 1.
    pub line: usize,
}

impl Text {
    pub(crate) fn new(text: impl Into<String>, line: usize) -> Self {
        let text = text.into();
        Self { text, line }
    }

    /// Returns this text as an expression that parses and uses only known names, and `more`.
    pub(crate) fn expression(self, more: &[&str]) -> Result<Self, LessonError> {
        syntax::check(&self.text, self.line, more)?;
        Ok(self)
    }

    /// Returns this text if its expressions in braces parse.
    pub(crate) fn sentence(self) -> Result<Self, LessonError> {
        syntax::check_text(&self.text, self.line)?;
        Ok(self)
    }

    /// Returns this text as a sentence that is not empty.
    pub(crate) fn paragraph(self) -> Result<Self, LessonError> {
        let checked = self.sentence()?;
        if prose::plain(&checked.text).trim().is_empty() {
            return Err(checked.wrong("the text is empty"));
        }
        Ok(checked)
    }

    /// Returns whether values of the run stand in it.
    pub(crate) fn has_value(&self) -> bool {
        self.text.contains('{')
    }

    /// Returns a fault of this text.
    pub(crate) fn wrong(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }
}

/// A known wrong answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    /// The expression of the answer, of the same kind as the key's.
    pub answer: Text,
    /// The sentence that the learner then reads.
    pub sentence: Text,
}

/// A choice: a text and when it is right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChoiceOption {
    /// The text that a learner reads.
    pub text: Text,
    /// An expression that is true if the option is right.
    pub when: Text,
    /// The sentence for a learner who chose it although it is wrong.
    pub sentence: Option<Text>,
}
