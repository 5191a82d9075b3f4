//! The figures of an analysis: curves of all subjects over each other, and their differences from a reference.

use tilescope_analysis::measures::{DifferenceCurve, anisotropy_reference_db};
use tilescope_figures::chart::{Axis, Figure, Level, LineChart, Look, Panel, Series};

use super::differences::Comparison;
use super::gather::Analysis;
use super::pictures::{self, IN_A_ROW};
use super::subject::{Place, Subject, places};

/// A peak higher than this is cut off: those of lattices would flatten everything else.
const MAX_PEAK: f64 = 8.0;
/// The same of a difference, of either sign.
const MAX_FREQUENCY: f64 = 4.0;
/// Bands may reach this many times as high as the highest curve.
const MAX_BAND: f64 = 1.5;
/// Anisotropies of fewer frequencies scatter by decibels: they do not stretch their axis.
const FEW: u64 = 50;
/// Periodograms in a figure that has curves as well.
const MAX_PICTURES: usize = 12;

const FREQUENCY: &str = "frequency \u{3bd} = |k| / \u{221a}N";
const DISTANCE: &str = "distance r / r_max";

/// Returns the one figure of everything, and how many periodograms it leaves out.
pub fn figure(analysis: &Analysis) -> (Figure, usize) {
    let subjects = &analysis.subjects;
    let left_out = subjects.len().saturating_sub(MAX_PICTURES);
    let shown = &subjects[..subjects.len() - left_out];
    let mut pictures: Vec<Panel> = shown.iter().map(pictures::panel).collect();
    let (mut rows, pairs) = curve_rows(analysis);
    if pictures.len() <= 2 {
        pictures.insert(0, pairs);
        rows.push(pictures);
        rows.extend(difference_row(analysis));
    } else {
        rows.push(vec![pairs]);
        rows.extend(difference_row(analysis));
        rows.extend(pictures.chunks(IN_A_ROW).map(<[Panel]>::to_vec));
    }
    rows.retain(|row| !row.is_empty());
    let title = match left_out {
        0 => title(analysis),
        some => format!(
            "{}; {some} of {} periodograms are left out",
            title(analysis),
            subjects.len()
        ),
    };
    (Figure { title, rows }, left_out)
}

/// Returns the figures of a page, which has room: curves, differences, all periodograms.
pub fn figures(analysis: &Analysis) -> Vec<Figure> {
    let subjects = &analysis.subjects;
    if subjects.len() <= 2 {
        return vec![figure(analysis).0];
    }
    let (mut rows, pairs) = curve_rows(analysis);
    rows.push(vec![pairs]);
    rows.extend(difference_row(analysis));
    rows.retain(|row| !row.is_empty());
    let curves = Figure {
        title: title(analysis),
        rows,
    };
    let pictures = subjects.chunks(MAX_PICTURES).enumerate();
    let pictures = pictures.map(|(index, some)| {
        let first = index * MAX_PICTURES + 1;
        let panels: Vec<Panel> = some.iter().map(pictures::panel).collect();
        Figure {
            title: format!(
                "Periodograms {first} to {} of {}",
                first + some.len() - 1,
                subjects.len()
            ),
            rows: panels.chunks(IN_A_ROW).map(<[Panel]>::to_vec).collect(),
        }
    });
    std::iter::once(curves).chain(pictures).collect()
}

fn title(analysis: &Analysis) -> String {
    match analysis.subjects.as_slice() {
        [subject] => format!("Analysis of {}", subject.label),
        _ if analysis.averaged => "Analysis of averages".to_owned(),
        subjects => format!("Analysis of {} sets", subjects.len()),
    }
}

fn look(analysis: &Analysis, index: usize) -> Look {
    match (analysis.against, index) {
        (true, 0) => Look::Reference,
        (true, _) => Look::Numbered(index - 1),
        (false, _) => Look::Numbered(index),
    }
}

