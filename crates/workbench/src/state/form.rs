//! The input of the next run.

use tilescope_classroom::room::NewFile;
use tilescope_session::ground::{GroundRequest, MadeGround};
use tilescope_session::layers::SessionKind;
use tilescope_session::recipe::{OwnPattern, Recipe};
use tilescope_sets::{Brush, BrushStroke, GrayImage, PAINTED};

use super::effects::{Context, Effect};
use super::{GpuState, RunView};
use crate::command::{Command, FormCommand, GpuCommand, PaintCommand};
use crate::device::EngineChoice;
use crate::draft::{Draft, DraftRefusal};

/// The input of the next run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form {
    /// The parameters as typed.
    pub draft: Draft,
    /// The pattern from a file to use instead of the one that the parameters describe.
    pub own_pattern: Option<OwnPattern>,
    /// Whether small runs start at once when a parameter changes.
    pub live: bool,
    /// Whether the pointer paints radii on the canvas.
    pub paints: bool,
    /// The brush that it paints with.
    pub brush: Brush,
    /// The painted radii that were saved last.
    pub saved_radii: Option<GrayImage>,
}

impl Form {
    /// Takes the parameters and the pattern of another form. The brush, and whether small runs start at once, stay.
    pub(super) fn take(&mut self, other: Self) {
        (self.draft, self.own_pattern) = (other.draft, other.own_pattern);
    }

    /// Returns the recipe of the next run.
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        let ground = self.draft.ground_request();
        Recipe {
            parameters: self.draft.parameters,
            // In a field or in space there is no tiling, and so no pattern. Exact tiling of a shape makes its own.
            own: self
                .own_pattern
                .clone()
                .filter(|_| ground.is_none() && !self.draft.is_in_space()),
            nested: self.draft.nesting(),
            ground: ground.map(Box::new),
            depth: self.draft.depth_asked(),
        }
        .with_its_method()
    }

    /// Returns why it cannot be run now, or `None` if it can.
    #[must_use]
    pub fn refusal(&self, gpu: &GpuState) -> Option<String> {
        let first = self.draft.refusals().into_iter().next();
        let of_draft = first.as_ref().map(DraftRefusal::with_name);

        let own =
            "Nested levels have a pattern of their own; they cannot be made from that of a file.";
        let has_own = self.draft.levels.is_some() && self.own_pattern.is_some();

        of_draft
            .or_else(|| has_own.then(|| own.to_owned()))
            .or_else(|| gpu.waiting())
    }

    /// Returns a sentence that names what differs from the run shown, if anything.
    #[must_use]
    pub fn remark(&self, run: &RunView, gpu: &GpuState) -> Option<String> {
        // While another run is being made, the run shown is about to be replaced.
        let session = run.session.as_ref().filter(|_| run.sampling.is_none())?;

        if !session.has_recipe() {
            // Combinations have no recipe, nor have nested levels from a file, exact tilings of a shape whose file does not state
            // their blocks, and the sets of a lesson's wrong process.
            let is_tiled = session.ground.as_ref().is_some_and(MadeGround::is_tiled);
            let what = match session.kind() {
                SessionKind::Combination => "A combination is",
                SessionKind::Varying if is_tiled => "An exact tiling of a file is",
                SessionKind::Varying => "A set of a lesson is",
                // Runs, exact tilings made here and sets in space always have a recipe: only nested levels come here.
                SessionKind::Run
                | SessionKind::Exact
                | SessionKind::Nested
                | SessionKind::Solid => "Nested levels of a file are",
            };
            return Some(format!("{what} shown, not a run of these parameters."));
        }

        let made = session.recipe();
        let mut names = self.draft.differences(&made.parameters);
        if self.draft.nesting() != made.nested {
            names.push("nested levels");
        }
        // The field and the shape are named apart, as one may be typed and the other come from a file.
        let ground = self.draft.ground_request();
        let radius = |ground: &Option<GroundRequest>| ground.as_ref().map(|it| it.radius.clone());
        let shape = |ground: &Option<GroundRequest>| {
            ground.as_ref().and_then(|ground| ground.shape.clone())
        };
        // A request without a field has no radius of its own: that of the parameters is compared above.
        let of_made = made.ground.map(|ground| *ground);
        if radius(&ground).flatten() != radius(&of_made).flatten() {
            names.push("radius as a function");
        }
        let stipple =
            |ground: &Option<GroundRequest>| ground.as_ref().and_then(|it| it.stipple.clone());
        if stipple(&ground) != stipple(&of_made) {
            names.push("stipple");
        }
        if shape(&ground) != shape(&of_made) {
            names.push("shape");
        }
        if self.draft.depth_asked() != made.depth {
            names.push("depth");
        }
        let may_have_pattern_file = ground.is_none() && !self.draft.is_in_space();
        if may_have_pattern_file && self.own_pattern != session.own {
            names.push("pattern file");
        }
        if gpu.differs(run, &self.draft) {
            names.push("engine");
        }

        (!names.is_empty()).then(|| format!("Not in the run shown: {}.", names.join(", ")))
    }

    /// Applies a command to the parameters that are being edited.
    pub(super) fn apply(&mut self, command: FormCommand, context: &mut Context) {
        match command {
            FormCommand::Type(field, text) => self.draft.set_text(field, text),
            FormCommand::Nudge(field, steps) => self.draft.nudge(field, steps),
            FormCommand::Live(live) => self.live = live,
            FormCommand::Count(text) => self.draft.set_count(text),
            FormCommand::Exactly(text) => self.draft.exactly = text,
            FormCommand::Preset(preset) => {
                let draft = Draft::from_parameters(preset.parameters());
                let ground = preset.ground();
                self.draft = draft
                    .with_nesting(preset.nesting())
                    .with_ground(ground.as_ref());
                // A preset describes its pattern.
                self.own_pattern = None;
            }

            FormCommand::Choose(choice) => self.draft.choose(choice),
            FormCommand::GeneratedPattern => self.own_pattern = None,

            FormCommand::Depth(text) => self.draft.depth = text,

            // The field gives the radius at each place, and the shape says where samples are.
            FormCommand::Expression(text) => self.draft.ground.expression = text,
            FormCommand::White(text) => self.draft.ground.white = text,
            FormCommand::Stipple(number, text) => self.draft.ground.stipple.set_text(number, text),
            FormCommand::Inverted(inverted) => self.draft.ground.stipple.is_inverted = inverted,
            FormCommand::RunOn(runs_on) => self.draft.ground.stipple.runs_on = runs_on,
            FormCommand::CoverImage => self.draft.cover_image(),
            FormCommand::WholeDomain => self.draft.remove_shape(),
            FormCommand::ReferenceSampler => self.draft.take_reference(),

            FormCommand::Paint(command) => self.paint(command, context),

            FormCommand::Reset => {
                self.take(Self::default());
                // The engine is shown among the parameters, and returns to its default with them.
                let automatic = Command::Gpu(GpuCommand::Engine(EngineChoice::Auto));
                context.ask(Effect::Issue(Box::new(automatic)));
            }
        }
    }
}

