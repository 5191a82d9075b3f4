//! The figures of an analysis: curves of all subjects over each other, their differences from a reference, and periodograms.
//! `tilescope_figures` draws them.

use std::fmt::Write;

use tilescope_analysis::measures::anisotropy_reference_db;
use tilescope_drawing::spectra::{self, chart};
use tilescope_figures::chart::{Axis, Figure, Level, LineChart, Look, Panel, Series};

use super::curve::Curve;
use super::differences::Differences;
use super::gather::Analysis;
use super::names;
use super::subject::Subject;

/// Curves higher than this are cut off: the peaks of lattices would flatten the others. This limit and the next three
/// are chosen, not measured.
const MAX_PEAK: f64 = 8.0;
/// Differences beyond this, of either sign, are cut off.
const MAX_DIFFERENCE: f64 = 4.0;
/// Bands may reach this many times as high as the highest curve.
const MAX_BAND: f64 = 1.5;
/// Anisotropies of fewer frequencies scatter by decibels; the axis may cut them off.
const FEW: u64 = 50;
/// Periodograms in one figure: four rows, chosen and not measured.
pub const MAX_PICTURES: usize = 12;
/// Periodograms in a row.
pub const IN_A_ROW: usize = 3;
/// The most characters of a name in the heading of a periodogram.
pub const HEADING: usize = 24;

const FREQUENCY: &str = "frequency \u{3bd} = |k| / \u{221a}N";
const DISTANCE: &str = "distance r / r_max";

/// Returns one figure with all curves, and the number of periodograms that it leaves out.
pub fn figure(analysis: &Analysis) -> (Figure, usize) {
    let subjects = &analysis.subjects;
    let left_out = subjects.len().saturating_sub(MAX_PICTURES);
    let shown = &subjects[..subjects.len() - left_out];
    let mut pictures: Vec<Panel> = shown.iter().map(periodogram).collect();

    let (spectra, pairs) = curve_rows(analysis);
    let mut rows = vec![spectra];
    // A row has room for the pair correlation and two pictures.
    if pictures.len() <= 2 {
        pictures.insert(0, pairs);
        rows.extend([pictures, difference_row(analysis)]);
    } else {
        // Curves are what one compares, and come before any number of pictures.
        rows.extend([vec![pairs], difference_row(analysis)]);
        rows.extend(pictures.chunks(IN_A_ROW).map(<[Panel]>::to_vec));
    }

    let mut title = title(analysis);
    // The picture may be seen without the note that the command prints.
    if left_out > 0 {
        let all = subjects.len();
        let _ = write!(title, "; {left_out} of {all} periodograms are left out");
    }
    (of_rows(title, rows), left_out)
}

/// Returns the figures of a page: curves, differences, and all periodograms.
pub fn figures(analysis: &Analysis) -> Vec<Figure> {
    let subjects = &analysis.subjects;
    // The periodograms of two subjects stand in one row with the pair correlation: one figure shows all.
    if subjects.len() <= 2 {
        return vec![figure(analysis).0];
    }
    let (spectra, pairs) = curve_rows(analysis);
    let rows = vec![spectra, vec![pairs], difference_row(analysis)];
    let curves = of_rows(title(analysis), rows);
    // A page has any number of figures, so that none of its periodograms is left out.
    let pictures = (subjects.chunks(MAX_PICTURES).enumerate()).map(|(index, some)| {
        let first = index * MAX_PICTURES + 1;
        let (last, all) = (first + some.len() - 1, subjects.len());
        let panels: Vec<Panel> = some.iter().map(periodogram).collect();
        let rows = panels.chunks(IN_A_ROW).map(<[Panel]>::to_vec).collect();
        of_rows(format!("Periodograms {first} to {last} of {all}"), rows)
    });
    std::iter::once(curves).chain(pictures).collect()
}

/// Returns the figure of the rows that are not empty.
pub fn of_rows(title: String, mut rows: Vec<Vec<Panel>>) -> Figure {
    rows.retain(|row| !row.is_empty());
    Figure { title, rows }
}