/// Returns the row of spectra, and the pair correlation.
fn curve_rows(analysis: &Analysis) -> (Vec<Vec<Panel>>, Panel) {
    let subjects = &analysis.subjects;
    let name = |index: usize| match look(analysis, index) {
        Look::Reference => format!("{} (reference)", subjects[index].label),
        Look::Numbered(_) => subjects[index].label.clone(),
    };
    let all = |curve: fn(&Subject) -> Vec<Place>| -> Vec<Series> {
        let each = subjects.iter().enumerate();
        let each = each
            .map(|(index, subject)| series(name(index), look(analysis, index), &curve(subject)));
        each.filter(|series| !series.points.is_empty()).collect()
    };
    let spectra = [
        power(all(Subject::power)),
        anisotropy(all(Subject::anisotropy), subjects),
    ];
    let spectra = spectra.into_iter().filter(|chart| !chart.series.is_empty());
    let pairs = Panel::Lines(correlation(all(Subject::correlation)));
    (vec![spectra.map(Panel::Lines).collect()], pairs)
}

/// Returns the differences of all subjects from the reference, if there are any.
fn difference_row(analysis: &Analysis) -> Option<Vec<Panel>> {
    let subjects = analysis.held();
    let all = |curve: fn(&Comparison) -> &DifferenceCurve| -> Vec<Series> {
        // Without a reference there are no comparisons.
        let each = subjects.iter().zip(&analysis.comparisons).enumerate();
        each.map(|(index, (subject, comparison))| {
            let curve = curve(comparison);
            let places = places(&curve.places, curve.bands.as_ref());
            series(subject.label.clone(), Look::Numbered(index), &places)
        })
        .filter(|series| !series.points.is_empty())
        .collect()
    };
    let charts = [
        difference(
            "Difference of radial mean power",
            FREQUENCY,
            "\u{394}P(\u{3bd})",
            all(|comparison| &comparison.power),
        ),
        difference(
            "Difference of pair correlation",
            DISTANCE,
            "\u{394}g(r)",
            all(|comparison| &comparison.pairs),
        ),
    ];
    let charts = charts.into_iter().filter(|chart| !chart.series.is_empty());
    let row: Vec<Panel> = charts.map(Panel::Lines).collect();
    (!row.is_empty()).then_some(row)
}

fn difference(title: &str, x: &str, y: &str, series: Vec<Series>) -> LineChart {
    LineChart {
        title: title.to_owned(),
        x: from_zero(x, &series),
        y: cut_difference(y, &series),
        levels: vec![Level {
            name: "no difference".to_owned(),
            y: 0.0,
        }],
        series,
    }
}

fn series(name: String, look: Look, places: &[Place]) -> Series {
    let band: Vec<[f64; 2]> = places.iter().filter_map(|place| place.band).collect();
    Series {
        name,
        look,
        points: places.iter().map(|place| [place.x, place.y]).collect(),
        band: (band.len() == places.len()).then_some(band),
    }
}

fn highest(series: &[Series]) -> f64 {
    (series.iter().flat_map(|series| &series.points))
        .map(|point| point[1].abs())
        .fold(0.0, f64::max)
}

/// Returns the ends of all bands: the lowest, at most 0, and the highest, at least 0.
fn ends_of_bands(series: &[Series]) -> [f64; 2] {
    let bands = series.iter().filter_map(|series| series.band.as_ref());
    (bands.flatten()).fold([0.0, 0.0], |[low, high], band| {
        [band[0].min(low), band[1].max(high)]
    })
}

/// Returns an axis of what cannot be negative: it cuts off high peaks, and bands that would dwarf their curves.
fn cut(label: &str, series: &[Series]) -> Axis {
    let top = highest(series);
    if top > MAX_PEAK {
        return Axis::new(format!("{label}, cut off at {MAX_PEAK}")).with_range(0.0, MAX_PEAK);
    }
    let [low, high] = ends_of_bands(series);
    if top > 0.0 && high > MAX_BAND * top {
        return Axis::new(format!("{label}, bands cut off")).with_range(0.0, MAX_BAND * top);
    }
    if low < 0.0 {
        return Axis::new(label).with_range(0.0, 1.05 * high.max(top).max(1.0));
    }
    Axis::new(label)
}

fn cut_difference(label: &str, series: &[Series]) -> Axis {
    let [low, high] = ends_of_bands(series);
    let (what, far) = match highest(series) {
        far if far > MAX_FREQUENCY => ("", far),
        _ => ("bands ", high.max(-low)),
    };
    if far > MAX_FREQUENCY {
        return Axis::new(format!("{label}, {what}cut off at \u{b1}{MAX_FREQUENCY}"))
            .with_range(-MAX_FREQUENCY, MAX_FREQUENCY);
    }
    Axis::new(label)
}

fn noise(y: f64) -> Level {
    Level {
        name: "white noise".to_owned(),
        y,
    }
}

