//! Paragraphs of lessons: plain, emphasised, strong, and code.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, Label, Response, Ui};
use tilescope_classroom::lessons::OpenLesson;
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Style, spans};
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::Known;

/// Shows paragraphs of the current step, translated and with the numbers of its run; those that begin with "- " are
/// items of a list.
pub fn show(ui: &mut Ui, open: &OpenLesson, paragraphs: &[String], size: f32, palette: &Palette) {
    for (index, words) in paragraphs.iter().enumerate() {
        let words = open.learner.words(words);
        let (indent, words) = match words.strip_prefix("- ") {
            Some(item) => (14.0, format!("\u{2022} {item}")),
            None => (0.0, words),
        };
        ui.horizontal(|ui| {
            ui.add_space(indent);
            paragraph(ui, &words, size, palette.text).known_as(format_args!("lesson-text-{index}"));
        });
        ui.add_space(5.0);
    }
}

/// Shows a paragraph, wrapped.
pub fn paragraph(ui: &mut Ui, words: &str, size: f32, color: Color32) -> Response {
    let job = job(ui, words, size, color);
    ui.add(Label::new(job).wrap())
}

/// Returns a paragraph with its fonts and colours, to be laid out by egui.
pub fn job(ui: &Ui, paragraph: &str, size: f32, color: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    let plain = FontId::proportional(size);
    for span in spans(paragraph) {
        let mut format = TextFormat::simple(plain.clone(), color);
        match span.style {
            Style::Plain => {}
            Style::Emphasis => format.italics = true,
            Style::Strong => format.font_id = FontId::new(size, semibold()),
            Style::Code => {
                format.font_id = FontId::monospace(size - 1.0);
                format.background = ui.visuals().code_bg_color;
            }
        }
        // The space between lines is chosen, not measured.
        format.line_height = Some(1.42 * size);
        job.append(&span.text, 0.0, format);
    }
    job
}
