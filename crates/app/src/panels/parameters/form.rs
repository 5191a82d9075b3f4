//! The fields of the parameters. An error stands in a row of its own below its field: it covers nothing, and the field in
//! which one types does not move.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{ComboBox, CursorIcon, Label, RichText, TextEdit, Ui};
use tilescope_core::{
    NOT_OF_EXACT, Parameter, ParameterGroup, ParameterKind, Parameters, TilingMethod,
};
use tilescope_drawing::palette::Palette;
use tilescope_session::glossary;
use tilescope_session::words::{capital, grouped};
use tilescope_ui::widgets::{Kebab, Known, heading};

use super::super::choices::{
    FORMULA, LEVELS, Listed, RADIUS_BY, SHAPE_BY, WITHIN, WITHOUT_IMAGE, meaning, options,
};
use super::super::engine;
use super::{FormContext, brush, changed_mark, field_width, labelled, shared};
use tilescope_workbench::command::{Command, FormCommand};
use tilescope_workbench::draft::{
    self, Choice, DraftRefusal, FormPart, Preset, RadiusBy, StippleNumber,
};
use tilescope_workbench::link::link_key;

/// The id by which tests and assistive tools find the error of choices that exclude each other. Other errors belong to
/// one field and have its name.
const ERROR_OF_CHOICES: &str = "refusal-0";

/// Shows the fields of all parameters.
pub(super) fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let mut fields = Fields {
        context,
        palette: context.palette,
        refusals: context.form.draft.refusals(),
        commands,
    };

    presets(ui, context, fields.commands);
    fields.group(ui, "Domain", ParameterGroup::Domain);
    fields.shape(ui);

    // A set in a field or in space is not tiled, and a shape only exactly: of the parameters below only the seed has a meaning
    // for darts.
    let draft = &context.form.draft;
    if draft.ground.is_asked() || draft.is_in_space() {
        if draft.ground.is_shape_of_one_radius() && !draft.is_in_space() {
            fields.method_of_shape(ui);
        }
        if draft.tiles_shape() {
            fields.tiling_of_shape(ui);
        } else {
            fields.number(ui, Parameter::Seed);
            let text = if draft.is_in_space() {
                "Darts of the reference sampler make this set of balls, which a plane shows."
            } else {
                "Darts of the reference sampler make this set, without tiling."
            };
            ui.label(RichText::new(text).color(context.palette.muted))
                .known_as("no-tiling");
        }
        fields.error(ui, FormPart::Choices, ERROR_OF_CHOICES);
        // Darts make no nested levels. If levels were chosen before, their choice is still shown, so that it can be
        // taken back.
        if context.form.draft.levels.is_some() {
            fields.nested(ui);
        }
        return;
    }

    fields.group(ui, "Tiling", ParameterGroup::Tiling);
    fields.group(ui, "Elimination and insertion", ParameterGroup::Algorithm);
    fields.error(ui, FormPart::Choices, ERROR_OF_CHOICES);
    engine::show(ui, context, fields.commands);
    fields.nested(ui);
}

struct Fields<'a> {
    context: &'a FormContext<'a>,
    palette: &'static Palette,
    refusals: Vec<DraftRefusal>,
    commands: &'a mut Vec<Command>,
}

