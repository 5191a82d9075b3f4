//! The charts of the analysis: their curves and axis ranges.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use std::sync::Arc;

use egui::{Color32, RichText, Ui};
use tilescope_analysis::measures::{MeasuredSet, Spectrum, anisotropy_reference_db};
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::heading;

use super::plot::{Curve, Dash, Plot, PlotAxis};
use super::{RunMeasures, Sets, difference, drag, line_of_second, picture as periodogram};
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::brush::{Brush, BrushAxis};

/// Height of charts, in screen points.
const HEIGHT: f32 = 168.0;
/// The narrowest of three pictures in a row, in screen points.
const MIN_SIDE: f32 = 150.0;
/// Share of a colour that remains in outdated curves.
const FADED: f32 = 0.38;
/// The end of the axis of power, with room above the peaks of a maximal set. It never changes, so that the chart of a moment
/// does not depend on the moments seen before, and charts can be compared while stepping. Higher values, as the power after
/// tiling, are cut off and marked with their number. The periodogram is white from the same power on.
const END_OF_POWER: f64 = periodogram::WHITE;
/// End of the axis of g, likewise fixed.
const END_OF_PAIRS: f64 = 4.0;

/// The label of the axes of frequencies.
const FREQUENCY: &str = "frequency \u{3bd} = |k| / \u{221a}N";

/// Shows the periodogram; with a second run both, and their difference.
pub fn picture(ui: &mut Ui, sets: &Sets<'_>, brush: Option<Brush>, own: &mut Vec<AnalysisCommand>) {
    heading(ui, "Periodogram");
    let shown = sets.first.spectrum();
    if sets.second.is_some() {
        compared(ui, sets, brush, own);
    } else {
        periodogram_of(ui, "", shown, sets.palette, brush, own);
    }
    // With two runs the words name the cells of the first run. The second run has other cells if its number of samples
    // differs.
    let cells = shown.map_or_else(String::new, |(spectrum, _)| cells_of(spectrum));
    let words = format!(
        "\u{3bd} along x and y, to \u{b1}{}; power 0 black, {} and above white{cells}",
        Spectrum::MAX_NU,
        periodogram::WHITE
    );
    let text = RichText::new(words).size(11.5).color(sets.palette.muted);
    ui.label(text);
}

/// Shows the periodogram of a run, "" or "-b".
fn periodogram_of(
    ui: &mut Ui,
    run: &str,
    shown: Option<(&Arc<Spectrum>, bool)>,
    palette: &Palette,
    brush: Option<Brush>,
    own: &mut Vec<AnalysisCommand>,
) {
    let ring = Brush::along(brush, BrushAxis::Frequency);
    let (spectrum, faded) =
        shown.map_or((None, false), |(spectrum, faded)| (Some(spectrum), faded));
    let dragged = periodogram::show(ui, run, spectrum, faded, ring, palette);
    drag(BrushAxis::Frequency, dragged, brush, own);
}

/// Shows the periodograms of both runs and their difference: in a row, or in two where a third of the width is too narrow.
fn compared(ui: &mut Ui, sets: &Sets<'_>, brush: Option<Brush>, own: &mut Vec<AnalysisCommand>) {
    let palette = sets.palette;
    let spectra = [Some(sets.first), sets.second].map(|run| run.and_then(|run| run.spectrum()));
    let mut of_run = |ui: &mut Ui, index: usize| {
        // The second text ends the chart's id, which differs between the runs.
        let (name, run) = [("A", ""), ("B", "-b")][index];
        ui.label(RichText::new(name).size(12.0).color(palette.muted));
        periodogram_of(ui, run, spectra[index], palette, brush, own);
    };
    let difference = |ui: &mut Ui| {
        let text = "B \u{2212} A";
        ui.label(RichText::new(text).size(12.0).color(palette.muted));
        // A spectrum of another moment has no difference at this one.
        let present = spectra.map(|shown| shown.filter(|(_, is_faded)| !is_faded));
        let both = present[0].zip(present[1]).map(|((a, _), (b, _))| [a, b]);
        difference::show(ui, both, palette);
    };

    if ui.available_width() >= 3.0 * MIN_SIDE {
        ui.columns_const(|[left, middle, right]| {
            of_run(left, 0);
            of_run(middle, 1);
            difference(right);
        });
        difference_text(ui, palette);
    } else {
        ui.columns_const(|[left, right]| {
            of_run(left, 0);
            of_run(right, 1);
        });
        ui.columns_const(|[left, right]| {
            difference(left);
            // The text begins beside the picture, which has its name above it.
            right.add_space(20.0);
            difference_text(right, palette);
        });
    }
}

