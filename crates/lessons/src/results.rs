//! The results of a learner, which stay on the learner's machine: an entry for each question, exported as CSV and as xAPI
//! statements. Keys are computed on the same machine, so a learner can fake results: they are no proof for a grade.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The result of one question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The lesson's name.
    pub lesson: String,
    /// The hash of the lesson's file.
    pub hash: String,
    /// The question's name.
    pub gate: String,
    /// The seed of its run.
    pub seed: u64,
    /// Whether the seed was drawn for practice.
    pub practised: bool,
    /// The first answer.
    pub answer: String,
    /// The score of the first answer, from 0 to 1.
    pub score: f64,
    /// How many answers were given.
    pub tries: u32,
    /// How many hints were asked for.
    pub hints: u32,
    /// Whether the learner gave up.
    pub given_up: bool,
    /// How sure the learner was, from 0 to 3, if they chose it.
    pub confidence: Option<u8>,
    /// Seconds from the question to its end.
    pub seconds: f64,
    /// When it ended, in seconds since 1970.
    pub time: f64,
}

/// The results of a learner, as they are stored and saved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// The version of the format: 1.
    pub version: u32,
    /// The learner's name, if they gave one.
    #[serde(default)]
    pub learner: String,
    /// When the results were cleared last, in seconds since 1970, if they ever were. Entries that are not newer are gone,
    /// also where another window still has them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cleared: Option<f64>,
    /// The entries, oldest first.
    pub entries: Vec<Entry>,
}

/// Why results cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The file is too large.
    #[error("the file has {0} bytes; results have at most {MAX_BYTES}")]
    TooLong(usize),
    /// It is not JSON, or not of this form.
    #[error("these are not results of lessons: {0}")]
    Corrupt(#[from] serde_json::Error),
    /// A newer version.
    #[error("the results have version {0}; this program reads version {VERSION}")]
    Newer(u32),
}

/// The version of results that this program writes.
pub const VERSION: u32 = 1;
/// The most bytes of a results file.
pub const MAX_BYTES: usize = 16_000_000;
/// The most entries that are kept; of more, the newest.
pub const MAX_ENTRIES: usize = 10_000;

const COLUMNS: &str = "learner,lesson,hash,gate,seed,practised,answer,score,tries,hints,given_up,confidence,seconds,time";

impl Results {
    /// Reads results.
    pub fn read(text: &str) -> Result<Self, ResultsError> {
        if text.len() > MAX_BYTES {
            return Err(ResultsError::TooLong(text.len()));
        }
        let read: Self = tilescope_core::json::from_text(text)?;
        if read.version > VERSION {
            return Err(ResultsError::Newer(read.version));
        }
        Ok(read)
    }

    /// Returns the results as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Adds entries. Only the newest [`MAX_ENTRIES`] are kept.
    pub fn add(&mut self, entries: impl IntoIterator<Item = Entry>) {
        self.version = VERSION;
        self.entries.extend(entries);
        let over = self.entries.len().saturating_sub(MAX_ENTRIES);
        self.entries.drain(..over);
    }

    /// Takes the entries of results that were kept elsewhere, such as by another window: each entry once, in the order of
    /// their times. What was cleared in either place is gone. The learner's name stays, unless there is none.
    pub fn merge(&mut self, other: &Self) {
        for entry in &other.entries {
            if !self.entries.contains(entry) {
                self.entries.push(entry.clone());
            }
        }
        let cleared = [self.cleared, other.cleared].into_iter().flatten();
        self.cleared = cleared.reduce(f64::max);
        if let Some(cleared) = self.cleared {
            self.entries.retain(|entry| entry.time > cleared);
        }

        // The sort is stable: entries of one time keep their order.
        self.entries.sort_by(|a, b| a.time.total_cmp(&b.time));
        if self.learner.is_empty() {
            self.learner.clone_from(&other.learner);
        }
        self.add([]);
    }

