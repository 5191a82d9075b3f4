//! Periodograms as panels: white where there is no power, black where there is three times that of noise.

use tilescope_figures::chart::{Axis, ImageChart, Panel};

use super::names;
use super::subject::Subject;

/// Periodograms in a row.
pub const IN_A_ROW: usize = 3;

/// Power that is black.
const BLACK: f64 = 3.0;
/// Letters of a name that a panel's heading has room for.
const HEADING: usize = 24;

/// Returns the periodogram of a subject; both axes are as long as the domain's shape makes them.
pub fn panel(subject: &Subject) -> Panel {
    let picture = &subject.spectrum.picture;
    let [x, y] = subject.spectrum.picture_reach;
    let each = match [picture.side, picture.row_side] {
        [1, 1] => String::new(),
        [along_x, along_y] => format!(" (means of {along_x} \u{d7} {along_y})"),
    };
    let middle = picture.power.len() / 2;
    let absent = !picture.power[middle].is_finite();
    Panel::Image(ImageChart {
        title: format!("Periodogram, {}", names::cut(&subject.label, HEADING)),
        x: Axis::new(format!("\u{3bd} along x; white 0, black {BLACK} and above"))
            .with_range(-x, x),
        y: Axis::new(format!("\u{3bd} along y{each}")).with_range(-y, y),
        columns: picture.size,
        values: picture.power.clone(),
        clamp: [0.0, BLACK],
        absent: absent.then_some(middle),
    })
}
