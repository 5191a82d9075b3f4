//! The field and the shape in the form: how the radius is given, the expression as typed, and the area to cover.

use serde::{Deserialize, Serialize};
use tilescope_core::{Boundary, Parameter, Parameters, TilingMethod};
use tilescope_sets::{
    BrushStroke, Expression, GrayImage, PAINTED, PaintedRadii, RadiusSource, ShapeSource,
    VaryingError, check_pixels,
};

use super::polygon::samples_in_polygon;
use super::refusal::part_of;
use super::{Draft, DraftRefusal, FormPart, StippleDraft};
use crate::ground::{GroundRequest, scaled_text};
use crate::typed;
use crate::words::{counted, sentence};

/// The expression that the field begins with: from a fifth of the largest radius on the left to all of it on the right.
const FIRST_EXPRESSION: &str = "0.006 + 0.024*x";

/// How many samples an image begins with, about. Chosen, not measured.
const SAMPLES_OF_IMAGE: f64 = 6_000.0;

/// How many samples a shape begins with, about, if the radius of the form does not suit it. Chosen, not measured.
const SAMPLES_OF_SHAPE: f64 = 3_000.0;

/// How the radius is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RadiusBy {
    /// One number for all places.
    #[default]
    Constant,
    /// A function of x and y.
    Expression,
    /// The grey of an image: from the radius of black to that of white.
    Image,
    /// The darkness of an image, as the density; the radius is that of black.
    Density,
    /// The darkness of an image, in a given number of dots.
    Stipple,
}

/// The field and the shape as they are edited.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundDraft {
    /// How the radius is given.
    pub by: RadiusBy,
    /// The radius as a function, as typed.
    pub expression: String,
    /// The image, if one was opened.
    pub image: Option<GrayImage>,
    /// The radius of white, as typed.
    pub white: String,
    /// The dots and the tone of a stipple, as typed.
    pub stipple: StippleDraft,
    /// The area to cover, if it is not the whole domain.
    pub shape: Option<ShapeSource>,
    /// Where the lower corner of the domain lies.
    pub origin: [f64; 2],
    /// What the radius was before it was painted, if it was painted.
    pub unpainted: Option<Box<Unpainted>>,
}

/// How the radius was given before it was painted.
#[derive(Clone, Debug, PartialEq)]
pub struct Unpainted {
    by: RadiusBy,
    image: Option<GrayImage>,
    white: String,
    /// The radius of the form, as typed.
    radius: String,
}

impl Default for GroundDraft {
    fn default() -> Self {
        Self {
            by: RadiusBy::Constant,
            expression: FIRST_EXPRESSION.to_owned(),
            image: None,
            white: String::new(),
            stipple: StippleDraft::default(),
            shape: None,
            origin: [0.0; 2],
            unpainted: None,
        }
    }
}

impl GroundDraft {
    /// Returns whether the radius is that of a field that was painted.
    #[must_use]
    pub fn is_painted(&self) -> bool {
        let is_of_brush = |image: &GrayImage| image.name() == PAINTED;
        self.by == RadiusBy::Image && self.image.as_ref().is_some_and(is_of_brush)
    }

    /// Returns whether a field or a shape is asked for.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.by != RadiusBy::Constant || self.shape.is_some()
    }

    /// Returns whether a shape of one radius is asked for, which can be tiled exactly.
    #[must_use]
    pub fn is_shape_of_one_radius(&self) -> bool {
        self.by == RadiusBy::Constant && self.shape.is_some()
    }

    /// Returns the request, or the error of an expression that cannot be read; `None` if neither a field nor a shape is
    /// asked for. `black` is the radius of the form.
    fn request(&self, black: f64) -> Option<Result<GroundRequest, VaryingError>> {
        if !self.is_asked() {
            return None;
        }

        let radius = match (self.by, self.image.clone()) {
            (RadiusBy::Stipple, Some(image)) => {
                // The stipple gives the radius and the shape, and its pixels begin at 0.
                return Some(Ok(GroundRequest {
                    radius: None,
                    shape: None,
                    origin: [0.0; 2],
                    stipple: Some(self.stipple.request(image)),
                }));
            }
            (RadiusBy::Expression, _) => match Expression::parse(&self.expression) {
                Ok(expression) => Some(RadiusSource::Expression {
                    expression,
                    scale: 1.0,
                }),
                Err(error) => return Some(Err(error)),
            },
            (RadiusBy::Image, Some(image)) => {
                // A text that is no number is among the refusals.
                let radii = [black, typed::number(&self.white).unwrap_or(black)];
                Some(RadiusSource::Image { image, radii })
            }
            // Darkness says how dense samples are, and the radius of the form is that of black.
            (RadiusBy::Density, Some(image)) => Some(RadiusSource::Density { image, black }),
            // Without a field the radius is that of the parameters.
            (RadiusBy::Constant, _)
            | (RadiusBy::Image | RadiusBy::Density | RadiusBy::Stipple, None) => None,
        };

        Some(Ok(GroundRequest {
            radius,
            shape: self.shape.clone(),
            origin: self.origin,
            stipple: None,
        }))
    }
}

