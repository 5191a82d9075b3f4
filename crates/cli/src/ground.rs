//! Arguments of a radius that varies and of shapes, what is made from them, and what the sets of certificates with such parts
//! are judged in.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use tilescope_analysis::Boundary as Border;
use tilescope_core::{Boundary, Parameter};
use tilescope_formats::{Certificate, VaryingDomain, read_whole};
use tilescope_sets::{
    Expression, GivenGround, GivenRadius, GrayImage, PlanarPolygon, RadiusSource, ShapeSource,
    VaryingRecipe,
};

use crate::make::Worked;
use crate::options::{SetArguments, pair};
use crate::output::Work;
use crate::paths::InFile;
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};

/// A field and a shape.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "A radius that varies, and shapes")]
pub struct GroundArguments {
    /// Radii from the grey of a PNG image: of black the first of --radius MIN..MAX, of white the second, between them in
    /// proportion. Its pixels fill the domain. Two places of radii a and b are then as near as 2ab / (a + b)
    #[arg(long, value_name = "PNG", conflicts_with_all = ["density_image", "radius_expression"])]
    pub radius_image: Option<PathBuf>,
    /// Samples as dense as a PNG image is dark: --radius is that of black, or --count chooses it. The radius is at most 64 times
    /// as large, also where the image is white: --mask leaves places out
    #[arg(long, value_name = "PNG", conflicts_with = "radius_expression")]
    pub density_image: Option<PathBuf>,
    /// The radius as a function of x and y, such as '0.006 + 0.024*x', with + - * / ^ pi abs atan2 cos exp floor hypot log max
    /// min pow sin sqrt tanh; with --count it is scaled
    #[arg(long, value_name = "FORMULA", group = "size")]
    pub radius_expression: Option<String>,
    /// Cover only the polygons of a `GeoJSON` file, in the coordinates of a plane; rings in rings are holes. Without --width,
    /// --height and --origin the domain is the rectangle around them. Distances are straight, also through holes
    #[arg(long, value_name = "GEOJSON", conflicts_with = "mask")]
    pub shape: Option<PathBuf>,
    /// Cover only the opaque pixels of a PNG image; of an image without transparency, those lighter than half grey
    #[arg(long, value_name = "PNG")]
    pub mask: Option<PathBuf>,
}

/// What the coordinates of a shape are.
#[derive(Debug, Args)]
pub struct CoordinateArguments {
    /// Take the corners of --shape as positions in a plane, though they may be longitudes and latitudes: all lie within 180
    /// and 90
    #[arg(long, requires = "shape")]
    planar: bool,
}

/// The parameters that a set has whose radius varies, or that covers a shape.
const USED: [Parameter; 5] = [
    Parameter::Width,
    Parameter::Height,
    Parameter::Radius,
    Parameter::Boundary,
    Parameter::Seed,
];

impl GroundArguments {
    /// Returns whether a field or a shape is asked for.
    pub fn is_given(&self) -> bool {
        self.option().is_some()
    }

    /// Returns the first option that is given.
    pub fn option(&self) -> Option<&'static str> {
        let files = [
            ("--radius-image", self.radius_image.is_some()),
            ("--density-image", self.density_image.is_some()),
            ("--radius-expression", self.radius_expression.is_some()),
            ("--shape", self.shape.is_some()),
            ("--mask", self.mask.is_some()),
        ];
        files
            .into_iter()
            .find(|(_, is_given)| *is_given)
            .map(|(name, _)| name)
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

    fn shape(&self, planar: bool) -> Result<Option<ShapeSource>> {
        if let Some(path) = &self.shape {
            let bytes = read_whole(path)?;
            let polygon = PlanarPolygon::from_geojson(&file_name(path), &bytes, planar);
            let polygon = polygon.context("--shape")?;
            return Ok(Some(ShapeSource::Polygon(polygon)));
        }
        let image = self.mask.as_deref().map(|path| image(path, "--mask"));
        Ok(image.transpose()?.map(ShapeSource::Mask))
    }