    /// Removes all entries. `now` is the time in seconds since 1970.
    pub fn clear(&mut self, now: f64) {
        // An entry of this very moment, or of a clock that was ahead, must not come back by a merge.
        let newest = self.entries.iter().map(|entry| entry.time);
        self.cleared = Some(newest.fold(now, f64::max));
        self.entries.clear();
    }

    /// Returns the mean score, from 0 to 1; 0 if there are no entries.
    #[must_use]
    pub fn share(&self) -> f64 {
        let sum: f64 = self.entries.iter().map(|entry| entry.score).sum();
        sum / (self.entries.len().max(1)) as f64
    }

    /// Returns the best score of a question, practised or not, and how often it was done; `None` if it never was.
    #[must_use]
    pub fn of_gate(&self, lesson: &str, gate: &str) -> Option<(f64, usize)> {
        let is_it = |entry: &&Entry| entry.lesson == lesson && entry.gate == gate;
        self.entries.iter().filter(is_it).fold(None, |best, entry| {
            let (score, times) = best.unwrap_or((0.0, 0));
            Some((f64::max(score, entry.score), times + 1))
        })
    }

    /// Returns xAPI statements, one for each entry.
    #[must_use]
    pub fn xapi(&self) -> Value {
        let name = match self.learner.as_str() {
            "" => "anonymous",
            name => name,
        };
        let statement = |entry: &Entry| {
            json!({
                "actor": {"objectType": "Agent", "account": {"homePage": "urn:tilescope", "name": name}},
                "verb": {"id": "http://adlnet.gov/expapi/verbs/answered", "display": {"en": "answered"}},
                "object": {
                    "id": format!("urn:tilescope:lesson:{}:{}", entry.lesson, entry.gate),
                    "definition": {"type": "http://adlnet.gov/expapi/activities/cmi.interaction"},
                },
                "result": {
                    "score": {"scaled": entry.score},
                    "success": entry.score > 0.999,
                    "completion": !entry.given_up,
                    "response": entry.answer,
                    "duration": format!("PT{:.1}S", entry.seconds),
                    "extensions": {
                        "urn:tilescope:tries": entry.tries, "urn:tilescope:hints": entry.hints,
                        "urn:tilescope:seed": entry.seed, "urn:tilescope:hash": entry.hash,
                    },
                },
                "timestamp": timestamp(entry.time),
            })
        };
        self.entries.iter().map(statement).collect()
    }
}

/// Returns the entries of several learners as CSV, with a heading.
///
/// # Errors
///
/// None that a text in memory can cause.
pub fn csv(all: &[Results]) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS.split(','))?;
    let yes_or_no = |is_so: bool| if is_so { "yes" } else { "no" };
    for results in all {
        for entry in &results.entries {
            let confidence = entry.confidence.map(|sure| sure.to_string());
            writer.write_record([
                results.learner.as_str(),
                &entry.lesson,
                &entry.hash,
                &entry.gate,
                &entry.seed.to_string(),
                yes_or_no(entry.practised),
                &entry.answer,
                &format!("{:.3}", entry.score),
                &entry.tries.to_string(),
                &entry.hints.to_string(),
                yes_or_no(entry.given_up),
                &confidence.unwrap_or_default(),
                &format!("{:.1}", entry.seconds),
                &timestamp(entry.time),
            ])?;
        }
    }
    let bytes = writer.into_inner();
    let bytes = bytes.map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns a time in seconds since 1970 in the form of ISO 8601, in UTC.
