//! Moments and stages in words: the events of a stage in one sentence, with the numbers of the run, or the last event.

use tilescope_core::{Boundary, Stage};

use crate::moment::ShownMoment;
use crate::nested::NestedLevels;
use crate::session::Session;
use crate::solid::MadeSolid;
use crate::stipple::MadeStipple;
use crate::units::radii;
use crate::words::{counted, grouped, share, stage_name};

/// Returns the name of a stage of a session with a capital letter.
#[must_use]
pub fn name_in(session: &Session, stage: Stage) -> String {
    // A combination has pieces in the place of blocks, nested levels have no stage but the end, an exact tiling has
    // levels, and a set in a field, a shape or space has throws.
    match stage {
        Stage::Blocks if session.combination.is_some() => "Pieces".to_owned(),
        Stage::Tile if session.combination.is_some() => "Place".to_owned(),
        Stage::Finish if session.nested.is_some() => "Levels".to_owned(),
        Stage::Finish if session.stipple().is_some() => "Dots".to_owned(),
        Stage::Iterate(k) if session.has_own_disks() => format!("Throw {k}"),
        Stage::Iterate(1) if session.is_exact() => "Levels 0, 1".to_owned(),
        Stage::Iterate(k) if session.is_exact() => format!("Level {k}"),
        stage => stage_name(stage),
    }
}

/// Returns the last step at a moment, in words: the stage, if the moment is its end, otherwise the event; of nested
/// levels the claims on the samples shown, of a stipple what its shown dots are, and of a set in space at the end of a
/// stage what the plane shows. Without a moment there is no session yet.
#[must_use]
pub fn happened(shown: Option<&ShownMoment<'_>>) -> String {
    let Some(shown) = shown else {
        return "The default session is being sampled.".to_owned();
    };

    if let Some((nested, count)) = shown.session.nested.as_ref().zip(shown.prefix) {
        return prefix_sentence(shown.session, nested, count);
    }

    if let Some((stipple, count)) = shown.session.stipple().zip(shown.prefix) {
        return stipple_sentence(shown.session, stipple, count);
    }

    // Of a set in space the plane says more than the stage as a whole.
    if let Some((solid, plane)) = shown.session.solid.as_ref().zip(shown.plane)
        && (shown.debugger.is_none() || shown.ends_stage())
    {
        return in_plane(shown.session, solid, shown.stage, plane);
    }

    match (shown.debugger, shown.cursor().checked_sub(1)) {
        // Before the first event, and where a stage ends, the stage as a whole says more than one event.
        (Some(debugger), Some(last)) if !shown.ends_stage() => {
            tilescope_debugger::sentence(debugger.recording(), last)
        }

        _ => stage_sentence(shown.session, shown.stage),
    }
}

/// Returns what a plane through a set in space shows at the end of a stage, in words.
fn in_plane(session: &Session, solid: &MadeSolid, stage: Stage, plane: i32) -> String {
    match stage {
        Stage::Iterate(throw) => {
            let iteration = session.iteration(throw);
            let count = iteration.map_or(0, |iteration| iteration.inserted.end as usize);
            let cubes = session.active_cubes(stage, plane).unwrap_or_default();
            solid.throw_sentence(throw, cubes, count, plane)
        }
        _ => solid.plane_sentence(plane),
    }
}

/// Returns the claims on the first `count` samples of nested levels, in words.
fn prefix_sentence(session: &Session, nested: &NestedLevels, count: usize) -> String {
    let r = session.run().domain.radius();
    let claim = nested.claim(count);
    let (distance, all) = (claim.distance / r, grouped(session.summary.count));

    // The level of the last sample; a prefix has at least one.
    let last = nested.level_of(count - 1);
    let begun = match nested.whole(count) {
        Some(level) if level == last => format!("level {level} is whole"),
        Some(level) => format!("level {level} is whole, and {last} has begun"),
        None => format!("level {last} has begun"),
    };

    let covering = match claim.covering {
        // Only a prefix that ends where a level ends promises to cover the domain.
        Some(covering) => format!(
            "no place is farther than {:.2} r from a sample.",
            covering / r
        ),
        None => "they need not cover yet.".to_owned(),
    };
    format!(
        "The first {} of {all} samples: {begun}. Distances exceed {distance:.2} r, and {covering}",
        grouped(count)
    )
}

