//! The results of a learner, which stay on the learner's machine: an entry for each question, exported as CSV and as xAPI
//! statements. Keys are computed on the same machine, so a learner can fake results: they are no proof for a grade.

use std::collections::HashSet;
use std::ops::RangeInclusive;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha1_smol::Sha1;
use tilescope_analysis::{BYTE_ORDER_MARK, Number, cell};

use crate::inventory::{Concept, TestForm};

/// The result of one question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The name of the lesson.
    pub lesson: String,
    /// The hash of the lesson's file.
    pub hash: String,
    /// The name of the question.
    pub gate: String,
    /// The form of the concept inventory, if the lesson is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<TestForm>,
    /// The concept that the question is about, if it names one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub concept: Option<Concept>,
    /// The seed of its run.
    pub seed: u64,
    /// Whether the seed was drawn for practice.
    pub practised: bool,
    /// The first answer in words.
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
    /// The votes of classes on the questions of forms, in the order of the talks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub votes: Vec<ClassVote>,
}

/// The vote of a class on a question of a form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassVote {
    /// The name of the form's lesson.
    pub lesson: String,
    /// Which form it is.
    pub form: TestForm,
    /// The concept of the question.
    pub concept: Concept,
    /// The share of right answers, from 0 to 1.
    pub share: f64,
    /// How many voted; none if the share was estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// When the class voted, in seconds since 1970.
    pub time: f64,
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
    /// They were written by a newer version.
    #[error("the results have version {0}; this program reads version {VERSION}")]
    Newer(u32),
    /// A number that no answer has.
    #[error("{what} {number}: {field} is {}; it is from {} to {}", Number(*.value), Number(*.limits.start()), Number(*.limits.end()))]
    Range {
        /// The thing that has the number: an entry or a vote.
        what: &'static str,
        /// Its number, from 1.
        number: usize,
        /// The name of the field.
        field: &'static str,
        /// The value that is out of range.
        value: f64,
        /// The least and the largest value.
        limits: RangeInclusive<f64>,
    },
}

/// The version of results that this program writes.
pub const VERSION: u32 = 1;
/// The most bytes of a results file. Chosen, not measured.
pub const MAX_BYTES: usize = 16_000_000;
/// The most entries that are kept; of more, the newest. Chosen, not measured.
pub const MAX_ENTRIES: usize = 10_000;

/// The longest time of a question in seconds: a window may stay open on it for years.
const MAX_SECONDS: f64 = 1e9;
/// The last second of the year 9999, in seconds since 1970: times of four-digit years can be written.
const MAX_TIME: f64 = 253_402_300_799.0;

/// The columns of the CSV. The form and the concept of an entry have none: `gain.rs` has the table by concept.
const COLUMNS: &str = "learner,lesson,hash,gate,seed,practised,answer,score,tries,hints,given_up,confidence,seconds,time";

impl Entry {
    /// Refuses numbers that no answer has. `entry` is the entry's number, for the message.
    fn check(&self, entry: usize) -> Result<(), ResultsError> {
        let sure = self.confidence.map_or(0.0, f64::from);
        for (field, value, limits) in [
            ("score", self.score, 0.0..=1.0),
            ("confidence", sure, 0.0..=3.0),
            ("seconds", self.seconds, 0.0..=MAX_SECONDS),
            ("time", self.time, 0.0..=MAX_TIME),
        ] {
            within("entry", entry, field, value, limits)?;
        }
        Ok(())
    }
}

impl ClassVote {
    /// Refuses numbers that no vote has. `vote` is the vote's number, for the message.
    fn check(&self, vote: usize) -> Result<(), ResultsError> {
        within("vote", vote, "share", self.share, 0.0..=1.0)?;
        within("vote", vote, "time", self.time, 0.0..=MAX_TIME)
    }
}

/// Refuses the value of a field that is out of its limits; `what` and `number` say where it is.
fn within(
    what: &'static str,
    number: usize,
    field: &'static str,
    value: f64,
    limits: RangeInclusive<f64>,
) -> Result<(), ResultsError> {
    if limits.contains(&value) {
        return Ok(());
    }
    Err(ResultsError::Range {
        what,
        number,
        field,
        value,
        limits,
    })
}

