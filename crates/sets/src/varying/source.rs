//! Where the radius and the shape of a set come from.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tilescope_core::Boundary;
use tilescope_formats::{Certificate, CertifiedRadius};

use super::error::VaryingError;
use super::expression::Expression;
use super::grid::RadiusGrid;
use super::image::{GrayImage, Tone, WHITE};
use super::polygon::PlanarPolygon;
use super::{GivenRadius, needed, stated_file};

/// The largest radius of a density, in the least: the density of white, which is none, cannot be reached. Where the lattice has less
/// room, radii are capped at that.
pub(super) const DENSITY_CAP: f64 = 64.0;

/// The parameters that state radii of a grid and those that follow from a density.
const RADIUS_GRID: &str = "radius-grid";
const DENSITY_GRID: &str = "density-grid";

/// Where the radius at each place comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum RadiusSource {
    /// It is the same everywhere.
    Constant(f64),
    /// It is the value of an expression, multiplied by a scale.
    Expression {
        /// The expression in the coordinates of the domain.
        expression: Expression,
        /// Its values are multiplied by this.
        scale: f64,
    },
    /// Grey is the radius: from that of black to that of white, in proportion.
    Image {
        /// The image whose grey is read.
        image: GrayImage,
        /// The radii of black and of white.
        radii: [f64; 2],
    },
    /// Darkness is the density: the radius is that of black, divided by the root of the darkness, and at most 64 times as much.
    Density {
        /// The image whose grey is read.
        image: GrayImage,
        /// The radius of black.
        black: f64,
    },
    /// Radii at the nodes of a grid.
    Grid {
        /// The radii, before they are scaled.
        grid: RadiusGrid,
        /// They are multiplied by this.
        scale: f64,
    },
}

impl RadiusSource {
    /// Returns the source of radii that are `by` times as large.
    #[must_use]
    pub fn scaled(&self, by: f64) -> Self {
        let mut scaled = self.clone();
        // These numbers are what certificates state, so that the same ones make the field again.
        match &mut scaled {
            Self::Constant(length) | Self::Density { black: length, .. } => *length *= by,
            Self::Expression { scale, .. } | Self::Grid { scale, .. } => *scale *= by,
            Self::Image { radii, .. } => *radii = radii.map(|radius| radius * by),
        }
        scaled
    }

    /// Returns the radius that is the same everywhere, if it is.
    pub(crate) const fn constant(&self) -> Option<f64> {
        match self {
            Self::Constant(radius) => Some(*radius),
            Self::Expression { .. }
            | Self::Image { .. }
            | Self::Density { .. }
            | Self::Grid { .. } => None,
        }
    }

    /// Refuses sources that define no field, as far as their own numbers show it. Each radius is checked at its node.
    pub(super) fn check(&self) -> Result<(), VaryingError> {
        match self {
            Self::Image { radii, .. } if !(0.0 < radii[0] && radii[0] <= radii[1]) => {
                Err(VaryingError::Reversed { radii: *radii })
            }
            Self::Constant(_)
            | Self::Expression { .. }
            | Self::Image { .. }
            | Self::Density { .. }
            | Self::Grid { .. } => Ok(()),
        }
    }

    /// Refuses the density of a white image, which is 0 everywhere.
    pub(super) fn refuse_white(&self) -> Result<(), VaryingError> {
        let all = 0.0;
        match self {
            Self::Density { image, .. } if image.darkness(all) <= 0.0 => Err(VaryingError::Blank {
                name: image.name().to_owned(),
            }),
            Self::Constant(_)
            | Self::Expression { .. }
            | Self::Image { .. }
            | Self::Density { .. }
            | Self::Grid { .. } => Ok(()),
        }
    }

    /// Whether radii beyond the lattice's limit are made as large as possible, rather than refused: a density has no largest
    /// radius.
    pub(super) fn is_capped(&self) -> bool {
        match self {
            Self::Density { .. } => true,
            Self::Grid { grid, .. } => grid.is_capped,
            Self::Constant(_) | Self::Expression { .. } | Self::Image { .. } => false,
        }
    }