impl Fields<'_> {
    /// Shows the parameters of a part of the form, numbers first, with what belongs to some of them below.
    fn group(&mut self, ui: &mut Ui, name: &str, group: ParameterGroup) {
        heading(ui, name);
        let of_group = |parameter: &Parameter| parameter.row().group == group;
        for parameter in draft::numbers().filter(of_group) {
            match parameter {
                // Width and height share a line, which is shown at the width. The depth, which is no parameter, follows
                // it.
                Parameter::Width => self.pair(ui, "Size", [Parameter::Width, Parameter::Height]),
                Parameter::Height => self.depth(ui),
                Parameter::Radius => self.radius(ui),
                _ => self.number(ui, parameter),
            }
        }

        let has_options = |parameter: &Parameter| !parameter.options().is_empty();
        for parameter in Parameter::all().filter(of_group).filter(has_options) {
            self.option(ui, parameter);
            if parameter == Parameter::Method {
                shared::show(ui, self.context, self.commands);
            }
            if parameter == Parameter::PatternBoundary {
                own_pattern(ui, self.context, self.commands);
            }
        }
    }

    /// Shows how the radius is given, and its number, its formula or its image; below them the number of samples and
    /// the brush, where they have a meaning.
    fn radius(&mut self, ui: &mut Ui) {
        let ground = &self.context.form.draft.ground;
        // Images come from files, and only with one are its choices offered.
        let offered = if ground.image.is_some() {
            &RADIUS_BY[..]
        } else {
            &RADIUS_BY[..WITHOUT_IMAGE]
        };
        self.choice(
            ui,
            ("radius-by", "Radius by"),
            "Whether the radius is one number, or depends on the place. An image that is dropped on the window can give it, too.",
            (ground.by, offered),
            Choice::RadiusBy,
        );

        match ground.by {
            // The field of the number of samples sets a planar radius: it is left out of a set in space.
            RadiusBy::Constant if self.context.form.draft.is_in_space() => {
                self.number(ui, Parameter::Radius);
            }
            RadiusBy::Constant => {
                self.number(ui, Parameter::Radius);
                self.samples(ui);
                return brush::show(ui, self.context, self.commands);
            }
            RadiusBy::Expression => self.expression(ui),
            RadiusBy::Image => {
                self.image_name(ui);
                self.number(ui, Parameter::Radius);
                self.white(ui);
            }
            RadiusBy::Density => {
                self.image_name(ui);
                self.number(ui, Parameter::Radius);
            }
            RadiusBy::Stipple => {
                self.image_name(ui);
                self.stipple(ui);
                // The number of dots is typed, so that none is estimated below. The brush is not offered, as a
                // stipple's radii follow from its image.
                return self.costs(ui);
            }
        }
        self.expected(ui);
        brush::show(ui, self.context, self.commands);
    }

    /// Shows the third side, which makes a set one in space.
    fn depth(&mut self, ui: &mut Ui) {
        let mut text = self.context.form.draft.depth.clone();
        let meaning = "The third side of a box: the set is one of balls in space, seen in a plane. Empty: the set is planar.";
        let part = (FormPart::Depth, "depth");
        self.free_text(ui, ("Depth", meaning), &mut text, part, FormCommand::Depth);
    }

    /// Shows the radius as a function of x and y.
    fn expression(&mut self, ui: &mut Ui) {
        let mut text = self.context.form.draft.ground.expression.clone();
        let command = FormCommand::Expression;
        let name = ("Formula", FORMULA);
        self.free_text(
            ui,
            name,
            &mut text,
            (FormPart::Expression, "radius-expression"),
            command,
        );
    }

    /// Shows how many dots a stipple has, and how dark its image is.
    fn stipple(&mut self, ui: &mut Ui) {
        let draft = &self.context.form.draft.ground.stipple;
        for number in StippleNumber::ALL {
            let mut text = draft.text(number).to_owned();
            let id = format!("stipple-{}", Kebab(number));
            self.free_text(
                ui,
                (number.name(), number.meaning()),
                &mut text,
                (FormPart::Stipple(number), &id),
                |text| FormCommand::Stipple(number, text),
            );
        }

        let (mut inverted, mut runs_on) = (draft.is_inverted, draft.runs_on);
        let switch = ui.checkbox(&mut inverted, "Inverted");
        switch.known_as("stipple-inverted");
        let why = "Dots where the image is light, as ink on black paper.";
        if switch.on_hover_text(why).changed() {
            self.issue(FormCommand::Inverted(inverted));
        }
        let switch = ui.checkbox(&mut runs_on, "Run on beyond the frame");
        switch.known_as("stipple-run-on");
        let why = "Makes dots beyond the frame, too, and drops them there: at the border there are a few more dots otherwise.";
        if switch.on_hover_text(why).changed() {
            self.issue(FormCommand::RunOn(runs_on));
        }
    }

    /// Shows the radius of white.
    fn white(&mut self, ui: &mut Ui) {
        let mut text = self.context.form.draft.ground.white.clone();
        let name = (
            "Of white",
            "The radius where the image is white; the one above is that of black.",
        );
        self.free_text(
            ui,
            name,
            &mut text,
            (FormPart::White, "white"),
            FormCommand::White,
        );
    }

    /// Shows a field for a text, and its error below: that of `part` of the form. `command` is issued with a changed
    /// text.
    fn free_text(
        &mut self,
        ui: &mut Ui,
        (name, meaning): (&str, &str),
        text: &mut String,
        (part, id): (FormPart, &str),
        command: impl FnOnce(String) -> FormCommand,
    ) {
        let is_wrong = self.refusal(part).is_some();
        labelled(ui, (name, meaning), self.palette, |ui, _| {
            let width = field_width(ui);
            let field = self.text_field(ui, text, (name, meaning), width, is_wrong);
            field.known_as(id);
            if field.changed() {
                self.issue(command(text.clone()));
            }
            self.run_on_enter(ui, &field);
        });
        self.error(ui, part, &format!("refusal-{id}"));
    }

    /// Shows the name of the image.
    fn image_name(&self, ui: &mut Ui) {
        if let Some(image) = &self.context.form.draft.ground.image {
            let [columns, rows] = image.pixels();
            let text = format!("{}, {columns} \u{d7} {rows} pixels", image.name());
            ui.label(RichText::new(text).color(self.palette.muted))
                .known_as("radius-image");
        }
    }

    /// Shows about how many samples a field asks for, and what a run of that size costs.
    fn expected(&self, ui: &mut Ui) {
        let draft = &self.context.form.draft;
        if let Some(samples) = draft.expected_samples() {
            let text = format!("About {} samples.", grouped(samples.round() as usize));
            ui.label(RichText::new(text).color(self.palette.muted))
                .known_as("expected-samples");
        }
        self.costs(ui);
    }

    /// Shows the area to cover, if it is not the whole domain, and offers the image as a mask, if there is one.
    fn shape(&mut self, ui: &mut Ui) {
        let ground = &self.context.form.draft.ground;
        // A stipple has a shape of its own: the places that are not white.
        let is_stipple = ground.by == RadiusBy::Stipple;
        if ground.image.is_some() && !ground.is_mask() && !is_stipple {
            let command = Command::Form(FormCommand::CoverImage);
            let why = "Covers the opaque pixels of the image alone; if all are opaque, those that are lighter than half grey. A radius that the image gave becomes one number; an image of as many pixels that is dropped on the window gives it again.";
            ui.link("Cover the image as a mask")
                .on_hover_text(why)
                .issues("cover-image", command, self.commands);
        }

        let Some(text) = ground.shape_text() else {
            return;
        };
        ui.label(RichText::new(text).color(self.palette.muted))
            .known_as("shape");
        let command = Command::Form(FormCommand::WholeDomain);
        ui.link("Cover the whole domain")
            .issues("whole-domain", command, self.commands);
    }

    /// Shows by which method a shape of one radius is made.
    fn method_of_shape(&mut self, ui: &mut Ui) {
        heading(ui, "Tiling");
        let parameter = Parameter::Method;
        let Some(current) = parameter.chosen(self.parameters()) else {
            return;
        };
        self.choice(
            ui,
            (link_key(parameter), &capital(parameter.row().label)),
            "By which method the samples of the shape are made.",
            (current.name, &SHAPE_BY),
            |name| Choice::Parameter(parameter, name.into()),
        );
        shared::show(ui, self.context, self.commands);
    }

    /// Shows the parameters of an exact tiling of a shape, which makes its own pattern.
    fn tiling_of_shape(&mut self, ui: &mut Ui) {
        let of_group = |parameter: &Parameter| parameter.row().group == ParameterGroup::Tiling;
        for parameter in draft::numbers().filter(of_group) {
            self.number(ui, parameter);
        }
        repeats(ui, self.context, self.palette);
        for parameter in [Parameter::PatternBoundary, Parameter::Dihedral] {
            self.option(ui, parameter);
        }
    }

    /// Shows a parameter that is chosen.
    fn option(&mut self, ui: &mut Ui, parameter: Parameter) {
        // A parameter that is a number has no option that could be chosen.
        let Some(current) = parameter.chosen(self.parameters()) else {
            return;
        };
        let is_exact = self.parameters().method == TilingMethod::Exact;
        // Exact tiling keeps the sample that arrived first, so that there is no order or insertion to choose.
        let has_meaning = !(is_exact && NOT_OF_EXACT.contains(&parameter));
        ui.add_enabled_ui(has_meaning, |ui| {
            self.choice(
                ui,
                (link_key(parameter), &capital(parameter.row().label)),
                meaning(parameter),
                (current, &options(parameter)),
                |option| Choice::Parameter(parameter, parameter.value_of(option)),
            );
        });
    }

    /// Shows the choice of nested levels, and below it their choices where there are to be some.
    fn nested(&mut self, ui: &mut Ui) {
        heading(ui, "Nested levels");
        let draft = &self.context.form.draft;
        self.choice(
            ui,
            ("levels", "Levels"),
            glossary::LEVEL.meaning,
            (draft.levels, &LEVELS),
            Choice::Levels,
        );
        // The choices below are about levels alone.
        if draft.levels.is_none() {
            return;
        }

        let meaning = "How many samples there are to be exactly. They are the first of a set that has as many or a few more, whose radius follows from it; there is no maximal set of every number. Empty: the radius decides.";
        let is_wrong = self.refusal(FormPart::Exactly).is_some();
        labelled(ui, ("Exactly", meaning), self.palette, |ui, _| {
            let mut text = draft.exactly.clone();
            let width = field_width(ui);
            let field = self.text_field(ui, &mut text, ("Exactly", meaning), width, is_wrong);
            field.known_as("exactly");
            if field.changed() {
                self.issue(FormCommand::Exactly(text));
            }
            self.run_on_enter(ui, &field);
        });
        self.error(ui, FormPart::Exactly, "refusal-exactly");

        self.choice(
            ui,
            ("within", "Within a level"),
            "The order of the samples that a level adds.",
            (draft.within, &WITHIN),
            Choice::Within,
        );
    }

    fn parameters(&self) -> &Parameters {
        &self.context.form.draft.parameters
    }

    fn issue(&mut self, command: FormCommand) {
        self.commands.push(Command::Form(command));
    }

    /// Shows the number of samples, which follows from the radius, and which can be typed to set the radius.
    fn samples(&mut self, ui: &mut Ui) {
        let draft = &self.context.form.draft;
        let is_wrong = self.refusal(FormPart::Samples).is_some();
        let name = "Samples";
        let meaning =
            "About how many samples the run will have. Type a number to set the radius by it.";

        labelled(ui, (name, meaning), self.palette, |ui, _| {
            let mut text = draft.count_text();
            let width = field_width(ui);
            let field = self.text_field(ui, &mut text, (name, meaning), width, is_wrong);
            field.known_as("count");
            if field.changed() {
                self.issue(FormCommand::Count(text));
            }
            self.run_on_enter(ui, &field);
        });
        self.error(ui, FormPart::Samples, "count.refusal");

        self.costs(ui);
    }

    /// Shows remarks on what a large run costs: it keeps no steps, and needs much memory.
    fn costs(&self, ui: &mut Ui) {
        let draft = &self.context.form.draft;
        if draft.keeps_result_only() {
            let text =
                "So large a run keeps its result only: there will be no steps to go through.";
            ui.label(RichText::new(text).small().color(self.palette.accent))
                .known_as("result-only");
        }

        if let Some(text) = &self.context.memory {
            ui.label(RichText::new(text).small().color(self.palette.accent))
                .known_as("memory-needed");
        }
    }

    fn number(&mut self, ui: &mut Ui, field: Parameter) {
        let palette = self.palette;
        let name = capital(field.row().label);
        let label = labelled(ui, (&name, meaning(field)), palette, |ui, _| {
            self.mark(ui, &[field]);
            let width = field_width(ui);
            self.edit(ui, field, &name, width);
            if let ParameterKind::Real { unit: "r", .. } = field.row().kind {
                ui.label(RichText::new("r").color(palette.muted));
            }
        });
        drag(ui, &label, field, self.commands);
        self.field_error(ui, field);
    }

    /// Shows two fields on one line.
    fn pair(&mut self, ui: &mut Ui, name: &str, fields: [Parameter; 2]) {
        labelled(ui, (name, meaning(fields[0])), self.palette, |ui, _| {
            self.mark(ui, &fields);
            ui.spacing_mut().item_spacing.x = 6.0;
            let width = (field_width(ui) - 6.0) / 2.0;
            for field in fields {
                self.edit(ui, field, &capital(field.row().label), width);
            }
        });
        for field in fields {
            self.field_error(ui, field);
        }
    }

    /// Draws a mark before fields of which one is not as in the run shown. The line above the Run button names them.
    fn mark(&self, ui: &Ui, fields: &[Parameter]) {
        let (draft, made) = (&self.context.form.draft, self.context.made.as_ref());
        if made.is_some_and(|made| fields.iter().any(|&field| draft.differs(field, made))) {
            changed_mark(ui, self.palette);
        }
    }

    fn refusal(&self, part: FormPart) -> Option<&DraftRefusal> {
        let mut refusals = self.refusals.iter();
        refusals.find(|refusal| refusal.part == part)
    }

    fn field_error(&self, ui: &mut Ui, field: Parameter) {
        let id = format!("refusal-{}", link_key(field));
        self.error(ui, FormPart::Field(field), &id);
    }

    /// Shows the error of a part of the form, if it has one, in a row of its own.
    fn error(&self, ui: &mut Ui, part: FormPart, id: &str) {
        if let Some(refusal) = self.refusal(part) {
            let text = RichText::new(&refusal.reason)
                .small()
                .color(self.palette.conflict);
            ui.add(Label::new(text).wrap()).known_as(id);
        }
    }

    /// Shows the text field of a parameter. Up and down change its number by small steps.
    fn edit(&mut self, ui: &mut Ui, field: Parameter, name: &str, width: f32) {
        let mut text = self.context.form.draft.text(field).to_owned();
        let is_wrong = self.refusal(FormPart::Field(field)).is_some();
        let explanation = (name, meaning(field));
        let response = self.text_field(ui, &mut text, explanation, width, is_wrong);
        response.known_as(link_key(field));
        if response.changed() {
            self.issue(FormCommand::Type(field, text));
        }
        if response.has_focus() {
            let pressed = |key| ui.input(|input| input.num_presses(key)) as i32;
            // Several presses may fall into one slow frame.
            let steps = pressed(egui::Key::ArrowUp) - pressed(egui::Key::ArrowDown);
            if steps != 0 {
                self.issue(FormCommand::Nudge(field, steps));
            }
        }
        self.run_on_enter(ui, &response);
    }

    /// Shows a text field with its name and its meaning, in the colour of faults if it is wrong.
    fn text_field(
        &self,
        ui: &mut Ui,
        text: &mut String,
        (name, meaning): (&str, &str),
        width: f32,
        is_wrong: bool,
    ) -> egui::Response {
        let color = is_wrong.then_some(self.palette.conflict);
        let edit = TextEdit::singleline(text)
            .align(egui::Align2::LEFT_CENTER)
            .id_salt(name)
            .font(egui::TextStyle::Monospace)
            .text_color_opt(color)
            .margin(egui::Margin::symmetric(8, 4))
            .desired_width(width);
        ui.add(edit).accessible_name(name).on_hover_text(meaning)
    }

    /// Runs when Enter was pressed in a field. While something is wrong nothing runs, and the field keeps the focus: what
    /// is typed to mend it would otherwise be taken for shortcuts.
    fn run_on_enter(&mut self, ui: &Ui, response: &egui::Response) {
        let entered = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let context = self.context;
        if entered && context.refusal.is_some() {
            response.request_focus();
        } else if entered && context.sampling.is_none() {
            self.commands.push(Command::Run);
        }
    }

    /// Shows a list of options; `command` makes the choice of an option that is selected.
    fn choice<T: Copy + PartialEq>(
        &mut self,
        ui: &mut Ui,
        (key, name): (&str, &str),
        explanation: &str,
        (current, options): (T, &[Listed<T>]),
        command: impl FnOnce(T) -> Choice,
    ) {
        // The list changes a copy of the value. A command follows below if the copy differs.
        let mut chosen = current;
        let current_option = options.iter().find(|(value, ..)| *value == current);

        labelled(ui, (name, explanation), self.palette, |ui, label| {
            let combo = ComboBox::from_id_salt(name)
                .selected_text(current_option.map_or("", |(_, text, _)| text))
                .width(field_width(ui))
                .truncate()
                .show_ui(ui, |ui| {
                    for (value, text, meaning) in options {
                        let option = ui.selectable_value(&mut chosen, *value, *text);
                        option.on_hover_text(*meaning);
                    }
                });
            let response = combo.response.labelled_by(label);
            response.known_as(key);
            response.on_hover_text(explanation);
        });

        if chosen != current {
            self.issue(FormCommand::Choose(command(chosen)));
        }
    }
}

