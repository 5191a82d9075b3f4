//! The brush: a ring of frequencies or a range of distances, and the search for the samples or pairs that cause
//! the values there. `tilescope_analysis` computes them in the background; the canvas draws them.

use std::sync::Arc;

use glam::DVec2;

use tilescope_analysis::Control;
use tilescope_analysis::measures::{MeasureError, frequency_shares, pairs_between};
use tilescope_session::geometry::{Key, key_of};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::{ShownMoment, Still};
use tilescope_session::session::Session;
use tilescope_session::task::{self, Task};
use tilescope_session::words::{counted, grouped};

use tilescope_drawing::brushed::{BrushedCause, Cause, MAX_PAIRS, Pair};

use super::measured::{Samples, refusal};

/// The share of samples whose colour shows their value; those beyond all have the strongest colour. Chosen,
/// not measured.
const TINTED: f64 = 0.95;

/// The frequencies around the first peak of maximal sets, as nu.
pub const FIRST_PEAK: [f64; 2] = [1.0, 1.3];

/// The quantity that a brush selects by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrushAxis {
    /// Frequencies as nu: |k| divided by the root of the number of samples.
    Frequency,
    /// Distances between two samples, in r.
    Distance,
}

impl BrushAxis {
    /// Returns the upper end of its range.
    #[must_use]
    pub const fn end(self) -> f64 {
        match self {
            Self::Frequency => 2.5,
            Self::Distance => 5.0,
        }
    }
}

/// A range of frequencies or distances.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Brush {
    /// Whether the range is of frequencies or of distances.
    pub axis: BrushAxis,
    /// Its ends, the lower one first.
    pub range: [f64; 2],
}

impl Brush {
    /// Returns the brush between two values in either order; `None` if it is empty or a value is NaN.
    #[must_use]
    pub fn between(axis: BrushAxis, a: f64, b: f64) -> Option<Self> {
        let [low, high] = [a.min(b), a.max(b)].map(|value| value.clamp(0.0, axis.end()));
        (low < high).then_some(Self {
            axis,
            range: [low, high],
        })
    }

    /// Returns the range of a brush, if it is along `axis`.
    #[must_use]
    pub fn along(brush: Option<Self>, axis: BrushAxis) -> Option<[f64; 2]> {
        let range = brush.filter(|brush| brush.axis == axis);
        range.map(|brush| brush.range)
    }
}

/// The moment and the brush that causes belong to.
type Of = (Key, Brush);
/// The causes, or why there are none; no reason if the user stopped the search.
pub type Outcome = Result<Cause, Option<String>>;

/// The causes of the brush at the current moment, if known.
#[derive(Default)]
pub struct Marks {
    /// The moment and the brush of the frame before.
    asked: Option<Of>,
    /// The search that is running.
    work: Option<(Of, Job<Outcome>)>,
    /// The causes that were found last.
    found: Option<(Of, BrushedCause)>,
    /// Why the last search found none.
    failed: Option<(Of, String)>,
    serial: u64,
}

impl Marks {
    /// Returns the causes of a brush at a moment.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>, brush: Brush) -> Option<&BrushedCause> {
        let (of, found) = self.found.as_ref()?;
        (*of == (key_of(shown), brush)).then_some(found)
    }

    /// Returns the result in words, or why there is none.
    #[must_use]
    pub fn description(&self, shown: &ShownMoment<'_>, brush: Brush) -> String {
        if let Some(found) = self.of(shown, brush) {
            return describe(&found.cause);
        }
        match &self.failed {
            Some((of, why)) if *of == (key_of(shown), brush) => why.clone(),
            _ => "Searching\u{2026}".to_owned(),
        }
    }

    /// Returns the fraction of a running search that is done, from 0 to 1.
    #[must_use]
    pub fn progress(&self) -> Option<f32> {
        self.work.as_ref().map(|(_, job)| job.fraction())
    }

    /// Stops the search; earlier results stay.
    pub(super) fn rest(&mut self) {
        (self.asked, self.work) = (None, None);
    }

    /// Takes a finished result, and starts the search once brush and moment stayed the same from one call to
    /// the next.
    pub(super) fn want(
        &mut self,
        session: &Arc<Session>,
        shown: &ShownMoment<'_>,
        brush: Option<Brush>,
        wake: &Wake,
    ) {
        self.poll();

        let wanted = brush.map(|brush| (key_of(shown), brush));
        // While a brush is dragged or the run plays, each frame would start a search that the next one drops. A search starts only
        // once a second frame asks for the same brush at the same moment.
        if self.asked != wanted {
            (self.asked, self.work) = (wanted, None);
            wake();
            return;
        }

        // Without a brush, nothing shows the causes that were found last.
        let Some(wanted) = wanted else {
            self.found = None;
            return;
        };

        let known = self
            .found
            .as_ref()
            .is_some_and(|(found, _)| *found == wanted);
        // A search that failed would fail again.
        let refused = self
            .failed
            .as_ref()
            .is_some_and(|(failed, _)| *failed == wanted);
        if known || refused || self.work.is_some() {
            return;
        }

        let still = Still::of(session, shown.moment());
        let (_, brush) = wanted;
        let causing = BrushTask { still, brush };
        self.work = Some((wanted, task::start(wake, causing)));
    }

    fn poll(&mut self) {
        let outcome = self.work.as_ref().and_then(|(_, job)| job.poll());
        if let Some(outcome) = outcome
            && let Some((of, _)) = self.work.take()
        {
            self.take(of, outcome);
        }
    }

    /// Takes the end of a search: its causes, or why there are none.
    fn take(&mut self, of: Of, outcome: Result<Outcome, String>) {
        match outcome {
            Ok(Ok(cause)) => {
                self.serial += 1;
                let serial = self.serial;
                self.found = Some((of, BrushedCause { serial, cause }));
            }
            // A search that was cancelled has nothing to report.
            Ok(Err(None)) => {}
            Ok(Err(Some(why))) => self.failed = Some((of, why)),
            Err(panic) => self.failed = Some((of, tilescope_session::words::sentence(&panic))),
        }
    }

    /// Waits for the running search; returns whether there was one.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle(&mut self) -> bool {
        let Some((of, job)) = self.work.take() else {
            return false;
        };
        let outcome = job.wait();
        self.take(of, outcome);
        true
    }
}

