//! All numbers as CSV, with one number a line, and as JSON.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;
use serde_json::{Value, json};
use tilescope_analysis::{BYTE_ORDER_MARK, cell};

use super::curve::Curve;
use super::differences::Differences;
use super::gather::Analysis;
use super::measure::{Measure, Spread};
use super::subject::Subject;

/// Returns the numbers as CSV, one a line; measures have no x. The measures of files precede those of their average.
/// Differences of measures have no lines, as they follow from those of the two subjects; differences of curves have
/// lines, and so have their measures. The table can be opened in a spreadsheet: it begins with a byte-order mark, and
/// no name in it is a formula.
pub fn csv(analysis: &Analysis) -> String {
    let mut out = format!("{BYTE_ORDER_MARK}file,measure,x,y,lower,upper\n");
    for (index, subject) in analysis.subjects.iter().enumerate() {
        // A single set has the measures of its only file.
        for member in subject.members.iter().filter(|_| subject.average) {
            csv_measures(&mut out, &quoted(&member.name), &member.measures);
        }
        let name = quoted(&subject.name);
        csv_measures(&mut out, &name, &subject.measures);
        csv_curves(&mut out, &name, &subject.curves);
        // The reference, which comes first, does not differ from itself.
        let compared = index.checked_sub(usize::from(analysis.has_reference));
        if let Some(of) = compared.and_then(|index| analysis.differences.get(index)) {
            csv_measures(&mut out, &name, &of.of_curves);
            csv_curves(&mut out, &name, &of.curves);
        }
    }
    out
}

/// Appends the measures of a set or an average in CSV.
pub fn csv_measures(out: &mut String, name: &str, measures: &[Measure]) {
    for measure in measures {
        // A measure that is not defined has no line.
        let Some(value) = measure.value else {
            continue;
        };
        let key = &measure.key;
        let Some(spread) = measure.spread else {
            let _ = writeln!(out, "{name},{key},,{value},,");
            continue;
        };
        let [lower, upper] = spread.band;
        let error = spread.standard_error;
        let _ = writeln!(out, "{name},{key},,{value},{lower},{upper}");
        let _ = writeln!(out, "{name},{key}_standard_error,,{error},,");
        let _ = writeln!(out, "{name},{key}_least,,{},,", spread.least);
        let _ = writeln!(out, "{name},{key}_most,,{},,", spread.most);
    }
}

/// Appends curves in CSV.
pub fn csv_curves(out: &mut String, name: &str, curves: &[(&str, Curve)]) {
    for (key, curve) in curves {
        for (index, [x, y]) in curve.points.iter().enumerate() {
            let band = curve.bands.as_ref().map(|bands| bands[index]);
            let ends = band.map_or_else(|| ",".to_owned(), |[low, high]| format!("{low},{high}"));
            let _ = writeln!(out, "{name},{key},{x},{y},{ends}");
        }
    }
}

/// Returns a name as a cell of CSV.
pub fn quoted(name: &str) -> String {
    let name = cell(name);
    if name.contains([',', '"', '\n', '\r']) {
        return format!("\"{}\"", name.replace('"', "\"\""));
    }
    name.into_owned()
}

/// Returns the whole analysis as one object; `saved` is the path of the report.
pub fn json(analysis: &Analysis, saved: Option<&str>) -> Value {
    let subjects = analysis.compared().iter().enumerate();
    let mut compared =
        subjects.map(|(index, subject)| subject_json(subject, analysis.differences.get(index)));

    // An average is the only subject that is compared; its files have numbers of their own.
    let (average, files) = if analysis.averaged {
        let members = analysis.compared().iter().flat_map(|one| &one.members);
        (compared.next(), json!(members.collect::<Vec<_>>()))
    } else {
        (None, compared.collect())
    };

    // Files of an average stand beside it, whether it is compared or the reference.
    let against = analysis.reference().map(|subject| {
        let mut object = subject_json(subject, None);
        if subject.average {
            object["files"] = json!(subject.members);
        }
        object
    });

    json!({
        "files": files,
        "average": average,
        "against": against,
        "failures": analysis.failures,
        "notes": analysis.notes,
        "report": saved,
    })
}

/// Returns an object of values by their names.
fn object<'a, T: Serialize>(pairs: impl IntoIterator<Item = (&'a str, T)>) -> Value {
    json!(pairs.into_iter().collect::<BTreeMap<_, _>>())
}

/// Returns the measures and curves of a set or of an average, and their differences from the reference.
fn subject_json(subject: &Subject, differences: Option<&Differences>) -> Value {
    let mut json = match subject.members.as_slice() {
        [member] if !subject.average => json!(member),
        // An average has this form even where only one of its files could be used, so that programs find its fields.
        members => json!({
            "sets": members.len(),
            "region": subject.region,
            "measures": object(subject.measures.iter().map(mean_json)),
        }),
    };

    json["label"] = json!(subject.label);
    json["curves"] = curves_json(&subject.curves);
    if let Some(differences) = differences {
        add_differences(&mut json, differences);
    }
    json
}

/// Returns curves by their names.
fn curves_json(all: &[(&'static str, Curve)]) -> Value {
    object(all.iter().map(|(key, curve)| (*key, curve.json())))
}

/// Adds the differences from the reference to the object of a set or of an average.
pub fn add_differences(json: &mut Value, differences: &Differences) {
    let each = (differences.measures.iter()).map(|one| (one.measure.key.as_str(), one));
    let values = each.clone().map(|(key, one)| (key, one.value));
    let of_curves = (differences.of_curves.iter()).map(|own| (own.key.as_str(), own.value));
    json["differences"] = object(values.chain(of_curves));
    json["curves_of_differences"] = curves_json(&differences.curves);

    let errors = object(each.filter_map(|(key, one)| Some((key, one.standard_error?))));
    // Two single sets have no spread, and their differences no errors.
    if errors != json!({}) {
        json["standard_errors_of_differences"] = errors;
    }
}

fn mean_json(measure: &Measure) -> (&str, Value) {
    let spread_of = |value: fn(&Spread) -> f64| measure.spread.as_ref().map(value);
    let mean = json!({
        "mean": measure.value,
        "standard_error": spread_of(|spread| spread.standard_error),
        "lower": spread_of(|spread| spread.band[0]),
        "upper": spread_of(|spread| spread.band[1]),
        "least": spread_of(|spread| spread.least),
        "most": spread_of(|spread| spread.most),
    });
    (measure.key.as_str(), mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_break_csv() {
        assert_eq!(quoted("a,\"b\".csv"), "\"a,\"\"b\"\".csv\"");
        assert_eq!(quoted("a b.csv"), "a b.csv");
        assert_eq!(quoted("=1+1.csv"), "'=1+1.csv");
        assert_eq!(quoted("=a,b"), "\"'=a,b\"");
    }
}
