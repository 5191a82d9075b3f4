//! Arguments of a radius that varies and of shapes, and what sets are judged in by them or by their certificates.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use tilescope_analysis::Boundary as Border;
use tilescope_core::Boundary;
use tilescope_formats::{Certificate, Overrides, first_points, read_whole};
use tilescope_sets::{
    Expression, GivenGround, GivenRadius, GrayImage, Ground, PlanarPolygon, RadiusSource,
    ShapeSource, VaryingError, VaryingRecipe,
};

use crate::options::SetArguments;
use crate::paths::InFile;

/// A field and a shape.
#[derive(Clone, Debug, Default, Args)]
#[command(
    next_help_heading = "A radius that varies, and shapes (bounded, unless --boundary says otherwise)"
)]
pub struct GroundArguments {
    /// Radii from the grey of a PNG or JPEG image: of black the first of --radius MIN..MAX, of white the second, between them in
    /// proportion. Its pixels fill the domain. Two places of radii a and b are then as near as 2ab / (a + b)
    #[arg(long, value_name = "IMAGE", conflicts_with_all = ["density_image", "radius_expression"])]
    pub radius_image: Option<PathBuf>,
    /// Samples as dense as a PNG or JPEG image is dark: --radius is that of black, or --count chooses it. The radius is at most 64 times
    /// as large, or from 32 times on where the width of pixels needs it, also where the image is white: a note says which, and
    /// --mask leaves places out
    #[arg(long, value_name = "IMAGE", conflicts_with = "radius_expression")]
    pub density_image: Option<PathBuf>,
    /// The radius as a function of x and y, such as '0.006 + 0.024*x', with + - * / ^ pi abs atan2 cos exp floor hypot log max
    /// min pow sin sqrt tanh; with --count it is scaled
    #[arg(long, value_name = "FORMULA", group = "size")]
    pub radius_expression: Option<String>,
    /// Cover only the polygons of a `GeoJSON` file, in the coordinates of a plane; rings in rings are holes. Without --width,
    /// --height and --origin the domain is the rectangle around them. Distances are straight, also through holes
    #[arg(long, value_name = "GEOJSON", conflicts_with = "mask")]
    pub shape: Option<PathBuf>,
    /// Cover only the opaque pixels of an image, PNG or JPEG; of one without transparency, those lighter than half grey
    #[arg(long, value_name = "IMAGE")]
    pub mask: Option<PathBuf>,
}

/// What the coordinates of a shape are.
#[derive(Debug, Args)]
pub struct CoordinateArguments {
    /// Take the corners of --shape as positions in a plane, though they may be longitudes and latitudes: all lie within 180
    /// and 90
    #[arg(long, requires = "shape")]
    pub planar: bool,
}

impl GroundArguments {
    /// Returns whether a field or a shape is asked for.
    pub fn is_given(&self) -> bool {
        self.option().is_some()
    }

