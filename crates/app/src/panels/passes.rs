//! The panel of GPU passes: their list on the left, the selected pass and one of its buffers on the right. It reads
//! [`Passes`], whose runs and tables are in `workbench/src/passes/`, and pushes commands. Begin with [`show`]. Sizes
//! are in screen points, and chosen, not measured, where no reason stands beside them.

mod choice;
mod grid;
mod list;

use egui::{
    Button, DragValue, FontId, Label, Layout, ProgressBar, RichText, ScrollArea, TextEdit, Ui,
    UiBuilder, Vec2, vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::{counted, grouped, stage_name};
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Icon, Kebab, Known, icon_button, name_group};

use self::list::{color, mark};
use super::common::named_bar;
use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_workbench::command::{Command, GpuCommand};
use tilescope_workbench::device::{CHOOSE_GPU_FIRST, EngineChoice};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::passes::model::{PassEntry, Visit, access_text};
use tilescope_workbench::passes::table::{BufferTable, PassSide};
use tilescope_workbench::passes::{Badge, Fault, PassCommand, Passes};

/// The width of the list, in screen points.
const LIST: f32 = 270.0;

/// Shown if the device does not measure times.
pub const NO_TIMES: &str = "no timestamps on this adapter";

/// How a pass is compared with the CPU.
const COMPARED: &str = "After the last pass of a stage everything is compared with the CPU's sequential engine: \
     blocks, tiles, samples, origins, fates, iterations, result. Of an exact tiling these are its samples.";

pub const CONTENT: Content = Content::of_state(Room::Whole, |ui, state, commands| {
    let refusal = state.gpu().passes_refusal(&state.runs().first);
    // The engine is all that is missing.
    let can_choose = refusal.as_deref() == Some(CHOOSE_GPU_FIRST);
    let context = PanelContext::of(state);
    passes_or_offer(ui, &context, refusal.as_deref(), can_choose, commands);
});

/// Minimum room for the list and table of passes, in screen points.
const ROOM_FOR_PASSES: Vec2 = vec2(620.0, 400.0);

/// Shows the GPU passes, or how to get them: `refusal` is why they cannot be run, if so, and `can_choose` whether only
/// the choice of the GPU is missing.
fn passes_or_offer(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    refusal: Option<&str>,
    can_choose: bool,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    if let Some(passes) = &context.run.passes {
        let mut own = Vec::new();
        // A list beside a table has no narrower form: in less room than this it scrolls.
        let size = ui.available_size().max(ROOM_FOR_PASSES);
        ScrollArea::both()
            .id_salt(Panel::Passes.name())
            .show(ui, |ui| {
                ui.allocate_ui(size, |ui| {
                    show(ui, passes, palette, &mut own);
                });
            });
        commands.extend(own.into_iter().map(Command::Passes));
        return;
    }

    let text = "Every compute pass of this session's run on the GPU, with its buffers before and after, compared with the CPU.";
    ui.label(RichText::new(text).color(palette.muted));
    let button = ui.add_enabled(refusal.is_none(), Button::new("Run the passes"));
    button.known_as("passes.run");
    let button = button.on_disabled_hover_text(refusal.unwrap_or_default());
    if button.clicked() {
        commands.push(Command::OpenPasses);
    }

    if let Some(refusal) = refusal {
        ui.label(RichText::new(refusal).color(palette.muted));
    }

    if can_choose {
        let choose = Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu));
        let button = (ui.button("Choose the GPU"))
            .on_hover_text("Opens the GPU and tests it against the CPU");
        button.issues("passes.choose-gpu", choose, commands);
    }
}

