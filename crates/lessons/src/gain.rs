//! Normalized gain from the form before to the form after: the share of the unknown that became known, (mean
//! after - mean before) / (1 - mean before) (Hake, "Interactive-engagement versus traditional methods", 1998). Begin with
//! [`Gains::of`].

use std::collections::{BTreeMap, BTreeSet};

use tilescope_analysis::{BYTE_ORDER_MARK, cell};
use tilescope_core::{Key, Stream, below};

use crate::inventory::{Concept, TestForm};
use crate::results::{ClassVote, Merged, Results};

/// How often learners are drawn again for an interval: 50 of the gains lie in each tail, which makes its end steady.
const RESAMPLES: u32 = 2000;
/// The share of the resampled gains below the interval, and the share above it.
const TAIL: f64 = 0.025;
/// A mean score from here on leaves nothing to be gained: means are sums of fractions, which are rounded.
const FULL: f64 = 1.0 - 1e-9;

/// A gain, and what it is computed of.
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    /// Whose gain it is: the name of a concept or of a learner, or "all" for all concepts.
    pub name: String,
    /// The number of learners with both forms; of one learner, of the questions that were answered in both; of votes, of the
    /// votes in the form after.
    pub count: usize,
    /// The mean score before, from 0 to 1.
    pub before: f64,
    /// The mean score after, from 0 to 1.
    pub after: f64,
    /// The gain; none if the form before is full, or if questions are lacking.
    pub gain: Option<f64>,
    /// The 95% interval of the gain, by drawing the learners again; none for fewer than two.
    pub interval: Option<[f64; 2]>,
    /// Whether there are answers to every question in both forms.
    pub is_complete: bool,
}

/// The gains of a class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gains {
    /// Of the class: over all concepts, then by concept. Empty if no learner has answers in both forms.
    pub class: Vec<Gain>,
    /// Of each learner who answered anything in both forms, in the sequence of the results.
    pub learners: Vec<Gain>,
    /// Of votes, which have no names: over all concepts, then by concept. Empty without votes in both forms.
    pub votes: Vec<Gain>,
}

/// The scores of one learner, or of a class's votes, before and after, by concept.
type Pairs = BTreeMap<Concept, [f64; 2]>;

impl Gains {
    /// Returns the gains of merged results. Of each learner the first answer to a question counts. The gain over all concepts
    /// is that of the learners with answers to every question in both forms.
    #[must_use]
    pub fn of(merged: &Merged) -> Self {
        let answers = merged.all.iter().flat_map(|results| &results.entries);
        // Questions of lessons have concepts, too, but only the forms are compared. A form asks one question of a
        // concept, so that its concept stands for the question.
        let asked = answers.filter_map(|entry| entry.form.and(entry.concept));
        let asked: BTreeSet<Concept> = asked.collect();

        let pairs: Vec<(&str, Pairs)> = merged
            .all
            .iter()
            .map(|results| (results.learner.as_str(), pairs_of(results)))
            // Without an answer in both forms there is nothing to compare.
            .filter(|(_, pairs)| !pairs.is_empty())
            .collect();
        Self {
            class: gains_of_class(&asked, &pairs),
            learners: pairs
                .iter()
                .map(|(name, pairs)| gain_of_learner(name, asked.len(), pairs))
                .collect(),
            votes: gains_of_votes(&merged.votes),
        }
    }

