//! Linked playback: which moment of one run corresponds to a moment of another. It is the same event as long as
//! the two runs are equal, then the same fraction of the same stage.

use tilescope_debugger::Divergence;
use tilescope_session::moment::Moment;
use tilescope_session::session::Session;

/// Returns the cursors up to which two runs are equal, event by event, given where they diverge. `None` if events were
/// left out of a tape, as single events then cannot be matched, or if the runs do not diverge at an event: they were not compared
/// yet, or differ in their domains or stages.
#[must_use]
pub fn common(
    first: &Session,
    second: &Session,
    divergence: Option<&Divergence>,
) -> Option<[usize; 2]> {
    let is_whole = |session: &&Session| {
        let recording = session.recording();
        recording.is_some_and(|recording| recording.tape().left_out() == 0)
    };
    // With events left out, equal cursors are not equal events.
    if ![first, second].iter().all(is_whole) {
        return None;
    }

    match divergence {
        // Equal runs correspond at every cursor.
        Some(&Divergence::Same) => Some([usize::MAX; 2]),
        Some(&Divergence::Events { a, b, .. }) => Some([a, b]),
        // One run ends there, and the other one goes on.
        Some(&Divergence::Ends { event, .. }) => Some([event; 2]),
        // Where the runs are not compared yet, or differ in a domain or a stage, no event is the first that differs.
        _ => None,
    }
}

/// Returns the moment of `to` that corresponds to the moment `at` of `from`. `common` has the cursors up to which the two runs are
/// equal, that of `from` first, if they are known.
#[must_use]
pub fn corresponding(
    from: &Session,
    at: Moment,
    to: &Session,
    common: Option<[usize; 2]>,
) -> Moment {
    let stage = to.stage_index(at.stage);
    let end = to.stage_end(stage);
    let (Some(cursor), Some(end)) = (at.cursor, end) else {
        // One of the runs has no events there, so that only whole stages correspond.
        return Moment::after(to, stage);
    };

    if let Some([a, b]) = common
        && cursor <= a.saturating_add(1)
    {
        // Up to the divergence cursors are equal, as no events were left out. At `a + 1` the event by which the runs differ has
        // just happened; in the other run that is so at `b + 1`.
        let same = if cursor <= a { cursor } else { b + 1 };
        return moment_at(to, same);
    }

    // Behind the divergence nothing corresponds exactly. From here on, `a` and `b` are the cursors just behind the divergence,
    // or 0 if it is not known.
    let [a, b] = common.map_or([0; 2], |both| both.map(|at| at.saturating_add(1)));
    if to.stages[stage] != at.stage {
        // The other run lacks the stage: the end of the last stage before it stands for it, but no moment before the divergence.
        return moment_at(to, end.max(b));
    }

    // Moments up to the divergence have been dealt with, so that only the part of the stage behind it is mapped, by proportion.
    // Returns where this part begins and ends; `least` is the cursor behind the divergence.
    let bounds = |session: &Session, stage: usize, least: usize| {
        // Both runs have events here, so that each stage has an end; the first stage begins at 0.
        let start = stage
            .checked_sub(1)
            .and_then(|before| session.stage_end(before));
        let end = session.stage_end(stage).unwrap_or(0);
        (start.unwrap_or(0).max(least.min(end)), end)
    };

    let (low, high) = bounds(from, from.stage_index(at.stage), a);
    let (first, last) = bounds(to, stage, b);
    // A part without events has length 0, which cannot be a divisor.
    let share = cursor.saturating_sub(low) as f64 / (high - low).max(1) as f64;
    let scaled = first + ((last - first) as f64 * share.min(1.0)).round() as usize;
    moment_at(to, scaled.max(b))
}

/// Returns the moment of a session after this many events, or at its end.
fn moment_at(session: &Session, cursor: usize) -> Moment {
    let end = session.stage_end(session.stages.len() - 1);
    Moment::at(session, cursor.min(end.unwrap_or(cursor)))
}