impl GroundDraft {
    /// Returns a sentence that says which area is covered, if that is not the whole domain.
    #[must_use]
    pub fn shape_text(&self) -> Option<String> {
        Some(match self.shape.as_ref()? {
            ShapeSource::Polygon(polygon) => {
                let rings = polygon.rings();
                let corners = counted(rings.iter().map(Vec::len).sum(), "corner", "corners");
                let count = counted(rings.len(), "ring", "rings");
                format!("Covers a polygon of {count}, {corners} in all.")
            }
            ShapeSource::Mask(image) if image.has_transparency() => {
                format!("Covers the opaque pixels of {}.", image.name())
            }
            ShapeSource::Mask(image) => {
                let name = image.name();
                format!("Covers the pixels of {name} that are lighter than half grey.")
            }
            ShapeSource::Dark { image, .. } => {
                format!("Covers the places of {} that are not white.", image.name())
            }
        })
    }

    /// Returns whether the image is the mask already.
    #[must_use]
    pub fn is_mask(&self) -> bool {
        let mask = match &self.shape {
            Some(ShapeSource::Mask(mask)) => Some(mask),
            _ => None,
        };
        mask.is_some() && mask == self.image.as_ref()
    }
}

impl From<Option<&GroundRequest>> for GroundDraft {
    fn from(request: Option<&GroundRequest>) -> Self {
        let mut draft = Self::default();
        let Some(request) = request else {
            return draft;
        };

        match &request.radius {
            Some(RadiusSource::Expression { expression, scale }) => {
                draft.by = RadiusBy::Expression;
                draft.expression = scaled_text(expression, *scale);
            }
            Some(RadiusSource::Image { image, radii }) => {
                (draft.by, draft.image) = (RadiusBy::Image, Some(image.clone()));
                // The radius of black is that of the parameters.
                let [_black, white] = radii;
                draft.white = white.to_string();
            }
            Some(RadiusSource::Density { image, .. }) => {
                (draft.by, draft.image) = (RadiusBy::Density, Some(image.clone()));
            }
            // The form asks for no grid, and has its one radius among the parameters.
            None | Some(RadiusSource::Constant(_) | RadiusSource::Grid { .. }) => {}
        }
        if let Some(stipple) = &request.stipple {
            (draft.by, draft.image) = (RadiusBy::Stipple, Some(stipple.image.clone()));
            draft.stipple = stipple.into();
        }
        // A shape may come with any radius. The image of a mask is offered for the radius, too.
        draft.shape.clone_from(&request.shape);
        if let (None, Some(ShapeSource::Mask(mask))) = (&draft.image, &draft.shape) {
            draft.image = Some(mask.clone());
        }
        draft.origin = request.origin;
        draft
    }
}

impl Draft {
    /// Returns the draft with this field and shape, if any.
    #[must_use]
    pub fn with_ground(self, request: Option<&GroundRequest>) -> Self {
        let ground = GroundDraft::from(request);
        Self { ground, ..self }
    }

    /// Returns the field and the shape that are asked for, if any. An expression that cannot be read is left out; it is among
    /// the refusals.
    #[must_use]
    pub fn ground_request(&self) -> Option<GroundRequest> {
        self.ground.request(self.parameters.radius)?.ok()
    }

