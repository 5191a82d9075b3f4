//! Finds where two runs diverge: the first event, or the first stage, at which they differ. Samples are compared by
//! position and not by id, since engines may number them differently.

mod runs;

pub use runs::first_divergence_of_runs;

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Domain, Point, RunEvent, Stage, Verdict};

use crate::event::Event;
use crate::recording::Recording;
use crate::sentence::sentence;

/// The first difference of two runs, a and b.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Divergence {
    /// Nothing that was compared differs.
    Same,
    /// The domains differ in size or boundary.
    Domain {
        /// The domain of the first run, in words.
        a: String,
        /// The domain of the second run, in words.
        b: String,
    },
    /// Two events differ, and all before them are equal.
    Events {
        /// The event of the first recording.
        a: usize,
        /// The event of the second one.
        b: usize,
        /// The first one in words.
        sentence_a: String,
        /// The second one in words.
        sentence_b: String,
    },
    /// One recording ends, and the other continues.
    Ends {
        /// Whether it is the first one that continues.
        a_goes_on: bool,
        /// Its first additional event.
        event: usize,
        /// The event in words.
        sentence: String,
    },
    /// A stage differs, and all before it are equal.
    Stage {
        /// The first stage at which they differ.
        stage: Stage,
        /// The point at which they differ. Of several samples, candidates or cells the lowest is named; of blocks, and
        /// where only the order of the result differs, the first.
        #[serde(rename = "place")]
        point: Option<Point>,
        /// A description of the first run there.
        a: String,
        /// A description of the second run there.
        b: String,
    },
}

/// Returns the difference of the domains or else the first event at which two recordings differ. If tests were left out
/// of either tape, only events that are never left out are compared.
#[must_use]
pub fn first_divergence(a: &Recording, b: &Recording) -> Divergence {
    if let Some(different) = domains(a.domain(), b.domain()) {
        return different;
    }

    // Recordings with different budgets leave out different tests, although their runs are the same: then tests are not
    // compared.
    let whole = a.tape().left_out() == 0 && b.tape().left_out() == 0;
    let mut left = events(a, whole);
    let mut right = events(b, whole);

    loop {
        // A pair of equal events continues the loop, and an unequal pair ends it. What comes out of the match is the first
        // additional event of the longer recording.
        let (longer, index, a_goes_on) = match (left.next(), right.next()) {
            (None, None) => return Divergence::Same,
            (Some((i, x)), Some((j, y))) => {
                if equal(a, x, b, y) {
                    continue;
                }
                return Divergence::Events {
                    a: i,
                    b: j,
                    sentence_a: sentence(a, i),
                    sentence_b: sentence(b, j),
                };
            }
            (Some((index, _)), None) => (a, index, true),
            (None, Some((index, _))) => (b, index, false),
        };

        return Divergence::Ends {
            a_goes_on,
            event: index,
            sentence: sentence(longer, index),
        };
    }
}

/// Returns the difference of two domains, if there is one.
fn domains(a: &Domain, b: &Domain) -> Option<Divergence> {
    let same = |f: fn(&Domain) -> i32| f(a) == f(b);
    if same(Domain::width) && same(Domain::height) && a.boundary() == b.boundary() {
        return None;
    }

    let text = |domain: &Domain| {
        let kind = if domain.is_periodic() {
            "periodic"
        } else {
            "bounded"
        };
        format!("{kind}, {} by {} units", domain.width(), domain.height())
    };

    Some(Divergence::Domain {
        a: text(a),
        b: text(b),
    })
}

/// Returns the events that are compared, each with its index: all, or if `whole` is false those that are never left out.
fn events(recording: &Recording, whole: bool) -> impl Iterator<Item = (usize, &Event)> {
    let stays = move |event: &Event| whole || !(event.is_detail() || event.left_out().is_some());
    recording
        .tape()
        .from(0)
        .filter(move |(_, event)| stays(event))
}

/// Returns whether the event `x` of `a` and `y` of `b` are on one line and name the same points.
fn equal(a: &Recording, x: &Event, b: &Recording, y: &Event) -> bool {
    if x.line() != y.line() {
        return false;
    }

    match (x.run_event(), y.run_event()) {
        (Some(x), Some(y)) => with_points(a, x) == with_points(b, y),
        // Notices of tests left out have no run event.
        _ => x == y,
    }
}

/// The points of an event. A candidate has the most: of its detector, of three sites, and of the sample of its verdict.
type Points = [Option<Point>; 5];