fn timestamp(time: f64) -> String {
    // Nobody took a lesson before 1970 or after the year 9999.
    let time = jiff::Timestamp::from_second(time.clamp(0.0, 253_402_300_000.0) as i64);
    time.map_or_else(|_| String::new(), |time| time.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry() -> Entry {
        Entry {
            lesson: "gaps".to_owned(),
            hash: "00".to_owned(),
            gate: "first".to_owned(),
            seed: 3,
            practised: true,
            answer: "1, \"2\"".to_owned(),
            score: 0.5,
            tries: 2,
            hints: 1,
            given_up: false,
            confidence: Some(2),
            seconds: 12.25,
            time: 86_400.0,
        }
    }

    #[test]
    fn results_are_written_and_read() {
        let mut results = Results {
            learner: "Ada".to_owned(),
            ..Results::default()
        };
        results.add([
            entry(),
            Entry {
                score: 1.0,
                ..entry()
            },
        ]);
        assert_eq!(Results::read(&results.to_json()).unwrap(), results);
        let marked = format!("\u{FEFF}{}", results.to_json());
        assert_eq!(Results::read(&marked).unwrap(), results);
        assert_eq!(results.of_gate("gaps", "first"), Some((1.0, 2)));
        assert_eq!(results.of_gate("gaps", "other"), None);
        let text = csv(&[results.clone()]).unwrap();
        assert_eq!(text.lines().count(), 3);
        assert!(
            text.contains("Ada,gaps,00,first,3,yes,\"1, \"\"2\"\"\",0.500,2,1,no,2,12."),
            "{text}"
        );
        assert!(text.contains("1970-01-02T00:00:00Z"), "{text}");
        let statements = results.xapi();
        assert_eq!(statements[0]["result"]["score"]["scaled"], 0.5);
        assert_eq!(statements[1]["result"]["success"], true);
        assert_eq!(statements[0]["result"]["duration"], "PT12.2S");
        assert!(matches!(
            Results::read("{\"version\":9,\"entries\":[]}"),
            Err(ResultsError::Newer(9))
        ));
        assert!(Results::read("[]").is_err());
    }

    fn at(time: f64) -> Entry {
        Entry { time, ..entry() }
    }

    fn times(results: &Results) -> Vec<f64> {
        results.entries.iter().map(|entry| entry.time).collect()
    }

    #[test]
    fn results_of_two_windows_are_merged_each_entry_once() {
        let mut one = Results::default();
        one.add([at(1.0), at(4.0)]);
        let mut two = Results {
            learner: "Ada".to_owned(),
            ..Results::default()
        };
        two.add([at(1.0), at(2.0), at(8.0)]);
        one.merge(&two);
        assert_eq!(times(&one), [1.0, 2.0, 4.0, 8.0]);
        assert_eq!(one.learner, "Ada");
        let before = one.clone();
        one.merge(&two);
        assert_eq!(one, before);
        // Another question that was answered at the same time is another entry.
        let mut third = Results::default();
        third.add([Entry {
            seed: 99,
            ..at(4.0)
        }]);
        one.merge(&third);
        assert_eq!(times(&one), [1.0, 2.0, 4.0, 4.0, 8.0]);
    }

    #[test]
    fn what_was_cleared_does_not_come_back_from_another_window() {
        let mut one = Results::default();
        one.add([at(1.0), at(2.0)]);
        let mut two = one.clone();
        one.clear(3.0);
        two.add([at(4.0)]);
        one.merge(&two);
        assert_eq!(times(&one), [4.0]);
        two.merge(&one);
        assert_eq!(times(&two), [4.0]);
        assert_eq!(Results::read(&two.to_json()).unwrap(), two);
        // The clock was ahead when the entry was made.
        let mut ahead = Results::default();
        ahead.add([at(90.0)]);
        let old = ahead.clone();
        ahead.clear(3.0);
        ahead.merge(&old);
        assert!(ahead.entries.is_empty());
    }

    #[test]
    fn only_the_newest_are_kept() {
        let mut results = Results::default();
        results.add((0..MAX_ENTRIES as u64 + 5).map(|seed| Entry { seed, ..entry() }));
        assert_eq!(
            (results.entries.len(), results.entries[0].seed),
            (MAX_ENTRIES, 5)
        );
    }
}