/// Explains the picture of the difference.
fn difference_text(ui: &mut Ui, palette: &Palette) {
    let words = format!(
        "The difference is that of means over cells: where A has more power in the colour of A's line, where B has more in that of B's, in full from {} on",
        difference::FULL
    );
    let text = RichText::new(words).size(11.5).color(palette.muted);
    // Columns justify their text, which tears so short lines apart.
    ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
        ui.label(text)
    });
}

/// Returns a remark on how many frequencies are averaged in a cell of the picture, and up to where they are measured if not
/// everywhere.
fn cells_of(spectrum: &Spectrum) -> String {
    let picture = &spectrum.picture;
    // The picture has `size` by `rows` cells, each of `side` by `row_side` frequencies.
    let mut text = match [picture.side, picture.row_side] {
        [1, 1] => String::new(),
        [side, row_side] => format!("; means of {side} \u{d7} {row_side}"),
    };

    let least = spectrum.picture_reach[0].min(spectrum.picture_reach[1]);
    // A cell at the rim may be measured in part: a reach that lacks less than a cell counts as all.
    let cell = 2.0 * least / picture.size.min(picture.rows) as f64;
    if least < Spectrum::MAX_NU - cell {
        // Half of the frequencies along a side are negative.
        let most_cycles = (picture.size * picture.side).max(picture.rows * picture.row_side) / 2;
        // On no axis more than `MAX_CYCLES` cycles are measured. Once an axis is near this limit, the reach is final;
        // before that it still grows. The share of 0.9 was chosen, not measured.
        let so_far = if most_cycles as f64 > 0.9 * Spectrum::MAX_CYCLES {
            let cycles = tilescope_session::words::grouped(Spectrum::MAX_CYCLES as usize);
            format!("({cycles} cycles)")
        } else {
            "so far".to_owned()
        };
        text = format!("{text}; measured to \u{3bd} {least:.2} {so_far}, grey beyond");
    }

    text
}

/// Returns the axis of frequencies.
const fn frequencies() -> PlotAxis<'static> {
    PlotAxis {
        label: FREQUENCY,
        sign: "\u{3bd}",
        range: [0.0, Spectrum::MAX_NU],
    }
}

/// Shows the charts of power, anisotropy and pair correlation.
pub fn curves(ui: &mut Ui, sets: &Sets<'_>, brush: Option<Brush>, own: &mut Vec<AnalysisCommand>) {
    ui.add_space(8.0);
    // Frequencies nu are relative to the number of samples, so that the length of r is not needed.
    let power = curves_of(sets, &|measured, _| {
        let spectrum = measured.spectrum_so_far()?;
        Some((spectrum.power(), spectrum.bands.clone()))
    });

    let ring = Brush::along(brush, BrushAxis::Frequency);
    let chart = Plot {
        title: "Radial mean power P(\u{3bd})",
        x: frequencies(),
        y: PlotAxis {
            label: "power",
            sign: "P",
            range: [0.0, END_OF_POWER],
        },
        level: (1.0, "white noise"),
        curves: power,
        is_compared: sets.second.is_some(),
        brush: ring,
        height: HEIGHT,
    };

    drag(
        BrushAxis::Frequency,
        chart.show(ui, sets.palette),
        brush,
        own,
    );

    ui.add_space(6.0);
    anisotropy(ui, sets, brush, own);
    ui.add_space(6.0);
    correlation(ui, sets, brush, own);
}

