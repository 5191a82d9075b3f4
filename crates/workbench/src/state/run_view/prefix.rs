//! The prefix of nested levels or of a stipple: how many samples are shown, and having these verified in the background as the number
//! moves. A verdict keeps the number that it is about, and is not taken for that of another.

use tilescope_debugger::Direction;
use tilescope_session::jobs::Job;
use tilescope_session::task::{self, SessionRef};
use tilescope_session::verification::{Verdict, VerifyTask};

use super::RunView;
use crate::state::Verification;
use crate::state::effects::Context;

/// Prefixes of at most this many samples are verified while the number still moves, since that takes less than a tenth
/// of a second.
const MAX_AT_ONCE: usize = 50_000;
/// For how long the number of a larger prefix must rest before it is verified, in seconds: while the number moves, each frame would
/// start work that the next one stops. Chosen, not measured.
const REST_SECS: f32 = 0.15;

/// The prefix that is shown.
#[derive(Default)]
pub struct Prefix {
    /// The number of samples that are shown.
    count: usize,
    /// For how long the number has rested, in seconds.
    rested_secs: f32,
    /// The number that the verdict, or the failure to give one, is about.
    judged: usize,
    /// The verification of another number: that number and the work.
    work: Option<(usize, Job<Result<Verdict, String>>)>,
}

impl RunView {
    /// Returns how many samples are shown, if the session has nested levels or is a stipple.
    #[must_use]
    pub fn prefix(&self) -> Option<usize> {
        let session = self.session.as_ref()?;
        session.has_prefixes().then_some(self.prefix.count)
    }

    /// Returns whether a stipple is shown.
    #[must_use]
    pub fn shows_stipple(&self) -> bool {
        let session = self.session.as_ref();
        session.is_some_and(|session| session.stipple().is_some())
    }

    /// Shows all samples of a session, whose verification begins elsewhere.
    pub(in crate::state) fn show_whole(&mut self, count: usize) {
        self.prefix = Prefix {
            count,
            judged: count,
            ..Prefix::default()
        };
    }

    /// Shows the first `count` samples; at least one.
    pub(super) fn show_prefix(&mut self, count: usize) {
        let all = self
            .session
            .as_ref()
            .map_or(0, |session| session.summary.count);
        let count = count.clamp(1, all.max(1));
        if count != self.prefix.count {
            (self.prefix.count, self.prefix.rested_secs) = (count, 0.0);
            self.witness_mark = None;
        }
    }

    /// Shows a sample more or less, or the next or previous end of a level.
    pub(in crate::state) fn step_prefix(&mut self, by_sample: bool, direction: Direction) {
        let (Some(session), Some(count)) = (&self.session, self.prefix()) else {
            return;
        };

        let ends = session.ends();
        let to = match (by_sample, direction) {
            (true, Direction::Forwards) => count + 1,
            // A prefix has at least one sample.
            (true, Direction::Backwards) => count - 1,
            (false, Direction::Forwards) => {
                let next = ends.into_iter().find(|&end| end > count);
                next.unwrap_or(count)
            }
            (false, Direction::Backwards) => {
                let before = ends.into_iter().rfind(|&end| end < count);
                before.unwrap_or(1)
            }
        };

        self.show_prefix(to);
    }

    /// Returns the number of samples that are shown, if the verdict on them is still to come.
    #[must_use]
    pub fn prefix_at_work(&self) -> Option<usize> {
        let count = self.prefix()?;
        (count != self.prefix.judged).then_some(count)
    }

    /// Returns the verdict on the prefix that is shown, in a short sentence; nothing for other sessions.
    #[must_use]
    pub fn prefix_verdict(&self) -> &'static str {
        match &self.verification {
            // In a lesson nothing is verified, as a verdict would answer questions.
            Verification::Nothing => "",
            _ if self.prefix().is_none() => "",
            _ if self.prefix_at_work().is_some() => " Verifying.",
            Verification::Done(verdict) if verdict.valid() => " Verified.",
            Verification::Done(_) => " This is not so.",
            Verification::Failed(_) => " There is no verdict.",
            Verification::Pending(_) => " Verifying.",
        }
    }

    /// Has the prefix verified, unless it is, and takes finished work. Work on a large prefix that is no longer shown is
    /// stopped.
    pub(in crate::state) fn follow_prefix(&mut self, dt_secs: f32, context: &Context) {
        let (Some(session), Some(count)) = (&self.session, self.prefix()) else {
            return;
        };

        self.prefix.rested_secs += dt_secs;
        // The verification of the whole set, which began elsewhere, must end before that of a prefix begins. In a
        // lesson nothing is verified.
        if matches!(
            self.verification,
            Verification::Pending(_) | Verification::Nothing
        ) {
            return;
        }

        if let Some((judged, outcome)) = self
            .prefix
            .work
            .as_ref()
            .and_then(|(judged, job)| Some((*judged, job.poll()?)))
        {
            (self.prefix.work, self.prefix.judged) = (None, judged);
            return self.finish_verification(outcome);
        }

        // Only work on a large prefix is stopped: work on a small one ends by itself in less than a tenth of a second.
        // No prefix of a stipple counts as small, as each verdict on dots makes the field of the image again.
        let at_once = session.nested.as_ref().map_or(0, |_| MAX_AT_ONCE);
        let is_stale = |(of, _): &(usize, _)| *of != count && *of > at_once;
        if self.prefix.work.as_ref().is_some_and(is_stale) {
            self.prefix.work = None;
        }

        let is_due = count <= at_once || self.prefix.rested_secs >= REST_SECS;
        if count != self.prefix.judged && self.prefix.work.is_none() && is_due {
            let judging = VerifyTask {
                session: SessionRef(std::sync::Arc::clone(session)),
                prefix: Some(count),
            };
            self.prefix.work = Some((count, task::start(&context.wake, judging)));
        }
    }

    /// Returns whether the number has to rest before its prefix is verified: another frame is due.
    pub(in crate::state) fn awaits_rest(&self) -> bool {
        let is_idle = self.prefix.work.is_none();
        let is_known = matches!(
            self.verification,
            Verification::Done(_) | Verification::Failed(_)
        );
        is_known && is_idle && self.prefix_at_work().is_some()
    }

    /// Waits for the verdict on the prefix.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_prefix(&mut self, context: &Context) {
        // The first round ends work on another number.
        for _ in 0..2 {
            self.follow_prefix(REST_SECS, context);
            if let Some((judged, job)) = self.prefix.work.take() {
                self.prefix.judged = judged;
                self.finish_verification(job.wait());
            }
        }
    }
}
