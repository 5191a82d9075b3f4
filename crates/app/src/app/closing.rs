//! Closing the native window: asks first if something would be lost, keeps the last session, and lets nothing
//! unfinished behind on the disk. Sizes are in screen points, and chosen, not measured, where no reason stands beside
//! them.

use egui::{Context, Modal, RichText, ViewportCommand, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::{Known, heading};
use tilescope_workbench::command::Command;
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::state::session_to_keep;

use super::App;

/// Whether the window may close.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Closing {
    /// No request to close has come.
    #[default]
    No,
    /// The question is open whether it may.
    Asked,
    /// It closes with the next frame.
    Sure,
}

impl App {
    /// Answers a request to close the window: asks if something would be lost, otherwise ends open work and lets it close.
    pub(super) fn follow_closing(&mut self, ctx: &Context) {
        if ctx.input(|input| input.viewport().close_requested()) {
            if self.closing != Closing::Sure && !self.unfinished().is_empty() {
                ctx.send_viewport_cmd(ViewportCommand::CancelClose);
                self.closing = Closing::Asked;
            } else {
                // A cancelled export removes its unfinished file before the window closes.
                self.state.finish();
                self.keep_session();
                return;
            }
        }
        if self.closing == Closing::Asked {
            self.ask_to_close(ctx);
        }
    }

    /// Returns what would be lost if the window were closed now.
    fn unfinished(&self) -> Vec<String> {
        let (run, form) = (&self.state.runs().first, self.state.form());
        self.state.files().unfinished(run, form)
    }

    /// Asks whether to close the window although something would be lost, and follows the answer.
    fn ask_to_close(&mut self, ctx: &Context) {
        let unfinished = self.unfinished();
        // The work that kept the window open may have ended meanwhile. Then nothing would be lost.
        if unfinished.is_empty() {
            self.closing = Closing::No;
            return;
        }

        let palette = Palette::of(self.state.appearance().look);
        // Of what would be lost, scenes can be saved; an export that is running cannot.
        let can_save = self.state.files().unsaved_scenes(&self.state.runs().first) > 0
            && self.state.runs().first.save_refusal().is_none();

        let modal = Modal::new(egui::Id::unique("closing")).show(ctx, |ui| {
            ui.set_width(320.0);
            heading(ui, "Close Tilescope?");
            for (index, sentence) in unfinished.iter().enumerate() {
                ui.label(sentence)
                    .known_as(format_args!("closing.reason-{}", index + 1));
            }
            let rest = "Without an answer the window stays open.";
            ui.label(RichText::new(rest).color(palette.muted));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
                let stay = ui.button("Keep it open").known_as("closing.stay").clicked();
                let save = can_save && ui.button("Save\u{2026}").known_as("closing.save").clicked();
                let close = ui
                    .button("Close anyway")
                    .known_as("closing.close")
                    .clicked();
                (stay, save, close)
            })
            .inner
        });

        let (stay, save, close) = modal.inner;
        if close {
            self.closing = Closing::Sure;
            ctx.send_viewport_cmd(ViewportCommand::Close);
        } else if save {
            self.closing = Closing::No;
            let command = FileCommand::Sheet(Purpose::Save);
            self.state.apply(Command::File(command));
        } else if stay || modal.should_close() {
            self.closing = Closing::No;
        }
    }

    /// Writes the session for the next start, if it is not the one that was written last.
    pub(super) fn keep_session(&mut self) {
        let (Some(kept), Some(text)) = (&self.kept, session_to_keep(&self.state)) else {
            return;
        };
        if self.kept_session.as_ref() == Some(&text) {
            return;
        }
        match kept.store_session(&text) {
            Ok(()) => self.kept_session = Some(text),
            Err(why) => self.state.report(why),
        }
    }
}