/// Shows the presets, each of which sets all parameters and runs, the choice of live runs, and the way back to the first
/// parameters.
fn presets(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        preset_menu(ui, commands);
        let mut live = context.form.live;
        let switch = ui.checkbox(&mut live, "Live");
        switch.known_as("live");
        let why = "Runs at once when a parameter changes, up to 50,000 samples. Drag the name of a number sideways, or press Up and Down in its field, to change it.";
        if switch.on_hover_text(why).changed() {
            commands.push(Command::Form(FormCommand::Live(live)));
        }
        let reset = ui.link("Reset");
        reset.known_as("reset-parameters");
        let why = "Reset the parameters and the engine to those of the first session";
        if reset.on_hover_text(why).clicked() {
            commands.push(Command::Form(FormCommand::Reset));
        }
    });
}

/// Shows the menu of presets. A click on one sets all parameters and runs.
fn preset_menu(ui: &mut Ui, commands: &mut Vec<Command>) {
    let menu = ui.menu_button("Presets", |ui| {
        for preset in Preset::all() {
            let row = ui.button(preset.name());
            row.known_as(format_args!("preset.{}", Kebab(preset)));
            if row.on_hover_text(preset.explanation()).clicked() {
                commands.push(Command::Form(FormCommand::Preset(preset)));
                commands.push(Command::Run);
                ui.close();
            }
        }
    });
    menu.response.opens_menu(menu.inner.is_some());
    menu.response.known_as("presets");
}

