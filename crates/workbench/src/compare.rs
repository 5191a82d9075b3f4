//! Two runs side by side: presets for the second run, the samples by which the two differ at a moment, and the event at
//! which they diverge. Begin with [`Comparison`]; `state/compare.rs` has the commands, and the runs themselves.

pub mod difference;
pub mod link;

use std::sync::Arc;

use tilescope_core::{Insertion, Order, Parameters, Search, TilingMethod, Variant};
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
    /// Keeps the current run as the second one, so that the next can be compared with it.
    Keep,
    /// Swaps the two runs: all panels show the first one.
    Swap,
    /// Closes the second run.
    Close,
    /// Links or unlinks the cameras.
    LinkCameras(bool),
    /// Links or unlinks playback.
    #[serde(rename = "link-clocks")]
    LinkPlayback(bool),
    /// Sets whether samples of only one run are marked.
    ShowDifferences(bool),
    /// Goes to the event at which the two runs diverge.
    GoToDivergence,
}

/// A preset for the second run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparePreset {
    /// The same with the next seed, and in exact tiling with its pattern.
    NextSeed,
    /// The same with the other search radius of detectors: the paper's 2 r, or the radius of the proof.
    Search,
    /// The same with the other insertion.
    Insertion,
    /// The same in the other order of elimination.
    Order,
    /// The same with the other form of Algorithm 4.
    Variant,
    /// The same by the other method, with the same pattern: only seams differ.
    Method,
    /// The same with blocks of twice the size.
    Leaf,
    /// The same by the other engine.
    Engine,
    /// The parameters as typed in the panel.
    Typed,
}

impl ComparePreset {
    /// Every preset, in the sequence of the menu.
    pub const ALL: [Self; 9] = [
        Self::NextSeed,
        Self::Search,
        Self::Insertion,
        Self::Order,
        Self::Variant,
        Self::Method,
        Self::Leaf,
        Self::Engine,
        Self::Typed,
    ];

    /// Returns the name, which completes "Compare with".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NextSeed => "the next seed",
            Self::Search => "the other search radius",
            Self::Insertion => "the other insertion",
            Self::Order => "the other order of elimination",
            Self::Variant => "the other form of Algorithm 4",
            Self::Method => "the other method of tiling",
            Self::Leaf => "blocks twice as large",
            Self::Engine => "the other engine",
            Self::Typed => "the parameters as typed",
        }
    }

    /// Returns the parameters of the second run if the first has `first` and the panel has `typed`.
    #[must_use]
    pub fn parameters(self, first: &Parameters, typed: &Parameters) -> Parameters {
        let mut second = *first;
        match self {
            // The seed after the largest one is 0. In exact tiling the pattern's seed follows it, as in the form.
            Self::NextSeed => {
                second.seed = first.seed.wrapping_add(1);
                second.pattern = second.pattern_following(first);
            }

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
                    // Any other order is compared with the one that runs have by default.
                    Order::Index | Order::Random | Order::PhaseGroup => Order::OwnBlockFirst,
                }
            }
            Self::Variant => {
                second.variant = match first.variant {
                    Variant::Staged => Variant::AsPrinted,
                    Variant::AsPrinted => Variant::Staged,
                }
            }
            Self::Method => {
                // Exact tiling clips from the same pattern, so that only seams differ. Choices that it does not have get their defaults.
                second = match first.method {
                    TilingMethod::Kdrt => first.as_exact(),
                    TilingMethod::Exact => Parameters {
                        method: TilingMethod::Kdrt,
                        ..*first
                    },
                }
            }
            Self::Leaf => second.leaf = 2.0 * first.leaf,

            // All engines give the same points, and the engine is no parameter: the caller chooses the other engine.
            Self::Engine => {}
            Self::Typed => second = *typed,
        }

        second
    }
}

/// The comparison of two runs.
pub struct Comparison {
    /// Whether the cameras are linked.
    pub linked_cameras: bool,
    /// Whether playback is linked.
    pub linked_playback: bool,
    /// Whether samples of only one run are marked.
    pub shows_differences: bool,
    /// The samples by which the runs differ at the current moment.
    pub differences: Differences,
    /// The search for the event at which two runs diverge: the generations of their sessions, and the running work.
    search: Option<([u64; 2], Job<Divergence>)>,
    /// The result of the last search, or why it failed.
    found: Option<([u64; 2], Result<Divergence, String>)>,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            linked_cameras: true,
            linked_playback: true,
            shows_differences: true,
            differences: Differences::default(),
            search: None,
            found: None,
        }
    }
}

impl Comparison {
    /// Returns whether cameras are linked, playback is linked, and differences are marked.
    #[must_use]
    pub const fn links(&self) -> [bool; 3] {
        [
            self.linked_cameras,
            self.linked_playback,
            self.shows_differences,
        ]
    }