/// Returns what the first `count` dots of a stipple are, in words.
fn stipple_sentence(session: &Session, stipple: &MadeStipple, count: usize) -> String {
    let all = session.summary.count;
    if count < all {
        return format!(
            "The first {} of {} dots: the same image with fewer dots, no two of which are near each other.",
            grouped(count),
            grouped(all)
        );
    }
    // On a page, whose numbers have 32 bits, no stipple has more dots than these hold.
    let made = grouped(usize::try_from(stipple.made).unwrap_or(usize::MAX));
    format!(
        "All {} dots: the first of {made} by their arrival, as dense as the image is dark.",
        grouped(all)
    )
}

/// Returns the events of `stage`, in one sentence.
#[must_use]
pub fn stage_sentence(session: &Session, stage: Stage) -> String {
    // Some stages of combinations and exact tilings differ from those of a run, and all of sets in a field or a shape.
    let other = combination_sentence(session, stage)
        .or_else(|| ground_sentence(session, stage))
        .or_else(|| exact_sentence(session, stage));
    if let Some(sentence) = other {
        return sentence;
    }

    let run = session.run();
    let summary = &session.summary;
    let samples = |count: usize| counted(count, "sample", "samples");

    match stage {
        Stage::Pattern => {
            let domain = run.pattern.domain();
            let boundary = match domain.boundary() {
                Boundary::Periodic => "periodic",
                Boundary::Bounded => "bounded",
            };
            format!(
                "Pattern: a maximal {boundary} set of {}, {:.0} r wide, from which every block clips.",
                samples(run.pattern.samples().len()),
                radii(domain.width()),
            )
        }

        Stage::Blocks => {
            let [width, height] = session.size_radii().to_array();
            format!(
                "Blocks: a domain of {width:.1} \u{d7} {height:.1} r is split into {} with edges of at least {} r.",
                counted(summary.blocks, "block", "blocks"),
                run.parameters.leaf,
            )
        }

        Stage::Tile => format!(
            "Tile: {}, each enlarged by r, bring {}; {} in conflict.",
            counted(summary.blocks, "clip", "clips"),
            samples(summary.tiled),
            counted(session.conflicts.len(), "pair is", "pairs are"),
        ),

        Stage::Eliminate => elimination_sentence(session),
        Stage::Iterate(k) => iteration_sentence(session, k),
        // No session stops at regions, which are a part of a parallel engine's run: the arm only completes the list.
        Stage::Regions | Stage::Finish => format!(
            "Finish: {} tiled \u{2212} {} eliminated + {} inserted = {}, in canonical order.",
            grouped(summary.tiled),
            grouped(summary.eliminated),
            grouped(summary.inserted.iter().sum()),
            samples(summary.count),
        ),
    }
}

/// Returns the sentence for the stage of elimination.
fn elimination_sentence(session: &Session) -> String {
    let summary = &session.summary;
    let samples = |count: usize| counted(count, "sample", "samples");

    // The first iteration's detectors are found during elimination. Uniform insertion has none, and not every engine records them.
    let detectors = session.iteration(1).map_or(0, |i| i.detectors.len());
    let looking = if detectors > 0 {
        format!(" {} will look for gaps.", samples(detectors))
    } else {
        String::new()
    };

    // Algorithm 4 as printed fills gaps while it eliminates; other runs insert nothing here.
    let at_once = match session.inserted_at_once() {
        0 => String::new(),
        n => format!(
            " {} inserted at once.",
            counted(n, "sample is", "samples are")
        ),
    };

    format!(
        "Eliminate: {} eliminated, because another sample claimed their disk first; {} stay.{at_once}{looking}",
        samples(summary.eliminated),
        grouped(summary.tiled - summary.eliminated),
    )
}

/// Returns the sentence for a stage of a combination, if that differs from the stage of a run.
fn combination_sentence(session: &Session, stage: Stage) -> Option<String> {
    let combination = session.combination.as_ref()?;
    let summary = &session.summary;
    let pieces = counted(summary.blocks, "piece", "pieces");
    let samples = |count: usize| counted(count, "sample", "samples");
    let inserted = summary.inserted.iter().sum();

    match stage {
        Stage::Blocks => {
            let [width, height] = session.size_radii().to_array();
            let seams = counted(combination.seams.len(), "seam", "seams");
            Some(format!(
                "Pieces: a domain of {width:.1} \u{d7} {height:.1} r is filled by {pieces}, which meet along {seams}."
            ))
        }

        Stage::Tile => Some(format!(
            "Place: {pieces} bring {}, up to r beyond their rectangles; {} in conflict.",
            samples(summary.tiled),
            counted(session.conflicts.len(), "pair is", "pairs are"),
        )),

        Stage::Finish => Some(format!(
            "Finish: {} of {pieces}; {} eliminated, {} inserted ({}).",
            samples(summary.count),
            grouped(summary.eliminated),
            grouped(inserted),
            share(inserted, summary.count),
        )),

        // A combination eliminates and iterates as a run does, and has no pattern.
        _ => None,
    }
}