    /// Returns what is given to judge a set.
    fn given(&self, planar: bool) -> Result<GivenGround> {
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

    /// Returns what a set in a file is judged in, if its radius varies or it covers a shape: by its certificate, or by these
    /// arguments.
    pub fn judged(
        &self,
        file: &Path,
        set: &SetArguments,
        stated: Option<&Certificate>,
    ) -> Result<Option<Arc<VaryingDomain>>> {
        let recipe = match stated.filter(|stated| stated.is_varying()) {
            Some(stated) => {
                // With another domain or radius the digests could only differ.
                let overridden = [
                    ("--radius", set.radius.is_some()),
                    ("--width", set.width.is_some()),
                    ("--height", set.height.is_some()),
                    ("--boundary", set.boundary.is_some()),
                ];
                if let Some((name, _)) = overridden.into_iter().find(|(_, is_given)| *is_given) {
                    bail!(
                        "{name} is that of the certificate, to which its field and its shape belong; leave it out"
                    );
                }
                VaryingRecipe::of_certificate(stated, self.given(set.planar)?)?
            }
            None if self.is_given() => self.foreign(set)?,
            None => return Ok(None),
        };

        Ok(Some(recipe.ground().in_file(file)?.varying))
    }

    /// Returns what a set of unknown origin is judged in.
    fn foreign(&self, set: &SetArguments) -> Result<VaryingRecipe> {
        let radius = match (&self.radius_expression, &self.density_image, set.radius) {
            (Some(text), ..) => formula(text)?,
            (None, Some(path), Some(black)) => RadiusSource::Density {
                image: image(path, "--density-image")?,
                black,
            },
            (None, None, Some(radius)) if self.radius_image.is_none() => {
                RadiusSource::Constant(radius)
            }
            _ if self.radius_image.is_some() => bail!(
                "--radius-image is for sets with a certificate, which states the radii of black and white"
            ),
            _ => bail!("the set has no certificate; give --radius"),
        };

        // As sets are made: a field seldom goes around, and a shape never.
        let boundary = set.boundary.unwrap_or(Border::Bounded);
        Ok(VaryingRecipe {
            radius,
            shape: self.shape(set.planar)?,
            size: [set.width, set.height],
            origin: set.origin(),
            boundary: Boundary::of(boundary == Border::Periodic),
            seed: 0,
            count: None,
        })
    }
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    tilescope_analysis::lossy(name).into_owned()
}

fn image(path: &Path, option: &'static str) -> Result<GrayImage> {
    let bytes = read_whole(path)?;
    GrayImage::from_png(&file_name(path), &bytes).context(option)
}

fn expression(text: &str) -> Result<Expression> {
    Expression::parse(text).context("--radius-expression")
}

fn formula(text: &str) -> Result<RadiusSource> {
    let expression = expression(text)?;
    let scale = 1.0;
    Ok(RadiusSource::Expression { expression, scale })
}

/// Makes a set whose radius varies, or that covers a shape.
pub fn make(arguments: &SampleArguments) -> Result<Worked> {
    refuse_tiling(arguments)?;
    let recipe = recipe(arguments)?;
    let mut watch = Stopwatch::start();
    let made = recipe.make(&mut watch)?;
    if recipe.count.is_some() {
        watch.drop_tries();
    }
    let work = Work::on_cpu(&mut watch);
    Ok(Worked { made, work })
}

/// Refuses, by their names, options of other ways to make a set.
fn refuse_tiling(arguments: &SampleArguments) -> Result<()> {
    let option = arguments.ground.option().unwrap_or_default();
    let why = format!("{option} needs the reference sampler, whose darts need no pattern");
    match arguments.method {
        None | Some(SamplingMethod::Reference) => {}
        Some(SamplingMethod::Kdrt) => bail!("--method kdrt: {why}; leave it out"),
        Some(SamplingMethod::Exact) => bail!("--method exact: {why}; leave it out"),
    }

    ensure!(
        arguments.nested.levels.is_none(),
        "--levels: {why}; leave it out"
    );
    ensure!(
        arguments.window.is_none(),
        "--window: {why}, and makes whole sets; leave it out"
    );
    ensure!(
        !arguments.resume,
        "--resume: {why}, and makes whole sets; leave it out"
    );
    ensure!(
        arguments.run.pattern.is_none(),
        "--pattern: {why}; leave it out"
    );
    arguments.engine.check_on_cpu("the reference sampler")?;
    match arguments
        .run
        .typed
        .iter()
        .find(|typed| !USED.contains(typed))
    {
        Some(typed) => bail!("--{}: {why}; leave it out", typed.key()),
        None => Ok(()),
    }
}

fn recipe(arguments: &SampleArguments) -> Result<VaryingRecipe> {
    let (run, ground) = (&arguments.run, &arguments.ground);
    let asked = &run.asked;
    let is_typed = |parameter: Parameter| run.typed.contains(&parameter);
    let black = is_typed(Parameter::Radius).then_some(asked.radius);
    let radius = if let Some(text) = &ground.radius_expression {
        formula(text)?
    } else if let Some(path) = &ground.radius_image {
        let radii = black.zip(run.greatest);
        let (black, white) = radii
            .context("--radius-image needs --radius MIN..MAX, the radii of black and of white")?;
        let image = image(path, "--radius-image")?;
        let radii = [black, white];
        RadiusSource::Image { image, radii }
    } else if let Some(path) = &ground.density_image {
        let image = image(path, "--density-image")?;
        // With a count any radius is scaled to it.
        let black = black.unwrap_or(1.0);
        RadiusSource::Density { image, black }
    } else {
        RadiusSource::Constant(black.unwrap_or(1.0))
    };

    // A side that is not typed follows from the shape or the pixels, and not from the parameters' defaults.
    let given = |parameter: Parameter, value: f64| is_typed(parameter).then_some(value);
    let is_bounded = !is_typed(Parameter::Boundary) || asked.boundary == Boundary::Bounded;
    Ok(VaryingRecipe {
        radius,
        shape: ground.shape(arguments.coordinates.planar)?,
        size: [
            given(Parameter::Width, asked.width),
            given(Parameter::Height, asked.height),
        ],
        origin: pair(arguments.origin.as_ref()),
        boundary: Boundary::of(!is_bounded),
        seed: asked.seed,
        count: run.count,
    })
}
