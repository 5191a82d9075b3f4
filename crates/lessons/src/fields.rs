//! The fields of a directive: lines of the form `key: value`. A line that begins with two spaces continues the one before.

use crate::error::{LessonError, shortened};

/// A line of a directive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    pub key: String,
    pub value: String,
    pub line: usize,
}

/// The fields of a directive.
#[derive(Clone, Debug)]
pub(crate) struct Fields {
    /// What holds the fields, for messages: "a choice gate".
    pub of: String,
    pub line: usize,
    pub all: Vec<Field>,
}

impl Fields {
    /// Reads fields from lines, the first of which is line `line` + 1 of the file.
    pub fn read(of: &str, line: usize, lines: &[&str]) -> Result<Self, LessonError> {
        let mut all: Vec<Field> = Vec::new();
        for (text, number) in lines.iter().zip(line + 1..) {
            if text.trim().is_empty() || text.starts_with('#') {
                continue;
            }
            if let Some(more) = text.strip_prefix("  ") {
                let last = all.last_mut().ok_or_else(|| {
                    LessonError::new(
                        number,
                        "this line continues another, but there is none before it",
                    )
                })?;
                last.value.push(' ');
                last.value.push_str(more.trim());
                continue;
            }
            let (key, value) = text.split_once(':').ok_or_else(|| {
                let text = shortened(text);
                LessonError::new(
                    number,
                    format!("\"{text}\" is not of the form \"key: value\""),
                )
            })?;
            all.push(Field {
                key: key.trim().to_owned(),
                value: value.trim().to_owned(),
                line: number,
            });
        }
        let of = of.to_owned();
        Ok(Self { of, line, all })
    }

    /// Refuses fields that are not known, and known ones that are there twice; those in `many` may be.
    pub fn only(&self, once: &[&str], many: &[&str]) -> Result<(), LessonError> {
        let known: Vec<&str> = once.iter().chain(many).copied().collect();
        for (index, Field { key, line, .. }) in self.all.iter().enumerate() {
            if !known.contains(&key.as_str()) {
                let what = format!("field of {}", self.of);
                return Err(LessonError::unknown(*line, &what, key, &known));
            }
            let before = self.all[..index].iter().any(|field| field.key == *key);
            if before && !many.contains(&key.as_str()) {
                let message = format!("{} has \"{key}\" twice", self.of);
                return Err(LessonError::new(*line, message));
            }
        }
        Ok(())
    }

    /// Returns the field of a key, if there is one.
    pub fn get(&self, key: &str) -> Option<&Field> {
        self.all.iter().find(|field| field.key == key)
    }

    /// Returns the field of a key.
    pub fn need(&self, key: &str) -> Result<&Field, LessonError> {
        let missing = || LessonError::new(self.line, format!("{} needs \"{key}: ...\"", self.of));
        let field = self.get(key).ok_or_else(missing)?;
        if field.value.is_empty() {
            return Err(LessonError::new(field.line, format!("\"{key}\" is empty")));
        }
        Ok(field)
    }

    /// Returns the fields of a key that may be there several times.
    pub fn many(&self, key: &str) -> impl Iterator<Item = &Field> {
        self.all.iter().filter(move |field| field.key == key)
    }
}

impl Field {
    /// Returns the value as a number between limits.
    pub fn number(&self, limits: [f64; 2]) -> Result<f64, LessonError> {
        let [low, high] = limits;
        let number = self.value.replace(',', ".").parse::<f64>();
        number
            .ok()
            .filter(|x| (low..=high).contains(x))
            .ok_or_else(|| {
                let Self { key, value, .. } = self;
                let value = shortened(value);
                let message =
                    format!("\"{key}\" is {value}; allowed are numbers from {low} to {high}");
                LessonError::new(self.line, message)
            })
    }

    /// Returns the parts of the value before and after a word; the second may be missing.
    pub fn split(&self, word: &str) -> (&str, Option<&str>) {
        match self.value.split_once(word) {
            Some((first, second)) => (first.trim(), Some(second.trim())),
            None => (self.value.as_str(), None),
        }
    }

    /// Returns the number of seeds `first..last`, both included.
    pub fn seeds(&self) -> Result<std::ops::RangeInclusive<u64>, LessonError> {
        let text = self
            .value
            .strip_prefix("seeds")
            .unwrap_or(&self.value)
            .trim();
        let read = || {
            let (first, last) = text.split_once("..")?;
            let (first, last): (u64, u64) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
            (first <= last && last - first < MAX_SEEDS).then_some(first..=last)
        };
        read().ok_or_else(|| {
            let value = shortened(&self.value);
            let message = format!(
                "\"{value}\" is not of the form \"seeds 1..40\", with at most {MAX_SEEDS} seeds"
            );
            LessonError::new(self.line, message)
        })
    }
}

/// The most seeds that a gate is practised with.
pub const MAX_SEEDS: u64 = 1_000;
