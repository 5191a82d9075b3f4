//! The fields of a directive: lines of the form `key: value`. A line that begins with two spaces continues the line before
//! it. `read.rs` says which fields there are.

use crate::error::{LessonError, shortened};
use crate::moment::Moment;
use crate::text::{ChoiceOption, Text};

/// The most options, items or candidates of a question. Chosen, not measured.
pub const MAX_OPTIONS: usize = 8;

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
    /// The directive in words, for messages: "a choice gate".
    pub of: String,
    pub line: usize,
    pub all: Vec<Field>,
}

impl Fields {
    /// Reads the fields of a directive, which is `of` in words, from its lines: the first is line `line` + 1 of the
    /// file.
    pub fn read(of: &str, line: usize, lines: &[&str]) -> Result<Self, LessonError> {
        let mut all: Vec<Field> = Vec::new();

        for (text, number) in lines.iter().zip(line + 1..) {
            // A line that begins with # is a remark of the author.
            if text.trim().is_empty() || text.starts_with('#') {
                continue;
            }

            let wrong = |message: String| LessonError::new(number, message);
            if let Some(more) = text.strip_prefix("  ") {
                let none = "this line continues another, but there is none before it";
                let last = all.last_mut().ok_or_else(|| wrong(none.to_owned()))?;
                last.value.push(' ');
                last.value.push_str(more.trim());
                continue;
            }

            let (key, value) = text.split_once(':').ok_or_else(|| {
                let text = shortened(text);
                wrong(format!("\"{text}\" is not of the form \"key: value\""))
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

    /// Refuses unknown fields, and fields that occur twice; those in `many` may occur several times.
    pub fn only(&self, once: &[&str], many: &[&str]) -> Result<(), LessonError> {
        let known: Vec<&str> = once.iter().chain(many).copied().collect();

        for (index, Field { key, line, .. }) in self.all.iter().enumerate() {
            if !known.contains(&key.as_str()) {
                let what = format!("field of {}", self.of);
                return Err(LessonError::unknown(*line, &what, key, &known));
            }

            // Only the first of two would count, and the other would be ignored without a word.
            let before = self.all[..index].iter().any(|field| field.key == *key);
            if before && !many.contains(&key.as_str()) {
                let message = format!("{} has \"{key}\" twice", self.of);
                return Err(LessonError::new(*line, message));
            }
        }
        Ok(())
    }

    /// Reads the field of a key, if there is one.
    pub(crate) fn optional<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Field) -> Result<T, LessonError>,
    ) -> Result<Option<T>, LessonError> {
        self.get(key).map(read).transpose()
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

    /// Returns the expression of a key, which may also use the names `more`.
    pub fn need_expression(&self, key: &str, more: &[&str]) -> Result<Text, LessonError> {
        self.need(key)?.expression(more)
    }

    /// Returns the number of a key; `otherwise` if there is none.
    pub fn number_or(
        &self,
        key: &str,
        otherwise: f64,
        limits: [f64; 2],
    ) -> Result<f64, LessonError> {
        let read = self.optional(key, |field| field.number(limits))?;
        Ok(read.unwrap_or(otherwise))
    }

    /// Returns the options `TEXT when: EXPRESSION => SENTENCE`; the sentence may be missing.
    pub fn options(&self) -> Result<Vec<ChoiceOption>, LessonError> {
        let option = |field: &Field| {
            let text = |part: &str| Text::new(part.trim(), field.line);
            let (shown, Some(rest)) = field.split(" when: ") else {
                let message = "an option is of the form \"option: TEXT when: EXPRESSION => SENTENCE\"; the sentence may be left out";
                return Err(field.wrong(message));
            };
            let (when, said) = match rest.split_once("=>") {
                Some((when, said)) => (when, Some(text(said).sentence()?)),
                None => (rest, None),
            };

            Ok(ChoiceOption {
                text: text(shown).paragraph()?,
                when: text(when).expression(&[])?,
                sentence: said,
            })
        };
        // A single option would leave nothing to choose.
        let least = 2;
        self.limited("option", least, option)
    }

    /// Reads the fields of a key, at least `least` and at most [`MAX_OPTIONS`].
    pub fn limited<T>(
        &self,
        key: &str,
        least: usize,
        read: impl Fn(&Field) -> Result<T, LessonError>,
    ) -> Result<Vec<T>, LessonError> {
        let items: Vec<T> = self.many(key).map(read).collect::<Result<_, _>>()?;
        let (of, count) = (&self.of, items.len());

        if count < least || count > MAX_OPTIONS {
            let message =
                format!("{of} has from {least} to {MAX_OPTIONS} of \"{key}\", not {count}");
            return Err(LessonError::new(self.line, message));
        }

        Ok(items)
    }

    /// Returns the fields of a key that may occur several times.
    pub fn many(&self, key: &str) -> impl Iterator<Item = &Field> {
        self.all.iter().filter(move |field| field.key == key)
    }
}

impl Field {
    /// Returns the value as a number between limits.
    pub fn number(&self, limits: [f64; 2]) -> Result<f64, LessonError> {
        let [low, high] = limits;
        let Self { key, value, .. } = self;
        // Authors may write decimal commas.
        let number = value.replace(',', ".").parse::<f64>().ok();
        number.filter(|x| (low..=high).contains(x)).ok_or_else(|| {
            let value = shortened(value);
            self.wrong(format!(
                "\"{key}\" is {value}; allowed are numbers from {low} to {high}"
            ))
        })
    }

    /// Returns the value as a whole number between limits.
    pub fn whole(&self, limits: [u32; 2]) -> Result<u32, LessonError> {
        let [low, high] = limits;
        let Self { key, value, .. } = self;
        let number = value.parse::<u32>().ok();
        number.filter(|x| (low..=high).contains(x)).ok_or_else(|| {
            let value = shortened(value);
            self.wrong(format!(
                "\"{key}\" is {value}; allowed are whole numbers from {low} to {high}"
            ))
        })
    }

    /// Returns the field with a part of its value.
    pub fn part(&self, value: &str) -> Self {
        let value = value.to_owned();
        Self {
            value,
            ..self.clone()
        }
    }

    /// Returns the value as a text.
    pub fn text(&self) -> Text {
        Text::new(self.value.as_str(), self.line)
    }

    /// Returns the value as an expression, which may also use the names `more`.
    pub fn expression(&self, more: &[&str]) -> Result<Text, LessonError> {
        self.text().expression(more)
    }

    /// Returns the value as a query.
    pub fn query(&self) -> Result<Text, LessonError> {
        // One with values of the moment is read when they are known.
        if !self.value.contains('{') {
            Moment::read(&format!("after {}", self.value), self.line)?;
        }
        self.text().sentence()
    }

    /// Returns whether the value is yes.
    pub fn yes_or_no(&self) -> Result<bool, LessonError> {
        match self.value.as_str() {
            "yes" => Ok(true),
            "no" => Ok(false),
            _ => Err(self.wrong(format!("\"{}\" is yes or no", self.key))),
        }
    }

    /// Returns a fault of this field.
    pub fn wrong(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }

    /// Returns the parts of the value before and after a word; the second may be missing.
    pub fn split(&self, word: &str) -> (&str, Option<&str>) {
        match self.value.split_once(word) {
            Some((first, second)) => (first.trim(), Some(second.trim())),
            None => (self.value.as_str(), None),
        }
    }

    /// Returns the seeds of `seeds first..last`, both ends included. Refuses a range without seeds, or with more than
    /// [`MAX_SEEDS`].
    pub fn seeds(&self) -> Result<std::ops::RangeInclusive<u64>, LessonError> {
        // The word "seeds" may be left out.
        let after = self.value.strip_prefix("seeds");
        let text = after.unwrap_or(&self.value).trim();

        let read = || {
            let (first, last) = text.split_once("..")?;
            let (first, last): (u64, u64) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
            (first <= last && last - first < MAX_SEEDS).then_some(first..=last)
        };

        read().ok_or_else(|| {
            let value = shortened(&self.value);
            self.wrong(format!(
                "\"{value}\" is not of the form \"seeds 1..40\", with at most {MAX_SEEDS} seeds"
            ))
        })
    }
}

/// The most seeds of practice of a question. Chosen, not measured.
pub const MAX_SEEDS: u64 = 1_000;
