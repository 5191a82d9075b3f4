//! `stipple`: dots as dense as an image is dark, and pictures of them.

use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tilescope_core::ParameterError;
use tilescope_figures::{on_paper, to_png_controlled, to_svg_with_fonts_controlled};
use tilescope_sets::{Stipple, StippleLook, StippleRecipe, Tone, VaryingError, color_of};

use crate::arguments::SetArgument;
use crate::drawing::{DrawingFields, drawing, fields_of};
use crate::failure::Failure;
use crate::ground::Ground;
use crate::image::Picture;
use crate::memory::ask_to_draw;
use crate::picture::{width, window_within};
use crate::sample::{PythonSet, facts_of, set_into_python};
use crate::task::run;
use crate::values::{real, real_if_given, shortened, whole};

/// The arguments of a stipple beside its image, as Python passes them.
#[derive(FromPyObject)]
pub struct StippleArguments<'py> {
    dots: Bound<'py, PyAny>,
    gamma: Bound<'py, PyAny>,
    contrast: Bound<'py, PyAny>,
    invert: bool,
    white: Bound<'py, PyAny>,
    run_on: bool,
    width: Option<Bound<'py, PyAny>>,
    seed: Bound<'py, PyAny>,
    by_darkness: bool,
    dot_radius: Option<Bound<'py, PyAny>>,
    paper: Option<String>,
    ink: Option<String>,
}

impl StippleArguments<'_> {
    fn tone(&self) -> PyResult<Tone> {
        let tone = Tone {
            gamma: real("gamma", &self.gamma)?,
            contrast: real("contrast", &self.contrast)?,
            is_inverted: self.invert,
        };
        // Refused before the image is read.
        tone.check().map_err(Failure::from)?;
        Ok(tone)
    }

    /// Returns how many dots there are to be.
    fn dots(&self) -> PyResult<u64> {
        let dots = whole("dots", &self.dots)?;
        // A recipe of no dots makes one, and leaves it out.
        if dots == 0 {
            let text = "dots is 0; it must be at least 1";
            return Err(PyValueError::new_err(text));
        }
        Ok(dots)
    }

    /// Returns a length that is above 0, if it is given.
    fn length(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
        let value = real_if_given(name, value)?;
        // Written so that NaN is refused, too, which no comparison holds for.
        let wrong = value.filter(|length| !(length.is_finite() && *length > 0.0));
        wrong.map_or(Ok(value), |length| {
            Err(PyValueError::new_err(format!(
                "{name} is {length}; it must be a finite number above 0"
            )))
        })
    }

    fn look(&self) -> PyResult<StippleLook> {
        // The message has the reason alone, and the name and the value are those of Python.
        let color = |name: &str, text: &Option<String>| {
            let read = |text: &String| {
                color_of(text).map_err(|reason| {
                    PyValueError::new_err(format!("{name} is '{}': {reason}", shortened(text)))
                })
            };
            text.as_ref().map(read).transpose()
        };
        Ok(StippleLook {
            paper: color("paper", &self.paper)?,
            ink: color("ink", &self.ink)?,
            by_darkness: self.by_darkness,
            dot_radius: Self::length("dot_radius", self.dot_radius.as_ref())?,
        })
    }
}

/// What a stipple says beside its set, for Python: how many sets were made, the radius of black, how many pixels are too
/// light, and how it is drawn.
type StippleFields = (usize, f64, usize, DrawingFields);