    /// Chooses how the radius is given. Where it was one number, the domain becomes bounded, as on the command line: few fields
    /// are periodic.
    pub(super) fn choose_radius_by(&mut self, by: RadiusBy) {
        // Without an image there is nothing to read the radius from.
        let is_of_image = matches!(by, RadiusBy::Image | RadiusBy::Density | RadiusBy::Stipple);
        if is_of_image && self.ground.image.is_none() {
            return;
        }

        // A stipple has its pixels as the unit of length, as on the command line, and a shape of its own. Other sets have the
        // unit square, or the part of it that an image fills. If the choice stays, so does the unit.
        let image = self.ground.image.clone().filter(|_| by != self.ground.by);
        match (image, self.ground.by) {
            (Some(image), _) if by == RadiusBy::Stipple => self.measure_in_pixels(&image),
            (Some(image), RadiusBy::Stipple) => {
                let width = Parameter::Width.text(&Parameters::default());
                self.set_text(Parameter::Width, width);
                // While a stipple is chosen, `set_image` measures in pixels.
                self.ground.by = RadiusBy::Density;
                self.set_image(image);
            }
            _ => {}
        }
        if by != RadiusBy::Constant && self.ground.by == RadiusBy::Constant {
            self.parameters.boundary = Boundary::Bounded;
        }
        self.ground.by = by;
    }

    /// Covers a shape in a bounded domain. With a polygon the domain becomes the rectangle around it. The radius is
    /// then replaced by one for this rectangle if it is not allowed there, if it is the default one, or if a stipple
    /// was chosen. With another shape the sides and the radius stay.
    pub fn set_shape(&mut self, shape: ShapeSource) {
        // A stipple has a shape of its own, so that its image no longer gives the radius.
        let was_stipple = self.ground.by == RadiusBy::Stipple;
        if was_stipple {
            self.ground.by = RadiusBy::Constant;
        }

        self.parameters.boundary = Boundary::Bounded;
        // A mask fills the domain as it is.
        if let ShapeSource::Polygon(polygon) = &shape {
            let [low, high] = polygon.bounds();
            let sides = [0, 1].map(|axis| high[axis] - low[axis]);
            // The lower corner of the rectangle around it is that of the domain.
            self.ground.origin = low;
            for (parameter, side) in [Parameter::Width, Parameter::Height].into_iter().zip(sides) {
                self.set_text(parameter, side.to_string());
            }

            // The default radius was chosen for the unit square, and a stipple does not use the form's radius: in these
            // two cases it is replaced even where it is allowed.
            let suits = self.parameters.validate_sequential().is_ok();
            let is_default =
                self.text(Parameter::Radius) == Parameter::Radius.text(&Parameters::default());
            if !suits || is_default || was_stipple {
                let area = sides[0] * sides[1];
                let radius = (tilescope_core::MAXIMAL_DENSITY * area / SAMPLES_OF_SHAPE).sqrt();
                self.set_text(Parameter::Radius, short(radius));
            }
        }
        self.ground.shape = Some(shape);
    }

    /// Covers the image as a mask: its opaque pixels or, if all are opaque, those lighter than half grey. Unless an
    /// expression gives the radius, it becomes one number, such that there are some thousand samples. Without an image
    /// nothing changes.
    pub fn cover_image(&mut self) {
        let Some(image) = self.ground.image.clone() else {
            return;
        };
        self.fit_pixels(&image);
        let share = image.inside_share();
        self.ground.origin = [0.0; 2];
        self.ground.shape = Some(ShapeSource::Mask(image));

        if self.ground.by != RadiusBy::Expression {
            self.ground.by = RadiusBy::Constant;
            let area = share * self.parameters.width * self.parameters.height;
            let radius = (tilescope_core::MAXIMAL_DENSITY * area / SAMPLES_OF_SHAPE).sqrt();
            // Where no pixel is inside, the radius stays, and the run says that there is nothing to cover.
            if radius > 0.0 {
                self.set_text(Parameter::Radius, short(radius));
            }
        }
    }

    /// Makes the pixels of an image the unit of length, and covers the whole domain.
    fn measure_in_pixels(&mut self, image: &GrayImage) {
        self.remove_shape();
        self.set_text(Parameter::Width, image.pixels()[0].to_string());
        self.fit_pixels(image);
    }

