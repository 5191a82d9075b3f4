//! The export sheet: format, file, size and frame rate. It explains why an export is impossible before anything is
//! written. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use std::path::Path;

use egui::{Align2, Button, RichText, TextEdit, Ui, Window, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_formats::{Format, Precision};
use tilescope_session::words::{grouped, sentence};
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Kebab, Known, name_group, primary_button};

use super::common::progress;
use super::sheet::{above_middle, entered, escaped, just_opened, scrolled, select_all};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::Command;
use tilescope_workbench::export::{ExportCommand, ExportForm, ExportKind, InkCommand, NumberField};
use tilescope_workbench::state::{ExportSource, Exports, State};

/// Width of a typed number.
const NUMBER_WIDTH: f32 = 84.0;
/// The parts of the canvas that pictures lack.
const LEFT_OUT: &str = "Marks of a comparison and of GPU buffers are left out.";
/// Width of the names beside fields.
const NAME_WIDTH: f32 = 92.0;

/// Shows the sheet while it is open.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(form) = &state.files().exports.sheet else {
        return;
    };
    let mut sheet = Sheet {
        exports: &state.files().exports,
        source: ExportSource::of(state),
        in_browser: state.files().in_browser(),
        form,
        palette: Palette::of(state.appearance().look),
        commands: Vec::new(),
    };

    let mut open = true;
    Window::new("Export")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, above_middle(ui))
        .show(ui.ctx(), |ui| {
            scrolled(ui, 480.0, |ui| {
                sheet.contents(ui);
                // The sheet may cover the notice, so that it shows errors itself.
                super::notice::in_sheet(ui, state);
            });
        });

    if !open || escaped(ui, state) {
        sheet.commands.push(ExportCommand::Close);
    }
    commands.extend(sheet.commands.into_iter().map(Command::Export));
}

struct Sheet<'a> {
    exports: &'a Exports,
    source: ExportSource<'a>,
    /// Whether files are downloaded by a browser.
    in_browser: bool,
    form: &'a ExportForm,
    palette: &'a Palette,
    commands: Vec<ExportCommand>,
}