fn title(analysis: &Analysis) -> String {
    match analysis.subjects.as_slice() {
        [subject] => format!("Analysis of {}", subject.label),
        _ if analysis.averaged => "Analysis of averages".to_owned(),
        subjects => format!("Analysis of {} sets", subjects.len()),
    }
}

/// Returns the periodogram of a subject.
fn periodogram(subject: &Subject) -> Panel {
    let title = format!("Periodogram, {}", names::cut(&subject.label, HEADING));
    Panel::Image(spectra::periodogram(&subject.spectrum, title))
}

/// Returns the row of spectra, and the pair correlation.
fn curve_rows(analysis: &Analysis) -> (Vec<Panel>, Panel) {
    let subjects = &analysis.subjects;
    let series_of_curve = |number_of_curve: usize| -> Vec<Series> {
        let each = subjects.iter().enumerate();
        let lines = each.map(|(index, subject)| {
            // The reference comes first, with a look of its own, and the others count from 0.
            let number = index.checked_sub(usize::from(analysis.has_reference));
            let look = number.map_or(Look::Reference, Look::Numbered);
            let (_, curve) = &subject.curves[number_of_curve];
            series(&subject.title, look, curve)
        });
        lines.flatten().collect()
    };
    // A subject has its curves in this order.
    let [powers, anisotropies, correlations] = [0, 1, 2].map(series_of_curve);

    let power = spectra::radial_mean(FREQUENCY, cut("power P(\u{3bd})", &powers), powers);
    let levels = levels_of_anisotropy(subjects);
    let axis = anisotropy_axis(subjects, &levels);
    let anisotropy = chart("Anisotropy", FREQUENCY, axis, anisotropies, levels);

    // Samples that do not regard each other are as frequent at every distance: g(r) is 1.
    let (name, axis) = ("white noise".to_owned(), cut("g(r)", &correlations));
    let noise = vec![Level { name, y: 1.0 }];
    let pairs = chart("Pair correlation", DISTANCE, axis, correlations, noise);
    // The pair correlation keeps its panel without a curve, too: it has its place in the rows of the figure.
    (drawn([power, anisotropy]), Panel::Lines(pairs))
}

/// Returns the differences of all subjects from the reference, if there is one: of the two curves that have
/// differences. Anisotropies are compared with the levels in their own chart.
fn difference_row(analysis: &Analysis) -> Vec<Panel> {
    let labels = analysis.compared().iter().map(|subject| &subject.label);
    let each: Vec<(&String, &Differences)> = labels.zip(&analysis.differences).collect();
    differences(&each, [FREQUENCY, DISTANCE])
}

/// Returns the charts of differences from a reference, each with the label of its subject: of powers over `frequency`, and of pair
/// correlations over `distance`.
pub fn differences(
    each: &[(&String, &Differences)],
    [frequency, distance]: [&str; 2],
) -> Vec<Panel> {
    let texts = [
        ("radial mean power", frequency, "P(\u{3bd})"),
        ("pair correlation", distance, "g(r)"),
    ];

    // Differences have their curves in the order of these texts.
    let charts = texts.iter().enumerate().map(|(number, (what, x, y))| {
        // Colours are those of the curves above, which count without the reference as well.
        let lines = each
            .iter()
            .enumerate()
            .map(|(index, (label, differences))| {
                let (_, curve) = &differences.curves[number];
                // The label alone names the curve. In other charts a mark behind it tells the reference, which is not
                // among these.
                series(label, Look::Numbered(index), curve)
            });
        let all: Vec<Series> = lines.flatten().collect();
        let (name, title) = ("no difference".to_owned(), format!("Difference of {what}"));
        let axis = cut_difference(&format!("\u{394}{y}"), &all);
        chart(&title, x, axis, all, vec![Level { name, y: 0.0 }])
    });
    drawn(charts)
}