    /// Returns the pixels of a row and of a column of a domain that ends like this, if there are pixels.
    pub(crate) fn pixels(&self, boundary: Boundary) -> Option<[usize; 2]> {
        match self {
            Self::Constant(_) | Self::Expression { .. } => None,
            Self::Image { image, .. } | Self::Density { image, .. } => Some(image.pixels()),
            Self::Grid { grid, .. } => Some(grid.squares(boundary)),
        }
    }

    /// Returns the source that a certificate states, with the image, the expression or the grid that is given.
    pub(crate) fn of_certificate(
        stated: &Certificate,
        given: GivenRadius,
    ) -> Result<Self, VaryingError> {
        let parameters = &stated.parameters;
        match &stated.radius {
            // A certificate may state a shape without a field.
            CertifiedRadius::Constant(radius) => return Ok(Self::Constant(*radius)),
            CertifiedRadius::Column(column) => {
                return Err(VaryingError::NoPlaces {
                    column: column.column.clone(),
                });
            }
            CertifiedRadius::Field(_) => {}
        }

        // A given expression or grid has the scale that the certificate states with its own expression or grid, or 1 if
        // it states none. One may take the place of the other: a grid may hold the values of a function of x and y that
        // the certificate states as an expression.
        let scale = || {
            let names = ["radius-expression", RADIUS_GRID, DENSITY_GRID];
            let found = names
                .into_iter()
                .find(|name| parameters.contains_key(*name));
            found.map_or(Ok(1.0), |name| number(&parameters[name]["scale"], "scale"))
        };

        // The radii of an image follow from the parameters that name it, which `of_image` reads below. Where an
        // expression is stated, no image is needed, and one that is given is passed over.
        let image = match given {
            GivenRadius::Image(image) => Some(image),
            GivenRadius::Nothing => None,
            GivenRadius::Expression(expression) => {
                let scale = scale()?;
                return Ok(Self::Expression { expression, scale });
            }
            GivenRadius::Grid(grid) => {
                let scale = scale()?;
                return Ok(Self::Grid { grid, scale });
            }
        };

        if let Some(field) = parameters.get("radius-expression") {
            // A value that is no text counts as the empty text, which is refused.
            let text = field["expression"].as_str().unwrap_or_default();
            let (expression, scale) = (Expression::parse(text)?, scale()?);
            return Ok(Self::Expression { expression, scale });
        }
        // An array is not in the certificate, and must be given.
        let mut arrays = [RADIUS_GRID, DENSITY_GRID].into_iter();
        if let Some(name) = arrays.find(|name| parameters.contains_key(*name)) {
            return Err(VaryingError::NeedsGrid { name });
        }
        Self::of_image(parameters, image)
    }

    /// Returns the source that the parameters of a certificate state of an image, which is not in the certificate.
    fn of_image(
        parameters: &BTreeMap<String, Value>,
        image: Option<GrayImage>,
    ) -> Result<Self, VaryingError> {
        if let Some(field) = parameters.get("radius-image") {
            let option = "--radius-image";
            let image =
                image.ok_or_else(|| needed("a field", parameters, "radius-image", option))?;
            let [black, white] = [0, 1].map(|at| number(&field["radii"][at], "radius-image.radii"));
            let radii = [black?, white?];
            return Ok(Self::Image { image, radii });
        }

        if let Some(field) = parameters.get("density-image") {
            let option = "--density-image";
            let image =
                image.ok_or_else(|| needed("a field", parameters, "density-image", option))?;
            let black = number(&field["black"], "density-image.black")?;
            // The field was made in the tone and in the stated blocks, which the given image need not have.
            let mut image = image.toned(Tone::of_stated(field))?;
            if let Some(block) = field["block"].as_u64() {
                image = image.in_blocks(usize::try_from(block).unwrap_or(usize::MAX))?;
            }
            return Ok(Self::Density { image, black });
        }
        Err(VaryingError::Unstated(
            "of the parameters radius-expression, radius-image, density-image, radius-grid and density-grid it has none"
                .to_owned(),
        ))
    }