    /// Makes the domain one that pixels fill: bounded, and as high as follows from the width, since pixels are squares.
    fn fit_pixels(&mut self, image: &GrayImage) {
        let [columns, rows] = image.pixels();
        let height = self.parameters.width * rows as f64 / columns as f64;
        self.set_text(Parameter::Height, height.to_string());
        self.parameters.boundary = Boundary::Bounded;
    }

    /// Takes the density from an image, whose pixels fill the domain: the height follows from the width, and the radius
    /// of black is such that there are some thousand samples. A mask of as many columns and rows stays as the shape;
    /// any other shape is removed. Where a stipple is chosen, the image is stippled instead.
    pub fn set_image(&mut self, image: GrayImage) {
        if self.ground.by == RadiusBy::Stipple {
            self.measure_in_pixels(&image);
            self.ground.image = Some(image);
            return;
        }

        self.fit_pixels(&image);
        let pixels = image.pixels();
        (self.ground.by, self.ground.image) = (RadiusBy::Density, Some(image));
        // A mask with other numbers of pixels would not fit, nor would a polygon, which brought a domain of its own.
        let fits = |mask: &GrayImage| mask.pixels() == pixels;
        if !matches!(&self.ground.shape, Some(ShapeSource::Mask(mask)) if fits(mask)) {
            self.remove_shape();
        }

        // `samples` is the number of samples with a black of radius 1. It goes with the inverse square of that radius.
        let request = self.ground.request(1.0);
        let at_one = request.and_then(Result::ok).and_then(|request| {
            let recipe = request.recipe(&self.parameters);
            recipe.expected_samples().ok()
        });
        if let Some(samples) = at_one {
            let radius = (samples / SAMPLES_OF_IMAGE).sqrt();
            self.set_text(Parameter::Radius, short(radius));
            // Where the image gives the radius itself, white begins with four times the radius of black. Chosen, not
            // measured.
            self.ground.white = short(4.0 * radius);
        }
    }

    /// Paints a stroke on the radii of the form, which become those of an image.
    ///
    /// Fails with a sentence where there are no radii to paint, or no pixels fill the domain.
    pub fn paint(&mut self, stroke: &BrushStroke) -> Result<(), String> {
        // A script may give a stroke without a place, which leaves the radii as they are, and makes no image of them.
        if stroke.path.is_empty() {
            return Ok(());
        }
        if let Some(refusal) = self.paint_refusal() {
            return Err(refusal.to_owned());
        }
        let request = self.ground_request().unwrap_or(GroundRequest {
            radius: None,
            shape: None,
            origin: self.ground.origin,
            stipple: None,
        });

        let in_words = |error: VaryingError| sentence(&error.to_string());
        let mut radii = PaintedRadii::of(&request.recipe(&self.parameters)).map_err(in_words)?;
        radii.paint(stroke);
        // Painted radii are always those of an image.
        let RadiusSource::Image {
            image,
            radii: [black, white],
        } = radii.source().map_err(in_words)?
        else {
            return Ok(());
        };

        if !self.ground.is_painted() {
            self.ground.unpainted = Some(Box::new(Unpainted {
                by: self.ground.by,
                image: self.ground.image.clone(),
                white: self.ground.white.clone(),
                radius: self.text(Parameter::Radius).to_owned(),
            }));
        }
        (self.ground.by, self.ground.image) = (RadiusBy::Image, Some(image));
        // Numbers are written such that they are read back exactly.
        self.ground.white = white.to_string();
        self.set_text(Parameter::Radius, black.to_string());
        Ok(())
    }

