//! Fields of radii and shapes: the request for them, as sessions and links hold it, and the ground that a session was
//! made on. Begin with [`GroundRequest`]; [`crate::varying`] makes the sessions.

use serde::{Deserialize, Serialize};
use tilescope_core::{Parameters, TilingMethod};
use tilescope_live::{CourseError, LiveGround};
use tilescope_sets::{
    ExactBlocks, Expression, Ground, PlanarPolygon, RadiusSource, ShapeSource, Stated,
    StippleRecipe, VaryingError, VaryingRecipe,
};

use crate::encoding::as_json;
use crate::stipple::{MadeStipple, StippleRequest};
use crate::words::{counted, grouped, significant};

/// Above this expected size only the result is kept. A sample takes about a hundred events, most of them darts and cuts of
/// cells: a tape holds the events of this number of samples without leaving any out.
pub const MAX_RECORDED: f64 = 50_000.0;

/// The most corners of a polygon in a saved session or a link. Chosen, not measured.
const MAX_PORTABLE_CORNERS: usize = 10_000;

/// The field and the shape that are asked for, beside the parameters of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundRequest {
    /// Where the radius comes from; `None` for that of the parameters.
    pub radius: Option<RadiusSource>,
    /// The area to cover; `None` for the whole domain.
    pub shape: Option<ShapeSource>,
    /// Where the lower corner of the domain lies in the coordinates of polygons and expressions.
    pub origin: [f64; 2],
    /// The stipple, if one is asked for: it gives the radius and the shape, which are then `None`.
    pub stipple: Option<StippleRequest>,
}

impl GroundRequest {
    /// Returns whether the method of the parameters tiles it exactly: a shape of one radius. Other sets are made by darts,
    /// whatever the method.
    #[must_use]
    pub fn is_tiled(&self, parameters: &Parameters) -> bool {
        // A pattern has one radius. A stipple has radii of its own, and stands beside a request without them.
        let has_one_radius = matches!(self.radius, None | Some(RadiusSource::Constant(_)));
        let is_shape = self.shape.is_some() && has_one_radius && self.stipple.is_none();
        is_shape && parameters.method == TilingMethod::Exact
    }

    /// Returns the recipe of the set. Of the parameters it takes the domain, the seed and, unless the radius comes from
    /// elsewhere, the radius; of an exact tiling of a shape also its blocks.
    #[must_use]
    pub fn recipe(&self, parameters: &Parameters) -> VaryingRecipe {
        let radius = self.radius.clone();
        let is_tiled = self.is_tiled(parameters);
        VaryingRecipe {
            radius: radius.unwrap_or(RadiusSource::Constant(parameters.radius)),
            shape: self.shape.clone(),
            size: [Some(parameters.width), Some(parameters.height)],
            origin: Some(self.origin),
            boundary: parameters.boundary,
            seed: parameters.seed,
            count: None,
            exact: is_tiled.then(|| ExactBlocks::from(parameters)),
        }
    }

    /// Returns the rings of its polygon, in the coordinates of the polygon; none of a mask.
    #[must_use]
    pub fn rings(&self) -> &[Vec<[f64; 2]>] {
        match &self.shape {
            Some(ShapeSource::Polygon(polygon)) => polygon.rings(),
            Some(ShapeSource::Mask(_) | ShapeSource::Dark { .. }) | None => &[],
        }
    }

