//! The inspector: the properties of the sample under the pointer, otherwise of the selection, with its history and the
//! causes of the last event. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

mod fate;

use glam::DVec2;

use egui::{Color32, RichText, Ui};
use tilescope_core::Origin;
use tilescope_core::stages::detect::Sites;
use tilescope_debugger::{Debugger, Recording, why};
use tilescope_drawing::palette::Palette;
use tilescope_session::moment::ShownMoment;
use tilescope_session::solid::MadeSolid;
use tilescope_session::units::radii;
use tilescope_session::words::{counted, event_number, grouped, significant};
use tilescope_ui::widgets::{Known, heading, row};

use super::common::divide;
use super::content::{Content, Room};
use super::context::PanelContext;
use tilescope_workbench::command::{Command, TimeCommand, ViewCommand, Which};

/// Rows of a history shown at once.
const MAX_ROWS: usize = 200;

pub const CONTENT: Content = Content::of_run(Room::Scrolled, show);

/// Shows the inspector, of a sample, a place or neither.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    // The sample under the pointer is shown while the pointer rests on it, and the selection again afterwards.
    let (id, name) = match (context.run.hovered, context.run.selected) {
        (Some(id), _) => (Some(id), "Sample under the pointer"),
        (None, Some(id)) => (Some(id), "Selected sample"),
        (None, None) => (None, "Selection"),
    };
    heading(ui, name);

    // The rows stand closer than in other panels, since a sample has many of them.
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.spacing_mut().interact_size.y = 18.0;
        match (id, context.run.place, context.run.shown()) {
            (Some(id), _, Some(shown)) => sample(ui, context, &shown, id, commands),
            (None, Some(at), Some(shown)) => {
                place(ui, &shown, at, palette, commands);
                gap(ui, context, &shown, at);
            }
            _ => {
                let text = "Click a sample, or any place, to read what happened there.";
                ui.label(RichText::new(text).color(palette.muted))
                    .known_as("inspector.hint");
            }
        }
    });

    // Also below a sample under the pointer the history is that of the selection.
    if context.run.selected.is_some() || context.run.place.is_some() {
        divide(ui, palette);
        history(ui, context, commands);
    }
}

/// Shows the events that involve the selection, the first [`MAX_ROWS`] of them, and what caused the last event. Without
/// a recording it says that there are no events.
fn history(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let Some(debugger) = &context.run.debugger else {
        super::common::no_events(ui, context);
        return;
    };
    if let Some(failure) = context.run.history_found.failure() {
        ui.label(RichText::new(failure).color(palette.conflict));
    }

    let events = context.run.history_found.events();
    heading(
        ui,
        &format!("History: {}", counted(events.len(), "event", "events")),
    )
    .known_as("history");
    let cursor = debugger.state().cursor();
    for &event in events.iter().take(MAX_ROWS) {
        // Events that are still to come are muted.
        let has_happened = event < cursor;
        let ink = if has_happened {
            palette.text
        } else {
            palette.muted
        };
        event_row(ui, debugger.recording(), event, ink, commands);
    }

    if events.len() > MAX_ROWS {
        let text = format!(
            "and {} more: the event browser finds them",
            grouped(events.len() - MAX_ROWS)
        );
        ui.label(RichText::new(text).color(palette.muted));
    }

    why(ui, debugger, cursor, palette, commands);
}

/// Shows the last event and, below it, the chain of its causes. Shows nothing before the first event.
fn why(
    ui: &mut Ui,
    debugger: &Debugger,
    cursor: usize,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(last) = cursor.checked_sub(1) else {
        return;
    };
    heading(ui, "Why? The causes of the last event");
    let recording = debugger.recording();
    for event in std::iter::once(last).chain(why::causes(recording, last)) {
        event_row(ui, recording, event, palette.text, commands);
    }
}

/// Shows the number and a short form of an event; a click goes to the moment after it.
fn event_row(
    ui: &mut Ui,
    recording: &Recording,
    event: usize,
    ink: Color32,
    commands: &mut Vec<Command>,
) {
    let short = tilescope_debugger::short(recording, event);
    let text = format!("{:>7}  {short}", event_number(event));
    let label = RichText::new(text).monospace().size(11.0).color(ink);
    let response = ui.add(egui::Button::new(label).frame(false).truncate());
    let tip = tilescope_debugger::sentence(recording, event);
    if response.on_hover_text(tip).clicked() {
        // The cursor counts the events that have happened, this one among them.
        commands.push(Command::Time(TimeCommand::Jump(event + 1)));
    }
}