/// Shows the chart of how much the power depends on the direction.
fn anisotropy(ui: &mut Ui, sets: &Sets<'_>, brush: Option<Brush>, own: &mut Vec<AnalysisCommand>) {
    let chart = Plot {
        title: "Anisotropy, dB",
        x: frequencies(),
        y: PlotAxis {
            label: "anisotropy in decibels",
            sign: "dB",
            // Fixed, as the other axes are. Chosen, not measured.
            range: [-10.0, 10.0],
        },
        level: (
            anisotropy_reference_db(1),
            "no preferred direction: \u{2212}10 log\u{2081}\u{2080} K, K = 1 set",
        ),
        curves: curves_of(sets, &|measured, _| {
            Some((measured.spectrum_so_far()?.anisotropy(), None))
        }),
        is_compared: sets.second.is_some(),
        brush: Brush::along(brush, BrushAxis::Frequency),
        // The curve of the anisotropy is the flattest of the three, and needs less height.
        height: HEIGHT - 14.0,
    };

    drag(
        BrushAxis::Frequency,
        chart.show(ui, sets.palette),
        brush,
        own,
    );
}

/// Shows the chart of the pair correlation: how often two samples have a distance, relative to independent samples.
fn correlation(ui: &mut Ui, sets: &Sets<'_>, brush: Option<Brush>, own: &mut Vec<AnalysisCommand>) {
    let pairs = curves_of(sets, &|measured, unit| {
        // Before the pairs are counted there are no points, and no curve.
        let points = measured.correlation(unit);
        (!points.is_empty()).then_some((points, None))
    });

    let chart = Plot {
        title: "Pair correlation g",
        x: PlotAxis {
            label: "distance, r-units (d / r)",
            sign: "d/r",
            range: [0.0, BrushAxis::Distance.end()],
        },
        y: PlotAxis {
            label: "pairs, relative to independent samples",
            sign: "g",
            range: [0.0, END_OF_PAIRS],
        },
        level: (1.0, "white noise"),
        curves: pairs,
        is_compared: sets.second.is_some(),
        brush: Brush::along(brush, BrushAxis::Distance),
        height: HEIGHT,
    };

    drag(
        BrushAxis::Distance,
        chart.show(ui, sets.palette),
        brush,
        own,
    );
}

/// The points of a curve, and the band around each of them, if it has one.
type CurvePoints = (Vec<[f64; 2]>, Option<Vec<[f64; 2]>>);

/// Returns the curves of the moment of each run, of the reference and of the file; `points` receives a set and the length of r in
/// its unit.
fn curves_of(
    sets: &Sets<'_>,
    points: &dyn Fn(&MeasuredSet, f64) -> Option<CurvePoints>,
) -> Vec<Curve> {
    let palette = sets.palette;
    let curve = |name: &str, line, color: Color32, (points, band): CurvePoints| Curve {
        name: name.to_owned(),
        points,
        band,
        line,
        color,
    };

    let mut curves = Vec::new();
    // The radius of a set is the length of r in the set's unit. A set without a radius has r as its unit.
    let in_own_unit = |measured: &MeasuredSet| points(measured, measured.radius.unwrap_or(1.0));
    let mut add = |run: RunMeasures<'_>, name: &str, line, color: Color32| {
        if let Some((found, faded)) = run.part(in_own_unit) {
            let color = if faded {
                color.gamma_multiply(FADED)
            } else {
                color
            };
            let name = if faded { "a moment before" } else { name };
            curves.push(curve(name, line, color, found));
        }
    };

    if let Some(second) = sets.second {
        add(sets.first, "run A", Dash::Solid, palette.accent);
        let (line, color) = line_of_second(palette);
        add(second, "run B", line, color);
    } else {
        add(sets.first, "this moment", Dash::Solid, palette.accent);
    }

    let others = [
        // The reference is measured in units of r.
        sets.reference
            .map(|measured| (measured, 1.0, "reference", Dash::Dotted, palette.text)),
        // In the unit of the file r has the length `sets.unit`.
        sets.reference_file.map(|file| {
            let (line, color) = (Dash::Dashed, palette.conflict);
            (&file.measured, sets.unit, file.name(), line, color)
        }),
    ];

    for (measured, unit, name, line, color) in others.into_iter().flatten() {
        // Two more bands would cover those of the runs, and are left out. Chosen, not measured.
        if let Some((found, _)) = points(measured, unit) {
            curves.push(curve(name, line, color, (found, None)));
        }
    }
    curves
}