/// Shows the panel in all the room there is.
pub fn show(ui: &mut Ui, passes: &Passes, palette: &Palette, commands: &mut Vec<PassCommand>) {
    let mut panel = PassesPanel {
        passes,
        palette,
        commands,
    };

    let area = ui.available_rect_before_wrap();
    // In a narrow panel the pass keeps more than half of the width.
    let (left, right) = area.split_left_right_at_x(area.left() + LIST.min(0.45 * area.width()));
    let column = |rect| {
        UiBuilder::new()
            .max_rect(rect)
            .layout(Layout::top_down(egui::Align::Min))
    };

    let mut ui_left = ui.new_child(column(left.shrink2(vec2(0.0, 2.0))).id_salt("list"));
    panel.list(&mut ui_left);
    // A line stands in the middle of the gap between the columns.
    let right = right.with_min_x(right.left() + 16.0);
    ui.painter()
        .vline(right.left() - 8.0, area.y_range(), (1.0, palette.line));

    let mut ui_right = ui.new_child(column(right.shrink2(vec2(0.0, 2.0))).id_salt("pass"));
    // A pass that is too wide must not cover the list.
    ui_right.set_clip_rect(right.intersect(ui.clip_rect()));
    panel.work(&mut ui_right);

    if let Some(entry) = passes.selected().and_then(|k| passes.entries().get(k)) {
        panel.pass(&mut ui_right, entry);
    }
    // The two columns have cursors of their own, which do not move that of the panel.
    ui.advance_cursor_after_rect(area);
}

/// The passes, and the commands that the panel issues.
struct PassesPanel<'a> {
    passes: &'a Passes,
    palette: &'a Palette,
    commands: &'a mut Vec<PassCommand>,
}

