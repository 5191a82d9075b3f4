//! Two runs side by side: what the second one is made from, what differs between the two at a moment, and where they
//! part. Nothing is sampled or judged here; the state holds the two runs.

pub mod difference;
pub mod link;

use std::sync::Arc;

use tilescope_core::{Insertion, Order, Parameters, Search, Variant};
use tilescope_debugger::{Divergence, first_divergence, first_divergence_of_runs};

use difference::Differences;
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::session::Session;
use tilescope_session::task::{self, SessionRef, Task};

/// An action of the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CompareCommand {
    /// Samples a second run.
    Start(ComparePreset),
    /// Keeps the run at hand as the second one, so that the next can be compared with it.
    Keep,
    /// Has the two runs change places: all panels show the first one.
    Swap,
    /// Forgets the second run.
    Close,
    /// Has the cameras move together, or not.
    LinkCameras(bool),
    /// Has the clocks run together, or not.
    LinkClocks(bool),
    /// Marks the samples that only one of the two has, or not.
    ShowDifferences(bool),
    /// Goes to where the two part.
    GoToDivergence,
}

/// What the second run is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparePreset {
    /// The same with the next seed.
    NextSeed,
    /// The same with the other reach of detectors: the paper's 2 r, or what the proof needs.
    Search,
    /// The same with the other way to fill gaps.
    Insertion,
    /// The same in the other order of elimination.
    Order,
    /// The same with the other form of Algorithm 4.
    Variant,
    /// The same with blocks of twice the size.
    Leaf,
    /// The same by the other engine.
    Engine,
    /// What the parameters panel says.
    Typed,
}

impl ComparePreset {
    /// Every one.
    pub const ALL: [Self; 8] = [
        Self::NextSeed,
        Self::Search,
        Self::Insertion,
        Self::Order,
        Self::Variant,
        Self::Leaf,
        Self::Engine,
        Self::Typed,
    ];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NextSeed => "the next seed",
            Self::Search => "the other search radius",
            Self::Insertion => "the other insertion",
            Self::Order => "the other order of elimination",
            Self::Variant => "the other form of Algorithm 4",
            Self::Leaf => "blocks twice as large",
            Self::Engine => "the other engine",
            Self::Typed => "the parameters as typed",
        }
    }

    /// Returns what the second run is made from when the first is made from `first` and the panel says `typed`.
    #[must_use]
    pub fn parameters(self, first: &Parameters, typed: &Parameters) -> Parameters {
        let mut second = *first;
        match self {
            Self::NextSeed => second.seed = first.seed.wrapping_add(1),
            Self::Search => {
                second.search = match first.search {
                    Search::Complete => Search::TwoRadii,
                    Search::TwoRadii => Search::Complete,
                }
            }
            Self::Insertion => {
                second.insertion = match first.insertion {
                    Insertion::Circumcentre => Insertion::Uniform,
                    Insertion::Uniform => Insertion::Circumcentre,
                }
            }
            Self::Order => {
                second.order = match first.order {
                    Order::OwnBlockFirst => Order::Index,
                    _ => Order::OwnBlockFirst,
                }
            }
            Self::Variant => {
                second.variant = match first.variant {
                    Variant::Staged => Variant::AsPrinted,
                    Variant::AsPrinted => Variant::Staged,
                }
            }
            Self::Leaf => second.leaf = 2.0 * first.leaf,
            Self::Engine => {}
            Self::Typed => second = *typed,
        }
        second
    }
}

/// What is known of two runs together.
pub struct Comparison {
    /// Whether the cameras move together.
    pub linked_cameras: bool,
    /// Whether the clocks run together.
    pub linked_clocks: bool,
    /// Whether samples that only one run has are marked.
    pub shows_differences: bool,
    /// What differs at the moment.
    pub differences: Differences,
    parting: Parting,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            linked_cameras: true,
            linked_clocks: true,
            shows_differences: true,
            differences: Differences::default(),
            parting: Parting::Unknown,
        }
    }
}

/// Generations of two sessions.
type Pair = [u64; 2];

/// Where the two part, as far as it is known.
enum Parting {
    Unknown,
    Pending(Pair, Job<Divergence>),
    Known(Pair, Divergence),
    Failed(Pair, String),
}

impl Comparison {
    /// Returns whether cameras move together, clocks run together, and differences are marked.
    #[must_use]
    pub const fn links(&self) -> [bool; 3] {
        [
            self.linked_cameras,
            self.linked_clocks,
            self.shows_differences,
        ]
    }

    /// Links cameras and clocks and marks differences, or not.
    pub const fn link(&mut self, [cameras, clocks, differences]: [bool; 3]) {
        self.linked_cameras = cameras;
        self.linked_clocks = clocks;
        self.shows_differences = differences;
    }

    /// Returns where two sessions part, once it is known.
    #[must_use]
    pub fn divergence(&self, a: &Session, b: &Session) -> Option<&Divergence> {
        match &self.parting {
            Parting::Known(pair, divergence) if *pair == [a.generation, b.generation] => {
                Some(divergence)
            }
            _ => None,
        }
    }