impl Form {
    /// Applies a command of the brush. A stroke and a reset change the radii; the state then makes the run again.
    fn paint(&mut self, command: PaintCommand, context: &mut Context) {
        match command {
            PaintCommand::Tool(paints) => {
                let refusal = self.draft.paint_refusal().filter(|_| paints);
                self.paints = paints && refusal.is_none();
                if let Some(why) = refusal {
                    context.tell(why.to_owned());
                }
            }
            PaintCommand::Brush(brush) => self.brush = brush.limited(),
            PaintCommand::Stroke(path) => {
                let brush = self.brush;
                if let Err(why) = self.draft.paint(&BrushStroke { brush, path }) {
                    context.tell_error(why);
                }
            }
            // The state paints it as a stroke, since a form has no view.
            PaintCommand::Dab => {}
            PaintCommand::Reset => self.draft.unpaint(),
            PaintCommand::Save => self.save_painted(context),
        }
    }

    /// Returns whether radii were painted that are in no file: no session and no link holds them.
    pub(super) fn has_unsaved_radii(&self) -> bool {
        let ground = &self.draft.ground;
        ground.is_painted() && ground.image != self.saved_radii
    }

    /// Saves the painted radii as a file that the command line reads.
    fn save_painted(&self, context: &mut Context) {
        let ground = &self.draft.ground;
        let Some(image) = ground.image.as_ref().filter(|_| ground.is_painted()) else {
            return context.tell("No radii were painted.".to_owned());
        };

        match image.to_png() {
            Ok(bytes) => {
                let file = NewFile {
                    stem: PAINTED.trim_end_matches(".png").to_owned(),
                    extension: "png",
                    path: None,
                    bytes,
                };
                let image = Box::new(image.clone());
                context.ask(Effect::SaveRadii(image, Box::new(file)));
            }
            Err(error) => context.tell_error(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::Parameter;

    use super::*;
    use crate::State;

    #[test]
    fn a_reset_discards_what_was_typed() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        state.gpu.engine = EngineChoice::Cpu;
        let typed = FormCommand::Type(Parameter::Seed, "7".to_owned());
        state.apply(Command::Form(typed));
        assert_eq!(state.form.draft.parameters.seed, 7);
        state.apply(Command::Form(FormCommand::Reset));
        assert_eq!(state.form, Form::default());
        assert_eq!(state.gpu.engine, EngineChoice::Auto);
    }

    #[test]
    fn painted_radii_are_saved_once_they_are_written() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        let folder = tempfile::tempdir().unwrap();
        let image = GrayImage::from_grey(2, vec![9; 4]).unwrap();
        let mut save_to = |path: std::path::PathBuf| {
            let file = NewFile {
                stem: "painted".to_owned(),
                extension: "png",
                path: Some(path),
                bytes: vec![1],
            };
            let effect = Effect::SaveRadii(Box::new(image.clone()), Box::new(file));
            state.carry_out(crate::command::Which::First, vec![effect]);
            state.form.saved_radii.is_some()
        };
        assert!(!save_to(folder.path().join("absent").join("painted.png")));
        assert!(save_to(folder.path().join("painted.png")));
    }

    #[test]
    fn only_numbers_can_be_typed() {
        let command = |text| serde_json::from_str::<FormCommand>(text);
        command(r#"{"type":["pattern-side","20"]}"#).expect("a number");
        for text in [r#"{"type":["order","index"]}"#, r#"{"nudge":["order",1]}"#] {
            let error = command(text).expect_err(text).to_string();
            assert!(error.contains("order is chosen, not typed"), "{error}");
        }
    }
}