impl PassesPanel<'_> {
    /// Shows the list and its heading.
    fn list(&mut self, ui: &mut Ui) {
        let (passes, palette) = (self.passes, self.palette);
        ui.add(Label::new(muted(passes.adapter(), palette)).truncate());
        let times = if passes.has_timestamps() {
            "times measured by the adapter, pass by pass"
        } else {
            NO_TIMES
        };
        ui.add(Label::new(muted(times, palette)).truncate());
        ui.add_space(2.0);
        ui.scope(|ui| list::show(ui, passes, palette, self.commands));
    }

    /// Shows the fault that is tried, if there is one, and below it the work in progress, why it ended, or its result.
    fn work(&mut self, ui: &mut Ui) {
        let (passes, palette) = (self.passes, self.palette);
        if let Some(fault) = passes.fault() {
            ui.horizontal(|ui| {
                let text = format!(
                    "What if: word {} of {} becomes {} after pass {}.",
                    grouped(fault.index as usize),
                    fault.buffer.as_str(),
                    fault.word,
                    // Users count passes from 1.
                    fault.after + 1,
                );
                ui.label(RichText::new(text).color(palette.margin))
                    .known_as("passes.fault");
                ui.button("Undo")
                    .issues("passes.undo", PassCommand::Fault(None), self.commands);
            });
        }

        // The line keeps its height when the work ends, so that nothing below moves.
        ui.horizontal(|ui| {
            ui.set_height(26.0);
            if let Some((activity, fraction)) = passes.activity() {
                // The button stands before the text, whose length changes, so that it stays under the pointer.
                ui.button("Cancel")
                    .issues("passes.cancel", PassCommand::Cancel, self.commands);
                let bar = ProgressBar::new(fraction).desired_width(160.0);
                named_bar(ui, bar.desired_height(8.0), "Passes", palette);
                ui.label(RichText::new(activity).color(palette.muted));
            } else if let Some(notice) = passes.notice() {
                let again = ui.button("List passes again");
                again.issues("passes.again", PassCommand::Again, self.commands);
                let text = RichText::new(notice).color(palette.margin);
                let label = ui.add(Label::new(text).truncate());
                label.known_as("passes.notice");
                label.on_hover_text(notice);
            } else {
                ui.label(RichText::new(summary(passes)).color(palette.muted))
                    .known_as("passes.summary");
            }
        });
    }

    /// Shows the selected pass.
    fn pass(&mut self, ui: &mut Ui, entry: &PassEntry) {
        let (passes, palette) = (self.passes, self.palette);
        self.title(ui, entry);
        numbers(ui, passes, entry, palette);
        // The run has not reached the pass yet, or works on it.
        let Some(visit) = passes.visit() else {
            ui.label(muted(
                "Its buffers are shown when the run is there.",
                palette,
            ));
            return;
        };

        way(ui, visit, palette);
        ui.add_space(4.0);
        self.buffers(ui, visit);
        choice::show(ui, passes, visit, palette, self.commands);

        // `None` if the pass has no buffer at the chosen index.
        if let Some(table) = passes.shown().table(Some(visit)) {
            self.tools(ui, table);
            // The file of the rows and the fault stand below the table, and take 62 points. The table keeps at least 60
            // points, which are three rows.
            let foot = 62.0;
            let room = vec2(
                ui.available_width(),
                (ui.available_height() - foot).max(60.0),
            );
            ui.allocate_ui(room, |ui| {
                ui.set_min_size(room);
                grid::show(ui, table, passes.shown(), palette, self.commands);
            });
            ui.add_space(4.0);
            self.export(ui);
            self.fault_editor(ui, visit, table);
        }
    }

    /// Shows the buttons that go from pass to pass, the name of the pass, and how it compares with the CPU.
    fn title(&mut self, ui: &mut Ui, entry: &PassEntry) {
        let (passes, palette) = (self.passes, self.palette);
        // The entry is that of the selected pass, so that `selected` is not `None` here.
        let (at, count) = (passes.selected().unwrap_or(0), passes.entries().len());
        let no_previous = (at == 0).then_some("This is the first pass.");
        let no_next = (at + 1 == count).then_some("This is the last pass.");
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let previous = icon_button(ui, Icon::Back, "Previous pass", no_previous, palette);
            previous.issues("passes.previous", PassCommand::Previous, self.commands);
            let next = icon_button(ui, Icon::Forward, "Next pass", no_next, palette);
            next.issues("passes.next", PassCommand::Next, self.commands);

            ui.add_space(6.0);
            let name = RichText::new(entry.report.name).font(FontId::new(17.0, semibold()));
            ui.label(name);
            ui.add_space(8.0);
            let stage = stage_name(entry.report.stage);
            // Users count passes from 1.
            let text = format!("pass {} of {count}, stage {stage}", at + 1);
            ui.label(RichText::new(text).color(palette.muted))
                .known_as("passes.place");
        });

        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(16.0, 18.0), egui::Sense::hover());
            mark(ui, rect.center(), &entry.badge, palette);
            let text = RichText::new(entry.badge.text()).color(color(&entry.badge, palette));
            let label = ui.add(Label::new(text).truncate());
            label.on_hover_text(COMPARED);
        });
    }

    /// Shows the choice of a buffer.
    fn buffers(&mut self, ui: &mut Ui, visit: &Visit) {
        let (passes, palette) = (self.passes, self.palette);
        let shown = ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            for (index, table) in visit.buffers.iter().enumerate() {
                let access = access_text(table.access);
                let text = RichText::new(table.name.as_str()).monospace();
                let is_shown = index == passes.shown().buffer();
                let count = table.changed_count();

                let mut button =
                    Button::selectable(is_shown, text).right_text(muted(access, palette));
                // A button without a line would look like a text until the pointer is over it.
                if !is_shown {
                    button = button.stroke((1.0, palette.line));
                }

                let response = ui.add(button).on_hover_text(format!(
                    "{access}, {} bytes, {}",
                    grouped(table.bytes as usize),
                    changed_text(count),
                ));
                let label = format!(
                    "Buffer {}: {access}, {}",
                    table.name.as_str(),
                    changed_text(count)
                );

                response.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::Button, ENABLED, is_shown, &label)
                });
                response.known_as(format_args!("buffer.{}", Kebab(table.name)));

                if response.clicked() {
                    self.commands.push(PassCommand::Buffer(index));
                }
            }
        });
        name_group(&shown.response, "Buffers of the pass");
    }

    /// Shows the choice of side and rows.
    fn tools(&mut self, ui: &mut Ui, table: &BufferTable) {
        let (passes, palette) = (self.passes, self.palette);
        let shown = passes.shown();
        // An empty buffer has no rows to choose from. A buffer of one row is shown whole, before and after the pass.
        if table.total <= 1 {
            return;
        }

        ui.horizontal(|ui| {
            let sides = ui.horizontal(|ui| {
                for side in PassSide::ALL {
                    let button = ui.selectable_label(shown.side() == side, side.name());
                    let id = format_args!("side.{}", Kebab(side));
                    button.issues(id, PassCommand::Side(side), self.commands);
                }
            });
            name_group(&sides.response, "Side of the pass");

            ui.add_space(10.0);
            let label = ui.label(RichText::new("Filter").color(palette.muted));
            let mut text = shown.filter().to_owned();
            let edit = TextEdit::singleline(&mut text)
                .align(egui::Align2::LEFT_CENTER)
                .font(egui::TextStyle::Monospace)
                .hint_text("x>5, changed")
                .desired_width(170.0);
            let edit = ui.add(edit).labelled_by(label.id);
            if edit.known_as("filter").changed() {
                self.commands.push(PassCommand::Filter(text));
            }

            ui.add_space(6.0);
            let (message, color) = match shown.error() {
                Some(error) => (
                    tilescope_session::words::sentence(&error.to_string()),
                    palette.conflict,
                ),
                None => (count_text(table, shown.rows().len()), palette.muted),
            };
            // The label may be cut off; the tooltip has all of it.
            let tip = message.clone();
            let result = ui.add(Label::new(RichText::new(message).color(color)).truncate());
            result.known_as("filtered");
            result.on_hover_text(tip);
        });
    }

    /// Shows the button that writes the rows to a file, and the result.
    fn export(&mut self, ui: &mut Ui) {
        let (passes, palette) = (self.passes, self.palette);
        ui.horizontal(|ui| {
            let label = ui.label(RichText::new("File").color(palette.muted));
            let mut path = passes.path();
            let edit = TextEdit::singleline(&mut path)
                .align(egui::Align2::LEFT_CENTER)
                .font(egui::TextStyle::Monospace)
                .desired_width(260.0);
            let edit = ui.add(edit).labelled_by(label.id);
            if edit.known_as("passes.path").changed() {
                self.commands.push(PassCommand::Path(path));
            }

            let export = ui.button("Export rows as CSV");
            export.issues("passes.export", PassCommand::Export, self.commands);

            let (text, color) = match passes.export_result() {
                None => return,
                Some(Ok(message)) => (message, palette.inserted),
                Some(Err(message)) => (message, palette.conflict),
            };
            // The message may be cut off. The tooltip has all of it.
            let label = ui.add(Label::new(RichText::new(text).color(color)).truncate());
            label.known_as("passes.written");
            label.on_hover_text(text);
        });
    }

    /// Shows the fields for a word of the buffer to change after the pass, to inject a fault.
    fn fault_editor(&mut self, ui: &mut Ui, visit: &Visit, table: &BufferTable) {
        let palette = self.palette;
        // The typed numbers are kept between frames, and are the same for all buffers.
        let id = ui.scope_id().with("what if");
        let (mut index, mut word) = ui.data(|data| data.get_temp(id)).unwrap_or((0_u64, 0_u32));

        ui.horizontal(|ui| {
            let muted = |text: &str| RichText::new(text).color(palette.muted);
            let label = ui.label(muted("What if word"));
            // A word has four bytes. An empty buffer has no word: there the fault changes nothing.
            let last = (table.bytes / 4).saturating_sub(1);
            ui.add(DragValue::new(&mut index).range(0..=last))
                .labelled_by(label.id);
            let label = ui.label(muted("of this buffer became"));
            ui.add(DragValue::new(&mut word)).labelled_by(label.id);
            ui.label(muted("after this pass?"));
            if ui.button("Try").known_as("passes.try").clicked() {
                self.commands.push(PassCommand::Fault(Some(Fault {
                    after: visit.pass,
                    buffer: table.name,
                    index,
                    word,
                })));
            }
        });

        ui.data_mut(|data| data.insert_temp(id, (index, word)));
    }
}