/// Notes that the pattern comes from a file, if it does; otherwise that it repeats within blocks, if it does.
fn own_pattern(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let Some(own) = &context.form.own_pattern else {
        repeats(ui, context, palette);
        return;
    };
    let text = format!(
        "The pattern comes from {}: {} samples.",
        own.file.path,
        grouped(own.pattern.samples().len())
    );
    ui.label(RichText::new(text).color(palette.muted))
        .known_as("own-pattern");
    let command = Command::Form(FormCommand::GeneratedPattern);
    ui.link("Use a generated pattern")
        .issues("generated-pattern", command, commands);
}

/// Notes that the pattern repeats within blocks, if it does.
fn repeats(ui: &mut Ui, context: &FormContext<'_>, palette: &Palette) {
    if let Some(side) = context.form.draft.side_without_repeats() {
        let text = format!(
            "The pattern repeats within the largest blocks; a side of {side} r would avoid that."
        );
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("pattern-repeats");
    }
}

/// How far the name of a number is dragged for a step, in screen points.
const STEP: f32 = 8.0;

/// Changes a number while its name is dragged sideways.
fn drag(ui: &Ui, label: &egui::Response, field: Parameter, commands: &mut Vec<Command>) {
    if label.hovered() || label.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if !label.dragged() {
        return;
    }
    let before: f32 = ui.data(|data| data.get_temp(label.id)).unwrap_or_default();
    let rest = if label.drag_started() { 0.0 } else { before };
    let moved = rest + label.drag_delta().x;
    let steps = (moved / STEP).trunc();
    // The rest of a step counts for the next movement.
    ui.data_mut(|data| data.insert_temp(label.id, moved - steps * STEP));
    if steps != 0.0 {
        let nudge = FormCommand::Nudge(field, steps as i32);
        commands.push(Command::Form(nudge));
    }
}
