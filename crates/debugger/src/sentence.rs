//! Events in words: one plain sentence each, for the timeline and for screen readers.

mod arrived;
mod exact;
mod gaps;
mod local;
mod short;
mod space;

use tilescope_core::stages::blocks::Axis;
use tilescope_core::{Fate, Insertion, Origin, Point, R, Rect, Run, RunEvent, Stage, Variant};

use crate::event::NONE;
use crate::recording::Recording;

pub use arrived::{arrival_text, why_here};
pub use short::short;
pub use tilescope_core::grouped;

/// Returns a sentence that describes the event at `index`, names its samples, and gives distances: in r or, where the
/// radius depends on the place, in the units of the domain. Past the last event it says that the run has ended.
#[must_use]
pub fn sentence(recording: &Recording, index: usize) -> String {
    let Some(event) = recording.event(index) else {
        return "The run has ended.".to_owned();
    };

    let words = Words(recording);
    let mut text = match event.run_event() {
        Some(run_event) => words.run_event(run_event, index),
        // Only a notice of tests that were left out is no run event, and it has their number.
        None => left_out(event.left_out().unwrap_or(0)),
    };

    // The texts below begin in lower case, as parts of a sentence. All begin with a letter of ASCII or a digit.
    if let Some(first) = text.get(..1).map(str::to_ascii_uppercase) {
        text.replace_range(..1, &first);
    }
    text.push('.');
    text
}

/// Returns a length in r with two decimals, or with three if two would round another length to 1.00.
pub(crate) fn radii(units: f64) -> String {
    let radii = units / f64::from(R);

    // "1.00 r" would say neither whether two samples are in conflict nor whether a place is covered.
    let off = (radii - 1.0).abs();
    if off > 0.0 && off < 0.005 {
        format!("{radii:.3} r")
    } else {
        format!("{radii:.2} r")
    }
}

/// Returns the coordinates of a point, in r from the domain's lowest corner.
pub(crate) fn coordinates(point: Point) -> String {
    let radii = |x: i32| f64::from(x) / f64::from(R);
    format!("({:.2}, {:.2}) r", radii(point.x), radii(point.y))
}

/// Returns the name of a sample: its number and where it comes from.
pub(crate) fn sample_name(run: &Run, sample: u32) -> String {
    let number = grouped(sample.into());
    match run.samples.origins.get(sample as usize) {
        Some(Origin::Tiled { block, .. }) => {
            format!("sample {number} of block {}", grouped((*block).into()))
        }
        Some(Origin::Inserted { .. }) => format!("inserted sample {number}"),
        None if sample == NONE => "a sample".to_owned(),
        None => format!("sample {number}"),
    }
}

/// Returns `1 sample` or `7 samples`.
pub(crate) fn count(number: u64, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", grouped(number))
}

struct Words<'a>(&'a Recording);