    /// Returns why that could not be found out.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        match &self.parting {
            Parting::Failed(_, why) => Some(why),
            _ => None,
        }
    }

    /// Has it found out where two sessions part, in the background, if that is neither known nor at work.
    pub fn seek(&mut self, a: &Arc<Session>, b: &Arc<Session>, wake: &Wake) {
        self.take();
        let wanted = [a.generation, b.generation];
        let known = match &self.parting {
            Parting::Unknown => false,
            Parting::Pending(pair, _) | Parting::Known(pair, _) | Parting::Failed(pair, _) => {
                *pair == wanted
            }
        };
        if !known {
            let pair = [a, b].map(|session| SessionRef(Arc::clone(session)));
            let job = task::start(wake, DivergenceTask(pair));
            self.parting = Parting::Pending(wanted, job);
        }
    }

    fn take(&mut self) {
        if let Parting::Pending(pair, job) = &self.parting
            && let Some(outcome) = job.poll()
        {
            self.parting = known(*pair, outcome);
        }
    }

    /// Waits for what is at work.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        if let Parting::Pending(pair, job) = &self.parting {
            let outcome = job.wait();
            self.parting = known(*pair, outcome);
        }
        self.differences.settle();
    }
}

fn known(pair: Pair, outcome: Result<Divergence, String>) -> Parting {
    match outcome {
        Ok(divergence) => Parting::Known(pair, divergence),
        Err(failure) => Parting::Failed(pair, failure),
    }
}

/// Has found out where two runs part.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct DivergenceTask([SessionRef; 2]);

impl Task for DivergenceTask {
    type Outcome = Divergence;
    const NAME: &'static str = "divergence";

    fn run(self, _: &Monitor) -> Divergence {
        let [a, b] = &self.0;
        divergence_of(a, b)
    }
}

fn divergence_of(a: &Session, b: &Session) -> Divergence {
    match (a.recording(), b.recording()) {
        (Some(a), Some(b)) => first_divergence(a, b),
        _ => first_divergence_of_runs(a.run(), b.run()),
    }
}

/// Returns the parameters by which two sessions differ, as [`contrast`] does; `None` where one is a combination.
#[must_use]
pub fn contrast_of(a: &Session, b: &Session) -> Option<Vec<(String, String, String)>> {
    let glued = a.combination.is_some() || b.combination.is_some();
    (!glued).then(|| contrast(&a.run().parameters, &b.run().parameters))
}

/// Returns the parameters by which two runs differ: the name, the first one's value and the second one's.
#[must_use]
pub fn contrast(a: &Parameters, b: &Parameters) -> Vec<(String, String, String)> {
    let mut found = Vec::new();
    let values = [a, b].map(|parameters| serde_json::to_value(parameters).unwrap_or_default());
    walk("", &values[0], &values[1], &mut found);
    found
}

fn walk(
    name: &str,
    a: &serde_json::Value,
    b: &serde_json::Value,
    found: &mut Vec<(String, String, String)>,
) {
    use serde_json::Value;
    if let (Value::Object(a), Value::Object(b)) = (a, b) {
        for (key, value) in a {
            let name = format!("{name} {key}");
            walk(&name, value, b.get(key).unwrap_or(&Value::Null), found);
        }
    } else if a != b {
        let text = |value: &Value| match value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        found.push((name.trim().replace('_', " "), text(a), text(b)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rival_but_the_engine_differs_in_what_it_says() {
        let (first, typed) = (
            Parameters::default(),
            Parameters {
                radius: 0.02,
                ..Parameters::default()
            },
        );
        let differing = |preset: ComparePreset| -> Vec<String> {
            let second = preset.parameters(&first, &typed);
            contrast(&first, &second)
                .into_iter()
                .map(|(name, ..)| name)
                .collect()
        };
        for (preset, expected) in [
            (ComparePreset::NextSeed, &["seed"][..]),
            (ComparePreset::Search, &["search"]),
            (ComparePreset::Insertion, &["insertion"]),
            (ComparePreset::Order, &["order"]),
            (ComparePreset::Variant, &["variant"]),
            (ComparePreset::Leaf, &["leaf"]),
            (ComparePreset::Engine, &[]),
            (ComparePreset::Typed, &["radius"]),
        ] {
            assert_eq!(differing(preset), expected, "{preset:?}");
        }
    }

    #[test]
    fn two_changes_lead_back() {
        let first = Parameters::default();
        for preset in [
            ComparePreset::Search,
            ComparePreset::Insertion,
            ComparePreset::Order,
            ComparePreset::Variant,
        ] {
            let second = preset.parameters(&first, &first);
            assert_ne!(second, first);
            assert_eq!(preset.parameters(&second, &first), first);
        }
    }

    #[test]
    fn what_lies_deeper_is_named_in_full() {
        let mut second = Parameters::default();
        second.pattern.seed = 9;
        let found = contrast(&Parameters::default(), &second);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "pattern seed");
        assert_eq!(found[0].2, "9");
    }
}