    /// Returns whether there is nothing to compare.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.learners.is_empty() && self.votes.is_empty()
    }

    /// Returns the gains as CSV, with a heading, to be opened in a spreadsheet: it begins with a byte-order mark, and no name
    /// in it is a formula. A gain is "-" where nothing could be gained, and empty where answers are lacking. `low` and
    /// `high` are the ends of its interval, empty without one.
    ///
    /// # Errors
    ///
    /// None that a text in memory can cause.
    pub fn csv(&self) -> Result<String, csv::Error> {
        let mut writer = csv::Writer::from_writer(BYTE_ORDER_MARK.to_string().into_bytes());
        writer.write_record([
            "of", "name", "count", "before", "after", "gain", "low", "high",
        ])?;

        for (of, gains) in [
            ("class", &self.class),
            ("learner", &self.learners),
            ("votes", &self.votes),
        ] {
            for gain in gains {
                let [low, high] = gain.ends();
                // `cell` keeps a spreadsheet from reading a name as a formula.
                writer.write_record([
                    of,
                    &cell(&gain.name),
                    &gain.count.to_string(),
                    &format!("{:.3}", gain.before),
                    &format!("{:.3}", gain.after),
                    &gain.shown(),
                    &low,
                    &high,
                ])?;
            }
        }

        let bytes = writer
            .into_inner()
            .map_err(|error| csv::Error::from(error.into_error()))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

impl Gain {
    /// Returns the gain with two decimals; "-" where the form before is full, and nothing where answers are lacking.
    #[must_use]
    pub fn shown(&self) -> String {
        match self.gain {
            Some(gain) => format!("{gain:.2}"),
            None if self.is_complete => "-".to_owned(),
            None => String::new(),
        }
    }

    /// Returns the ends of the interval with two decimals, empty if there is none.
    #[must_use]
    pub fn ends(&self) -> [String; 2] {
        let ends = self
            .interval
            .map(|ends| ends.map(|end| format!("{end:.2}")));
        ends.unwrap_or_default()
    }
}

/// Returns a learner's scores in the questions that were answered in both forms.
fn pairs_of(results: &Results) -> Pairs {
    // The time and the score of the first answer.
    let mut first: BTreeMap<(Concept, TestForm), (f64, f64)> = BTreeMap::new();
    for entry in &results.entries {
        // A form is not practised, unless someone has changed the file.
        let (Some(form), Some(concept), false) = (entry.form, entry.concept, entry.practised)
        else {
            continue;
        };

        let (time, score) = first
            .entry((concept, form))
            .or_insert((entry.time, entry.score));
        // Entries of a file may be in any sequence.
        if entry.time < *time {
            (*time, *score) = (entry.time, entry.score);
        }
    }

    let score = |concept, form| first.get(&(concept, form)).map(|&(_, score)| score);
    both(score)
}

/// Returns the values of the concepts that have one in both forms.
fn both(value: impl Fn(Concept, TestForm) -> Option<f64>) -> Pairs {
    let pair = |concept: Concept| {
        let [before, after] = [TestForm::Before, TestForm::After].map(|form| value(concept, form));
        Some((concept, [before?, after?]))
    };
    Concept::ALL.into_iter().filter_map(pair).collect()
}

/// Returns the mean of pairs.
fn mean(pairs: &[[f64; 2]]) -> [f64; 2] {
    let count = pairs.len().max(1) as f64;
    [0, 1].map(|form| pairs.iter().map(|pair| pair[form]).sum::<f64>() / count)
}

/// Returns the normalized gain; none if nothing could be gained.
fn normalized([before, after]: [f64; 2]) -> Option<f64> {
    (before < FULL).then(|| (after - before) / (1.0 - before))
}

/// Returns the gain of one learner, of whom the given number of questions were asked.
fn gain_of_learner(name: &str, asked: usize, pairs: &Pairs) -> Gain {
    let scores: Vec<[f64; 2]> = pairs.values().copied().collect();
    let [before, after] = mean(&scores);
    // A learner who lacks an answer has means over fewer questions than the class, so that the gains could not be
    // compared.
    let is_complete = pairs.len() == asked;

    Gain {
        name: name.to_owned(),
        count: pairs.len(),
        before,
        after,
        gain: normalized([before, after]).filter(|_| is_complete),
        interval: None,
        is_complete,
    }
}

/// Returns the gains of a class: over all concepts that were asked, then by concept.
fn gains_of_class(asked: &BTreeSet<Concept>, pairs: &[(&str, Pairs)]) -> Vec<Gain> {
    // Over all concepts only the learners with every answer count, as means over different questions cannot be compared.
    let complete = pairs.iter().filter(|(_, pairs)| pairs.len() == asked.len());
    let means = complete.map(|(_, pairs)| mean(&pairs.values().copied().collect::<Vec<_>>()));
    let all = ("all", means.collect::<Vec<_>>());

    let of_concept = |concept: &Concept| {
        let scores = pairs.iter().filter_map(|(_, pairs)| pairs.get(concept));
        (concept.name(), scores.copied().collect::<Vec<_>>())
    };

    let rows = std::iter::once(all).chain(asked.iter().map(of_concept));
    // There is no row over all concepts if no learner has every answer, nor for a concept that no learner has answered
    // in both forms.
    rows.filter(|(_, scores)| !scores.is_empty())
        .map(|(name, scores)| {
            let [before, after] = mean(&scores);
            Gain {
                name: name.to_owned(),
                count: scores.len(),
                before,
                after,
                gain: normalized([before, after]),
                interval: interval(&scores),
                // A learner is left out of each row for which an answer is lacking.
                is_complete: true,
            }
        })
        .collect()
}

/// Returns the 95% interval of the gain of learners by the bootstrap: from the learners as many are drawn with
/// replacement, and their gain is computed, [`RESAMPLES`] times. The draws are the same for every call. `None` for
/// fewer than two learners, and if no draw has a gain.
fn interval(scores: &[[f64; 2]]) -> Option<[f64; 2]> {
    // One learner has no spread.
    if scores.len() < 2 {
        return None;
    }

    let resampled = |resample: u32| {
        let key = Key::from_seed(0).derive(Stream::Order, resample);
        // A draw gives several words, of which one is enough.
        let draw = |index: u32| below(key.draw(Stream::Order, index)[0], scores.len() as u32);
        let drawn = (0..scores.len() as u32).map(|index| scores[draw(index) as usize]);
        normalized(mean(&drawn.collect::<Vec<_>>()))
    };
    // A draw of learners who all knew everything before has no gain.
    let mut gains: Vec<f64> = (0..RESAMPLES).filter_map(resampled).collect();
    gains.sort_by(f64::total_cmp);

    let at = |share: f64| {
        let last = gains.len().checked_sub(1)?;
        gains.get((share * last as f64).round() as usize).copied()
    };
    Some([at(TAIL)?, at(1.0 - TAIL)?])
}

/// Returns the gains of votes: over all concepts that were voted on in both forms, then by concept. Each vote on a
/// concept has the same weight, as the number of learners who took part in it may be unknown.
fn gains_of_votes(votes: &[ClassVote]) -> Vec<Gain> {
    let shares_of = |concept: Concept, form: TestForm| {
        let is_of = move |vote: &&ClassVote| vote.concept == concept && vote.form == form;
        let cast = votes.iter().filter(is_of);
        cast.map(|vote| vote.share).collect::<Vec<f64>>()
    };

    // The mean share of right answers of each concept that was voted on in both forms.
    let pairs = both(|concept, form| {
        let shares = shares_of(concept, form);
        (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
    });
    if pairs.is_empty() {
        return Vec::new();
    }

    let row = |name: &str, count: usize, means: [f64; 2]| Gain {
        name: name.to_owned(),
        count,
        before: means[0],
        after: means[1],
        gain: normalized(means),
        // Votes have no learners who could be drawn again.
        interval: None,
        // Concepts without votes in one of the forms are in no row.
        is_complete: true,
    };

    // As `Gain::count` says, the votes in the form after count.
    let votes_on = |concept: Concept| shares_of(concept, TestForm::After).len();
    let all = mean(&pairs.values().copied().collect::<Vec<_>>());
    let sum = pairs.keys().map(|&concept| votes_on(concept)).sum();

    let mut rows = vec![row("all", sum, all)];
    let by_concept = pairs.iter();
    rows.extend(by_concept.map(|(&of, &means)| row(of.name(), votes_on(of), means)));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Entry;

    fn entry(form: TestForm, concept: Concept, score: f64, time: f64) -> Entry {
        Entry {
            lesson: "a form".to_owned(),
            hash: "00".to_owned(),
            gate: concept.name().to_owned(),
            form: Some(form),
            concept: Some(concept),
            seed: 1,
            practised: false,
            answer: "A".to_owned(),
            score,
            tries: 1,
            hints: 0,
            given_up: false,
            confidence: None,
            seconds: 1.0,
            time,
        }
    }

    /// Results of a learner with these scores, before and after, in the first concepts.
    fn learner(name: &str, scores: &[[f64; 2]]) -> (String, Results) {
        let mut results = Results {
            learner: name.to_owned(),
            ..Results::default()
        };
        for (&concept, [before, after]) in Concept::ALL.iter().zip(scores) {
            results.add([
                entry(TestForm::Before, concept, *before, 1.0),
                entry(TestForm::After, concept, *after, 2.0),
            ]);
        }
        (String::new(), results)
    }

    fn about(gain: f64, expected: f64) {
        assert!((gain - expected).abs() < 1e-12, "{gain}, not {expected}");
    }

    #[test]
    fn the_gain_of_a_class_is_that_of_its_means() {
        let files = [
            learner("Ada", &[[0.0, 1.0], [0.0, 1.0]]),
            learner("Bob", &[[1.0, 1.0], [0.0, 0.0]]),
        ];
        let gains = Gains::of(&Merged::of(files));
        let names: Vec<&str> = gains.class.iter().map(|gain| gain.name.as_str()).collect();
        assert_eq!(names, ["all", "pattern", "clip"]);

        // Before: 0 and 0.5; after: 1 and 0.5. The mean of the learners' gains would be 0.5.
        let [all, pattern, clip] = &gains.class[..] else {
            panic!("three rows")
        };
        about(all.before, 0.25);
        about(all.after, 0.75);
        about(all.gain.unwrap(), 2.0 / 3.0);
        about(pattern.gain.unwrap(), 1.0);
        about(clip.gain.unwrap(), 0.5);
        assert_eq!([all.count, pattern.count, clip.count], [2; 3]);
        about(gains.learners[0].gain.unwrap(), 1.0);
        about(gains.learners[1].gain.unwrap(), 0.0);
    }

    #[test]
    fn a_full_form_before_leaves_no_gain_and_lacking_answers_do_not_count() {
        let (_, mut half) = learner("Cy", &[[0.0, 1.0], [0.0, 1.0]]);
        half.entries.pop();
        let (_, mut none) = learner("Di", &[[0.0, 1.0]]);
        none.entries.pop();
        let files = [
            learner("Ada", &[[1.0, 1.0], [1.0, 0.0]]),
            (String::new(), half),
            (String::new(), none),
        ];
        let gains = Gains::of(&Merged::of(files));

        // Cy has both forms of the first concept only, and Di of none.
        let rows: Vec<_> = gains
            .class
            .iter()
            .map(|gain| (gain.count, gain.gain))
            .collect();
        assert_eq!(rows, [(1, None), (2, Some(1.0)), (1, None)]);
        let shown: Vec<_> = gains
            .learners
            .iter()
            .map(|it| (it.count, it.shown()))
            .collect();
        assert_eq!(shown, [(2, "-".to_owned()), (1, String::new())]);
        assert!(Gains::of(&Merged::default()).is_empty() && !gains.is_empty());
    }

    #[test]
    fn the_first_answer_counts_whatever_its_place_in_the_file() {
        let (name, mut results) = learner("Ada", &[[0.0, 0.0]]);
        let again = |score, time| entry(TestForm::After, Concept::Pattern, score, time);
        let practised = Entry {
            practised: true,
            ..again(1.0, 0.1)
        };
        results.entries.insert(0, again(1.0, 9.0));
        results.entries.insert(0, practised);
        let gains = Gains::of(&Merged::of([(name.clone(), results.clone())]));
        assert!(gains.learners[0].after.abs() < 1e-9);

        // The control: an earlier answer is the first one.
        results.entries.push(again(1.0, 0.5));
        let gains = Gains::of(&Merged::of([(name, results)]));
        assert!((gains.learners[0].after - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_interval_holds_the_gain_is_the_same_each_time_and_shrinks_with_the_class() {
        let class = |size: usize| {
            let scores = |k: usize| [[0.0, f64::from(u8::from(k.is_multiple_of(2)))]];
            let files = (0..size).map(|k| learner(&format!("learner {k}"), &scores(k)));
            Gains::of(&Merged::of(files)).class[0].clone()
        };
        let [few, many] = [10, 160].map(class);
        for gain in [&few, &many] {
            let [low, high] = gain.interval.unwrap();
            about(gain.gain.unwrap(), 0.5);
            assert!(low < 0.5 && 0.5 < high, "{gain:?}");
        }
        // The standard error of a share of a half is 0.5 / sqrt(n), and 95% are within 1.96 of them.
        let width = |gain: &Gain| gain.interval.map(|[low, high]| high - low).unwrap();
        assert!((width(&few) - 0.62).abs() < 0.1, "{few:?}");
        assert!((width(&many) - 0.155).abs() < 0.03, "{many:?}");
        assert_eq!(few, class(10));
        assert_eq!(class(1).interval, None);
    }

    #[test]
    fn votes_have_gains_of_their_own_and_count_once() {
        let vote = |form, share: f64, time| ClassVote {
            lesson: "before".to_owned(),
            form,
            concept: Concept::Loss,
            share,
            count: Some(30),
            time,
        };
        let results = Results {
            votes: vec![
                vote(TestForm::Before, 0.2, 1.0),
                vote(TestForm::Before, 0.4, 2.0),
                vote(TestForm::After, 0.65, 3.0),
            ],
            ..Results::default()
        };
        let read = Results::read(&results.to_json()).unwrap();
        assert_eq!(read, results);
        let gains = Gains::of(&Merged::of([
            ("a".to_owned(), results.clone()),
            ("b".to_owned(), results),
        ]));
        assert!(gains.class.is_empty() && gains.learners.is_empty());
        let [all, loss] = &gains.votes[..] else {
            panic!("{:?}", gains.votes)
        };
        about(all.gain.unwrap(), 0.5);
        assert_eq!((loss.name.as_str(), loss.count), ("loss", 1));
    }

    #[test]
    fn tables_are_safe_in_spreadsheets() {
        let files = [
            learner("=1+1", &[[1.0, 1.0]]),
            learner("-Bob", &[[0.0, 0.25]]),
        ];
        let text = Gains::of(&Merged::of(files)).csv().unwrap();
        let table = text.strip_prefix('\u{feff}').expect("a byte-order mark");
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[0], "of,name,count,before,after,gain,low,high");
        assert!(
            lines[1].starts_with("class,all,2,0.500,0.625,0.25,"),
            "{text}"
        );
        assert_eq!(lines[3], "learner,'=1+1,1,1.000,1.000,-,,");
        assert_eq!(lines[4], "learner,'-Bob,1,0.000,0.250,0.25,,");
    }
}