impl Sheet<'_> {
    /// Shows the choice of the kind, the fields of this kind, and the button that writes it.
    fn contents(&mut self, ui: &mut Ui) {
        self.kinds(ui);
        ui.add_space(6.0);
        let explanation = ui.words(self.explanation());
        ui.label(RichText::new(explanation).color(self.palette.muted))
            .known_as("export.explanation");
        ui.add_space(8.0);
        self.file(ui);
        ui.add_space(6.0);
        match self.form.kind {
            // A file of samples has numbers. Only one that draws a stipple, an SVG, has a look.
            ExportKind::Result | ExportKind::Samples => {
                self.precision(ui);
                if self.form.draws_samples() && self.source.is_stipple() {
                    self.ink(ui);
                }
            }
            ExportKind::Picture if self.is_on_paper() => {
                self.colours(ui);
                self.ink(ui);
                self.width(ui);
            }
            // Balls are shown without charts beside them. Their animation is one turn of the set, during which no
            // events happen: there is no part of the run to choose.
            kind if self.source.shows_balls(kind) => {
                self.scale(ui);
                self.colours(ui);
                self.legend(ui);
                if kind == ExportKind::Animation {
                    self.delay(ui);
                }
            }
            // A passage of the plane shows one moment, without charts. No events happen during it, so that no number of
            // events lies between two frames.
            ExportKind::Animation if self.source.shows_passage(self.form) => {
                self.scale(ui);
                self.colours(ui);
                self.legend(ui);
                self.span(ui);
                self.delay(ui);
            }
            // The dots of a stipple have no part of a run to choose: all of them arrive.
            ExportKind::Animation if self.source.is_stipple() => {
                self.ink(ui);
                self.width(ui);
                self.delay(ui);
            }
            ExportKind::Picture | ExportKind::Scenes => {
                self.scale(ui);
                self.colours(ui);
                self.legend(ui);
                self.analysis(ui);
            }
            ExportKind::Animation => {
                self.scale(ui);
                self.colours(ui);
                self.legend(ui);
                self.analysis(ui);
                self.span(ui);
                self.frames(ui);
                self.delay(ui);
            }
        }

        // The last line before the button says what a click will write, or why it cannot.
        ui.add_space(8.0);
        self.prospect(ui);
        ui.add_space(6.0);
        self.write_or_cancel(ui);
    }

    /// Shows the buttons for the kind of export.
    fn kinds(&mut self, ui: &mut Ui) {
        let shown = ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for kind in ExportKind::ALL {
                let refusal = (self.source.kind_refusal(kind)).map(|refusal| refusal.to_string());
                let chosen = self.form.kind == kind;
                let button = Button::selectable(chosen, ui.words(kind.name()));
                // A kind that is chosen stays enabled, and readable, when it cannot be written: the reason is shown below.
                let response = ui.add_enabled(chosen || refusal.is_none(), button);
                response.known_as(format_args!("export.{}", Kebab(kind)));
                let response = response.on_disabled_hover_text(refusal.unwrap_or_default());
                if response.clicked() {
                    self.commands.push(ExportCommand::Choose(kind));
                }
            }
        });
        name_group(&shown.response, &ui.words("Kind of file"));
    }

    /// Returns a description of the export of the chosen kind, in words.
    fn explanation(&self) -> String {
        match self.form.kind {
            ExportKind::Result if self.in_browser => {
                "The result is written, read back and verified; it is downloaded with its certificate, in one archive."
                    .to_owned()
            }
            ExportKind::Result => {
                "The result is written, read back and verified; its certificate is put beside it."
                    .to_owned()
            }

            ExportKind::Samples => "The samples that cover their disks at the moment shown. The certificate says whether this set is conflict-free and maximal; before the end of a run it need be neither.".to_owned(),

            // Nothing but the dots is drawn, and always in the whole domain.
            ExportKind::Picture if self.is_on_paper() => {
                "All dots of the moment shown, as ink on paper, with the parameters inside."
                    .to_owned()
            }
            ExportKind::Picture if self.source.shows_balls(self.form.kind) => {
                "The balls of the set as they are seen, with the parameters inside.".to_owned()
            }
            ExportKind::Picture => {
                format!("The canvas as it is, with the parameters inside. {LEFT_OUT}")
            }
            ExportKind::Scenes => {
                format!("A picture of every scene, with its caption, in files whose names are numbered. {LEFT_OUT}")
            }
            ExportKind::Animation => self.animation(),
        }
    }

    /// Returns what an animation shows, in words.
    fn animation(&self) -> String {
        if self.source.shows_balls(self.form.kind) {
            return "The set turns once. The corner that is cut out turns with it.".to_owned();
        }
        if self.source.shows_passage(self.form) {
            return "The plane passes through the set, from one end of the third axis to the other."
                .to_owned();
        }
        if self.source.is_stipple() {
            return "The dots appear in the order of their arrival, as ink on paper, until all are there."
                .to_owned();
        }

        let Some(range) = self.source.range(self.form) else {
            return "An animation shows the view from event to event.".to_owned();
        };
        let (start, end) = (grouped(range.start), grouped(range.end));
        let whose = if self.form.whole_run {
            "the whole run"
        } else if self.source.time.playback.range.is_some() {
            "the range of the loop"
        } else {
            "the stage shown; a loop on the timeline chooses another range"
        };
        format!(
            "The canvas from event {start} to event {end}: {whose}. The selection, the brush, and marks of a comparison and of GPU buffers are left out."
        )
    }

    /// Shows the field of the file, its formats, and remarks on its name.
    fn file(&mut self, ui: &mut Ui) {
        // A browser chooses the folder itself, so that there is nothing to browse for.
        let in_browser = self.in_browser;
        let name = if in_browser { "File name" } else { "File" };
        let label = ui.label(ui.words(name));
        ui.horizontal(|ui| {
            let mut path = self.form.path.clone();
            let edit = TextEdit::singleline(&mut path)
                .align(egui::Align2::LEFT_CENTER)
                .font(egui::TextStyle::Monospace)
                .margin(egui::Margin::symmetric(8, 6))
                .desired_width(
                    ui.available_width()
                        - if in_browser {
                            // The width leaves room for the margins of the field.
                            16.0
                        } else {
                            // Room for the margins of the field and the button that browses.
                            67.0 + 2.0 * ui.spacing().button_padding.x
                        },
                );
            let response = ui.add(edit).labelled_by(label.id);
            response.known_as("export.path");
            // Typing replaces the proposed name.
            if just_opened(ui, "export") {
                select_all(ui, &response, path.chars().count());
            }
            if response.changed() {
                self.commands.push(ExportCommand::Path(path));
            }
            self.write_on_enter(ui, &response);

            if in_browser {
                return;
            }
            let browse = ui.button(ui.words("Browse\u{2026}"));
            if browse.known_as("export.browse").clicked() {
                self.commands.push(ExportCommand::Browse);
            }
        });
        self.formats(ui);

        let (text, color) = if let Some(refusal) = self.form.name_refusal() {
            (refusal.to_string(), self.palette.conflict)
        } else {
            // A name that is not refused has the ending of a format.
            let format = (self.form.kind.format(&self.form.file())).unwrap_or_default();
            let in_folder = self.folder();
            let file = self.form.file();
            // A name without an ending gets that of the format. The text then shows the whole name.
            let is_typed = Path::new(self.form.path.trim()) == file;
            let name = file.file_name().filter(|_| !is_typed);
            let added = name.map_or_else(String::new, |name| {
                format!(" File: {}.", name.to_string_lossy())
            });
            let text = format!("Format: {format}.{added}{in_folder}");
            (text, self.palette.muted)
        };
        ui.label(RichText::new(text).small().color(color))
            .known_as("export.format");

        if let Some(taken) = &self.form.taken {
            let name = taken.file_name().unwrap_or_default().to_string_lossy();
            let text = ui.words(format!("{name} exists already and would be replaced."));
            ui.label(RichText::new(text).small().color(self.palette.conflict))
                .known_as("export.taken");
        }
    }

    /// Shows the formats; a click changes the extension of the file.
    fn formats(&mut self, ui: &mut Ui) {
        let chosen = tilescope_workbench::export::extension(&self.form.file());
        let shown = ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(3.0, 3.0);
            for extension in self.form.kind.extensions() {
                let is_chosen = chosen.as_deref() == Some(extension);
                let text = RichText::new(extension).small();
                let chip = ui.add(Button::selectable(is_chosen, text));
                chip.known_as(format_args!("export.format.{extension}"));
                let path = self.form.file().with_extension(extension);
                let name = self.form.kind.format(&path).unwrap_or_default();
                if chip.on_hover_text(name).clicked() {
                    let path = path.to_string_lossy().into_owned();
                    self.commands.push(ExportCommand::Path(path));
                }
            }
        });
        name_group(&shown.response, &ui.words("Format"));
    }

    /// Returns the folder of the file in a sentence; nothing where a browser chooses it.
    fn folder(&self) -> String {
        if self.in_browser {
            return String::new();
        }
        let file = std::path::absolute(self.form.file());
        let folder = file.as_deref().ok().and_then(Path::parent);
        folder.map_or_else(String::new, |folder| {
            format!(" Folder: {}", folder.display())
        })
    }

    /// Shows the buttons for the number type of coordinates.
    fn precision(&mut self, ui: &mut Ui) {
        let format = Format::from_path(&self.form.file());
        // A format with one number type shows it, without a choice. A name without a known format has no choice either.
        let has_choice = format
            .is_some_and(|f| f.precision(Precision::Single) != f.precision(Precision::Double));
        self.named(ui, "Coordinates", |sheet, ui, _| {
            for (precision, name) in [
                (Precision::Double, "f64, to the bit"),
                (Precision::Single, "f32, rounded"),
            ] {
                let shown =
                    format.map_or(sheet.form.precision, |f| f.precision(sheet.form.precision));
                let button = Button::selectable(shown == precision, ui.words(name));
                let response = ui.add_enabled(has_choice, button);
                response.known_as(format_args!("export.{}", Kebab(precision)));
                let why = ui.words("This format has only one option.");
                if response.on_disabled_hover_text(why).clicked() {
                    sheet.commands.push(ExportCommand::Precision(precision));
                }
            }
        });
    }

    fn scale(&mut self, ui: &mut Ui) {
        let has_scale = self.form.has_scale();
        self.named(ui, "Scale", |sheet, ui, label| {
            sheet.number(ui, NumberField::Scale, has_scale, label);
            let unit = if has_scale {
                "pixels for a point of the window"
            } else {
                "SVG can be shown at any scale"
            };
            ui.label(RichText::new(ui.words(unit)).color(sheet.palette.muted));
        });
    }

    /// Returns whether the picture has dots of ink on paper.
    fn is_on_paper(&self) -> bool {
        self.form.kind == ExportKind::Picture && self.form.ink.on_paper && self.source.is_stipple()
    }

    /// Shows the colours of paper and ink, and how large dots are.
    fn ink(&mut self, ui: &mut Ui) {
        let ink = &self.form.ink;
        // The type is that of both rows: each variant is a function of a type of its own.
        let paper: fn(String) -> InkCommand = InkCommand::Paper;
        for (name, id, text, command) in [
            ("Paper", "export.paper", &ink.paper, paper),
            ("Ink", "export.ink", &ink.color, InkCommand::Color),
        ] {
            self.named(ui, name, |sheet, ui, label| {
                let mut text = text.clone();
                let edit = TextEdit::singleline(&mut text)
                    .id_salt(id)
                    .hint_text("#rrggbb")
                    .font(egui::TextStyle::Monospace)
                    .margin(egui::Margin::symmetric(8, 4))
                    .desired_width(NUMBER_WIDTH);
                let response = ui.add(edit).labelled_by(label);
                response.known_as(id);
                if response.changed() {
                    sheet.commands.push(ExportCommand::Ink(command(text)));
                }
                let unit = "black, white or #rrggbb; if empty, as the tone asks for";
                ui.label(RichText::new(ui.words(unit)).color(sheet.palette.muted));
            });
        }

        self.named(ui, "Dots", |sheet, ui, _| {
            for (by_darkness, name, id) in [
                (false, "all equal", "export.dots-equal"),
                (true, "the darker the larger", "export.dots-by-darkness"),
            ] {
                let chosen = sheet.form.ink.by_darkness == by_darkness;
                let command = ExportCommand::Ink(InkCommand::ByDarkness(by_darkness));
                let button = Button::selectable(chosen, ui.words(name));
                ui.add(button).issues(id, command, &mut sheet.commands);
            }
        });
    }

    /// Shows the width of a picture of dots.
    fn width(&mut self, ui: &mut Ui) {
        let has_columns = self.form.has_columns();
        self.named(ui, "Width", |sheet, ui, label| {
            sheet.number(ui, NumberField::Columns, has_columns, label);
            let unit = if has_columns {
                "pixels"
            } else {
                "SVG can be shown at any scale"
            };
            ui.label(RichText::new(ui.words(unit)).color(sheet.palette.muted));
        });
    }

    fn colours(&mut self, ui: &mut Ui) {
        let is_on_paper = self.is_on_paper();
        self.named(ui, "Colours", |sheet, ui, _| {
            if sheet.form.kind == ExportKind::Picture && sheet.source.is_stipple() {
                let command = ExportCommand::Ink(InkCommand::OnPaper);
                let button = Button::selectable(is_on_paper, ui.words("ink on paper"));
                ui.add(button)
                    .issues("export.on-paper", command, &mut sheet.commands);
            }
            for (print, name) in [(false, "as in the window"), (true, "for print")] {
                let chosen = sheet.form.print == print && !is_on_paper;
                let button = Button::selectable(chosen, ui.words(name));
                if ui.add(button).clicked() {
                    sheet.commands.push(ExportCommand::Print(print));
                }
            }
        });
    }

    fn legend(&mut self, ui: &mut Ui) {
        self.named(ui, "Legend", |sheet, ui, _| {
            let mut legend = sheet.form.legend;
            let text = ui.words("below the picture");
            let switch = ui.checkbox(&mut legend, text);
            if switch.known_as("export.legend").changed() {
                sheet.commands.push(ExportCommand::Legend(legend));
            }
        });
    }

    fn analysis(&mut self, ui: &mut Ui) {
        self.named(ui, "Analysis", |sheet, ui, _| {
            let mut analysis = sheet.form.analysis;
            let text = ui.words("beside the picture");
            let switch = ui.checkbox(&mut analysis, text);
            if switch.known_as("export.analysis").changed() {
                sheet.commands.push(ExportCommand::Analysis(analysis));
            }
        });
    }

    /// Shows the buttons for the part of the run that an animation has.
    fn span(&mut self, ui: &mut Ui) {
        let has_loop = self.source.time.playback.range.is_some();
        let part = if has_loop { "the loop" } else { "this stage" };
        let passes = self.source.shows_passage(self.form);
        let (has_plane, has_events) = self.source.plane_and_events();
        self.named(ui, "Shows", |sheet, ui, _| {
            if has_plane {
                let text = ui.words("the plane's passage");
                let button = Button::selectable(passes, text);
                let button = ui.add(button);
                if button.known_as("export.passage").clicked() {
                    sheet.commands.push(ExportCommand::Passage(true));
                }
            }

            // Without events there are no stages to choose from.
            let spans = [(false, part), (true, "the whole run")];
            for (whole, name) in spans.into_iter().filter(|_| has_events) {
                let chosen = !passes && sheet.form.whole_run == whole;
                let button = Button::selectable(chosen, ui.words(name));
                let id = if whole { "whole-run" } else { "part" };
                if ui
                    .add(button)
                    .known_as(format_args!("export.{id}"))
                    .clicked()
                {
                    sheet.commands.push(ExportCommand::WholeRun(whole));
                }
            }
        });
    }

    /// Shows how many ticks of which clock lie between two frames.
    fn frames(&mut self, ui: &mut Ui) {
        self.named(ui, "A frame every", |sheet, ui, label| {
            let enabled = true;
            sheet.number(ui, NumberField::Every, enabled, label);
            // Each frame is at a cursor of the events. GPU passes are at no cursors, so that frames cannot follow their
            // clock.
            let clocks = Clock::ALL.into_iter().filter(|&c| c != Clock::Pass);
            for clock in clocks {
                let plural = ui.words(format!("{}s", clock.name()));
                let button = Button::selectable(sheet.form.clock == clock, plural);
                let id = format_args!("export.{}", Kebab(clock));
                if ui.add(button).known_as(id).clicked() {
                    sheet.commands.push(ExportCommand::Clock(clock));
                }
            }
        });
    }

    fn delay(&mut self, ui: &mut Ui) {
        self.named(ui, "Delay", |sheet, ui, label| {
            let enabled = true;
            sheet.number(ui, NumberField::Delay, enabled, label);
            let unit = "ms for a frame";
            ui.label(RichText::new(ui.words(unit)).color(sheet.palette.muted));
        });
    }

    /// Shows a label and the fields beside it.
    fn named(&mut self, ui: &mut Ui, name: &str, add: impl FnOnce(&mut Self, &mut Ui, egui::Id)) {
        let title = ui.words(name);
        let shown = ui.horizontal_wrapped(|ui| {
            ui.set_min_height(28.0);
            let size = vec2(NAME_WIDTH, 20.0);
            let layout = egui::Layout::left_to_right(egui::Align::Center);
            let label = ui.allocate_ui_with_layout(size, layout, |ui| {
                ui.set_min_width(NAME_WIDTH);
                ui.label(&title).id
            });
            add(self, ui, label.inner);
        });
        name_group(&shown.response, &title);
    }

    /// Shows the field of a number, in the colour of faults if the text in it is no number that can be used. `label` is
    /// the id of its name; a field that is not `enabled` can be read only.
    fn number(&mut self, ui: &mut Ui, entry: NumberField, enabled: bool, label: egui::Id) {
        let (text, is_wrong) = match entry {
            NumberField::Scale => (&self.form.scale, self.form.scale().is_err()),
            NumberField::Every => (&self.form.every, self.form.every().is_err()),
            NumberField::Delay => (&self.form.delay, self.form.delay().is_err()),
            NumberField::Columns => (&self.form.columns, self.form.columns().is_err()),
        };
        let mut text = text.clone();
        let edit = TextEdit::singleline(&mut text)
            .align(egui::Align2::LEFT_CENTER)
            .id_salt(entry)
            .font(egui::TextStyle::Monospace)
            // A field that is switched off is not wrong.
            .text_color_opt((is_wrong && enabled).then_some(self.palette.conflict))
            .margin(egui::Margin::symmetric(8, 4))
            .desired_width(NUMBER_WIDTH);
        let response = ui.add_enabled(enabled, edit).labelled_by(label);
        response.known_as(format_args!("export.{}", Kebab(entry)));
        if response.changed() {
            self.commands.push(ExportCommand::Type(entry, text));
        }
        self.write_on_enter(ui, &response);
    }

    fn write_on_enter(&mut self, ui: &Ui, response: &egui::Response) {
        if entered(ui, response) {
            let idle = self.exports.fraction().is_none();
            if idle && self.exports.prospect(self.source).is_ok() {
                self.commands.push(ExportCommand::Write);
            }
        }
    }

    /// Shows in a sentence what a click would write, or why nothing can be written.
    fn prospect(&self, ui: &mut Ui) {
        let (text, color) = match self.exports.prospect(self.source) {
            Ok(prospect) => (sentence(&prospect), self.palette.text),
            // Shown below the file name instead. A blank keeps the height of the line.
            Err(refusal) if Some(&refusal) == self.form.name_refusal().as_ref() => {
                (" ".to_owned(), self.palette.muted)
            }
            Err(refusal) => (refusal.to_string(), self.palette.conflict),
        };
        ui.label(RichText::new(text).color(color))
            .known_as("export.prospect");
    }

    /// Shows the button that writes the file, or the progress of writing. Both take the same room, so that nothing moves.
    /// Cancel is below them, so that a double click on the button does not hit it.
    fn write_or_cancel(&mut self, ui: &mut Ui) {
        if let Some(job) = &self.exports.work {
            // The height is that of the button, unless this is enlarged for fingers.
            let activity = job.activity();
            progress(ui, "export", &activity, job.fraction(), 34.0, self.palette)
                .known_as("export.progress");
            ui.horizontal(|ui| {
                ui.set_height(18.0);
                if job.is_cancelled() {
                    ui.label(
                        RichText::new(ui.words("Stopping"))
                            .small()
                            .color(self.palette.muted),
                    );
                } else {
                    let cancel = ui.link(RichText::new(ui.words("Cancel export")).small());
                    if cancel.known_as("export.cancel").clicked() {
                        self.commands.push(ExportCommand::Cancel);
                    }
                }
            });
            return;
        }

        let refusal = (self.exports.prospect(self.source).err()).map(|refusal| refusal.to_string());
        let button = primary_button(ui, &self.button(), refusal.as_deref(), self.palette);
        button.known_as("export.write");
        // The first click may ask whether to replace a file. The second click of a double click must not answer that.
        if button.clicked() && !(self.form.asked && button.double_clicked()) {
            self.commands.push(ExportCommand::Write);
        }
        // The line below the progress has the same height.
        ui.allocate_space(vec2(1.0, 18.0));
    }

    /// Returns the text of the button that begins the export.
    fn button(&self) -> String {
        match (&self.form.taken, self.form.kind) {
            (Some(taken), _) if self.form.asked => {
                let name = taken.file_name().unwrap_or_default().to_string_lossy();
                format!("Replace {name}?")
            }
            (_, kind) => {
                let verb = if self.in_browser { "Download" } else { "Write" };
                let what = match kind {
                    ExportKind::Result | ExportKind::Samples => "file and certificate",
                    ExportKind::Picture => "picture",
                    ExportKind::Scenes => "pictures",
                    ExportKind::Animation => "animation",
                };
                format!("{verb} {what}")
            }
        }
    }
}
