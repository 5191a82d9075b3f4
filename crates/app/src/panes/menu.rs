//! The context menu of the canvas, with the history and the moments of the sample, gap or block under the pointer. It opens
//! by the secondary button or, with the focus on the canvas, by the menu key. To add an entry, begin with `entries`.

use egui::{Key, Modifiers, PointerButton, Popup, Pos2, Response, SetOpenCommand, Ui};
use glam::DVec2;
use tilescope_core::Origin;
use tilescope_debugger::{Direction, NONE, Target};
use tilescope_drawing::subject::Subject;
use tilescope_session::selection::Selection;
use tilescope_session::words::grouped;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{Command, TimeCommand, ViewCommand, Which};
use tilescope_workbench::scenes::SceneCommand;

use super::input;

/// The sample, if there is one, and the place of the plane that the menu is about.
#[derive(Clone, Copy)]
struct MenuSubject {
    sample: Option<u32>,
    /// The place, in r.
    place: DVec2,
}

/// An entry of the menu.
struct MenuEntry {
    id: &'static str,
    name: String,
    commands: Vec<Command>,
    /// Whether a line separates it from the entries before it.
    begins_group: bool,
}

impl MenuEntry {
    fn new(id: &'static str, name: impl Into<String>, commands: Vec<Command>) -> Self {
        Self {
            id,
            name: name.into(),
            commands,
            begins_group: false,
        }
    }
}

/// Shows the menu, if it is open.
pub fn show(
    ui: &Ui,
    response: &Response,
    subject: &Subject<'_>,
    which: Which,
    commands: &mut Vec<Command>,
) {
    let id = response.id.with("menu");
    if let Some(pos) = asked_at(ui, response, subject) {
        let about = MenuSubject::at(response, subject, pos);
        ui.data_mut(|data| data.insert_temp(id, (pos, about)));
        Popup::open_id(ui.ctx(), id);
    }

    // The subject is kept while the menu is open, since the pointer moves on to the entries.
    let Some((pos, about)) = ui.data(|data| data.get_temp::<(Pos2, MenuSubject)>(id)) else {
        return;
    };

    // A click on the canvas beside the menu closes it.
    let closes = response.clicked().then_some(SetOpenCommand::Bool(false));
    let popup = Popup::menu(response).id(id).open_memory(closes);
    popup.at_position(pos).show(|ui| {
        for entry in entries(subject, which, about) {
            if entry.begins_group {
                ui.separator();
            }
            let button = ui.button(entry.name);
            button.known_as(format_args!("canvas-menu.{}", entry.id));
            if button.clicked() {
                commands.extend(entry.commands);
                ui.close();
            }
        }
    });
}

/// Returns where on the screen the menu opens, if the button or the key was pressed. A long press of a finger selects
/// instead.
fn asked_at(ui: &Ui, response: &Response, subject: &Subject<'_>) -> Option<Pos2> {
    if response.clicked_by(PointerButton::Secondary) {
        return response.interact_pointer_pos();
    }
    let is_pressed =
        response.has_focus() && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Menu));
    is_pressed.then(|| {
        // The menu of the key is about the selection, if it is in view, and otherwise about the middle.
        let session = subject.shown.session;
        let sample = subject.selected.map(|id| session.position(id));
        let selected = sample.or(subject.place);
        selected
            .map(|at| subject.camera.screen_from_domain(response.rect, at))
            .filter(|at| response.rect.contains(*at))
            .unwrap_or(response.rect.center())
    })
}

impl MenuSubject {
    fn at(response: &Response, subject: &Subject<'_>, pos: Pos2) -> Self {
        Self {
            sample: input::nearest(response, subject, pos, input::PICK_POINTS),
            place: subject.camera.domain_from_screen(response.rect, pos),
        }
    }
}

