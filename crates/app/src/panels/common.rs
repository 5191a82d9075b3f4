//! What several panels share: scrolling, lines between sections, remarks, pictures as textures. Sizes are in screen
//! points, and chosen, not measured, where no reason stands beside them.

use std::sync::Arc;

use egui::{
    ColorImage, Id, ProgressBar, Response, RichText, ScrollArea, TextureHandle, TextureOptions, Ui,
};
use tilescope_drawing::palette::Palette;
use tilescope_drawing::picture::Thumbnail;
use tilescope_session::words::capital;
use tilescope_ui::focus;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Known, name_group};

use super::context::PanelContext;
use crate::actions::{NO_EVENTS_OF_DOTS, NO_EVENTS_OF_LEVELS, NO_EVENTS_OF_SPACE};
use crate::textures::texture_of;
use tilescope_workbench::layout::Panel;

/// Shows the content of a panel, which scrolls independently of other panels of the same tab.
pub fn scrolled(ui: &mut Ui, panel: Panel, add: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical()
        .id_salt(panel.name())
        .auto_shrink([false, false])
        .show(ui, |ui| {
            ui.set_max_width(ui.available_width() - 12.0);
            add(ui);
            focus::follow(ui);
        });
}

/// Draws a thin line between two sections.
pub fn divide(ui: &mut Ui, palette: &Palette) {
    ui.add_space(10.0);
    let (rect, _) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), 1.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, palette.line);
    ui.add_space(6.0);
}

/// Shows a bar without words, which for screen readers has a name.
pub fn named_bar(ui: &mut Ui, bar: ProgressBar, name: &str, palette: &Palette) {
    let shown = ui.add(bar.fill(palette.accent));
    name_group(&shown, &ui.words(name));
}

/// Shows how far work is, and about how long it still takes, in a bar of this height. `name` is different for each
/// work, `activity` says what goes on now, and `fraction` is the share that is done.
pub fn progress(
    ui: &mut Ui,
    name: &str,
    activity: &str,
    fraction: f32,
    height: f32,
    palette: &Palette,
) -> Response {
    // An activity may be a sentence. Its stop and dots are cut, since a number follows.
    let activity = capital(activity.trim_matches(['.', ' ']));
    let percent = fraction * 100.0;
    let mut words = match activity.as_str() {
        "" => format!("{percent:.0}%"),
        activity => format!("{activity}: {percent:.0}%"),
    };

    if let Some(left) = time_left(ui, name, fraction) {
        words = format!("{words}, {left}");
    }

    let text = RichText::new(words).small().color(palette.text);
    let bar = ProgressBar::new(fraction)
        .desired_height(height)
        // The text lies on the bar, and has to be read on its filled part and on its empty part.
        .fill(palette.accent.gamma_multiply(0.35))
        .text(text);
    ui.add(bar)
}

/// The least share of the work, and the least time in seconds, from which the time left is estimated. Chosen, not
/// measured.
const ESTIMATED_FROM: (f32, f64) = (0.02, 2.0);

/// Returns "about 20 s left" for work that is this far, estimated from its pace since it was first shown; `None` too early
/// for an estimate. `name` is different for each work.
fn time_left(ui: &Ui, name: &str, fraction: f32) -> Option<String> {
    let id = Id::unique("time left").with(name);
    let now = ui.input(|input| input.time);
    // The time when the work was first shown, how far it was then, and how far it was when it was last shown.
    let seen: Option<(f64, f32, f32)> = ui.data(|data| data.get_temp(id));
    // Work that is less far than before is another one.
    let (start, first) = match seen {
        Some((start, first, last)) if fraction >= last => (start, first),
        _ => (now, fraction),
    };
    ui.data_mut(|data| data.insert_temp(id, (start, first, fraction)));

    let (done, secs) = (fraction - first, now - start);
    let (least_done, least_secs) = ESTIMATED_FROM;
    if done < least_done || secs < least_secs {
        return None;
    }
    let left = secs * f64::from((1.0 - fraction) / done);
    Some(left_in_words(left))
}

/// Returns "about 20 s left" or "about 3 min left": rounded up, since an estimate is no promise.
fn left_in_words(secs: f64) -> String {
    if secs < 90.0 {
        format!("about {:.0} s left", (secs / 5.0).ceil().max(1.0) * 5.0)
    } else {
        format!("about {:.0} min left", (secs / 60.0).ceil())
    }
}

/// Shows why the session has no events.
pub fn no_events(ui: &mut Ui, context: &PanelContext<'_>) {
    let text = match &context.run.session {
        None => "There is no session yet.".to_owned(),
        Some(session) if session.combination.is_some() => {
            "A combination has stages but no events: its sets existed before.".to_owned()
        }
        Some(session) if session.nested.is_some() => NO_EVENTS_OF_LEVELS.to_owned(),
        Some(session) if session.stipple().is_some() => NO_EVENTS_OF_DOTS.to_owned(),
        Some(session) if session.solid.is_some() => NO_EVENTS_OF_SPACE.to_owned(),
        // Any other session that keeps its stages has events, unless the GPU's run differs from the run that the CPU
        // recorded.
        Some(session) if session.has_stages() => {
            "The GPU's run differs from the CPU's, so that it has no events.".to_owned()
        }
        Some(_) => format!(
            "A run of more than {} samples keeps its result alone: there are no events to step through.",
            tilescope_session::words::grouped(tilescope_session::limits::MAX_STAGED as usize)
        ),
    };
    ui.label(RichText::new(text).color(context.palette.muted))
        .known_as("no-events");
}

/// Returns the texture of a small picture, as [`texture_of`] does.
pub fn thumbnail_texture(ui: &Ui, id: Id, thumbnail: &Arc<Thumbnail>) -> TextureHandle {
    texture_of(ui, id, thumbnail, TextureOptions::LINEAR, |picture| {
        ColorImage::from_rgba_unmultiplied(picture.size, &picture.rgba)
    })
}

/// Has screen readers announce the text of a label whenever it changes.
pub fn read_out(ui: &Ui, response: &egui::Response) {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_live(egui::accesskit::Live::Polite);
    });
}

#[cfg(test)]
mod tests {
    use super::left_in_words;

    #[test]
    fn the_time_left_is_rounded_up() {
        for (secs, text) in [
            (0.2, "about 5 s left"),
            (11.0, "about 15 s left"),
            (89.0, "about 90 s left"),
            (91.0, "about 2 min left"),
            (600.0, "about 10 min left"),
        ] {
            assert_eq!(left_in_words(secs), text);
        }
    }
}