/// Shows a position in r, as everywhere in the window, and in the unit of the domain, as in fields and files.
fn coordinates(ui: &mut Ui, shown: &ShownMoment<'_>, at: DVec2, palette: &Palette) {
    let radius = shown.session.run().domain.radius();
    row(ui, "x", &format!("{:.4} r", at.x), palette);
    row(ui, "y", &format!("{:.4} r", at.y), palette);
    let DVec2 { x, y } = at * radius;
    row(ui, "In files", &format!("{x:.6}, {y:.6}"), palette);
}

/// Shows a place: its coordinates, the nearest sample that is in the set at this moment, and whether a sample covers the
/// place. In the plane through a set in space, all samples that cover the place are shown instead of the nearest one.
fn place(
    ui: &mut Ui,
    shown: &ShownMoment<'_>,
    at: DVec2,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    coordinates(ui, shown, at, palette);
    if shown.plane.is_some() {
        return place_in_plane(ui, shown, at, palette, commands);
    }
    let mut nearest: Option<(f64, u32)> = None;
    let mut is_covered = false;
    // The nearest sample is looked for far beyond its disk, so that in a gap, too, its distance is shown: up to 3.5 r
    // away (chosen), or up to twice the largest radius. No sample covers a place farther away than the largest radius.
    let reach = f64::max(3.5, 2.0 * shown.session.largest_radius());
    // Samples within `reach` of a rectangle are visited. Here the rectangle is the place alone, from `at` to `at`.
    shown.session.index.visit(at, at, reach, |seen| {
        let distance = seen.position.distance(at);
        // Only samples that cover their disks at this moment count.
        if !shown.covers(seen.id) {
            return;
        }
        if nearest.is_none_or(|(least, _)| distance < least) {
            nearest = Some((distance, seen.id));
        }
        // Where radii differ, another sample than the nearest may cover the place.
        is_covered |= shown.session.covers_place(seen.id, at);
    });

    match nearest {
        Some((distance, id)) => {
            row(ui, "Nearest sample", &grouped(id as usize), palette);
            row(ui, "Its distance", &format!("{distance:.4} r"), palette);
            let covered = if is_covered { "yes" } else { "no: a gap" };
            row(ui, "Covered", covered, palette);
        }
        None => row(ui, "Covered", "no: nothing is near", palette),
    }
}

/// Shows which samples cover a place of the plane through a set in space, first the one that arrived first: since then
/// no dart there could become a sample.
fn place_in_plane(
    ui: &mut Ui,
    shown: &ShownMoment<'_>,
    at: DVec2,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut covering: Vec<(u32, String)> = Vec::new();
    // A ball reaches r, which is 1 here, from its middle. The rectangle from `at` to `at`, around which balls are
    // visited, is the place alone.
    shown.session.index.visit(at, at, 1.0, |seen| {
        let distance = seen.position.distance(at);
        // Only balls that are there at this moment count.
        if !shown.covers(seen.id) {
            return;
        }
        // The plane cuts a ball in a disk: the ball covers the places in it.
        if let Some(cut) = shown.cut(seen.id).filter(|cut| distance <= cut.radius) {
            covering.push((seen.id, cut.seen_from(distance)));
        }
    });

    // Ids are in the order of arrival.
    covering.sort_unstable();
    match covering.split_first() {
        Some(((first, seen), others)) => {
            row(ui, "Covered first by", &grouped(*first as usize), palette);
            row(ui, "It is", seen, palette);
            let ids: Vec<u32> = others.iter().map(|&(id, _)| id).collect();
            if !ids.is_empty() {
                self::others(ui, "And by", &ids, palette, commands);
            }
        }
        None => row(ui, "Covered", "no: a gap", palette),
    }
}

/// Shows the gap at a place.
fn gap(ui: &mut Ui, context: &PanelContext<'_>, shown: &ShownMoment<'_>, at: DVec2) {
    let palette = context.palette;
    if let Some(gap) = context.run.geometry.gap_at(shown, at) {
        for (name, value) in [
            ("Area of the gap", format!("{:.5} r\u{b2}", gap.area)),
            ("Samples around it", gap.sites.len().to_string()),
            ("Farthest from them", format!("{:.4} r", gap.deepest.1)),
        ] {
            row(ui, name, &value, palette);
        }
    }
}