/// Returns an event with its ids removed, and the points of these ids, or the points that describe its node or block.
fn with_points(recording: &Recording, run_event: RunEvent) -> (RunEvent, Points) {
    let mut points = of_block(recording, run_event);
    let mut bare = run_event;

    // Engines number samples as they come, so that ids are compared by their positions.
    let mut at = 0;
    strip(&mut bare, &mut |id: &mut u32| {
        points[at] = recording.point(*id);
        (*id, at) = (0, at + 1);
    });

    if let RunEvent::Candidate { sites, .. } = bare {
        // The sites are in the order of their ids, which differ between engines: their points are sorted. The
        // detector comes before the sites, the sample of the verdict after them.
        points[1..=sites.ids().len()].sort_unstable_by_key(|point| point.map(Point::row_major));
    }

    (bare, points)
}

/// Passes every id of a sample in an event to `take`, which replaces it. Of a candidate, the detector comes first, then the
/// sites, then the sample of the verdict: [`with_points`] sorts the sites' points and relies on this order.
fn strip(run_event: &mut RunEvent, take: &mut impl FnMut(&mut u32)) {
    match run_event {
        RunEvent::Tiled { sample, .. }
        | RunEvent::Take { sample, .. }
        | RunEvent::Keep { sample, .. }
        | RunEvent::Detect { sample }
        | RunEvent::Search { centre: sample, .. }
        | RunEvent::NoGap { sample }
        | RunEvent::Call { pivot: sample, .. }
        | RunEvent::Pairs { pivot: sample, .. }
        | RunEvent::Pass { by: sample, .. }
        | RunEvent::Wake { behind: sample, .. }
        | RunEvent::Insert { sample, .. } => take(sample),

        // The two samples of such an event have different roles, which are taken in a fixed order.
        RunEvent::Test {
            pivot: a, other: b, ..
        }
        | RunEvent::Eliminate { sample: a, by: b }
        | RunEvent::Mark {
            sample: a,
            because: b,
        } => {
            take(a);
            take(b);
        }

        RunEvent::Dart { verdict, .. } => take_from_verdict(verdict, take),

        RunEvent::Candidate {
            detector,
            sites,
            verdict,
            ..
        } => {
            take(detector);
            take_from_sites(sites, take);
            take_from_verdict(verdict, take);
        }

        // All other events name no sample. Numbers of nodes and blocks stay: they are compared as they are.
        _ => {}
    }
}

/// Takes the id out of a verdict.
fn take_from_verdict(verdict: &mut Verdict, take: &mut impl FnMut(&mut u32)) {
    if let Verdict::Covered { by: id } | Verdict::NotNearest { nearer: id } = verdict {
        take(id);
    }
}

/// Takes the ids out of sites.
fn take_from_sites(sites: &mut Sites, take: &mut impl FnMut(&mut u32)) {
    match sites {
        Sites::Three(ids) => ids.iter_mut().for_each(take),
        Sites::Border(ids) => ids.iter_mut().for_each(take),
        Sites::Corner(id) => take(id),
        Sites::Dart | Sites::Unrecorded => {}
    }
}

/// Returns the points that describe a node or a block, as its event only has its number: the corners of a node and its cut,
/// the corners of a leaf, or the start of a clip and its symmetry; `None` in the places that are not used.
fn of_block(recording: &Recording, run_event: RunEvent) -> Points {
    let run = recording.run();

    let (corners, cut) = match run_event {
        RunEvent::Split { index, .. } => {
            let split = run.blocks.splits.get(index as usize);
            // A point serves to hold the axis and the plane, so that cuts across x and across y at one distance differ.
            let plane = split.map(|split| Point::new(split.axis as i32, split.plane));
            (split.map(|split| split.rect), plane)
        }

        RunEvent::Leaf { block } => {
            let leaf = run.blocks.leaves.get(block as usize);
            (leaf.map(|leaf| leaf.rect), None)
        }

        RunEvent::Clip { block } => {
            let tile = run.tiles.get(block as usize);
            // Here, too, a point serves to hold a number.
            let symmetry = tile.map(|tile| Point::new(i32::from(tile.symmetry.0), 0));
            return [tile.map(|tile| tile.start), symmetry, None, None, None];
        }

        // All other events say all about themselves.
        _ => return [None; 5],
    };

    let ends = [corners.map(|rect| rect.min), corners.map(|rect| rect.max)];
    [ends[0], ends[1], cut, None, None]
}