    /// Returns why the radii of the form cannot be painted, if they cannot.
    #[must_use]
    pub fn paint_refusal(&self) -> Option<&'static str> {
        if self.levels.is_some() {
            return Some("Nested levels have one radius, which cannot be painted.");
        }
        if self.is_in_space() {
            return Some("A set in space has one radius, which cannot be painted.");
        }
        if self.ground.by == RadiusBy::Stipple {
            return Some(
                "The dots of a stipple follow its image: choose another radius to paint it.",
            );
        }
        // A radius, a formula or a side that is wrong gives no radii.
        (!self.refusals().is_empty())
            .then_some("Something in the form is wrong: mend it, then paint.")
    }

    /// Returns what the radius was before it was painted, as that of parameters and as a field; `None` if none is painted.
    #[must_use]
    pub fn before_painting(&self) -> Option<(f64, Option<RadiusSource>)> {
        let before = self.ground.unpainted.as_deref();
        let before = before.filter(|_| self.ground.is_painted())?;
        // It was a radius with which a set was painted, so that it is a number.
        let black = typed::number(&before.radius)?;
        let ground = GroundDraft {
            by: before.by,
            image: before.image.clone(),
            white: before.white.clone(),
            expression: self.ground.expression.clone(),
            ..GroundDraft::default()
        };
        // Radii that were painted over a number have neither a field nor a shape before them.
        let request = ground.request(black).and_then(Result::ok);
        Some((black, request.and_then(|request| request.radius)))
    }

    /// Returns to the radii from before they were painted.
    pub fn unpaint(&mut self) {
        let Some(before) = self.ground.unpainted.take() else {
            return;
        };
        // If the radius was chosen otherwise since then, that choice stays.
        if self.ground.is_painted() {
            let Unpainted {
                by,
                image,
                white,
                radius,
            } = *before;
            (self.ground.by, self.ground.image, self.ground.white) = (by, image, white);
            self.set_text(Parameter::Radius, radius);
        }
    }

    /// Returns the command that makes the set of the painted field, without a shape, from the saved file.
    #[must_use]
    pub fn painted_command(&self) -> Option<String> {
        if !self.ground.is_painted() {
            return None;
        }
        let Parameters {
            width,
            height,
            radius,
            seed,
            boundary,
            ..
        } = self.parameters;

        let periodic = match boundary {
            Boundary::Periodic => " --boundary periodic",
            // A field on the command line is bounded unless it says otherwise.
            Boundary::Bounded => "",
        };
        // The lower corner of the domain, which a shape that was opened has moved.
        let origin = match self.ground.origin {
            [x, y] if x == 0.0 && y == 0.0 => String::new(),
            [x, y] => format!(" --origin {x} {y}"),
        };
        let white = &self.ground.white;
        Some(format!(
            "tilescope sample --radius-image {PAINTED} --radius {radius}..{white} --width {width} --height {height}{origin}{periodic} --seed {seed} --out set.csv"
        ))
    }

    /// Covers the whole domain again.
    pub fn remove_shape(&mut self) {
        (self.ground.shape, self.ground.origin) = (None, [0.0; 2]);
    }

    /// Returns whether the next run tiles a shape exactly.
    #[must_use]
    pub fn tiles_shape(&self) -> bool {
        let is_exact = self.parameters.method == TilingMethod::Exact;
        is_exact && self.ground.is_shape_of_one_radius() && !self.is_in_space()
    }

    /// Returns about how many samples a field and a shape ask for; `None` if neither is asked for, or if they are refused.
    pub(super) fn ground_samples(&self) -> Option<f64> {
        let request = self.ground_request()?;
        if let Some(stipple) = &request.stipple {
            return Some(stipple.dots as f64);
        }
        let recipe = request.recipe(&self.parameters);
        let samples = recipe.glance().ok()?;
        // Of the whole domain only the share of a mask has samples.
        if let Some(ShapeSource::Mask(mask)) = &recipe.shape {
            return Some(samples * mask.inside_share());
        }
        Some(samples_in_polygon(&recipe, request.rings()).unwrap_or(samples))
    }

    /// Returns why the field and the shape that are asked for cannot be made, as far as a short look shows.
    pub(super) fn ground_refusal(&self) -> Option<DraftRefusal> {
        let refused = |part, error: &VaryingError| {
            let reason = sentence(&error.to_string());
            Some(DraftRefusal { part, reason })
        };
        let request = match self.ground.request(self.parameters.radius)? {
            Ok(request) => request,
            Err(error) => return refused(FormPart::Expression, &error),
        };

        let white = &self.ground.white;
        if self.ground.by == RadiusBy::Image && typed::number(white).is_none() {
            let (part, reason) = (FormPart::White, format!("\"{white}\" is not a number."));
            return Some(DraftRefusal { part, reason });
        }

        // Each level has one radius, and fills a rectangle.
        if self.levels.is_some() {
            let what = "Nested levels have one radius in a rectangle: choose none, or a constant radius without a shape.";
            let (part, reason) = (FormPart::Choices, what.to_owned());
            return Some(DraftRefusal { part, reason });
        }

        if let Some(stipple) = &request.stipple {
            let p = &self.parameters;
            let of_frame = || {
                // The run finds what else is wrong: only it looks at the pixels, in the tone that is chosen.
                let error = check_pixels(stipple.image.pixels(), [p.width, p.height]).err()?;
                refused(FormPart::Field(Parameter::Width), &error)
            };
            return self.ground.stipple.refusal(stipple).or_else(of_frame);
        }

        // An exact tiling also needs blocks and a pattern, whose parameters are those of the form. They are checked
        // only if `glance` below finds no error in the field and the shape.
        let of_tiling = || {
            let error = self.parameters.validate_sequential().err()?;
            let (part, reason) = (
                part_of(&error, &self.parameters),
                sentence(&error.to_string()),
            );
            Some(DraftRefusal { part, reason })
        };

        // Each error stands at the field that mends it. The domain of a varying radius is judged with a radius of the
        // field, so that its errors, like most others, stand at the input that gives the field.
        let Err(error) = request.recipe(&self.parameters).glance() else {
            return self.tiles_shape().then(of_tiling).flatten();
        };
        let part = match (&error, self.ground.by) {
            (VaryingError::Domain(error), RadiusBy::Constant) => part_of(error, &self.parameters),
            (VaryingError::Ratio { .. } | VaryingError::Aspect { .. }, _) => {
                FormPart::Field(Parameter::Width)
            }
            (_, RadiusBy::Expression) => FormPart::Expression,
            (VaryingError::Reversed { .. } | VaryingError::Contrast { .. }, RadiusBy::Image) => {
                FormPart::White
            }
            // The refusals of a stipple are those above.
            (_, RadiusBy::Constant | RadiusBy::Image | RadiusBy::Density | RadiusBy::Stipple) => {
                FormPart::Field(Parameter::Radius)
            }
        };
        refused(part, &error)
    }
}