/// Shows where a sample comes from, and its state at this moment and in the end. The state is left out for samples of
/// nested levels and in space, since each is kept from its arrival on.
fn sample(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    shown: &ShownMoment<'_>,
    id: u32,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let session = shown.session;
    let run = session.run();
    row(ui, "Id", &grouped(id as usize), palette);
    coordinates(ui, shown, session.position(id), palette);
    // Samples of nested levels have neither block nor origin.
    if let Some(nested) = &session.nested {
        let level = nested.level_of(id as usize);
        row(ui, "Added by level", &level.to_string(), palette);
        // Levels that were read from a file have no ranks here, as the file's column of ranks is not read. While a
        // question of a lesson is open, ranks are hidden, as the answer may follow from them.
        let rank = nested.ranks.get(id as usize);
        if let Some(rank) = rank.filter(|_| !context.is_veiled) {
            row(ui, "Rank", &format!("{rank:.6}"), palette);
        }
        return;
    }

    if let Some(solid) = &session.solid {
        return sample_in_space(ui, solid, shown, id, palette);
    }

    let own_radius = || significant(session.radius_of(id) * run.domain.radius());
    match run.samples.origins[id as usize] {
        // A large set of darts in a field or a shape keeps nothing but its samples, and so does an exact tiling of a
        // shape from a file. The origin is then a placeholder, which is not shown.
        Origin::Tiled { .. } if session.is_in_field() => {
            row(ui, "Radius", &own_radius(), palette);
        }
        Origin::Tiled {
            block,
            pattern,
            own,
        } => {
            // The samples of a combination come from its pieces instead of blocks.
            let is_combination = session.combination.is_some();
            let (source_name, index_name, inside) = if is_combination {
                ("Of piece", "Sample of its set", "inside its rectangle")
            } else {
                ("Tiled into block", "Pattern sample", "inside its block")
            };
            row(ui, source_name, &block.to_string(), palette);
            row(ui, index_name, &grouped(pattern as usize), palette);
            // A sample is `own` if it lies inside the block or rectangle, and not in the margin around it.
            let lies = if own { inside } else { "in the margin" };
            row(ui, "Lies", lies, palette);
        }
        Origin::Inserted { iteration, sites } => {
            // In a field or a shape that darts fill, `iteration` is the number of the throw. The radius is shown, as it
            // may differ from sample to sample.
            if session.is_in_field() {
                row(ui, "Radius", &own_radius(), palette);
                row(ui, "From throw", &iteration.to_string(), palette);
            } else if session.is_exact() {
                row(ui, "The pattern lacks it", &fate::level(iteration), palette);
            } else {
                row(ui, "Inserted in iteration", &iteration.to_string(), palette);
            }
            inserted_at(ui, sites, palette, commands);
        }
    }

    fate::show(ui, context, shown, id, commands);
}

/// Shows where a sample in space lies along the third axis, and how the plane cuts its ball.
fn sample_in_space(
    ui: &mut Ui,
    solid: &MadeSolid,
    shown: &ShownMoment<'_>,
    id: u32,
    palette: &Palette,
) {
    let z = solid.height(id);
    row(ui, "z", &format!("{:.4} r", radii(z)), palette);
    let in_files = significant(solid.users_from_plane(z));
    row(ui, "z in files", &in_files, palette);
    // The cut depends on where the sample and the plane lie, and not on the moment. So it is shown before the sample
    // arrives, too.
    let cut = match shown.cut(id) {
        Some(cut) => format!("radius {:.4} r", cut.radius),
        None => "none: over r away".to_owned(),
    };
    row(ui, "Cut by the plane", &cut, palette);
    // A dart of a recorded run has its throw.
    if let Origin::Inserted { iteration, .. } = shown.session.run().samples.origins[id as usize] {
        row(ui, "From throw", &iteration.to_string(), palette);
    }
}

/// Shows by which samples an inserted one was found.
fn inserted_at(ui: &mut Ui, sites: Sites, palette: &Palette, commands: &mut Vec<Command>) {
    match sites {
        Sites::Three(ids) => others(ui, "At the circumcentre of", &ids, palette, commands),
        Sites::Border(ids) => others(ui, "On the border between", &ids, palette, commands),
        Sites::Corner(id) => others(ui, "In the corner near", &[id], palette, commands),
        Sites::Dart => row(ui, "By", "a dart", palette),
        Sites::Unrecorded => row(ui, "Sites", "not kept in a large run", palette),
    }
}

/// Shows links to other samples: beside the name if there is room, otherwise below it.
fn others(ui: &mut Ui, name: &str, ids: &[u32], palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(palette.muted));
        // Three ids may be wider than the room beside the name.
        if ids.len() < 3 {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                links(ui, ids, commands);
            });
        }
    });
    if ids.len() >= 3 {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
            ui.set_max_height(20.0);
            links(ui, ids, commands);
        });
    }
}

fn links(ui: &mut Ui, ids: &[u32], commands: &mut Vec<Command>) {
    // The rows are laid out from right to left.
    for &id in ids.iter().rev() {
        let link = ui.link(RichText::new(grouped(id as usize)).monospace());
        if link.on_hover_text("Select it and fly there").clicked() {
            commands.push(Command::View(Which::First, ViewCommand::GoToSample(id)));
        }
    }
}