impl Words<'_> {
    fn sample(&self, sample: u32) -> String {
        sample_name(self.0.run(), sample)
    }

    /// Returns how far apart two samples are.
    fn apart(&self, a: u32, b: u32) -> String {
        match (self.0.point(a), self.0.point(b)) {
            (Some(a), Some(b)) => radii((self.0.domain().distance_squared(a, b) as f64).sqrt()),
            _ => "some way".to_owned(),
        }
    }

    /// Returns the sentence of a run event, which has this index.
    fn run_event(&self, run_event: RunEvent, index: usize) -> String {
        // Exact tiling shares events with other runs, but some mean something else in it: a sample is kept or
        // eliminated as it arrives.
        if let Some(text) = self.exact(run_event) {
            return text;
        }
        // Where the radius depends on the place, the sentences of darts name the radii.
        if let Some(text) = self.local(run_event, index) {
            return text;
        }
        // In space places have three coordinates.
        if let Some(text) = self.space(run_event, index) {
            return text;
        }

        match run_event {
            RunEvent::Begin(stage) => self.begin(stage),
            RunEvent::Candidate {
                detector,
                sites,
                offset,
                verdict,
            } => self.candidate(detector, sites, offset, verdict),
            RunEvent::Insert { sample, iteration } => self.insertion(sample, iteration),
            RunEvent::Dart {
                point,
                ranked,
                verdict,
                ..
            } => self.dart(point, ranked, verdict),
            RunEvent::Cut {
                cell, side, kept, ..
            } => gaps::cut(cell, side, kept),

            // The other kinds are divided among functions, each of which passes on the kinds that are not its own: `change`,
            // then `tree`, `round` and `search`.
            _ => self.change(run_event, index),
        }
    }

    /// Returns the sentence of a stage that begins.
    fn begin(&self, stage: Stage) -> String {
        let run = self.0.run();

        // How many samples take part in elimination: those of the clips, which have the lowest ids, without the ones dropped
        // outside a bounded domain.
        let samples = || {
            let tiled = run.tiles.last().map_or(0, |tile| tile.samples.end as usize);
            let fates = run.samples.fates.iter().take(tiled);
            let inside = fates.filter(|&&fate| fate != Fate::Dropped).count();
            count(inside as u64, "sample")
        };

        let blocks = || count(run.blocks.leaves.len() as u64, "block");

        match stage {
            Stage::Pattern => "the pattern is about to be made".to_owned(),
            Stage::Blocks => format!(
                "the domain, {}, is about to be cut into {}",
                size(&self.0.domain().rect()),
                blocks()
            ),
            Stage::Tile => format!("the tiling of {} is about to begin", blocks()),

            // As printed, each elimination is followed by insertions, so that no stage only resolves conflicts.
            Stage::Eliminate if run.parameters.variant == Variant::AsPrinted => format!(
                "conflicts among {} are about to be resolved and gaps filled in turn",
                samples()
            ),
            Stage::Eliminate => {
                format!("conflicts among {} are about to be resolved", samples())
            }

            Stage::Iterate(k) => format!("iteration {} is about to begin", grouped(k.into())),
            Stage::Regions => "the regions are about to be sampled".to_owned(),
            Stage::Finish => "the valid samples are about to be put in order".to_owned(),
        }
    }

    /// Returns the sentence of an event of the KD-tree's nodes and blocks.
    fn tree(&self, run_event: RunEvent) -> String {
        let blocks = &self.0.run().blocks;
        match run_event {
            RunEvent::Split { index, turned } => self.split(index, turned),

            RunEvent::Leaf { block } => {
                // A recording that was cut off may lack the block: the sentence then gives no size.
                let leaf = blocks.leaves.get(block as usize);
                let of_size =
                    leaf.map_or_else(String::new, |leaf| format!(", {}", size(&leaf.rect)));
                let block = grouped(block.into());
                format!("block {block} is a leaf of the KD-tree{of_size}")
            }

            RunEvent::Clip { block } => {
                // A recording that was cut off keeps the tiles of its clips, so that 0 never stands in.
                let tile = self.0.run().tiles.get(block as usize);
                let samples = tile.map_or(0, |tile| tile.samples.len() as u64);
                let block = grouped(block.into());
                format!(
                    "block {block} receives its clip of the pattern, {}",
                    count(samples, "sample")
                )
            }

            _ => self.round(run_event),
        }
    }

    /// Returns the sentence of a split.
    fn split(&self, index: u32, turned: bool) -> String {
        let Some(split) = self.0.run().blocks.splits.get(index as usize) else {
            return format!("node {} of the KD-tree is cut", grouped(index.into()));
        };

        let axis = match split.axis {
            Axis::X => "x",
            Axis::Y => "y",
        };

        // Algorithm 1 takes the axes in turn; a node too short for two leaves across its axis is cut across the other.
        let reason = if turned {
            ", since it is too short across the other axis"
        } else {
            ""
        };

        let (node, plane) = (size(&split.rect), radii(f64::from(split.plane)));
        format!("a node, {node}, is cut across {axis} at {plane}{reason}")
    }

    /// Returns the sentence of an event that changes a sample, or compares two.
    fn change(&self, run_event: RunEvent, index: usize) -> String {
        match run_event {
            RunEvent::Tiled { sample, inside, .. } => self.tiled(sample, inside),
            RunEvent::Take { sample, valid } => self.take(sample, valid),

            // `rest` marks a sample deep inside its block. It is kept without a turn, since no other clip reaches it.
            RunEvent::Keep { sample, rest: true } => {
                format!("{} is kept, since nothing contests it", self.sample(sample))
            }
            RunEvent::Keep { sample, .. } => {
                format!("{} is kept and claims its disk", self.sample(sample))
            }

            RunEvent::Test {
                pivot,
                other,
                covers,
            } => {
                let (a, b) = (self.sample(pivot), self.sample(other));
                let apart = self.apart(pivot, other);
                if covers {
                    format!("{a} covers {b}, {apart} away: they are in conflict")
                } else {
                    format!("{a} does not cover {b}, {apart} away")
                }
            }

            RunEvent::Eliminate { sample, by } => {
                let (winner, loser) = (self.sample(by), self.sample(sample));
                format!(
                    "{winner} eliminates {loser}, {} away",
                    self.apart(by, sample)
                )
            }

            // Line 3 of the paper's Algorithm 4 marks the sample whose turn it is. No other sample is the reason, so
            // that its own id stands for one.
            RunEvent::Mark { sample, because } if sample == because => {
                format!("{} stays and becomes a gap detector", self.sample(sample))
            }
            RunEvent::Mark { sample, because } => self.mark(sample, because, index),

            _ => self.tree(run_event),
        }
    }

    /// Returns the sentence of a sample whose turn comes. One that is not valid any more is passed over, with the sample that
    /// eliminated it if that is recorded.
    fn take(&self, sample: u32, valid: bool) -> String {
        let name = self.sample(sample);

        match self.0.run().samples.fates.get(sample as usize) {
            _ if valid => format!("the turn of {name} comes, and it is valid"),
            Some(&Fate::Eliminated { by }) => {
                format!(
                    "{name} is passed over: {} has eliminated it",
                    self.sample(by)
                )
            }
            _ => format!("{name} is passed over: it is no longer valid"),
        }
    }

    /// Returns the sentence of a tiled sample; `inside` says whether it lies in the domain.
    fn tiled(&self, sample: u32, inside: bool) -> String {
        let name = self.sample(sample);
        let own = match self.0.run().samples.origins.get(sample as usize) {
            Some(Origin::Tiled { own: true, .. }) => "inside the block",
            _ => "in the margin around the block",
        };
        if inside {
            format!("{name} is tiled, {own}")
        } else {
            format!("{name} would lie outside the domain and is dropped")
        }
    }

    /// Returns the sentence of a sample that is marked because of the loss of another one.
    fn mark(&self, sample: u32, because: u32, index: usize) -> String {
        let (name, lost) = (self.sample(sample), self.sample(because));

        let gone = match self.0.status(because, index) {
            crate::life::Status::Dropped => "was dropped",
            crate::life::Status::Eliminated => "was eliminated",
            // No engine of today marks a sample because of one that is still there.
            _ => "opened a place",
        };

        let apart = self.apart(sample, because);
        format!("{name} becomes a gap detector: {lost}, {apart} away, {gone}")
    }

    /// Returns the sentence of an event of an iteration or of the end.
    fn round(&self, run_event: RunEvent) -> String {
        match run_event {
            RunEvent::Iteration { number, detectors } => {
                // Staged insertion by darts has no detectors: it throws at active cells, which may hold uncovered places, and
                // the event has their number instead.
                let noun = match self.0.run().parameters.insertion {
                    Insertion::Uniform if self.0.run().parameters.variant == Variant::Staged => {
                        "active cell"
                    }
                    _ => "detector",
                };

                let (number, detectors) = (grouped(number.into()), count(detectors.into(), noun));
                format!("iteration {number} begins with {detectors}")
            }

            RunEvent::IterationEnd { number, inserted } => {
                let (number, what) = (grouped(number.into()), count(inserted.into(), "sample"));
                format!("iteration {number} ends: it inserted {what}")
            }

            RunEvent::Rank { candidates } => {
                let verb = if candidates == 1 { "is" } else { "are" };
                let candidates = count(candidates.into(), "candidate");
                format!("{candidates} {verb} put in random order")
            }

            RunEvent::Finish { count: number } => {
                format!("the result is there: {}", count(number.into(), "sample"))
            }

            _ => self.search(run_event),
        }
    }
}

/// Returns a number with three significant digits, without an exponent.
#[must_use]
pub fn significant(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    // Three significant digits: the last one is two places behind the first, whose place the logarithm gives.
    // From 100 on there are no decimals; the most, 12, are chosen, not measured.
    let decimals = (2.0 - number.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{number:.decimals$}")
}

/// Returns a length in r, small ones as a fraction, since the sides of cells are halved.
#[must_use]
pub fn fraction(units: i32) -> String {
    // Cells are halved from a part of r on, and R is a power of two, so that their sides divide it.
    if units > 0 && units < R && R % units == 0 {
        format!("r / {}", grouped(u64::from((R / units).unsigned_abs())))
    } else {
        radii(f64::from(units))
    }
}

fn size(rect: &Rect) -> String {
    let width = f64::from(rect.width()) / f64::from(R);
    format!("{width:.2} by {}", radii(f64::from(rect.height())))
}

fn left_out(number: u32) -> String {
    let verb = if number == 1 { "was" } else { "were" };
    let tests = count(number.into(), "test");
    format!("{tests} that came to nothing {verb} left out here to stay within the budget")
}