/// Returns a number with three significant digits.
fn short(number: f64) -> String {
    // A written number can always be read again.
    let rounded = format!("{number:.2e}").parse::<f64>();
    rounded.unwrap_or(number).to_string()
}

#[cfg(test)]
mod tests {
    use tilescope_sets::PlanarPolygon;

    use super::*;
    use crate::draft::Choice;

    fn by_expression(text: &str) -> Draft {
        let mut draft = Draft::default();
        draft.choose(Choice::RadiusBy(RadiusBy::Expression));
        text.clone_into(&mut draft.ground.expression);
        draft
    }

    #[test]
    fn a_wrong_expression_refuses_the_run_at_its_field() {
        assert_eq!(by_expression(FIRST_EXPRESSION).refusals(), []);
        for (text, part) in [
            ("0.006 + ", "cannot be read"),
            ("x - 0.5", "above 0 everywhere"),
            ("0.001 + x", "times as much"),
        ] {
            let refusals = by_expression(text).refusals();
            assert_eq!(refusals.len(), 1, "{text}: {refusals:?}");
            assert_eq!(refusals[0].part, FormPart::Expression);
            assert!(refusals[0].reason.contains(part), "{}", refusals[0].reason);
            assert!(refusals[0].with_name().starts_with("Formula: "));
        }

        // The constant radius is not used, so that a wrong one refuses nothing. Of a constant radius it does.
        let mut draft = by_expression("0.02");
        draft.set_text(Parameter::Radius, "one".to_owned());
        assert_eq!(draft.refusals(), []);
        draft.choose(Choice::RadiusBy(RadiusBy::Constant));
        assert_eq!(draft.refusals().len(), 1);
    }

