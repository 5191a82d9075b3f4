//! How subjects differ from the one they are held against: value less reference, number by number and along curves.

use tilescope_analysis::measures::{DifferenceCurve, MeasureError};

use super::scalars::Scalar;
use super::subject::{Number, Subject};
use super::table::{Row, Table};

/// The differences of one subject.
pub struct Comparison {
    /// Those of its numbers; none where either is not defined.
    pub numbers: Vec<(Scalar, Option<Difference>)>,
    pub power: DifferenceCurve,
    pub pairs: DifferenceCurve,
}

/// The difference of two numbers.
#[derive(Clone, Copy)]
pub struct Difference {
    pub value: f64,
    /// From the spread between sets, where both have one.
    pub standard_error: Option<f64>,
}

impl Comparison {
    /// Returns how a subject differs from the reference.
    pub fn of(subject: &Subject, reference: &Subject) -> Result<Self, MeasureError> {
        let [power, pairs] = subject.less(reference)?;
        let base = |key: &str| {
            let mut numbers = reference.numbers.iter();
            numbers.find(|number| number.scalar.key == key)
        };
        let numbers = subject.numbers.iter().map(|number| {
            let base = base(number.scalar.key);
            let difference = base.and_then(|base| difference(number, base));
            (number.scalar.clone(), difference)
        });
        Ok(Self {
            numbers: numbers.collect(),
            power,
            pairs,
        })
    }

    /// Returns what is said of the curves' differences.
    pub fn of_curves(&self) -> Vec<Scalar> {
        [(&self.power, &POWER), (&self.pairs, &PAIRS)]
            .into_iter()
            .flat_map(|(curve, names)| of_curve(curve, names))
            .collect()
    }
}

fn difference(number: &Number, base: &Number) -> Option<Difference> {
    let error = |number: &Number| number.spread.map(|spread| spread.standard_error);
    Some(Difference {
        value: number.scalar.value? - base.scalar.value?,
        standard_error: (error(number).zip(error(base))).map(|(a, b)| a.hypot(b)),
    })
}

/// Key, label and unit of what is said of a curve.
type Names = [(&'static str, &'static str, &'static str); 4];

const POWER: Names = [
    (
        "power_difference_rms",
        "radial mean power: RMS difference",
        "",
    ),
    ("power_difference_largest", "largest difference", ""),
    ("power_difference_largest_at", "where that is", "nu"),
    (
        "power_difference_outside",
        "annuli outside the band (5 by chance)",
        "%",
    ),
];
const PAIRS: Names = [
    (
        "pair_correlation_difference_rms",
        "pair correlation: RMS difference",
        "",
    ),
    (
        "pair_correlation_difference_largest",
        "largest difference",
        "",
    ),
    (
        "pair_correlation_difference_largest_at",
        "where that is",
        "r_max",
    ),
    (
        "pair_correlation_difference_outside",
        "bins outside the band (5 by chance)",
        "%",
    ),
];

fn of_curve(curve: &DifferenceCurve, names: &Names) -> Vec<Scalar> {
    let largest = curve.largest();
    let values = [
        (curve.rms(), 4),
        (largest.map(|place| place[1]), 4),
        (largest.map(|place| place[0]), 3),
        (curve.outside().map(|share| 100.0 * share), 1),
    ];
    (names.iter().zip(values))
        .map(|((key, label, unit), (value, decimals))| Scalar {
            key,
            label,
            unit,
            value,
            decimals,
        })
        .collect()
}

/// Returns the table of differences.
pub fn table(reference: &Subject, subjects: &[Subject], comparisons: &[Comparison]) -> Table {
    let Some(first) = comparisons.first() else {
        return Table::default();
    };
    let numbers = first.numbers.iter().enumerate();
    let numbers = numbers.map(|(index, (scalar, _))| Row {
        label: scalar.label.to_owned(),
        unit: scalar.unit,
        cells: (comparisons.iter())
            .map(|comparison| signed(&comparison.numbers[index]))
            .collect(),
    });
    let curves: Vec<Vec<Scalar>> = comparisons.iter().map(Comparison::of_curves).collect();
    let curves = (0..curves[0].len()).map(|index| Row {
        label: curves[0][index].label.to_owned(),
        unit: curves[0][index].unit,
        cells: (curves.iter())
            .map(|column| unsigned(&column[index]))
            .collect(),
    });
    Table {
        head: format!("less {}", reference.label),
        names: (subjects.iter())
            .map(|subject| subject.label.clone())
            .collect(),
        rows: numbers.chain(curves).collect(),
        joined: Vec::new(),
    }
}

fn signed((scalar, difference): &(Scalar, Option<Difference>)) -> String {
    let Some(difference) = difference else {
        return "-".to_owned();
    };
    let decimals = scalar.decimals;
    match difference.standard_error {
        None => format!("{:+.decimals$}", difference.value),
        Some(error) => format!(
            "{:+.more$} \u{b1} {error:.more$}",
            difference.value,
            more = decimals + 1
        ),
    }
}

fn unsigned(scalar: &Scalar) -> String {
    let text = |value| format!("{value:.*}", scalar.decimals);
    scalar.value.map_or_else(|| "-".to_owned(), text)
}
