//! Pictures of the power of sets in space in three planes of frequencies, in rows of three.

use tilescope_analysis::PlanePower;
use tilescope_drawing::spectra;
use tilescope_figures::chart::{Figure, Panel};

use super::subject::SolidSubject;
use crate::analyze::curves::{HEADING, IN_A_ROW, MAX_PICTURES, of_rows};
use crate::analyze::names;

/// Sets whose planes are in one figure: each has a row of its own.
pub const MAX_SETS: usize = MAX_PICTURES / IN_A_ROW;

/// Returns the planes of a set, that without a cycle along x first.
pub fn row(subject: &SolidSubject) -> Vec<Panel> {
    let label = names::cut(&subject.label, HEADING);
    let picture = |power: &PlanePower| {
        let axis = ["x", "y", "z"][power.axis];
        let title = format!("Power at k_{axis} = 0, {label}");
        Panel::Image(spectra::plane(power, title))
    };
    subject.planes.iter().map(picture).collect()
}

/// Returns the figures that hold the planes of all sets.
pub fn figures(subjects: &[&SolidSubject]) -> Vec<Figure> {
    let figure = |(index, some): (usize, &[&SolidSubject])| {
        let first = index * MAX_SETS + 1;
        let (last, all) = (first + some.len() - 1, subjects.len());
        let rows = some.iter().map(|subject| row(subject)).collect();
        of_rows(format!("Planes of sets {first} to {last} of {all}"), rows)
    };
    subjects.chunks(MAX_SETS).enumerate().map(figure).collect()
}