    /// Sets whether cameras are linked, playback is linked, and differences are marked.
    pub const fn link(&mut self, [cameras, playback, differences]: [bool; 3]) {
        self.linked_cameras = cameras;
        self.linked_playback = playback;
        self.shows_differences = differences;
    }

    /// Returns where two sessions diverge, once known.
    #[must_use]
    pub fn divergence(&self, a: &Session, b: &Session) -> Option<&Divergence> {
        let (pair, found) = self.found.as_ref()?;
        let found = found.as_ref().ok()?;
        (*pair == [a.generation, b.generation]).then_some(found)
    }

    /// Returns why the divergence could not be found.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        let (_, found) = self.found.as_ref()?;
        found.as_ref().err().map(String::as_str)
    }

    /// Starts looking in the background for where two sessions diverge, unless that is known or running.
    pub fn seek(&mut self, a: &Arc<Session>, b: &Arc<Session>, wake: &Wake) {
        let outcome = self.search.as_ref().and_then(|(_, job)| job.poll());
        self.take(outcome);
        let wanted = [a.generation, b.generation];
        let searched = self.search.as_ref().map(|(pair, _)| *pair);
        // A running search counts, or otherwise the last result, also where it is a failure: it would fail again.
        if searched.or(self.found.as_ref().map(|(pair, _)| *pair)) != Some(wanted) {
            let pair = [a, b].map(|session| SessionRef(Arc::clone(session)));
            let job = task::start(wake, DivergenceTask(pair));
            (self.search, self.found) = (Some((wanted, job)), None);
        }
    }

    fn take(&mut self, outcome: Option<Result<Divergence, String>>) {
        if let Some(outcome) = outcome
            && let Some((pair, _)) = self.search.take()
        {
            self.found = Some((pair, outcome));
        }
    }

    /// Waits for the running search.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        let outcome = self.search.as_ref().map(|(_, job)| job.wait());
        self.take(outcome);
        self.differences.settle();
    }
}

/// The task of finding where two runs diverge.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct DivergenceTask([SessionRef; 2]);

impl Task for DivergenceTask {
    type Outcome = Divergence;
    const NAME: &'static str = "divergence";

    fn run(self, _: &Monitor) -> Divergence {
        let [a, b] = &self.0;
        match (a.recording(), b.recording()) {
            (Some(a), Some(b)) => first_divergence(a, b),
            _ => first_divergence_of_runs(a.run(), b.run()),
        }
    }
}

/// Returns the parameters by which two sessions differ, as [`contrast`] returns them; `None` if one is a combination.
#[must_use]
pub fn contrast_of(a: &Session, b: &Session) -> Option<Vec<(String, String, String)>> {
    let glued = a.combination.is_some() || b.combination.is_some();
    (!glued).then(|| contrast(&a.run().parameters, &b.run().parameters))
}

/// Returns the parameters by which two runs differ: the name, the first run's value and the second run's.
#[must_use]
pub fn contrast(a: &Parameters, b: &Parameters) -> Vec<(String, String, String)> {
    let mut found = Vec::new();
    // Parameters can always be written as a value.
    let values = [a, b].map(|parameters| serde_json::to_value(parameters).unwrap_or_default());
    walk("", &values[0], &values[1], &mut found);
    found
}

/// Appends the parts in which two values differ, by their names in objects.
fn walk(
    name: &str,
    a: &serde_json::Value,
    b: &serde_json::Value,
    found: &mut Vec<(String, String, String)>,
) {
    use serde_json::Value;
    if let (Value::Object(a), Value::Object(b)) = (a, b) {
        // Both objects are parts of parameters, which always have the same names.
        for (key, value) in a {
            let name = format!("{name} {key}");
            walk(&name, value, b.get(key).unwrap_or(&Value::Null), found);
        }
    } else if a != b {
        let text = |value: &Value| match value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        // The outermost object has no name, so that names begin with a blank.
        found.push((name.trim().replace('_', " "), text(a), text(b)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_preset_but_the_engine_changes_its_parameter() {
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
            (ComparePreset::Method, &["method"]),
            (ComparePreset::Leaf, &["leaf"]),
            (ComparePreset::Engine, &[]),
            (ComparePreset::Typed, &["radius"]),
        ] {
            assert_eq!(differing(preset), expected, "{preset:?}");
        }
    }

    #[test]
    fn applying_a_preset_twice_restores_the_parameters() {
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
    fn nested_parameters_are_named_in_full() {
        let mut second = Parameters::default();
        second.pattern.seed = 9;
        let found = contrast(&Parameters::default(), &second);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "pattern seed");
        assert_eq!(found[0].2, "9");
    }
}