/// Returns the sentence for a stage of a set in a field or a shape, which has throws of darts alone.
fn ground_sentence(session: &Session, stage: Stage) -> Option<String> {
    let (parameters, request) = &session.ground.as_ref()?.asked;
    // An exact tiling of a shape has the stages of any exact tiling.
    if session.is_exact() {
        return None;
    }

    let samples = |count: usize| counted(count, "sample", "samples");
    // A tiled shape comes here without its tiles only from a file.
    let how = if request.is_tiled(parameters) {
        "by exact tiling, from a file"
    } else {
        "by darts, in the order of their arrival"
    };

    Some(match stage {
        // Each throw of darts is a stage of its own.
        Stage::Iterate(k) => {
            let iteration = session.iteration(k)?;
            format!(
                "Throw {k}: {} darts; {} become samples.",
                counted(
                    iteration.cells.len(),
                    "active cell throws",
                    "active cells throw"
                ),
                grouped(iteration.inserted.len()),
            )
        }
        _ => format!(
            "Finish: {} {how} ({}).",
            samples(session.summary.count),
            request.description()
        ),
    })
}

/// Returns the sentence for a stage of an exact tiling, if that differs from the stage of another run.
fn exact_sentence(session: &Session, stage: Stage) -> Option<String> {
    if !session.is_exact() {
        return None;
    }

    let summary = &session.summary;
    let samples = |count: usize| counted(count, "sample", "samples");

    let k = match stage {
        Stage::Iterate(k) => k,
        Stage::Tile => {
            return Some(format!(
                "Tile: {}, laid on the pattern without margins, bring {}; {} in conflict.",
                counted(summary.blocks, "block", "blocks"),
                samples(summary.tiled),
                counted(session.conflicts.len(), "pair is", "pairs are"),
            ));
        }
        Stage::Finish => {
            return Some(format!(
                "Finish: {} tiled \u{2212} {} lost + {} that the pattern lacks = {}, in canonical order.",
                grouped(summary.tiled),
                grouped(summary.eliminated),
                grouped(summary.inserted.iter().sum()),
                samples(summary.count),
            ));
        }
        // Pattern and blocks are as in every run, and no session of exact tiling has one of the others.
        Stage::Pattern | Stage::Blocks | Stage::Eliminate | Stage::Regions => return None,
    };

    // Samples are lost as they arrive, level by level.
    let lost = grouped(session.lost_in(session.stage_index(stage)));
    let iteration = session.iteration(k)?;
    let inserted = samples(iteration.inserted.len());

    // The first iteration has two levels.
    Some(match k {
        1 => format!(
            "Levels 0 and 1: what came first stays; {lost} lost, {inserted} that the pattern lacks."
        ),
        _ => format!(
            "Level {k}: darts thrown at {}; {lost} lost, {inserted} that the pattern lacks.",
            counted(iteration.cells.len(), "open cell", "open cells")
        ),
    })
}

/// Returns the sentence for iteration `k`, counted from 1.
fn iteration_sentence(session: &Session, k: u32) -> String {
    // A stage that the session lacks has no numbers to be named.
    let Some(iteration) = session.iteration(k) else {
        return format!("Iteration {k}.");
    };

    let inserted = counted(iteration.inserted.len(), "sample", "samples");

    // Uniform insertion throws darts at open cells instead of looking for gaps by detectors.
    if !iteration.cells.is_empty() {
        let cells = counted(iteration.cells.len(), "open cell", "open cells");
        return format!("Iteration {k}: darts thrown at {cells}; {inserted} inserted.");
    }

    // Not every engine records its detectors.
    if iteration.detectors.is_empty() {
        return format!("Iteration {k}: {inserted} inserted.");
    }
    format!(
        "Iteration {k}: {} found {}; {inserted} inserted.",
        counted(iteration.detectors.len(), "detector", "detectors"),
        counted(
            iteration.candidates.len(),
            "uncovered place",
            "uncovered places"
        ),
    )
}