    /// Returns the first option that is given.
    pub fn option(&self) -> Option<&'static str> {
        let options = [
            ("--radius-image", self.radius_image.is_some()),
            ("--density-image", self.density_image.is_some()),
            ("--radius-expression", self.radius_expression.is_some()),
            ("--shape", self.shape.is_some()),
            ("--mask", self.mask.is_some()),
        ];
        options
            .into_iter()
            .find(|(_, is_given)| *is_given)
            .map(|(name, _)| name)
    }

    /// Returns the first option that is given by which the radius varies.
    pub fn field_option(&self) -> Option<&'static str> {
        self.option()
            .filter(|option| !matches!(*option, "--shape" | "--mask"))
    }

    /// Refuses the first option that is given, as `whose` has no use for it.
    pub fn refuse(&self, whose: &str) -> Result<()> {
        match self.option() {
            Some(name) => bail!("{name}: {whose}; leave it out"),
            None => Ok(()),
        }
    }

    /// Returns the files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = [
            &self.radius_image,
            &self.density_image,
            &self.shape,
            &self.mask,
        ];
        files.into_iter().filter_map(|file| file.as_deref())
    }

    /// Returns the shape that is to be covered, if one is given.
    pub fn shape(&self, planar: bool) -> Result<Option<ShapeSource>> {
        if let Some(path) = &self.shape {
            let bytes = read_whole(path)?;
            let polygon = PlanarPolygon::from_geojson(&file_name(path), &bytes, planar)
                .map_err(planar_hint)
                .context("--shape")?;
            return Ok(Some(ShapeSource::Polygon(polygon)));
        }
        let image = self.mask.as_deref().map(|path| image(path, "--mask"));
        Ok(image.transpose()?.map(ShapeSource::Mask))
    }

    /// Returns the field and the shape that the arguments give to judge a set.
    pub fn given(&self, planar: bool) -> Result<GivenGround> {
        // Both kinds of images are given as such: the certificate says whether its field follows from radii or from densities.
        let radius = if let Some(path) = &self.radius_image {
            GivenRadius::Image(image(path, "--radius-image")?)
        } else if let Some(path) = &self.density_image {
            GivenRadius::Image(image(path, "--density-image")?)
        } else if let Some(text) = &self.radius_expression {
            GivenRadius::Expression(expression(text)?)
        } else {
            GivenRadius::Nothing
        };
        let shape = self.shape(planar)?;
        Ok(GivenGround { radius, shape })
    }

    /// Returns the field and the shape by which a set in a file is judged, from its certificate or from these arguments; nothing
    /// for a set of one radius in a rectangle.
    pub fn judged(
        &self,
        file: &Path,
        set: &SetArguments,
        stated: Option<&Certificate>,
    ) -> Result<Option<Ground>> {
        match self.recipe(set, stated)? {
            Some(recipe) => Ok(Some(recipe.ground().in_file(file)?)),
            None => Ok(None),
        }
    }

    /// Returns the recipe of the field and the shape that [`Self::judged`] returns.
    fn recipe(
        &self,
        set: &SetArguments,
        stated: Option<&Certificate>,
    ) -> Result<Option<VaryingRecipe>> {
        Ok(match stated.filter(|stated| stated.is_varying()) {
            Some(stated) => {
                // The certificate has digests of the values of the field and the mask in its own domain. In another
                // domain or with another radius these values have other digests, so that the check could only fail.
                set.refuse_domain("to which its field and its shape belong")?;
                let given = self.given(set.planar)?;
                Some(VaryingRecipe::of_certificate(stated, given)?)
            }
            None if self.is_given() => Some(self.foreign(set)?),
            None => None,
        })
    }

    /// Puts the field and the shape in which a file is to be judged into the overrides: those of its certificate, or of these
    /// arguments. Without either the overrides stay as they are.
    pub fn judge_in(
        &self,
        file: &Path,
        set: &SetArguments,
        overrides: &mut Overrides,
    ) -> Result<()> {
        let certificate = set.certificate(file)?;
        let stated = certificate.as_ref().filter(|stated| stated.is_varying());
        if let Some(mut recipe) = self.recipe(set, stated)? {
            // A mask is filled by darts or by exact tiling, and each method has a lattice of its own. Where no
            // certificate states the method, the positions show on which of the two lattices they lie.
            if stated.is_none() && recipe.has_two_lattices() {
                let (positions, format) = first_points(file, overrides).in_file(file)?;
                recipe = recipe.fitted_to(&positions, format).in_file(file)?;
            }
            let ground = recipe.ground().in_file(file)?;
            // An origin that is not given is that of the field and the shape: the certificate's, or the lower corner of the
            // rectangle around the shape.
            overrides.origin = overrides.origin.or(Some(ground.origin));
            // The verifier takes the region and the radius from it.
            overrides.varying = Some(ground.varying);
        }
        Ok(())
    }

    /// Returns the field and the shape that the arguments state for a set whose certificate, if it has one, states
    /// neither.
    fn foreign(&self, set: &SetArguments) -> Result<VaryingRecipe> {
        // An expression gives the radius alone. A density needs a radius beside it, that of black; and where there is a shape
        // alone, the radius is the same everywhere.
        let radius = match (
            &self.radius_expression,
            &self.density_image,
            set.least_radius(),
        ) {
            (Some(_), _, Some(_)) => {
                bail!("both --radius and --radius-expression are given; give one")
            }
            (Some(text), _, None) => formula(text)?,
            (None, Some(path), Some(black)) => RadiusSource::Density {
                image: image(path, "--density-image")?,
                black,
            },
            (None, None, Some(radius)) if self.radius_image.is_none() => {
                RadiusSource::Constant(radius)
            }
            _ if self.radius_image.is_some() => self.grey(set)?,
            _ => bail!("no certificate states a field or a shape of the set; give --radius"),
        };

        // The same default as for making a set: few fields are periodic, and no shape is.
        let boundary = set.boundary.unwrap_or(Border::Bounded);
        Ok(VaryingRecipe {
            radius,
            shape: self.shape(set.planar)?,
            size: [set.width, set.height],
            origin: set.origin(),
            boundary: Boundary::of(boundary == Border::Periodic),
            // A seed, a count and the blocks of exact tiling are for making a set. To judge one, only the field and the
            // shape are taken; `judge_in` finds out from the positions whether a mask was tiled exactly.
            seed: 0,
            count: None,
            exact: None,
        })
    }

    /// Returns the radii that an image gives, between the two that no certificate states.
    fn grey(&self, set: &SetArguments) -> Result<RadiusSource> {
        let option = "--radius-image";
        let span = set
            .radius
            .and_then(|span| Some([span.least, span.greatest?]));
        let path = self.radius_image.as_deref().zip(span);
        let (path, radii) = path.with_context(|| {
            format!("no certificate states the radii of black and of white, so that {option} needs --radius MIN..MAX")
        })?;
        let image = image(path, option)?;
        Ok(RadiusSource::Image { image, radii })
    }
}

/// Returns the name of a file without its folders.
pub fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    tilescope_analysis::lossy(name).into_owned()
}

/// Reads an image, and adds the option that gave it to errors.
pub fn image(path: &Path, option: &'static str) -> Result<GrayImage> {
    let bytes = read_whole(path)?;
    GrayImage::read(&file_name(path), &bytes).context(option)
}

/// Adds the option that takes coordinates as they are to the error of those that may be degrees.
fn planar_hint(error: VaryingError) -> anyhow::Error {
    match error {
        VaryingError::Degrees { .. } => {
            anyhow!("{error}; --planar takes them as they are")
        }
        other => other.into(),
    }
}

fn expression(text: &str) -> Result<Expression> {
    Expression::parse(text).context("--radius-expression")
}

/// Returns the radius that a formula gives.
pub fn formula(text: &str) -> Result<RadiusSource> {
    let expression = expression(text)?;
    // The formula is taken as it is written. Only a wanted number of samples scales it later.
    let scale = 1.0;
    Ok(RadiusSource::Expression { expression, scale })
}