/// Returns the charts that have a curve.
pub fn drawn(charts: impl IntoIterator<Item = LineChart>) -> Vec<Panel> {
    let charts = charts.into_iter().filter(|chart| !chart.series.is_empty());
    charts.map(Panel::Lines).collect()
}

/// Returns a curve as a chart draws it; `None` without a point, as its name would stand in the legend alone.
pub fn series(name: &str, look: Look, curve: &Curve) -> Option<Series> {
    let series = || Series {
        name: name.to_owned(),
        look,
        points: curve.points.clone(),
        band: curve.bands.clone(),
    };
    (!curve.points.is_empty()).then(series)
}

fn highest(series: &[Series]) -> f64 {
    let points = series.iter().flat_map(|series| &series.points);
    points.map(|point| point[1].abs()).fold(0.0, f64::max)
}

/// Returns the ends of all bands: the lowest, at most 0, and the highest, at least 0.
fn ends_of_bands(series: &[Series]) -> [f64; 2] {
    let bands = series.iter().filter_map(|series| series.band.as_ref());
    (bands.flatten()).fold([0.0, 0.0], |[low, high], band| {
        [band[0].min(low), band[1].max(high)]
    })
}

/// Returns the axis of a quantity that is not negative: it cuts off high peaks, and bands that would dwarf their curves.
pub fn cut(label: &str, series: &[Series]) -> Axis {
    let top = highest(series);
    if top > MAX_PEAK {
        return Axis::new(format!("{label}, cut off at {MAX_PEAK}")).with_range(0.0, MAX_PEAK);
    }
    let [low, high] = ends_of_bands(series);
    // Curves that are 0 everywhere would give an empty range. White noise, at 1, lies in the range if a curve reaches
    // 2/3, which every curve does that ends near white noise.
    if top > 0.0 && high > MAX_BAND * top {
        return Axis::new(format!("{label}, bands cut off")).with_range(0.0, MAX_BAND * top);
    }
    // Without a range the axis would begin at the lower end of a band, which is below 0, where the quantity cannot be.
    // White noise, at 1, stays in the chart, with a twentieth of room above.
    if low < 0.0 {
        return Axis::new(label).with_range(0.0, 1.05 * high.max(top).max(1.0));
    }
    Axis::new(label)
}

/// Returns the axis of differences: it cuts off those far from 0.
fn cut_difference(label: &str, series: &[Series]) -> Axis {
    let [low, high] = ends_of_bands(series);
    // The label names bands where they alone are cut off, and every curve is there as a whole.
    let (what, far) = match highest(series) {
        far if far > MAX_DIFFERENCE => ("", far),
        _ => ("bands ", high.max(-low)),
    };
    if far > MAX_DIFFERENCE {
        return Axis::new(format!("{label}, {what}cut off at \u{b1}{MAX_DIFFERENCE}"))
            .with_range(-MAX_DIFFERENCE, MAX_DIFFERENCE);
    }
    Axis::new(label)
}

/// Returns the anisotropies that means of K sets without preferred directions have: a line for each K of the subjects.
fn levels_of_anisotropy(subjects: &[Subject]) -> Vec<Level> {
    let mut sets: Vec<u64> = subjects.iter().map(Subject::sets).collect();
    sets.sort_unstable();
    sets.dedup();
    // The names of the lines stand side by side above the chart, where several have no room for the words. The first
    // one has the formula for all.
    let is_only = sets.len() == 1;
    let what = if is_only {
        "no preferred direction: "
    } else {
        ""
    };
    let level = |(index, &count): (usize, &u64)| {
        let plural = if count == 1 { "set" } else { "sets" };
        let mut name = format!("K = {count} {plural}");
        if index == 0 {
            name = format!("{what}\u{2212}10 log\u{2081}\u{2080} K, {name}");
        }
        let y = anisotropy_reference_db(count);
        Level { name, y }
    };
    sets.iter().enumerate().map(level).collect()
}