fn muted(text: &str, palette: &Palette) -> RichText {
    RichText::new(text).small().color(palette.muted)
}

/// Returns the comparison of the whole run with the CPU.
fn summary(passes: &Passes) -> String {
    let entries = passes.entries();
    let count = |wanted: fn(&Badge) -> bool| entries.iter().filter(|e| wanted(&e.badge)).count();
    // Within a stage the CPU has no state to compare with. Each pass that ends a stage was compared, so that it
    // differs if it is not equal.
    let compared = count(|badge| *badge != Badge::Intermediate);
    let equal = count(|badge| *badge == Badge::Equal);
    let all = counted(entries.len(), "pass", "passes");
    let stages = counted(compared, "stage", "stages");
    let are = if equal == 1 { "is" } else { "are" };
    let differ = compared - equal;

    let again = match passes.restarts() {
        0 => String::new(),
        n => format!(
            "; begun anew {} with more room or a wider halo",
            counted(n as usize, "time", "times")
        ),
    };
    format!("{all}, {stages}: {equal} {are} equal to the CPU, {differ} differ{again}")
}

/// Shows how the run reached this pass.
fn way(ui: &mut Ui, visit: &Visit, palette: &Palette) {
    let text = if visit.replayed {
        "Reached by a new run from the beginning: the device only steps forwards."
    } else {
        "Reached by stepping forwards."
    };
    let label = ui.add(Label::new(muted(text, palette)).truncate());
    label.known_as("passes.way");
    label.on_hover_text("Lists that many invocations append to may have their rows in another sequence in every run.");
}

