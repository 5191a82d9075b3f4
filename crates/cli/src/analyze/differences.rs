//! Differences of a subject from the reference: value minus reference, measure by measure and along curves.

use tilescope_analysis::measures::{DifferenceCurve, MeasureError};

use super::curve::Curve;
use super::measure::{Form, Measure};
use super::subject::Subject;

/// The differences of a subject from the reference.
pub struct Differences {
    /// The differences of its measures.
    pub measures: Vec<Difference>,
    /// Measures of the curves' differences.
    pub of_curves: Vec<Measure>,
    /// The differences of the radial mean power and of the pair correlation, by their names in CSV and JSON.
    pub curves: [(&'static str, Curve); 2],
}

/// The difference of a measure.
pub struct Difference {
    /// The measure of the subject.
    pub measure: Measure,
    /// `None` if one of the two values is not defined.
    pub value: Option<f64>,
    /// From the spread between sets, if both values are means over several.
    pub standard_error: Option<f64>,
}

impl Differences {
    /// Returns how a subject differs from the reference.
    pub fn of(subject: &Subject, reference: &Subject) -> Result<Self, MeasureError> {
        let curves = subject.minus(reference)?;
        let words = ["annuli", "r_max"];
        Ok(Self::between(
            &subject.measures,
            &reference.measures,
            curves,
            words,
        ))
    }

    /// Returns the differences of measures from those of a reference, with those of the radial mean power and of the pair
    /// correlation. The words say what the points of the power are called, and the unit of the correlation's distances.
    pub fn between(
        own: &[Measure],
        reference: &[Measure],
        [power, pairs]: [DifferenceCurve; 2],
        [points, unit]: [&'static str; 2],
    ) -> Self {
        let difference = |measure: &Measure| {
            // Found by its key: averages have measures that single sets lack, so that the same measure may have another
            // index.
            let is_same = |other: &&Measure| other.key == measure.key;
            let base = reference.iter().find(is_same);
            let error = |measure: &Measure| measure.spread.map(|spread| spread.standard_error);
            let values = measure.value.zip(base.and_then(|base| base.value));
            let errors = error(measure).zip(base.and_then(error));
            Difference {
                measure: measure.clone(),
                value: values.map(|(value, base)| value - base),
                // The sets are independent, so that their errors add in quadrature. Without a difference there is no
                // error of it.
                standard_error: errors.map(|(a, b)| a.hypot(b)).filter(|_| values.is_some()),
            }
        };

        let [power_key, pairs_key] = ["power_difference", "pair_correlation_difference"];
        // The labels of each curve: its name, what its points are called, and the unit of its x.
        let of_power = of_curve(&power, power_key, "radial mean power", points, "nu");
        let of_pairs = of_curve(&pairs, pairs_key, "pair correlation", "bins", unit);

        Self {
            measures: own.iter().map(difference).collect(),
            of_curves: of_power.into_iter().chain(of_pairs).collect(),
            curves: [
                (power_key, Curve::new(power.points, power.bands)),
                (pairs_key, Curve::new(pairs.points, pairs.bands)),
            ],
        }
    }
}

/// Returns the measures of a curve of differences. Their keys begin with `key`. The first label has the curve's `name`,
/// as the rows below it belong to the same curve; labels call its points `points`, and its x is in `unit`.
fn of_curve(
    curve: &DifferenceCurve,
    key: &str,
    name: &str,
    points: &str,
    unit: &'static str,
) -> [Measure; 4] {
    let (x_of_largest, largest) = curve.largest().map(|[x, y]| (x, y)).unzip();
    let outside_percent = curve.outside().map(|share| 100.0 * share);

    let (rms_label, at_label) = ("RMS difference", "position of the largest difference");
    // Where two curves differ by chance alone, a point is in the band with probability 0.95.
    let outside_label = format!("{points} outside the band (5 by chance)");
    let measure = |end: &str, label: &str, unit, decimals, value| {
        let form = Form { unit, decimals };
        Measure::new(format!("{key}_{end}"), label.to_owned(), form, value)
    };
    [
        measure("rms", &format!("{name}: {rms_label}"), "", 4, curve.rms()),
        measure("largest", "largest difference", "", 4, largest),
        measure("largest_at", at_label, unit, 3, x_of_largest),
        measure("outside", &outside_label, "%", 1, outside_percent),
    ]
}

impl Difference {
    /// Returns the difference for a table; one with an error has one more decimal.
    pub fn text(&self) -> String {
        let decimals = self.measure.decimals;
        match (self.value, self.standard_error) {
            (None, _) => "-".to_owned(),
            (Some(value), None) => format!("{value:+.decimals$}"),
            (Some(value), Some(error)) => {
                format!("{value:+.more$} \u{b1} {error:.more$}", more = decimals + 1)
            }
        }
    }
}