impl Results {
    /// Reads results.
    ///
    /// # Errors
    ///
    /// A file that is too large, of another form or of a newer version, and an entry or a vote with a number out of its
    /// range.
    pub fn read(text: &str) -> Result<Self, ResultsError> {
        // A file may come from anywhere, so that its length is limited.
        if text.len() > MAX_BYTES {
            return Err(ResultsError::TooLong(text.len()));
        }

        let read: Self = tilescope_core::json::from_text(text)?;
        // In a newer version the same fields may have another meaning.
        if read.version > VERSION {
            return Err(ResultsError::Newer(read.version));
        }

        // Errors count entries and votes from 1.
        for (number, entry) in (1..).zip(&read.entries) {
            entry.check(number)?;
        }

        for (number, vote) in (1..).zip(&read.votes) {
            vote.check(number)?;
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

    /// Takes the entries and votes of results that were kept elsewhere, such as by another window, each once; entries are in the
    /// order of their times. Results that were cleared in either place are gone. The learner's name stays, unless there is none.
    pub fn merge(&mut self, other: &Self) {
        // Both lists are of one learner. Entries are compared without the name, which one of the lists may lack.
        let own = self.entries.iter();
        let mut seen = own.map(|entry| id("", entry)).collect();
        self.take_unseen(&other.entries, "", &mut seen);

        for vote in &other.votes {
            if !self.votes.contains(vote) {
                self.votes.push(vote.clone());
            }
        }

        // The later clearing includes the earlier one.
        let cleared = [self.cleared, other.cleared].into_iter().flatten();
        self.cleared = cleared.reduce(f64::max);
        if let Some(cleared) = self.cleared {
            self.entries.retain(|entry| entry.time > cleared);
            self.votes.retain(|vote| vote.time > cleared);
        }

        if self.learner.is_empty() {
            self.learner.clone_from(&other.learner);
        }

        // Two full lists together may be longer than the limit, above which `add` drops the oldest entries.
        self.add([]);
    }

    /// Adds entries of a learner that are not among those seen, each once, and sorts all by their times. Entries are
    /// equal if everything in them is: `seen` has what `id` gives for each entry and its learner. Returns how many were
    /// left out.
    fn take_unseen(
        &mut self,
        entries: &[Entry],
        learner: &str,
        seen: &mut HashSet<String>,
    ) -> usize {
        let before = self.entries.len();
        let unseen = entries
            .iter()
            .filter(|entry| seen.insert(id(learner, entry)));
        self.entries.extend(unseen.cloned());
        let added = self.entries.len() - before;

        // The sort is stable: entries of one time keep their order.
        self.entries.sort_by(|a, b| a.time.total_cmp(&b.time));
        entries.len() - added
    }

    /// Removes all entries and votes. `now` is the time in seconds since 1970.
    pub fn clear(&mut self, now: f64) {
        // An entry of this very moment, or of a clock that was ahead, must not come back by a merge.
        let entries = self.entries.iter().map(|entry| entry.time);
        let times = entries.chain(self.votes.iter().map(|vote| vote.time));
        self.cleared = Some(times.fold(now, f64::max));
        self.entries.clear();
        self.votes.clear();
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

    /// Returns xAPI statements, one for each entry. Equal entries of one learner have equal ids, so that a store of
    /// statements takes each of them once, however often it is sent.
    #[must_use]
    pub fn xapi(&self) -> Value {
        // A statement needs an actor with a name.
        let name = match self.learner.as_str() {
            "" => "anonymous",
            name => name,
        };

        let statement = |entry: &Entry| {
            json!({
                "id": id(name, entry),
                "actor": {"objectType": "Agent", "account": {"homePage": HOME_PAGE, "name": name}},
                "verb": {"id": "http://adlnet.gov/expapi/verbs/answered", "display": {"en": "answered"}},
                "object": {
                    "id": format!("urn:tilescope:lesson:{}:{}", in_iri(&entry.lesson), in_iri(&entry.gate)),
                    "definition": {"type": "http://adlnet.gov/expapi/activities/cmi.interaction"},
                },
                "result": {
                    "score": {"scaled": entry.score},
                    // A success is the full score, which as a sum of rounded fractions may be a little below 1.
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

/// The system in which learners have their names, as xAPI asks: an address of the web.
const HOME_PAGE: &str = env!("CARGO_PKG_REPOSITORY");

/// Returns the id of a statement, which follows from everything that the statement says.
fn id(learner: &str, entry: &Entry) -> String {
    let said = json!([learner, entry]);
    // The namespace of names that are addresses of the web (RFC 9562, section 6.6).
    name_based_uuid(
        0x6ba7_b811_9dad_11d1_80b4_00c0_4fd4_30c8,
        &format!("{HOME_PAGE}#{said}"),
    )
}

/// Returns the UUID of version 5 of a name: the first 128 bits of the SHA-1 of namespace and name, six of which are
/// replaced by version and variant (RFC 9562, section 5.5).
fn name_based_uuid(namespace: u128, name: &str) -> String {
    let mut hash = Sha1::from(namespace.to_be_bytes());
    hash.update(name.as_bytes());
    let digest = hash.digest().bytes();

    let mut bytes = [0; 16];
    bytes.copy_from_slice(&digest[..16]);
    // Version 5, and the variant of that RFC.
    bytes[6] = bytes[6] & 0x0f | 0x50;
    bytes[8] = bytes[8] & 0x3f | 0x80;

    let hex = format!("{:032x}", u128::from_be_bytes(bytes));
    [
        &hex[..8],
        &hex[8..12],
        &hex[12..16],
        &hex[16..20],
        &hex[20..],
    ]
    .join("-")
}

/// Returns a word as a part of an identifier, in which a blank or a colon would end or divide it.
fn in_iri(word: &str) -> String {
    const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.');
    utf8_percent_encode(word, ESCAPED).to_string()
}

/// Results of several files, each entry once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Merged {
    /// The results of each learner, in the sequence of the files; a file without a name is a learner of its own.
    pub all: Vec<Results>,
    /// The votes of classes, each once.
    pub votes: Vec<ClassVote>,
    /// How many entries were left out because an equal one of the same learner came before.
    pub repeated: usize,
}

impl Merged {
    /// Merges files, each with the name that a learner without a name is to have. Entries are equal if everything in
    /// them is, the time included: a file that was handed in twice counts once, and so does an older one of a learner
    /// whose newer one has the same entries.
    #[must_use]
    pub fn of(files: impl IntoIterator<Item = (String, Results)>) -> Self {
        let mut merged = Self::default();
        let mut seen = HashSet::new();
        for (name, results) in files {
            let is_named = !results.learner.is_empty();

            // Files without a learner's name may be of different people, and are kept apart.
            let others = merged.all.iter();
            let known = others
                .filter(|_| is_named)
                .position(|other| other.learner == results.learner);
            let at = known.unwrap_or_else(|| {
                merged.all.push(Results {
                    learner: if is_named {
                        results.learner.clone()
                    } else {
                        name
                    },
                    version: results.version,
                    ..Results::default()
                });
                merged.all.len() - 1
            });

            // Entries are compared together with the name inside the file. A name that is given to a learner without
            // one would differ between two copies of a file, and their entries would count twice.
            let into = &mut merged.all[at];
            merged.repeated += into.take_unseen(&results.entries, &results.learner, &mut seen);
            for vote in results.votes {
                if !merged.votes.contains(&vote) {
                    merged.votes.push(vote);
                }
            }
        }
        merged
    }

    /// Returns how many learners have entries.
    #[must_use]
    pub fn learners(&self) -> usize {
        let with_entries = self.all.iter().filter(|one| !one.entries.is_empty());
        let names: HashSet<&str> = with_entries.map(|one| one.learner.as_str()).collect();
        names.len()
    }
}

/// Returns the entries of several learners as CSV, with a heading, to be opened in a spreadsheet: it begins with a
/// byte-order mark, and no text of it is a formula. Forms, concepts and votes are left to the table of gains.
///
/// # Errors
///
/// None that a text in memory can cause.
pub fn csv(all: &[Results]) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(BYTE_ORDER_MARK.to_string().into_bytes());
    writer.write_record(COLUMNS.split(','))?;

    let yes_or_no = |is_so: bool| if is_so { "yes" } else { "no" };
    for results in all {
        for entry in &results.entries {
            // Its cell is empty if the learner chose none.
            let confidence = entry.confidence.map(|sure| sure.to_string());

            // `cell` keeps a spreadsheet from reading a text as a formula.
            writer.write_record([
                cell(&results.learner).as_ref(),
                &cell(&entry.lesson),
                &cell(&entry.hash),
                &cell(&entry.gate),
                &entry.seed.to_string(),
                yes_or_no(entry.practised),
                &cell(&entry.answer),
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

    let bytes = writer
        .into_inner()
        .map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns a time in seconds since 1970 in the form of ISO 8601, in UTC.
fn timestamp(time: f64) -> String {
    let time = jiff::Timestamp::from_second(time.clamp(0.0, MAX_TIME) as i64);
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
            form: None,
            concept: None,
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

    fn of(learner: &str, entries: &[Entry]) -> Results {
        Results {
            learner: learner.to_owned(),
            entries: entries.to_vec(),
            ..Results::default()
        }
    }

    #[test]
    fn tables_are_safe_and_readable_in_spreadsheets() {
        let words = Entry {
            answer: "+1+cmd|' /C calc'!A0".to_owned(),
            gate: "@gate".to_owned(),
            lesson: "-lesson".to_owned(),
            hash: "=hash".to_owned(),
            ..entry()
        };
        let number = Entry {
            answer: "-0.5".to_owned(),
            ..entry()
        };
        let text = csv(&[of("=HYPERLINK(\"x\")", &[words, number])]).unwrap();
        let table = text.strip_prefix('\u{feff}').expect("a byte-order mark");
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let rows: Vec<_> = reader.records().collect::<Result<_, _>>().unwrap();

        for row in &rows {
            for cell in row {
                let is_number = cell.parse::<f64>().is_ok();
                assert!(
                    is_number || !cell.starts_with(['=', '+', '-', '@']),
                    "{cell}"
                );
            }
        }
        assert_eq!(&rows[0][0], "'=HYPERLINK(\"x\")");
        assert_eq!(&rows[1][6], "-0.5", "numbers stay numbers");
    }

    #[test]
    fn what_is_given_twice_counts_once() {
        let file = |name: &str, results: Results| (name.to_owned(), results);
        let later = Entry {
            time: 86_401.0,
            ..entry()
        };
        let newer = of("Ada", &[entry(), later]);
        let older = of("Ada", &[entry()]);
        let merged = Merged::of([file("a", older), file("b", newer.clone()), file("c", newer)]);
        let entries: usize = merged.all.iter().map(|one| one.entries.len()).sum();
        assert_eq!((entries, merged.repeated, merged.learners()), (2, 3, 1));

        // Copies of a file without a name are the same results, and another learner's answers are others.
        let files = [("a", ""), ("copy", ""), ("b", "Bob")];
        let merged = Merged::of(files.map(|(name, learner)| file(name, of(learner, &[entry()]))));
        assert_eq!((merged.repeated, merged.learners()), (1, 2));
        assert_eq!(merged.all[0].learner, "a");
    }

    #[test]
    fn statements_have_ids_that_follow_from_what_they_say() {
        let id = |learner: &str, entry: Entry| of(learner, &[entry]).xapi()[0]["id"].clone();
        let first = id("Ada", entry());
        assert_eq!(first, id("Ada", entry()));
        // The example of RFC 9562, appendix A.4, in the namespace of domain names.
        assert_eq!(
            name_based_uuid(0x6ba7_b810_9dad_11d1_80b4_00c0_4fd4_30c8, "www.example.com"),
            "2ed6657d-e927-568b-95e1-2665a8aea6a2"
        );
        let later = Entry {
            time: 86_400.5,
            ..entry()
        };
        assert!(first != id("Bob", entry()) && first != id("Ada", later));

        let odd = Entry {
            lesson: "my lesson:1".to_owned(),
            ..entry()
        };
        let statement = of("Ada", &[odd]).xapi()[0].clone();
        assert_eq!(
            statement["object"]["id"],
            "urn:tilescope:lesson:my%20lesson%3A1:first"
        );
        let home = statement["actor"]["account"]["homePage"].as_str().unwrap();
        assert!(home.starts_with("https://"), "{home}");
    }

    #[test]
    fn numbers_that_no_answer_has_are_refused() {
        type Change = fn(&mut Entry);
        let read = |change: Change| {
            let mut changed = entry();
            change(&mut changed);
            Results::read(&of("Ada", &[entry(), changed]).to_json())
        };
        let changes: [(&str, Change); 7] = [
            ("score is 1e300", |entry| entry.score = 1e300),
            ("score is -0.1", |entry| entry.score = -0.1),
            ("seconds is -1e300", |entry| entry.seconds = -1e300),
            ("seconds is 1e300", |entry| entry.seconds = 1e300),
            ("confidence is 255", |entry| entry.confidence = Some(255)),
            ("time is -1", |entry| entry.time = -1.0),
            ("time is 1e300", |entry| entry.time = 1e300),
        ];
        for (part, change) in changes {
            let error = read(change).unwrap_err().to_string();
            assert!(
                error.starts_with("entry 2: ") && error.contains(part),
                "{error}"
            );
        }
        assert!(read(|entry| entry.score = 1.0).is_ok());
        assert!(read(|entry| entry.confidence = Some(3)).is_ok());
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
