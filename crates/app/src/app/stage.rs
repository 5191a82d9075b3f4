//! The two windows of a talk: the stage on the projector, the notes on the lecturer's screen. Either may be closed and
//! opened again, and they can exchange screens. What they show is in `panels/lesson/stage.rs` and `notes.rs` beside it; what
//! the talk's commands do is in `classroom/src/room/talk.rs`. Begin with `App::show_talk`.

use egui::{
    Context, Rect, Ui, Vec2, ViewportBuilder, ViewportClass, ViewportCommand, ViewportId, vec2,
};
use tilescope_classroom::talk::TalkCommand;
use tilescope_session::look::Look;
use tilescope_workbench::command::Command;
use tilescope_workbench::state::State;

use super::App;
use crate::actions;
use crate::panels::lesson::{notes, stage};

/// The size of the second window, in screen points without zoom: the notes with the votes and the next step fit in it.
const SECOND_SIZE: Vec2 = vec2(1000.0, 800.0);

/// The state of a talk's windows that is kept between frames.
#[derive(Default)]
pub struct Stage {
    /// The zoom and the look before the talk.
    before: Option<(f32, Look)>,
    /// The size in which the second window opens where there is no second screen, in screen points.
    second_size: Vec2,
    /// Whether the window had full screen before the talk.
    was_full: bool,
    /// A screen without the first window, in screen points, if there is one.
    pub other_screen: Option<Rect>,
}

/// The content of a window.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Stage,
    Notes,
}

impl App {
    /// Shows the windows of the talk, and carries out the commands that they issue.
    pub(super) fn show_talk(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.begin_stage(&ctx);
        let Some(talk) = &self.state.talks().open else {
            return;
        };

        // The first window shows the stage, unless the two are exchanged or the notes alone are open: the first window
        // stays while the talk goes on, and then shows the notes.
        let windows = talk.windows;
        let roles = match (windows.stage, windows.notes, windows.are_swapped) {
            (true, true, true) | (false, true, _) => [Role::Notes, Role::Stage],
            _ => [Role::Stage, Role::Notes],
        };

        let open = |role: Role| match role {
            Role::Stage => windows.stage,
            Role::Notes => windows.notes,
        };

        let [root, other] = roles;
        // On a page there is no second window.
        let second = Some(other).filter(|role| open(*role) && !ctx.embed_viewports());
        if ui.input(|input| input.viewport().close_requested()) && second.is_some() {
            // Only the content is closed: this window then shows the content of the other one, and the talk continues. Full
            // screen, which the window got when the talk began, ends.
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(false));
            self.commands.push(Command::Talk(close_command(root)));
        }

        self.show_role(ui, root);
        if let Some(role) = second {
            let builder = self.window_of(role);
            let id = ViewportId::from_hash_of("the other window of a talk");
            ctx.show_viewport_immediate(id, builder, |ui, class| {
                // A system that opens no second window would have this content drawn over that of the first one.
                if class == ViewportClass::EmbeddedWindow {
                    return;
                }
                if ui.input(|input| input.viewport().close_requested()) {
                    self.commands.push(Command::Talk(close_command(role)));
                }
                self.show_role(ui, role);
            });
        }

