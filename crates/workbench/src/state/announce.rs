//! What a screen reader should say: what happened last, the verdict, notices, each when it is new. Nothing is shown here.

use tilescope_session::sentence::{happened, name_in};

use super::{State, Verification};

/// What was there when something was announced last, and the announcement.
#[derive(Default)]
pub struct Announcer {
    happened: String,
    verdict: Option<(u64, String)>,
    notice: Option<String>,
    announcement: Option<String>,
}

impl State {
    /// Returns what a screen reader should say: the last thing that was new when the state went on. It stays the same until
    /// there is something else to say.
    #[must_use]
    pub fn announcement(&self) -> Option<String> {
        self.messages.announcer.announcement.clone()
    }

    /// Finds out what is new.
    pub(super) fn announce(&mut self) {
        let happened = self.told_of_time();
        let verdict = self.told_of_verdict();
        let notice = self.messages.notice.as_ref().map(|notice| {
            let kind = if notice.is_error { "Error: " } else { "" };
            format!("{kind}{}", notice.text)
        });
        let old = &self.messages.announcer;
        let mut new = Vec::new();
        if old.happened != happened {
            new.push(happened.clone());
        }
        if let Some((_, text)) = verdict.as_ref().filter(|_| old.verdict != verdict) {
            new.push(text.clone());
        }
        if let Some(text) = notice.as_ref().filter(|_| old.notice != notice) {
            new.push(text.clone());
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

    /// While time runs by itself only stages are told: nobody can listen to every event.
    fn told_of_time(&self) -> String {
        match (&self.runs.first.session, self.current_stage()) {
            (Some(session), Some(stage)) if self.time.playback.is_playing() => {
                format!("Playing: {}.", name_in(session, stage))
            }
            _ => happened(self.shown().as_ref()),
        }
    }

    fn told_of_verdict(&self) -> Option<(u64, String)> {
        let generation = self.runs.first.session.as_ref()?.generation;
        let text = match &self.runs.first.verification {
            Verification::Nothing | Verification::Pending(_) => return None,
            Verification::Failed(why) => format!("There is no verdict. {why}"),
            Verification::Done(verdict) => {
                let report = &verdict.report;
                match (report.conflict_free(), report.maximal()) {
                    (true, true) => "Verified: conflict-free and maximal.".to_owned(),
                    (true, false) => "The verifier found gaps: the set is not maximal.".to_owned(),
                    (false, true) => "The verifier found conflicts.".to_owned(),
                    (false, false) => "The verifier found conflicts and gaps.".to_owned(),
                }
            }
        };
        Some((generation, text))
    }
}
