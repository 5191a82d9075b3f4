//! What is brushed: a ring of frequencies or a range of distances, and the samples or pairs that cause what is seen there.
//! They are found in the background by `tilescope_analysis`; the canvas draws them.

use std::sync::Arc;

use glam::DVec2;

use tilescope_analysis::measures::{MeasureError, frequency_shares, pairs_between};
use tilescope_session::geometry::{Key, key_of};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::{ShownMoment, Still};
use tilescope_session::session::Session;
use tilescope_session::task::{self, Task};
use tilescope_session::words::{counted, grouped};

use tilescope_drawing::brushed::{BrushedCause, Cause, MAX_PAIRS, Pair};

use super::measured::{Control, Samples, refusal};

/// This part of the samples has a colour of its own for its share; those beyond have the strongest one.
const TINTED: f64 = 0.95;

/// Frequencies about the first peak of maximal sets, as nu.
pub const FIRST_PEAK: [f64; 2] = [1.0, 1.3];

/// What a range is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrushAxis {
    /// Frequencies, as nu.
    #[serde(alias = "Frequency")]
    Frequency,
    /// Distances, in r.
    #[serde(alias = "Distance")]
    Distance,
}

impl BrushAxis {
    /// Returns how far a brush of it may reach.
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
    /// What it is of.
    pub axis: BrushAxis,
    /// Its ends, rising.
    pub range: [f64; 2],
}

impl Brush {
    /// Returns the brush between two values, whichever is the larger one; none where it is empty or a value is no number.
    #[must_use]
    pub fn between(axis: BrushAxis, a: f64, b: f64) -> Option<Self> {
        let [low, high] = [a.min(b), a.max(b)].map(|value| value.clamp(0.0, axis.end()));
        (low < high).then_some(Self {
            axis,
            range: [low, high],
        })
    }

    /// Returns its range, if it is of `axis`.
    #[must_use]
    pub fn along(brush: Option<Self>, axis: BrushAxis) -> Option<[f64; 2]> {
        let range = brush.filter(|brush| brush.axis == axis);
        range.map(|brush| brush.range)
    }
}

/// A moment and a brush.
type Of = (Key, Brush);
/// What was found; or why nothing was, if the user did not wish it so.
pub type Outcome = Result<Cause, Option<String>>;

/// The causes of what is brushed at the moment, as far as they are known.
#[derive(Default)]
pub struct Marks {
    /// What was asked for in the frame before.
    asked: Option<Of>,
    work: Option<(Of, Job<Outcome>)>,
    found: Option<(Of, BrushedCause)>,
    failed: Option<(Of, String)>,
    serial: u64,
}

impl Marks {
    /// Returns what was found for a brush of a moment.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>, brush: Brush) -> Option<&BrushedCause> {
        let (of, found) = self.found.as_ref()?;
        (*of == (key_of(shown), brush)).then_some(found)
    }

    /// Says what was found, or why nothing was.
    #[must_use]
    pub fn said(&self, shown: &ShownMoment<'_>, brush: Brush) -> String {
        if let Some(found) = self.of(shown, brush) {
            return said(&found.cause);
        }
        match &self.failed {
            Some((of, why)) if *of == (key_of(shown), brush) => why.clone(),
            _ => "Being looked for\u{2026}".to_owned(),
        }
    }

    /// Returns how much of the search is done, from 0 to 1, while causes are looked for.
    #[must_use]
    pub fn progress(&self) -> Option<f32> {
        self.work.as_ref().map(|(_, job)| job.fraction())
    }

    /// Stops looking; what was found stays.
    pub(super) fn rest(&mut self) {
        (self.asked, self.work) = (None, None);
    }

    /// Takes what is found, and has the causes looked for once brush and moment rest from one call to the next.
    pub(super) fn want(
        &mut self,
        session: &Arc<Session>,
        shown: &ShownMoment<'_>,
        brush: Option<Brush>,
        wake: &Wake,
    ) {
        self.poll();
        let of = brush.map(|brush| (key_of(shown), brush));
        if self.asked != of {
            (self.asked, self.work) = (of, None);
            wake();
            return;
        }
        let Some(of) = of else {
            self.found = None;
            return;
        };
        let known = self.found.as_ref().is_some_and(|(found, _)| *found == of);
        let refused = self
            .failed
            .as_ref()
            .is_some_and(|(failed, _)| *failed == of);
        if known || refused || self.work.is_some() {
            return;
        }
        let still = Still::of(session, shown.moment());
        let causing = BrushTask { still, brush: of.1 };
        self.work = Some((of, task::start(wake, causing)));
    }

    fn poll(&mut self) {
        let outcome = self.work.as_ref().and_then(|(_, job)| job.poll());
        if let Some(outcome) = outcome
            && let Some((of, _)) = self.work.take()
        {
            self.take(of, outcome);
        }
    }

    fn take(&mut self, of: Of, outcome: Result<Outcome, String>) {
        match outcome {
            Ok(Ok(cause)) => {
                self.serial += 1;
                let serial = self.serial;
                self.found = Some((of, BrushedCause { serial, cause }));
            }
            Ok(Err(None)) => {}
            Ok(Err(Some(why))) => self.failed = Some((of, why)),
            Err(panic) => self.failed = Some((of, tilescope_session::words::sentence(&panic))),
        }
    }

    /// Waits for what is at work; returns whether anything was.
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

/// Has the causes of what is brushed at a moment found.
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

/// Returns the causes of what is seen of `set` in a brush. `ids` are those of its samples, among `all` samples of the run.
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
                ids: [pair.first, pair.second].map(|index| ids[index as usize]),
                offset: DVec2::from(pair.offset) / set.radius,
            });
            Ok(Cause::Pairs {
                total: found.total,
                pairs: pairs.collect(),
            })
        }
        BrushAxis::Frequency => {
            let root = (points.len() as f64).sqrt();
            let ring = brush.range.map(|nu| nu * root);
            let found = frequency_shares(points, region, ring, control)?;
            let mean = found.mean_power as f32;
            let mut shares = vec![f32::NAN; all];
            for (id, share) in ids.iter().zip(found.relative(points, region)) {
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

/// Returns the distance from the mean beyond which only few shares are.
fn strongest(shares: &[f32], mean: f32) -> f32 {
    let sizes = shares.iter().filter(|share| share.is_finite());
    let mut sizes: Vec<f32> = sizes.map(|share| (share - mean).abs()).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let place = (TINTED * (sizes.len() - 1) as f64) as usize;
    let (_, size, _) = sizes.select_nth_unstable_by(place, f32::total_cmp);
    size.max(f32::MIN_POSITIVE)
}

fn said(cause: &Cause) -> String {
    match cause {
        Cause::Pairs { total, pairs } => {
            let count = counted(*total as usize, "pair", "pairs");
            let cut = if *total > pairs.len() as u64 {
                format!(
                    "; the {} lowest in the domain are kept",
                    grouped(pairs.len())
                )
            } else {
                String::new()
            };
            format!("{count}, joined by lines on the canvas{cut}.")
        }
        Cause::Shares { frequencies: 0, .. } => "No frequency lies in the ring.".to_owned(),
        Cause::Shares {
            frequencies,
            mean_power,
            strongest,
            ..
        } => format!(
            "{}, mean power {mean_power:.3}. Large red samples add more than the mean sample, small blue ones less; strongest at {strongest:.1} of noise's share in the same place from the mean.",
            counted(*frequencies as usize, "frequency", "frequencies"),
        ),
    }
}