        self.apply_commands(&ctx);
    }

    /// Shows one of the two windows of a talk.
    fn show_role(&mut self, ui: &mut Ui, role: Role) {
        // Keys reach the window that has the focus, and act before it is drawn.
        let any_pressed = actions::press_keys(ui.ctx(), &mut self.state);
        if any_pressed {
            self.follow_commands(ui.ctx());
        }
        match role {
            Role::Stage => {
                fit_stage(ui);
                stage::show(ui, &self.state, &mut self.canvas, &mut self.commands);
            }
            Role::Notes => {
                // The clock of the notes shows seconds, also while nothing else changes.
                let second = std::time::Duration::from_secs(1);
                ui.ctx().request_repaint_after(second);
                notes::show(ui, &self.state, &mut self.commands);
            }
        }
    }

    /// When a talk begins, notes a screen without the first window, for the second one.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn find_other_screen(&mut self, ctx: &Context, frame: &eframe::Frame) {
        let is_beginning = self.state.talks().open.is_some() && self.stage.before.is_none();
        let Some(window) = frame.winit_window().filter(|_| is_beginning) else {
            return;
        };

        // Monitors are measured in pixels, and windows are placed in points.
        let pixels_per_point = ctx.pixels_per_point();
        let each = window.available_monitors().map(|monitor| {
            let (at, size) = (monitor.position(), monitor.size());
            let corner = egui::pos2(at.x as f32, at.y as f32);
            Rect::from_min_size(corner, egui::vec2(size.width as f32, size.height as f32))
        });
        let screens: Vec<Rect> = each.collect();

        // One pixel within the window, as its corner may lie on the border of two screens. Where the system does not
        // say where the window is, it is taken to be at the origin.
        let corner = window.outer_position().unwrap_or_default();
        let here = egui::pos2(corner.x as f32 + 1.0, corner.y as f32 + 1.0);
        let other = other_screen(&screens, here);
        self.stage.other_screen = other.map(|screen| screen / pixels_per_point);
    }

    fn begin_stage(&mut self, ctx: &Context) {
        if self.stage.before.is_none() {
            self.stage.before = Some((ctx.zoom_factor(), self.state.appearance().look));
            let screen = ctx.input(|input| input.viewport().monitor_size);
            // The size is fixed now, in points of the present zoom: the stage changes the zoom, and must not resize this window.
            let size = SECOND_SIZE / ctx.zoom_factor();
            self.stage.second_size = screen.map_or(size, |screen| size.min(0.9 * screen));
            self.stage.was_full = ctx.input(|input| input.viewport().fullscreen == Some(true));
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(true));
        }
    }

    /// Once a talk is over, restores zoom and full screen as they were before it.
    pub(super) fn leave_stage(&mut self, ctx: &Context) {
        if let Some((zoom, look)) = self.stage.before.take() {
            // The look may have been changed on the stage, and the projector's look enlarges the window.
            ctx.set_zoom_factor(zoom * self.state.appearance().look.zoom() / look.zoom());
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(self.stage.was_full));
            ctx.request_repaint();
        }
    }

    /// Returns how the second window opens: on the other screen, if there is one.
    fn window_of(&self, role: Role) -> ViewportBuilder {
        let title = match role {
            Role::Stage => "Tilescope: the stage",
            Role::Notes => "Tilescope: notes",
        };
        let builder = ViewportBuilder::default()
            .with_title(title)
            // Chosen, not measured.
            .with_min_inner_size([320.0, 240.0]);
        match self.stage.other_screen {
            Some(screen) => builder
                .with_position(screen.min)
                .with_inner_size(screen.size()),
            None => builder.with_inner_size(self.stage.second_size),
        }
    }
}

/// Zooms so that the stage is [`stage::HEIGHT`] screen points high.
fn fit_stage(ui: &Ui) {
    let ctx = ui.ctx();
    let pixels = ui.available_height() * ctx.pixels_per_point();
    let native = ctx.native_pixels_per_point().unwrap_or(1.0);
    let zoom = pixels / (stage::HEIGHT * native);
    // Each change of the zoom lays the window out anew, so that 0.2% of the height, one point, may differ. A window without
    // height has no zoom.
    if (zoom / ctx.zoom_factor() - 1.0).abs() > 0.002 && zoom > 0.05 {
        ctx.set_zoom_factor(zoom);
        ctx.request_repaint();
    }
}

const fn close_command(role: Role) -> TalkCommand {
    match role {
        Role::Stage => TalkCommand::StageClosed,
        Role::Notes => TalkCommand::NotesClosed,
    }
}

/// Returns the colour of chosen options on the stage.
#[must_use]
pub fn stage_accent(state: &State) -> egui::Color32 {
    stage::palette_of(state).accent
}

/// Returns the first of `screens` that does not contain the point `here`, all in pixels.
#[cfg(not(target_arch = "wasm32"))]
#[must_use]
fn other_screen(screens: &[Rect], here: egui::Pos2) -> Option<Rect> {
    screens
        .iter()
        .copied()
        .find(|screen| !screen.contains(here))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_other_screen_is_one_where_the_window_is_not() {
        let laptop = Rect::from_min_size(pos2(0.0, 0.0), vec2(1280.0, 800.0));
        let projector = Rect::from_min_size(pos2(1280.0, 0.0), vec2(1920.0, 1080.0));
        let both = [laptop, projector];
        assert_eq!(other_screen(&both, pos2(100.0, 100.0)), Some(projector));
        assert_eq!(other_screen(&both, pos2(2000.0, 100.0)), Some(laptop));
        assert_eq!(other_screen(&[laptop], pos2(100.0, 100.0)), None);
    }
}
