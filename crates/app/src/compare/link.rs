//! Which moment of one run corresponds to a moment of another: the same event as long as the two are the same, then the
//! same share of the same stage.

use tilescope_core::Stage;
use tilescope_debugger::Divergence;

use crate::session::Session;

/// A moment of a session: the place of its stage, and its cursor where there are events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At {
    /// The place of the stage in the session's list.
    pub stage: usize,
    /// How many events have happened.
    pub cursor: Option<usize>,
}

/// Returns the cursors up to which two recordings are the same, by what is known of where they part.
#[must_use]
pub const fn common(divergence: Option<&Divergence>) -> Option<[usize; 2]> {
    match divergence {
        Some(&Divergence::Same) => Some([usize::MAX; 2]),
        Some(&Divergence::Events { a, b, .. }) => Some([a, b]),
        Some(&Divergence::Ends { event, .. }) => Some([event; 2]),
        _ => None,
    }
}

/// Returns the moment of `to` that corresponds to the moment `at` of `from`. `common` are the cursors up to which
/// the two are the same, if that is known.
#[must_use]
pub fn corresponding(from: &Session, at: At, to: &Session, common: Option<[usize; 2]>) -> At {
    let stage = corresponding_stage(from.stages[at.stage], to);
    let end = to.stage_end(stage);
    let (Some(cursor), Some(end)) = (at.cursor, end) else {
        return At { stage, cursor: end };
    };
    if let Some([a, b]) = common
        && cursor <= a.min(b)
    {
        let cursor = cursor.min(to.stage_end(to.stages.len() - 1).unwrap_or(cursor));
        return At {
            stage: to.stage_at(cursor),
            cursor: Some(cursor),
        };
    }
    if to.stages[stage] != from.stages[at.stage] {
        return At {
            stage,
            cursor: Some(end),
        };
    }
    let bounds = |session: &Session, stage: usize, least: usize| {
        let start = stage
            .checked_sub(1)
            .and_then(|before| session.stage_end(before));
        let end = session.stage_end(stage).unwrap_or(0);
        (start.unwrap_or(0).max(least.min(end)), end)
    };
    let [a, b] = common.unwrap_or([0; 2]);
    let (low, high) = bounds(from, at.stage, a);
    let (first, last) = bounds(to, stage, b);
    let share = cursor.saturating_sub(low) as f64 / (high - low).max(1) as f64;
    let cursor = first + ((last - first) as f64 * share.min(1.0)).round() as usize;
    At {
        stage,
        cursor: Some(cursor),
    }
}

/// Returns the place of a stage in a session's list, else of the last one before it.
fn corresponding_stage(stage: Stage, to: &Session) -> usize {
    to.stages
        .iter()
        .rposition(|&other| other <= stage)
        .unwrap_or(0)
}
