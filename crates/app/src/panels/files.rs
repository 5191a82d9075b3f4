//! The sheet that opens and saves sessions and patterns. Sizes are in screen points, and chosen, not measured, where no
//! reason stands beside them.

use std::path::Path;

use egui::{Align2, ProgressBar, RichText, TextEdit, Ui, Window};
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::{Known, primary_button};

use super::common::{named_bar, read_out};
use super::sheet::{above_middle, entered, escaped, just_opened, scrolled, select_all, width};
use tilescope_workbench::command::Command;
use tilescope_workbench::files::{FileCommand, FileForm, Purpose, missing_folder};
use tilescope_workbench::state::State;

/// Shows the sheet while it is open.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut own = Vec::new();
    dropped(ui, state, &mut own);
    if let Some(form) = &state.files().sheet {
        sheet(ui, state, form, &mut own);
    }
    commands.extend(own.into_iter().map(Command::File));
}

fn sheet(ui: &Ui, state: &State, form: &FileForm, own: &mut Vec<FileCommand>) {
    let mut open = true;
    Window::new(form.purpose.title())
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, above_middle(ui))
        .show(ui.ctx(), |ui| {
            scrolled(ui, 480.0, |ui| contents(ui, state, form, own));
        });
    if !open || escaped(ui, state) {
        own.push(FileCommand::Close);
    }
}

/// Shows what the sheet is for, the field of the file, and the button that opens or saves it.
fn contents(ui: &mut Ui, state: &State, form: &FileForm, own: &mut Vec<FileCommand>) {
    let palette = Palette::of(state.appearance().look);
    ui.label(RichText::new(form.purpose.explanation()).color(palette.muted));
    if let Some(more) = state
        .files()
        .in_browser()
        .then(|| together(form.purpose))
        .flatten()
    {
        ui.label(RichText::new(more).color(palette.muted));
    }

    ui.add_space(8.0);
    file(ui, state, form, own);

    // The line asks whether to replace a file, or says that its folder is missing. Otherwise it is blank, so that
    // nothing below moves when it is needed.
    let saves = form.purpose == Purpose::Save;
    let missing = no_folder(form.path.trim()).filter(|_| saves);
    let question = if form.asked {
        "There is such a file already."
    } else {
        missing.as_deref().unwrap_or(" ")
    };
    let response = ui.label(RichText::new(question).color(palette.conflict));
    read_out(ui, &response);
    response.known_as("file.question");
    ui.add_space(4.0);

    let verb = if form.asked {
        "Replace the file"
    } else {
        form.purpose.verb()
    };

    let why_not = refusal(state, form);
    let button = primary_button(ui, verb, why_not.as_deref(), palette);
    button.known_as("file.go");
    // The first click may ask whether to replace a file. The second click of a double click must not answer that.
    if button.clicked() && !(form.asked && button.double_clicked()) {
        own.push(FileCommand::Go);
    }

    ui.horizontal(|ui| {
        ui.set_height(24.0);
        progress(ui, state, palette, own);
    });
    super::notice::in_sheet(ui, state);
}

/// Returns which files to choose together in a browser, where a file cannot refer to another by its path.
const fn together(purpose: Purpose) -> Option<&'static str> {
    match purpose {
        Purpose::Save => None,
        Purpose::Pattern | Purpose::Against => Some("Choose the set and its certificate at once."),
        Purpose::Open => {
            Some("If its pattern comes from a file, choose that and its certificate at once.")
        }
        Purpose::Combination => {
            Some("Choose the sets that it names and their certificates at once.")
        }
    }
}

/// Shows the field for the file's name. In a browser a name is typed only to save, and files to open are chosen in its
/// dialog.
fn file(ui: &mut Ui, state: &State, form: &FileForm, own: &mut Vec<FileCommand>) {
    let (in_browser, is_saving) = (state.files().in_browser(), form.purpose == Purpose::Save);
    let can_type = is_saving || !in_browser;
    let label = ui.label(if in_browser && is_saving {
        "File name"
    } else {
        "File"
    });
    ui.horizontal(|ui| {
        let mut path = form.path.clone();
        let edit = TextEdit::singleline(&mut path)
            .font(egui::TextStyle::Monospace)
            .margin(egui::Margin::symmetric(8, 6))
            .interactive(can_type)
            // The width leaves room for the button that browses.
            .desired_width(ui.available_width() - 110.0);
        let response = ui.add(edit).labelled_by(label.id);
        response.known_as("file.path");

        // Typing replaces the proposed name.
        if just_opened(ui, form.purpose.title()) && can_type {
            select_all(ui, &response, path.chars().count());
        }
        if response.changed() {
            own.push(FileCommand::Path(path));
        }
        if entered(ui, &response) && refusal(state, form).is_none() {
            own.push(FileCommand::Go);
        }
        // A browser chooses the folder of a download itself, so that there is none to browse for.
        if in_browser && is_saving {
            return;
        }
        let browse = ui.button("Browse\u{2026}");
        browse.issues("file.browse", FileCommand::Browse, own);
    });
}

/// Returns why the sheet's button does nothing now, or `None` if it does something.
fn refusal(state: &State, form: &FileForm) -> Option<String> {
    let path = form.path.trim();

    // Only the first reason is shown. They are in the order in which a user can mend them.
    let reason = if busy(state).is_some() {
        "A file is being read or written."
    } else if path.is_empty() {
        if state.files().in_browser() && form.purpose != Purpose::Save {
            "Choose a file."
        } else {
            "Name a file."
        }
    } else if form.purpose == Purpose::Save {
        // The session of run A is saved, whether or not a second run is beside it.
        return (state.runs().first)
            .save_refusal()
            .map(str::to_owned)
            .or_else(|| no_folder(path));
    // The file is compared with the session of run A. To open a file for any other purpose needs no session.
    } else if form.purpose == Purpose::Against && state.runs().first.session.is_none() {
        "There is no session yet."
    } else {
        return None;
    };

    Some(reason.to_owned())
}

/// Returns that the folder of a file to be written does not exist, if so.
fn no_folder(path: &str) -> Option<String> {
    let folder = missing_folder(Path::new(path))?;
    Some(format!("There is no folder \"{}\".", folder.display()))
}

/// Returns how far a file is read or written, from 0 to 1; `None` if none is.
fn busy(state: &State) -> Option<f32> {
    state
        .files()
        .filing
        .as_ref()
        .map(|filing| filing.job.fraction())
}

/// Shows how far a file is read or written, and the way out.
fn progress(ui: &mut Ui, state: &State, palette: &Palette, own: &mut Vec<FileCommand>) {
    if let Some(fraction) = busy(state) {
        ui.button("Cancel the file")
            .issues("file.cancel", FileCommand::Cancel, own);
        let bar = ProgressBar::new(fraction).desired_height(6.0);
        named_bar(ui, bar, "Reading or writing", palette);
    }
}

/// Shows that a dropped file is being read, where no sheet says it.
fn dropped(ui: &Ui, state: &State, own: &mut Vec<FileCommand>) {
    if state.files().sheet.is_some() || busy(state).is_none() {
        return;
    }
    let palette = Palette::of(state.appearance().look);
    Window::new("Opening the dropped file")
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, above_middle(ui))
        .show(ui.ctx(), |ui| {
            ui.set_width(width(ui, 320.0));
            ui.horizontal(|ui| progress(ui, state, palette, own));
        });
}