/// Returns an axis that holds all anisotropies of at least [`FEW`] frequencies.
fn anisotropy_axis(subjects: &[Subject], levels: &[Level]) -> Axis {
    let annuli = (subjects.iter())
        .flat_map(|one| &one.spectrum.profile.annuli)
        .filter(|annulus| annulus.anisotropy_db.is_finite());
    let of_annulus = annuli.map(|one| Anisotropy {
        frequencies: one.count,
        decibels: one.anisotropy_db,
    });
    let all: Vec<Anisotropy> = of_annulus.collect();
    range_of_many(&all, levels.iter().map(|level| level.y))
}

/// The anisotropy of an annulus.
struct Anisotropy {
    /// Over how many frequencies it was measured.
    frequencies: u64,
    decibels: f64,
}

/// Returns the axis of anisotropies: as wide as annuli of many frequencies and the levels of chance need.
fn range_of_many(all: &[Anisotropy], levels: impl Iterator<Item = f64>) -> Axis {
    let label = "anisotropy, dB";
    let wider = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
    let nothing = [f64::INFINITY, f64::NEG_INFINITY];
    let many = (all.iter())
        .filter(|one| one.frequencies >= FEW)
        .map(|one| one.decibels)
        .fold(nothing, wider);
    // If no annulus has that many frequencies, the curves determine the range.
    if many[0] > many[1] {
        return Axis::new(label);
    }

    // The lines of sets without a preferred direction are what the curves are compared with.
    let [least, most] = levels.fold(many, wider);
    // A twentieth of the range; half a decibel at least, so that a flat curve does not lie on the frame.
    let spare = (0.05 * (most - least)).max(0.5);
    let [low, high] = [least - spare, most + spare];
    let is_cut = (all.iter()).any(|one| !(low..=high).contains(&one.decibels));
    let remark = if is_cut {
        "; few frequencies cut off"
    } else {
        ""
    };
    Axis::new(format!("{label}{remark}")).with_range(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(y: f64, band: [f64; 2]) -> Series {
        Series {
            name: "a.csv".to_owned(),
            look: Look::Numbered(0),
            points: vec![[0.0, 0.0], [1.0, y]],
            band: Some(vec![[0.0, 0.0], band]),
        }
    }

    #[test]
    fn bands_neither_dwarf_their_curve_nor_reach_below_zero() {
        let axis = |y, band| cut("g(r)", &[curve(y, band)]);
        assert_eq!(axis(2.0, [1.5, 2.5]), Axis::new("g(r)"));
        let wide = axis(2.0, [-7.0, 11.0]);
        assert_eq!(wide.range, Some([0.0, 3.0]));
        assert!(wide.label.ends_with("bands cut off"));
        let range = axis(2.0, [-0.1, 2.5]).range.unwrap();
        assert!(range[0].abs() < 1e-12 && range[1] > 2.5, "{range:?}");
        assert_eq!(axis(20.0, [19.0, 21.0]).range, Some([0.0, MAX_PEAK]));
        let difference = cut_difference("d", &[curve(0.1, [-9.0, 9.0])]);
        assert_eq!(difference.range, Some([-MAX_DIFFERENCE, MAX_DIFFERENCE]));
        assert_eq!(cut_difference("d", &[curve(0.1, [-1.0, 1.0])]).range, None);
    }

    #[test]
    fn a_handful_of_frequencies_does_not_stretch_the_axis_of_anisotropy() {
        let axis = |all: &[(u64, f64)]| {
            let all = all.iter().map(|&(frequencies, decibels)| Anisotropy {
                frequencies,
                decibels,
            });
            range_of_many(&all.collect::<Vec<_>>(), std::iter::once(0.0))
        };
        let many = [(50, -1.0), (400, 1.0)];
        let with_few = [(4, -12.0), (50, -1.0), (400, 1.0)];
        assert_eq!(axis(&with_few).range, axis(&many).range);
        assert_eq!(axis(&many).range, Some([-1.5, 1.5]));
        assert!(axis(&with_few).label.contains("cut off"));
        assert!(!axis(&many).label.contains("cut off"));
        assert_eq!(axis(&with_few[..1]).range, None, "nothing else is there");
    }
}