/// Makes a stipple. Returns also what it is judged in.
#[pyfunction]
pub fn stipple<'py>(
    py: Python<'py>,
    image: Picture<'py>,
    arguments: StippleArguments<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PythonSet<'py>, Ground, StippleFields)> {
    // The image comes last, as it takes longest. Its tone is made with the dots, so that Ctrl-C stops that as well.
    let (tone, look, dots) = (arguments.tone()?, arguments.look()?, arguments.dots()?);
    let (white, seed) = (
        real("white", &arguments.white)?,
        whole("seed", &arguments.seed)?,
    );
    let width = StippleArguments::length("width", arguments.width.as_ref())?;
    let (runs_on, pixels) = (arguments.run_on, image.image()?);

    let (made, settled) = run(py, progress, |watch| {
        let recipe = StippleRecipe {
            image: pixels.toned(tone)?,
            white,
            dots,
            width,
            runs_on,
            seed,
        };
        let made = recipe.make(&mut watch.observer());
        let made = made.map_err(|error| of_dots(error, dots))?;
        // Copies of the set are judged in the field of the radii that were found.
        let settled = recipe.settled(made.black)?;
        Ok((made, settled))
    })?;
    let Stipple {
        made,
        black,
        capped,
        runs,
        ground,
    } = made;

    let drawing = look.drawing(
        black,
        &ground.varying.judged,
        &made.set.points,
        tone.is_inverted,
    );
    let fields = (runs, black, capped, fields_of(&drawing));

    let ground = Ground::of_made(settled, &made.facts);
    // A stipple has a field always, so that this never fails.
    let ground = ground.ok_or_else(|| PyValueError::new_err("the stipple has no field"))?;
    let facts = facts_of(&made.facts);
    // Only nested levels have ranks.
    let ranks = Vec::new();
    Ok((
        set_into_python(made.set, ranks, &facts, py)?,
        ground,
        fields,
    ))
}

/// Names the argument that a radius follows from, where the radius is refused.
fn of_dots(error: VaryingError, dots: u64) -> Failure {
    let named = |many: &str| format!("dots is {dots}, which is too {many}: {error}");
    match error {
        // Many dots have small radii, in which the sides are long and the pixels wide; few have large ones.
        VaryingError::Domain(ParameterError::SideTooLong { .. }) | VaryingError::Fine { .. } => {
            Failure::Value(named("many"))
        }
        VaryingError::Domain(_) => Failure::Value(named("few")),
        _ => error.into(),
    }
}

/// Returns the bytes of a picture of dots of these radii in paper and ink: PNG or SVG.
#[pyfunction]
#[pyo3(signature = (set, radii, *, svg, size, window, progress))]
pub fn draw_dots(
    py: Python<'_>,
    set: SetArgument<'_>,
    radii: PyReadonlyArray1<'_, f64>,
    svg: bool,
    size: &Bound<'_, PyAny>,
    window: Option<&Bound<'_, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<u8>> {
    let size = width(size)?;
    let (points, region) = (set.points()?, set.region()?);
    let [left, bottom, right, top] =
        window_within(window, &region)?.unwrap_or([0.0, 0.0, region.width, region.height]);
    // Only stipples have one, and only they call this.
    let drawing = set.drawing.map(drawing);
    let drawing = drawing.ok_or_else(|| PyValueError::new_err("the set has no paper and ink"))?;
    // Python passes contiguous arrays.
    let radii = radii.as_slice().unwrap_or_default();

    run(py, progress, |watch| {
        let sides = [right - left, top - bottom];
        // Only a bitmap takes memory for each of its pixels.
        let pixels = size as f64 * size as f64 * sides[1] / sides[0];
        ask_to_draw(points.len(), if svg { 0.0 } else { pixels })?;
        // Dots that do not reach into the picture are left out, and need not be laid out.
        let reaches = |&([x, y], radius): &([f64; 2], f64)| {
            (-radius..=sides[0] + radius).contains(&x) && (-radius..=sides[1] + radius).contains(&y)
        };
        // The picture begins at the window's corner.
        let placed = points.iter().map(|[x, y]| [x - left, y - bottom]);
        let dots = placed.zip(radii.iter().copied()).filter(reaches);
        let scene = on_paper(sides, size as u32, [drawing.paper, drawing.ink], dots);

        let mut control = watch.steps("draw");
        Ok(if svg {
            to_svg_with_fonts_controlled(&scene, &mut control)?.into_bytes()
        } else {
            // The scene is laid out in pixels already.
            let scale = 1.0;
            to_png_controlled(&scene, scale, &mut control)?
        })
    })
}