    /// Returns a sentence's part that says what it is: "radius 0.006 + 0.024*x, in a polygon of 5 corners".
    #[must_use]
    pub fn description(&self) -> String {
        if let Some(stipple) = &self.stipple {
            let dots = grouped(usize::try_from(stipple.dots).unwrap_or(usize::MAX));
            return format!("{} in {dots} dots", stipple.image.name());
        }
        let radius = match &self.radius {
            None | Some(RadiusSource::Constant(_)) => "one radius".to_owned(),
            Some(RadiusSource::Expression { expression, .. }) => {
                format!("radius {}", expression.text())
            }
            Some(RadiusSource::Image { image, .. }) => format!("radius by {}", image.name()),
            Some(RadiusSource::Density { image, .. }) => format!("density by {}", image.name()),
            Some(RadiusSource::Grid { .. }) => "radius by a grid".to_owned(),
        };

        // The shape follows behind a comma, if there is one.
        match &self.shape {
            None => radius,
            Some(ShapeSource::Polygon(_)) => {
                let corner_count = self.rings().iter().map(Vec::len).sum();
                let corners = counted(corner_count, "corner", "corners");
                format!("{radius}, in a polygon of {corners}")
            }
            Some(ShapeSource::Mask(image) | ShapeSource::Dark { image, .. }) => {
                format!("{radius}, in the mask {}", image.name())
            }
        }
    }
}

/// Returns an expression with its scale as one text. A set of a given count has a scale; links and forms have the text alone.
/// The product is that of the scaled expression, bit for bit, as a number is printed such that it is read back exactly.
pub(crate) fn scaled_text(expression: &Expression, scale: f64) -> String {
    let text = expression.text();
    if scale.to_bits() == 1.0_f64.to_bits() {
        return text.to_owned();
    }
    format!("{scale} * ({text})")
}

/// A request as sessions and links hold it: without images, which stay where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct PortableGround {
    /// The radius as a function of x and y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_expression: Option<String>,
    /// The corners of each ring of the area to cover; none for the whole domain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rings: Vec<Vec<[f64; 2]>>,
    /// Where the lower corner of the domain lies.
    #[serde(default)]
    pub origin: [f64; 2],
}

impl PortableGround {
    /// Returns a request in this form; `None` if it has an image, a grid, a long polygon or a constant radius of its
    /// own.
    #[must_use]
    pub fn of(request: &GroundRequest) -> Option<Self> {
        // A stipple is of an image.
        if request.stipple.is_some() {
            return None;
        }
        let radius_expression = match &request.radius {
            None => None,
            Some(RadiusSource::Expression { expression, scale }) => {
                Some(scaled_text(expression, *scale))
            }
            // An image or a grid. A constant radius is not expected here: it is among the parameters instead.
            Some(_) => return None,
        };

        // A mask has no corners, and is an image.
        let rings = request.rings();
        let is_mask = request.shape.is_some() && rings.is_empty();
        let corners: usize = rings.iter().map(Vec::len).sum();
        (!is_mask && corners <= MAX_PORTABLE_CORNERS).then(|| Self {
            radius_expression,
            rings: rings.to_vec(),
            origin: request.origin,
        })
    }

    /// Returns the request; `None` if it asks for neither a field nor a shape.
    ///
    /// Fails when the expression cannot be read, or the rings are no polygon.
    pub fn request(self) -> Result<Option<GroundRequest>, VaryingError> {
        let radius = match &self.radius_expression {
            None => None,
            Some(text) => Some(RadiusSource::Expression {
                expression: Expression::parse(text)?,
                scale: 1.0,
            }),
        };

        // Corners are checked as those of a file: edges may not cross.
        let shape = if self.rings.is_empty() {
            None
        } else {
            let polygon = PlanarPolygon::from_rings("the shape", self.rings)?;
            Some(ShapeSource::Polygon(polygon))
        };

        // A corner of the domain alone asks for nothing.
        let is_asked = radius.is_some() || shape.is_some();
        Ok(is_asked.then_some(GroundRequest {
            radius,
            shape,
            origin: self.origin,
            stipple: None,
        }))
    }
}