    #[test]
    fn a_polygon_brings_its_rectangle_and_a_radius_that_suits_it() {
        let rings = vec![vec![[100.0, 50.0], [160.0, 50.0], [130.0, 90.0]]];
        let polygon = PlanarPolygon::from_rings("a park", rings).unwrap();
        let mut draft = Draft::default();
        draft.set_shape(ShapeSource::Polygon(polygon));
        let p = draft.parameters;
        assert_eq!((p.width, p.height), (60.0, 40.0));
        assert_eq!(draft.refusals(), []);
        let samples = draft.expected_samples().unwrap();
        assert!((1_300.0..1_700.0).contains(&samples), "{samples}");

        let request = draft.ground_request().unwrap();
        let [left, bottom] = request.origin;
        assert_eq!((left, bottom), (100.0, 50.0));
        let again = Draft::from_parameters(p).with_ground(Some(&request));
        assert_eq!(again.ground_request(), Some(request));
        draft.remove_shape();
        assert_eq!(draft.ground_request(), None);
    }

    #[test]
    fn a_polygon_is_covered_where_dots_of_an_image_were_chosen() {
        let mut draft = Draft::default();
        draft.set_image(GrayImage::from_grey(4, vec![9_000; 8]).unwrap());
        draft.choose(Choice::RadiusBy(RadiusBy::Stipple));
        let shape_of = |draft: &Draft| draft.ground_request().and_then(|request| request.shape);
        assert_eq!(shape_of(&draft), None);

        let ring = vec![[0.0, 0.0], [60.0, 0.0], [30.0, 40.0]];
        let polygon = PlanarPolygon::from_rings("a park", vec![ring]).unwrap();
        draft.set_shape(ShapeSource::Polygon(polygon.clone()));
        assert_eq!(shape_of(&draft), Some(ShapeSource::Polygon(polygon)));
        assert_eq!(
            (draft.ground.by, draft.refusals()),
            (RadiusBy::Constant, vec![])
        );
        let samples = draft.expected_samples().unwrap();
        assert!((1_300.0..1_700.0).contains(&samples), "{samples}");
    }

    #[test]
    fn a_stipple_is_measured_in_pixels_and_stays_one_with_another_image() {
        let image = |columns| GrayImage::from_grey(columns, vec![9_000; 8]).unwrap();
        let size = |draft: &Draft| [draft.parameters.width, draft.parameters.height];
        let mut draft = Draft::default();
        draft.choose(Choice::RadiusBy(RadiusBy::Stipple));
        assert_eq!(draft.ground.by, RadiusBy::Constant, "there is no image");
        draft.set_image(image(4));
        assert_eq!(
            (draft.ground.by, size(&draft)),
            (RadiusBy::Density, [1.0, 0.5])
        );
        draft.choose(Choice::RadiusBy(RadiusBy::Stipple));
        assert_eq!((draft.refusals(), size(&draft)), (vec![], [4.0, 2.0]));
        draft.set_image(image(8));
        assert_eq!(
            (draft.ground.by, size(&draft)),
            (RadiusBy::Stipple, [8.0, 1.0])
        );
        draft.choose(Choice::RadiusBy(RadiusBy::Image));
        assert_eq!(
            (draft.ground.by, size(&draft)),
            (RadiusBy::Image, [1.0, 0.125])
        );
        assert_eq!(draft.refusals(), []);
    }

    #[test]
    fn a_stipple_is_refused_before_its_run_only_where_pixels_are_no_squares() {
        // A white icon, which is black if inverted, and an image that is wider than a domain of small radii may be.
        for (columns, grey) in [(2, vec![u16::MAX; 4]), (20_000, vec![9_000; 20_000])] {
            let mut draft = Draft::default();
            draft.ground.image = Some(GrayImage::from_grey(columns, grey).unwrap());
            draft.choose(Choice::RadiusBy(RadiusBy::Stipple));
            assert_eq!(
                (draft.ground.by, draft.refusals()),
                (RadiusBy::Stipple, vec![])
            );
            draft.set_text(Parameter::Height, "7".to_owned());
            let refusals = draft.refusals();
            assert_eq!(refusals[0].part, FormPart::Field(Parameter::Width));
        }
    }

    #[test]
    fn levels_and_fields_exclude_each_other() {
        let mut draft = by_expression(FIRST_EXPRESSION);
        draft.choose(Choice::Levels(Some(3)));
        assert_eq!(draft.refusals()[0].part, FormPart::Choices);
    }
}