/// Returns the entries of the menu.
fn entries(subject: &Subject<'_>, which: Which, about: MenuSubject) -> Vec<MenuEntry> {
    let mut entries = Vec::new();
    if let Some(sample) = about.sample {
        entries.extend(of_sample(subject, which, sample));
    }

    let mut add = |group: Vec<MenuEntry>| {
        let start = entries.len();
        entries.extend(group);
        // The first entries have no line above them.
        if let Some(first) = entries.get_mut(start).filter(|_| start > 0) {
            first.begins_group = true;
        }
    };
    add(of_place(subject, which, about.place));

    let session = subject.shown.session;
    // The position that is copied is the sample's own, where the menu is about one, and not that of the pointer.
    let at = about.sample.map_or(about.place, |id| session.position(id));
    let view = |command| vec![Command::View(which, command)];
    let centre = view(ViewCommand::Centre(about.place));
    let copy = view(ViewCommand::CopyPosition(at));
    let mut of_view = vec![
        MenuEntry::new("centre", "Centre here", centre),
        MenuEntry::new("copy", "Copy the position", copy),
    ];
    // Scenes are moments of run A, and only a run with events has such moments.
    if which == Which::First && subject.shown.debugger.is_some() {
        let scene = vec![Command::Scene(SceneCommand::Add)];
        of_view.push(MenuEntry::new(
            "scene",
            "Make a scene of this moment",
            scene,
        ));
    }

    add(of_view);
    entries
}

/// Returns the entries about a sample: its history, and the moments that changed it.
fn of_sample(subject: &Subject<'_>, which: Which, sample: u32) -> Vec<MenuEntry> {
    let pick = Command::View(which, ViewCommand::Pick(Selection::Sample(sample)));
    let name = format!("Show the history of sample {}", grouped(sample as usize));
    let inspect = Command::View(which, ViewCommand::Inspect);
    let mut entries = vec![MenuEntry::new("history", name, vec![pick.clone(), inspect])];

    // The entries that follow move in time, which is that of run A.
    let debugger = subject.shown.debugger.filter(|_| which == Which::First);
    let Some(recording) = debugger.map(tilescope_debugger::Debugger::recording) else {
        return entries;
    };
    let Some(life) = recording.life(sample) else {
        return entries;
    };

    let origin = recording.run().samples.origins[sample as usize];
    let is_inserted = matches!(origin, Origin::Inserted { .. });
    // Exact tiling fills no gaps and resolves no conflicts: what comes and goes does so by its arrival.
    let is_exact = recording.is_exact();
    let (birth, name_of_birth) = match (is_inserted, is_exact) {
        (true, true) => ("inserted", "Go to where it came"),
        (true, false) => ("inserted", "Go to where it was inserted"),
        (false, _) => ("placed", "Go to where it was placed"),
    };
    let name_of_loss = if is_exact {
        "Go to where it was lost"
    } else {
        "Go to where it was eliminated"
    };

    for ((id, name), event) in [
        ((birth, name_of_birth), life.born),
        (("kept", "Go to where it was kept"), life.kept),
        (("lost", name_of_loss), life.lost),
    ] {
        // An inserted sample is kept, and one outside the domain is lost, by the same event that made it. Such an event
        // has one entry only, that of the birth.
        let is_first_entry = event != life.born || id == birth;
        if event != NONE && is_first_entry {
            let cursor_behind = event as usize + 1;
            let jump = Command::Time(TimeCommand::Jump(cursor_behind));
            entries.push(MenuEntry::new(id, name, vec![pick.clone(), jump]));
        }
    }

    let run_to = TimeCommand::RunTo(Target::Sample(sample), Direction::Forwards);
    let next = vec![pick, Command::Time(run_to)];
    entries.push(MenuEntry::new("next", "Go to its next event", next));
    entries
}

/// Returns the entries about a place: the gap or the block there, and its history.
fn of_place(subject: &Subject<'_>, which: Which, place: DVec2) -> Vec<MenuEntry> {
    let shown = subject.shown;
    let size = shown.session.size_radii();
    // A place beyond the domain has no history, even where a copy of the domain is drawn.
    if !(place.cmpge(DVec2::ZERO) & place.cmplt(size)).all() {
        return Vec::new();
    }

    let (history, id, name) = if subject.geometry.is_gap(&shown, place) {
        let history = "Why is this a gap? The history of this place";
        (history, "gap", "Go to this gap")
    } else {
        let history = "Show the history of this place";
        (history, "block", "Zoom to this block")
    };

    let view = |command| Command::View(which, command);
    let pick = view(ViewCommand::Pick(Selection::Place(place)));
    let inspect = vec![pick, view(ViewCommand::Inspect)];
    // One command serves both names: it flies to the gap at the place, or else to the block there.
    let zoom = vec![view(ViewCommand::FlyToBlock(place))];
    vec![
        MenuEntry::new("place", history, inspect),
        MenuEntry::new(id, name, zoom),
    ]
}