/// Shows the numbers of a pass: workgroups, invocations and time.
fn numbers(ui: &mut Ui, passes: &Passes, entry: &PassEntry, palette: &Palette) {
    let report = &entry.report;
    let mut parts = Vec::new();
    // Of a pass whose workgroups the device counted, the numbers are unknown unless they were read back.
    if let Some([x, y, z]) = report.workgroups {
        let from = if report.indirect {
            " (counted by the device)"
        } else {
            ""
        };
        parts.push(format!("{x} \u{d7} {y} \u{d7} {z} workgroups{from}"));
    }

    if let Some(count) = report.invocations {
        parts.push(counted(count as usize, "invocation", "invocations"));
    }

    // A single pass may lack its time on an adapter that measures others.
    parts.push(match report.seconds {
        Some(seconds) => tilescope_workbench::passes::model::duration_text(seconds),
        None if passes.has_timestamps() => "not timed".to_owned(),
        None => NO_TIMES.to_owned(),
    });
    ui.label(RichText::new(parts.join("   ")).color(palette.muted));
}

fn changed_text(count: usize) -> String {
    match count {
        0 => "nothing changed in the rows read".to_owned(),
        n => format!("{} changed", counted(n, "row", "rows")),
    }
}

/// Returns how many rows are shown, of how many, how many were read back, and how many of these the pass changed.
fn count_text(table: &BufferTable, shown: usize) -> String {
    let total = table.total as usize;
    let (rows, changed) = (table.rows(), table.changed_count());
    let read = if rows < total {
        format!("; only the first {} were read", grouped(rows))
    } else {
        String::new()
    };
    let changes = if changed > 0 {
        format!(", {} changed", grouped(changed))
    } else {
        String::new()
    };
    format!(
        "{} of {} rows{read}{changes}",
        grouped(shown),
        grouped(total)
    )
}