/// What a session's set was made on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MadeGround {
    /// The parameters and the request from which it was made.
    pub asked: (Parameters, GroundRequest),
    /// The least and the greatest radius of its field, in user units.
    pub radii: [f64; 2],
    /// What the stipple became, if it is one.
    pub stipple: Option<MadeStipple>,
    /// Whether the samples are those of the request. A lesson also shows what a wrong process makes of it.
    pub is_as_asked: bool,
    /// What the certificate of its file states of the way in which it was made, if it is an exact tiling from a file: numbers
    /// of its pattern are among that, which is not made again.
    #[serde(with = "as_json")]
    pub stated: Option<Stated>,
}

impl MadeGround {
    /// Returns the recipe of the set; of a stipple that of its field and its shape.
    #[must_use]
    pub fn recipe(&self) -> VaryingRecipe {
        let (parameters, request) = &self.asked;
        let of_stipple = |(wanted, made): (StippleRecipe, &MadeStipple)| {
            // It was made, so that it is not refused here.
            wanted.settled(made.black).ok()
        };
        let stipple = self.stipple_recipe().zip(self.stipple.as_ref());
        let settled = stipple.and_then(of_stipple);
        settled.unwrap_or_else(|| request.recipe(parameters))
    }

    /// Returns whether it was tiled exactly, and not made by darts.
    #[must_use]
    pub fn is_tiled(&self) -> bool {
        let (parameters, request) = &self.asked;
        request.is_tiled(parameters)
    }

    /// Returns what the dots were made from, if they are a stipple.
    #[must_use]
    pub fn stipple_recipe(&self) -> Option<StippleRecipe> {
        let (parameters, request) = &self.asked;
        request.stipple.as_ref()?.recipe(parameters).ok()
    }

    /// Returns the field and the shape of the set, and what certificates state of the way in which it is made. Of an exact
    /// tiling that is not from a file, its run says more ([`VaryingRecipe::facts_of_tiling`]).
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when they are refused, which those of a made set are not.
    pub fn ground(&self) -> Result<(Ground, Stated), VaryingError> {
        let recipe = self.recipe();
        let ground = recipe.ground()?;
        let stated = match (&self.stated, self.stipple_recipe()) {
            (Some(stated), _) => stated.clone(),
            (None, Some(stipple)) => stipple.stated(&recipe, &ground),
            (None, None) => recipe.stated_on(&ground),
        };
        Ok((ground, stated))
    }

    /// Returns what measures that move with the run need of the field and the shape; an error where too many squares would be
    /// kept, or the ground is refused.
    pub fn live(&self) -> Result<LiveGround, String> {
        let (ground, _) = self.ground().map_err(|error| error.to_string())?;
        LiveGround::of(&ground.varying.judged).ok_or_else(|| CourseError::Steep.to_string())
    }

    /// Returns the least and the greatest radius as text, or the one radius.
    #[must_use]
    pub fn radii_text(&self) -> String {
        let [least, greatest] = self.radii.map(significant);
        if least == greatest {
            return least;
        }
        format!("{least} to {greatest}")
    }

    /// Returns whether the radius depends on the place.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.radii[0] < self.radii[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scaled_expression_is_one_text_with_the_same_radii() {
        let expression = Expression::parse("0.1 + x*y").expect("an expression");
        let scale = 0.1 + 0.2;
        let text = scaled_text(&expression, scale);
        let one = Expression::parse(&text).expect("an expression");
        for place in 0..1000 {
            let [x, y] = [0.37, 0.73].map(|by| f64::from(place) * by);
            assert_eq!(
                (scale * expression.at(x, y)).to_bits(),
                one.at(x, y).to_bits()
            );
        }
        assert_eq!(scaled_text(&expression, 1.0), expression.text());

        // The request comes back from a session with the same radii.
        let radius = RadiusSource::Expression { expression, scale };
        let request = GroundRequest {
            radius: Some(radius),
            shape: None,
            origin: [0.0, 0.0],
            stipple: None,
        };
        let portable = PortableGround::of(&request).expect("neither image nor grid");
        assert_eq!(portable.radius_expression.as_deref(), Some(text.as_str()));
    }
}