fn power(series: Vec<Series>) -> LineChart {
    LineChart {
        title: "Radial mean power".to_owned(),
        x: from_zero(FREQUENCY, &series),
        y: cut("power P(\u{3bd})", &series),
        levels: vec![noise(1.0)],
        series,
    }
}

/// A mean of K sets without preferred directions has a level of its own: one line for each K.
fn anisotropy(series: Vec<Series>, subjects: &[Subject]) -> LineChart {
    let mut sets: Vec<u64> = subjects.iter().map(Subject::sets).collect();
    sets.sort_unstable();
    sets.dedup();
    let formula = "\u{2212}10 log\u{2081}\u{2080} K";
    // Several names share a line: the first has the formula.
    let what = if sets.len() == 1 {
        "no preferred direction: "
    } else {
        ""
    };
    let levels: Vec<Level> = (sets.iter().enumerate())
        .map(|(index, sets)| Level {
            name: match (index, sets) {
                (0, 1) => format!("{what}{formula}, K = 1 set"),
                (0, _) => format!("{what}{formula}, K = {sets} sets"),
                _ => format!("K = {sets} sets"),
            },
            y: anisotropy_reference_db(*sets),
        })
        .collect();
    LineChart {
        title: "Anisotropy".to_owned(),
        x: from_zero(FREQUENCY, &series),
        y: anisotropy_axis(subjects, &levels),
        levels,
        series,
    }
}

/// Returns an axis as long as the anisotropies of many frequencies ask for.
fn anisotropy_axis(subjects: &[Subject], levels: &[Level]) -> Axis {
    let annuli = subjects
        .iter()
        .flat_map(|subject| &subject.spectrum.profile.annuli);
    let annuli = annuli.filter(|annulus| annulus.anisotropy_db.is_finite());
    let all = annuli.map(|annulus| (annulus.count, annulus.anisotropy_db));
    range_of_many(all, levels.iter().map(|level| level.y))
}

fn range_of_many(all: impl Iterator<Item = (u64, f64)>, levels: impl Iterator<Item = f64>) -> Axis {
    let label = "anisotropy, dB";
    let wider = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
    let nothing = [f64::INFINITY, f64::NEG_INFINITY];
    let (mut few, mut many) = (nothing, nothing);
    for (count, value) in all {
        if count < FEW {
            few = wider(few, value);
        } else {
            many = wider(many, value);
        }
    }
    if many[0] > many[1] {
        return Axis::new(label);
    }
    let many = levels.fold(many, wider);
    let spare = (0.05 * (many[1] - many[0])).max(0.5);
    let range = [many[0] - spare, many[1] + spare];
    let cut = few[0] < range[0] || few[1] > range[1];
    let label = if cut {
        format!("{label}; few frequencies cut off")
    } else {
        label.to_owned()
    };
    Axis::new(label).with_range(range[0], range[1])
}

fn correlation(series: Vec<Series>) -> LineChart {
    LineChart {
        title: "Pair correlation".to_owned(),
        x: from_zero(DISTANCE, &series),
        y: cut("g(r)", &series),
        levels: vec![noise(1.0)],
        series,
    }
}

fn from_zero(label: &str, series: &[Series]) -> Axis {
    let ends = series.iter().filter_map(|series| series.points.last());
    let end = ends.map(|point| point[0]).fold(0.0, f64::max);
    Axis::new(label).with_range(0.0, end)
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
        assert_eq!(difference.range, Some([-MAX_FREQUENCY, MAX_FREQUENCY]));
        assert_eq!(cut_difference("d", &[curve(0.1, [-1.0, 1.0])]).range, None);
    }

    #[test]
    fn a_handful_of_frequencies_does_not_stretch_the_axis_of_anisotropy() {
        let axis = |all: &[(u64, f64)]| range_of_many(all.iter().copied(), std::iter::once(0.0));
        let many = [(50, -1.0), (400, 1.0)];
        let with_few = [(4, -12.0), (50, -1.0), (400, 1.0)];
        assert_eq!(axis(&with_few).range, axis(&many).range);
        assert_eq!(axis(&many).range, Some([-1.5, 1.5]));
        assert!(axis(&with_few).label.contains("cut off"));
        assert!(!axis(&many).label.contains("cut off"));
        assert_eq!(axis(&with_few[..1]).range, None, "nothing else is there");
    }
}
