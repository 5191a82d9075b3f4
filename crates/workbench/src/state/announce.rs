//! Announcements for screen readers: the last event or stage, the verdict and the notice, each when it changes.

use tilescope_classroom::lessons::Lessons;
use tilescope_session::sentence::{happened, name_in};
use tilescope_session::words::grouped;

use super::{Notice, RunView, Verification};

/// The texts announced last, and the announcement.
#[derive(Default)]
pub struct Announcer {
    happened: String,
    /// The generation of the session, and its verdict.
    verdict: Option<(u64, String)>,
    notice: Option<String>,
    pub(super) announcement: Option<String>,
}

impl Announcer {
    /// Updates the announcement, in the language of the window, if the moment, the verdict or the notice has changed.
    /// During playback only a change of the stage counts as another moment.
    pub(super) fn follow(
        &mut self,
        run: &RunView,
        is_playing: bool,
        notice: Option<&Notice>,
        lessons: &Lessons,
    ) {
        let happened = time_text(run, is_playing);
        let verdict = verdict_text(run);
        let notice = notice.map(|notice| {
            let kind = if notice.is_error { "Error: " } else { "" };
            format!("{kind}{}", notice.text)
        });

        // Only changes are announced, because a screen reader reads each announcement from its beginning.
        let mut new = Vec::new();
        if self.happened != happened {
            new.push(lessons.in_words(&happened));
        }
        if let Some((_, text)) = verdict.as_ref().filter(|_| self.verdict != verdict) {
            new.push(lessons.in_words(text));
        }
        if let Some(text) = notice.as_ref().filter(|_| self.notice != notice) {
            new.push(lessons.in_words(text));
        }
        if !new.is_empty() {
            self.announcement = Some(new.join(" "));
        }
        (self.happened, self.verdict, self.notice) = (happened, verdict, notice);
    }
}

/// Returns the announcement of the moment. During playback only stages are announced, since there are too many
/// events to listen to.
fn time_text(run: &RunView, is_playing: bool) -> String {
    match (&run.session, run.current_stage()) {
        (Some(session), Some(stage)) if is_playing => {
            format!("Playing: {}.", name_in(session, stage))
        }
        _ => happened(run.shown().as_ref()),
    }
}

/// Returns the announcement of the verdict, and the generation of its session: the same words about another session are announced
/// again. `None` if there is no session, or while its verification has not ended.
fn verdict_text(run: &RunView) -> Option<(u64, String)> {
    let generation = run.session.as_ref()?.generation;

    let text = match &run.verification {
        Verification::Nothing | Verification::Pending(_) => return None,
        Verification::Failed(why) => format!("There is no verdict. {why}"),
        Verification::Done(verdict) => {
            let found = match (verdict.conflict_free(), verdict.maximal()) {
                // A stipple is a prefix of a maximal set, and not maximal itself.
                (true, true) if verdict.stipple.is_some() => {
                    "Verified: the dots are conflict-free."
                }
                (true, true) => "Verified: conflict-free and maximal.",
                (true, false) => "The verifier found gaps: the set is not maximal.",
                (false, true) => "The verifier found conflicts.",
                (false, false) => "The verifier found conflicts and gaps.",
            };

            // A verdict on nested levels is about a prefix, whose radius and covering are promised for its number of
            // samples. Whether they are as promised is said in place of conflicts and gaps.
            match verdict.claim {
                Some(claim) => {
                    let word = if verdict.valid() { "" } else { " not" };
                    let count = grouped(claim.count);
                    format!("The first {count} samples are{word} as promised.")
                }
                None => found.to_owned(),
            }
        }
    };

    Some((generation, text))
}
