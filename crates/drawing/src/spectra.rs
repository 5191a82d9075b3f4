//! Spectra as charts, for reports and for pictures of moments: a periodogram as a grid of grey cells, and curves over the
//! frequency. `tilescope_figures` draws them.

use tilescope_analysis::PlanePower;
use tilescope_analysis::measures::{CoarsePower, Spectrum};
use tilescope_figures::chart::{Axis, ImageChart, Level, LineChart, Series};

/// Power drawn black in a periodogram; zero is white.
pub const BLACK: f64 = 3.0;

/// Returns the periodogram of a spectrum, as it is printed: dark ink where much power is.
#[must_use]
pub fn periodogram(spectrum: &Spectrum, title: String) -> ImageChart {
    power_picture(&spectrum.picture, spectrum.picture_reach, ["x", "y"], title)
}

/// Returns the power in a plane of frequencies of a set in space, as it is printed: dark ink where much power is.
#[must_use]
pub fn plane(power: &PlanePower, title: String) -> ImageChart {
    let along = match power.axis {
        0 => ["y", "z"],
        1 => ["x", "z"],
        _ => ["x", "y"],
    };
    power_picture(&power.picture, power.reach, along, title)
}

/// Returns a picture of powers that reaches as far as given to both sides of zero, with frequencies along two named axes.
fn power_picture(
    picture: &CoarsePower,
    [x, y]: [f64; 2],
    [along_x, along_y]: [&str; 2],
    title: String,
) -> ImageChart {
    // Where cells hold more than one frequency, the vertical axis says so: the horizontal one names the shades.
    let each = match [picture.side, picture.row_side] {
        [1, 1] => String::new(),
        [columns, rows] => format!(" (means of {columns} \u{d7} {rows})"),
    };

    // Rows and columns are odd in number, so that the zero frequency is in the middle. If it is alone in its cell, the
    // cell has no power to show, and is NaN.
    let middle = picture.power.len() / 2;
    let is_absent = !picture.power[middle].is_finite();

    ImageChart {
        title,
        x: Axis::new(format!(
            "\u{3bd} along {along_x}; white 0, black {BLACK} and above"
        ))
        .with_range(-x, x),
        y: Axis::new(format!("\u{3bd} along {along_y}{each}")).with_range(-y, y),
        columns: picture.size,
        values: picture.power.clone(),
        clamp: [0.0, BLACK],
        absent: is_absent.then_some(middle),
    }
}

/// Returns a periodogram as a window shows it in the dark: light where much power is.
#[must_use]
pub fn on_dark(printed: ImageChart) -> ImageChart {
    // The lower end of the scale is white: negative powers turn it round.
    let values = printed.values.into_iter().map(|power| -power);
    ImageChart {
        x: Axis {
            label: format!("\u{3bd} along x; black 0, white {BLACK} and above"),
            ..printed.x
        },
        values: values.collect(),
        clamp: [-BLACK, 0.0],
        ..printed
    }
}

/// Returns the radial mean power of spectra, over frequencies in the unit that `frequency` names.
#[must_use]
pub fn radial_mean(frequency: &str, y: Axis, series: Vec<Series>) -> LineChart {
    let (name, title) = ("white noise".to_owned(), "Radial mean power");
    chart(title, frequency, y, series, vec![Level { name, y: 1.0 }])
}

/// Returns a chart whose horizontal axis begins at 0 and ends with its longest curve.
#[must_use]
pub fn chart(title: &str, x: &str, y: Axis, series: Vec<Series>, levels: Vec<Level>) -> LineChart {
    let ends = series.iter().filter_map(|series| series.points.last());
    let end = ends.map(|point| point[0]).fold(0.0, f64::max);
    LineChart {
        title: title.to_owned(),
        x: Axis::new(x).with_range(0.0, end),
        y,
        levels,
        series,
    }
}