    /// Returns the parameter that states this source.
    pub(crate) fn stated(&self) -> (&'static str, Value) {
        match self {
            Self::Constant(radius) => ("radius", json!(radius)),
            Self::Expression { expression, scale } => {
                let value = json!({ "expression": expression.text(), "scale": scale });
                ("radius-expression", value)
            }

            // A certificate names an image by its file and digest, or by its digest alone, since it cannot hold the
            // image.
            Self::Image { image, radii } => {
                let mut value = image.stated();
                value["radii"] = json!(radii);
                ("radius-image", value)
            }
            Self::Density { image, black } => {
                let mut value = image.stated();
                value["black"] = json!(black);
                image.tone.state(&mut value);
                // Blocks of one pixel are the image itself, and are not stated.
                if image.block > 1 {
                    value["block"] = json!(image.block);
                }
                ("density-image", value)
            }
            Self::Grid { grid, scale } => {
                // Radii beyond the limit are refused, but those that follow from a density are made as large as
                // possible: the mark of a capped grid shows from which of the two it was made.
                let name = if grid.is_capped {
                    DENSITY_GRID
                } else {
                    RADIUS_GRID
                };
                let [columns, rows] = grid.counts();
                let value = json!({ "columns": columns, "rows": rows, "scale": scale });
                (name, value)
            }
        }
    }
}

/// Returns a number of a certificate, which may say anything: a value that is no number is refused by its name.
fn number(value: &Value, what: &str) -> Result<f64, VaryingError> {
    let unstated = || VaryingError::Unstated(format!("`{what}` is {value}"));
    value.as_f64().ok_or_else(unstated)
}

/// Returns the radius of the mean of `count` grey values, whose sum is `sum`.
pub(super) fn radius_of_grey([black, white]: [f64; 2], sum: u32, count: u32) -> f64 {
    let share = f64::from(sum) / f64::from(count * WHITE);
    black + (white - black) * share
}

/// Returns the radius at which samples are as dense as the mean of `count` grey values, whose sum is `sum`, is dark.
pub(super) fn radius_of_darkness(black: f64, sum: u32, count: u32) -> f64 {
    let darkness = f64::from(count * WHITE - sum) / f64::from(count * WHITE);
    // White has no density, and an infinite radius.
    (black / darkness.sqrt()).min(DENSITY_CAP * black)
}

/// The parameter that states white.
const WHITE_KEY: &str = "white";

/// The area to cover, in a form that is no rectangle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShapeSource {
    /// The inside of polygons.
    Polygon(PlanarPolygon),
    /// The chosen pixels of an image.
    Mask(GrayImage),
    /// The pixels of the image of a density that are no lighter than white.
    Dark {
        /// The image of the density.
        image: GrayImage,
        /// The least darkness of covered places: 0 is white, and 1 black.
        white: f64,
    },
}

impl ShapeSource {
    /// Returns the pixels that are no lighter than white, if a certificate states it of the image of a density.
    pub(super) fn dark_of_certificate(stated: &Certificate, radius: &RadiusSource) -> Option<Self> {
        let white = stated.parameters.get(WHITE_KEY)?.as_f64()?;
        match radius {
            RadiusSource::Density { image, .. } => Some(Self::Dark {
                image: image.clone(),
                white,
            }),
            RadiusSource::Constant(_)
            | RadiusSource::Expression { .. }
            | RadiusSource::Image { .. }
            | RadiusSource::Grid { .. } => None,
        }
    }

    /// Returns the pixels of a row and of a column, if there are pixels.
    pub(super) fn pixels(&self) -> Option<[usize; 2]> {
        match self {
            Self::Polygon(_) => None,
            Self::Mask(image) | Self::Dark { image, .. } => Some(image.pixels()),
        }
    }

    /// Returns the parameter that states the file of this shape, if it is from one.
    pub(super) fn stated(&self) -> Option<(&'static str, Value)> {
        match self {
            Self::Polygon(polygon) => {
                let [name, digest] = polygon.file.as_ref()?;
                Some(("shape", stated_file(name, digest)))
            }
            Self::Mask(image) => Some(("mask", image.stated())),
            // The image is that of the density, which is stated.
            Self::Dark { white, .. } => Some((WHITE_KEY, json!(white))),
        }
    }
}
