//! Announcements for screen readers: the last event or stage, the verdict and the notice, each when it changes.

use tilescope_session::sentence::{happened, name_in};
use tilescope_session::words::grouped;

use super::{State, Verification};

/// The texts announced last, and the announcement.
#[derive(Default)]
pub struct Announcer {
    happened: String,
    verdict: Option<(u64, String)>,
    notice: Option<String>,
    announcement: Option<String>,
}

impl State {
    /// Returns the text for a screen reader: the newest of these. It stays the same until there is another.
    #[must_use]
    pub fn announcement(&self) -> Option<String> {
        self.messages.announcer.announcement.clone()
    }

    /// Updates the announcement.
    pub(super) fn announce(&mut self) {
        let happened = self.time_text();
        let verdict = self.verdict_text();
        let notice = self.messages.notice.as_ref().map(|notice| {
            let kind = if notice.is_error { "Error: " } else { "" };
            format!("{kind}{}", notice.text)
        });
        let old = &self.messages.announcer;
        let mut new = Vec::new();
        if old.happened != happened {
            new.push(self.classroom.lessons.in_words(&happened));
        }
        if let Some((_, text)) = verdict.as_ref().filter(|_| old.verdict != verdict) {
            new.push(self.classroom.lessons.in_words(text));
        }
        if let Some(text) = notice.as_ref().filter(|_| old.notice != notice) {
            new.push(self.classroom.lessons.in_words(text));
        }
        let announcement = if new.is_empty() {
            self.messages.announcer.announcement.take()
        } else {
            Some(new.join(" "))
        };
        self.messages.announcer = Announcer {
            happened,
            verdict,
            notice,
            announcement,
        };
    }

    /// Returns the announcement of the moment. During playback only stages are announced, since there are too many
    /// events to listen to.
    fn time_text(&self) -> String {
        match (&self.runs.first.session, self.current_stage()) {
            (Some(session), Some(stage)) if self.time.playback.is_playing() => {
                format!("Playing: {}.", name_in(session, stage))
            }
            _ => happened(self.shown().as_ref()),
        }
    }

    fn verdict_text(&self) -> Option<(u64, String)> {
        let generation = self.runs.first.session.as_ref()?.generation;
        let text = match &self.runs.first.verification {
            Verification::Nothing | Verification::Pending(_) => return None,
            Verification::Failed(why) => format!("There is no verdict. {why}"),
            Verification::Done(verdict) => {
                let found = match (verdict.conflict_free(), verdict.maximal()) {
                    (true, true) => "Verified: conflict-free and maximal.",
                    (true, false) => "The verifier found gaps: the set is not maximal.",
                    (false, true) => "The verifier found conflicts.",
                    (false, false) => "The verifier found conflicts and gaps.",
                };
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
}