/// The task of finding the causes of a brush at a moment.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct BrushTask {
    still: Still,
    brush: Brush,
}

impl Task for BrushTask {
    type Outcome = Outcome;
    const NAME: &'static str = "causes";

    fn run(self, monitor: &Monitor) -> Outcome {
        let still = &self.still;
        let ids: Vec<u32> = still.covering().into_iter().map(|(_, id)| id).collect();
        let all = still.session().run().samples.len();
        let set = super::samples(still);
        let control = |progress| monitor.follow(progress);
        cause(&set, &ids, all, self.brush, &control).map_err(|error| refusal(&error))
    }
}

/// Returns the causes of a brush over `set`. `ids` are the ids of its samples, among `all` samples of the run.
pub fn cause(
    set: &Samples,
    ids: &[u32],
    all: usize,
    brush: Brush,
    control: Control<'_>,
) -> Result<Cause, MeasureError> {
    let (points, region) = (&set.points[..], set.region);

    match brush.axis {
        BrushAxis::Distance => {
            let range = brush.range.map(|distance| distance * set.radius);
            let found = pairs_between(points, region, range, MAX_PAIRS, control)?;
            let pairs = found.pairs.iter().map(|pair| Pair {
                // The canvas identifies samples by their ids in the run, not by their indices in this set.
                ids: [pair.first, pair.second].map(|index| ids[index as usize]),
                offset: DVec2::from(pair.offset) / set.radius,
            });

            Ok(Cause::Pairs {
                total: found.total,
                pairs: pairs.collect(),
            })
        }
        BrushAxis::Frequency => {
            // The brush has frequencies as nu = |k| / sqrt(N), and the search needs |k|.
            let root = (points.len() as f64).sqrt();
            let ring = brush.range.map(|nu| nu * root);
            let found = frequency_shares(points, region, ring, control)?;

            let mean = found.mean_power as f32;
            // A sample of the run that has no disk at this moment keeps NaN and gets no tint.
            let mut shares = vec![f32::NAN; all];
            for (id, share) in ids.iter().zip(found.relative(points, region)) {
                // Near the border of a bounded domain, the weight of some samples is too small to tell their share. They get the mean,
                // which has no tint.
                let known = share.is_finite();
                shares[*id as usize] = if known { share as f32 } else { mean };
            }

            Ok(Cause::Shares {
                frequencies: found.frequencies,
                mean_power: found.mean_power,
                strongest: strongest(&shares, mean),
                shares,
            })
        }
    }
}

/// Returns the distance from the mean that all shares but those beyond [`TINTED`] keep within, never 0; 1 without shares.
fn strongest(shares: &[f32], mean: f32) -> f32 {
    let finite = shares.iter().filter(|share| share.is_finite());
    let mut sizes: Vec<f32> = finite.map(|share| (share - mean).abs()).collect();

    if sizes.is_empty() {
        // The result is a divisor: without shares any will do, and equal shares must not make it 0.
        return 1.0;
    }

    let index = (TINTED * (sizes.len() - 1) as f64) as usize;
    let (_, size, _) = sizes.select_nth_unstable_by(index, f32::total_cmp);
    size.max(f32::MIN_POSITIVE)
}

/// Returns the causes in words.
fn describe(cause: &Cause) -> String {
    match cause {
        Cause::Pairs { total, pairs } => {
            let (count, kept) = (
                counted(*total as usize, "pair", "pairs"),
                grouped(pairs.len()),
            );

            // The search goes through the domain from below, and stops keeping pairs at their limit.
            let cut = if *total > pairs.len() as u64 {
                format!("; the {kept} lowest in the domain are kept")
            } else {
                String::new()
            };
            format!("{count}, joined by lines on the canvas{cut}.")
        }
        // An empty ring has no mean power to state.
        Cause::Shares { frequencies: 0, .. } => "No frequency lies in the ring.".to_owned(),
        // The text states `TINTED` as 95%: this share of the samples differs from the mean by at most `strongest`.
        Cause::Shares {
            frequencies,
            mean_power,
            strongest,
            ..
        } => format!(
            "{}, mean power {mean_power:.3}. Large orange samples add more than the mean sample, small blue ones less; 95% of the samples differ from it by at most {strongest:.1} times white noise's share.",
            counted(*frequencies as usize, "frequency", "frequencies"),
        ),
    }
}
