//! The brush that paints radii, in the form below the radius. Sizes are in screen points, and chosen, not measured.

use egui::{Label, RichText, Slider, Ui};
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{Brush, Command, FormCommand, PaintCommand};

use super::{FormContext, labelled};

/// How wide the sliders are: with their numbers they fit in the narrowest panel.
const SLIDER_WIDTH: f32 = 70.0;

/// The text that appears while the pointer is over the switch of the tool.
const WHY: &str = "Strokes on the canvas make the radius smaller or larger in a soft disk, and the run is made again after each. The image stays on this machine.";

/// Shows the switch of the tool, the brush, and what can be done with painted radii.
pub(super) fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let form = context.form;
    let mut issue = |command| commands.push(Command::Form(FormCommand::Paint(command)));

    let mut paints = form.paints;
    let switch = ui.checkbox(&mut paints, "Paint radii");
    switch.known_as("paint-radii");
    if switch.on_hover_text(WHY).changed() {
        issue(PaintCommand::Tool(paints));
    }

    if form.paints {
        let mut brush = form.brush;
        sliders(ui, context, &mut brush);
        ui.horizontal(|ui| {
            for (is_larger, name, id) in [
                (false, "Smaller", "brush-smaller"),
                (true, "Larger", "brush-larger"),
            ] {
                let choice = ui.radio_value(&mut brush.is_larger, is_larger, name);
                choice.known_as(id);
            }
        });
        if brush != form.brush {
            issue(PaintCommand::Brush(brush));
        }
    }

    if form.draft.ground.is_painted() {
        painted(ui, context, commands);
    }
}

/// Shows the sliders of the brush.
fn sliders(ui: &mut Ui, context: &FormContext<'_>, brush: &mut Brush) {
    let [least, most] = Brush::SIZES.map(|size| 100.0 * size);
    let mut percent = 100.0 * brush.size;
    let size = (
        "Brush",
        "The radius of the brush, as a share of the longer side of the domain.",
    );
    labelled(ui, size, context.palette, |ui, label| {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let slider = Slider::new(&mut percent, least..=most)
            .logarithmic(true)
            .suffix("%")
            .max_decimals(0);
        ui.add(slider).labelled_by(label).known_as("brush-size");
    });
    // A size that is made a percentage, and a size again, may differ in its last bit. The size is therefore set only
    // when the slider has changed: otherwise a slider at rest would issue commands.
    if percent.to_bits() != (100.0 * brush.size).to_bits() {
        brush.size = percent / 100.0;
    }

    let [least, most] = Brush::STRENGTHS;
    let strength = (
        "Strength",
        "By which power of two a stroke changes the radius in its middle: 1 halves or doubles it.",
    );
    labelled(ui, strength, context.palette, |ui, label| {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let slider = Slider::new(&mut brush.strength, least..=most).max_decimals(1);
        ui.add(slider).labelled_by(label).known_as("brush-strength");
    });
}

/// Shows which image holds the painted radii, the way back, and the file for the command line.
fn painted(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let muted = |text: &str| RichText::new(text).color(context.palette.muted);
    let Some(image) = &context.form.draft.ground.image else {
        return;
    };

    let [columns, rows] = image.pixels();
    // The text below gives the width of a brush of 2% as an example. The size of a brush is its radius, which is half
    // of its width.
    let wide = (2.0 * 0.02 * columns.max(rows) as f64).round();
    let text = format!(
        "Painted in {columns} \u{d7} {rows} pixels of 16 bits, with radii between them in proportion: a brush of 2% is {wide} pixels wide. Links do not hold an image."
    );
    ui.add(Label::new(muted(&text)).wrap()).known_as("painted");

    let save = (
        "Save painted.png",
        "Saves the painted radii as an image, with which the command line makes the same set. Beside an older painted.png its name gets a number, which the command then needs, too.",
        "save-painted",
        PaintCommand::Save,
    );
    let reset = (
        "Radii as before painting",
        "Removes all strokes.",
        "unpaint",
        PaintCommand::Reset,
    );
    // An image that was opened as painted has no radii from before.
    let has_way_back = context.form.draft.ground.unpainted.is_some();
    for (name, why, id, command) in [Some(save), has_way_back.then_some(reset)]
        .into_iter()
        .flatten()
    {
        let command = Command::Form(FormCommand::Paint(command));
        ui.link(name)
            .on_hover_text(why)
            .issues(id, command, commands);
    }
    if let Some(command) = context.form.draft.painted_command() {
        // It can be selected and copied.
        let text = muted(&command).monospace().size(10.5);
        ui.add(Label::new(text).wrap()).known_as("painted-command");
        if context.form.draft.ground.shape.is_some() {
            let of_shape =
                muted("It covers the whole rectangle: add the shape by --mask or --shape.");
            ui.add(Label::new(of_shape).wrap());
        }
    }
}
