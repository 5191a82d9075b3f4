//! All numbers for programs: CSV in long form, JSON.

use std::fmt::Write;

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::curve::Curve;
use super::differences::Differences;
use super::gather::Analysis;
use super::measure::{Measure, Spread};
use super::measured::Member;
use super::subject::Subject;

/// Returns all numbers, one a line: measures have no x. The measures of a file come before those of its average.
pub fn csv(analysis: &Analysis) -> String {
    let mut out = "file,measure,x,y,lower,upper\n".to_owned();
    for (index, subject) in analysis.subjects.iter().enumerate() {
        for member in subject.members.iter().filter(|_| subject.average) {
            csv_measures(&mut out, &quoted(&member.name), &member.measures);
        }
        let name = quoted(&subject.name);
        csv_measures(&mut out, &name, &subject.measures);
        csv_curves(&mut out, &name, &subject.curves);
        let compared = index.checked_sub(usize::from(analysis.has_reference));
        if let Some(of) = compared.and_then(|index| analysis.differences.get(index)) {
            csv_measures(&mut out, &name, &of.of_curves);
            csv_curves(&mut out, &name, &of.curves);
        }
    }
    out
}

fn csv_measures(out: &mut String, name: &str, measures: &[Measure]) {
    for measure in measures {
        let (key, Some(value)) = (&measure.key, measure.value) else {
            continue;
        };
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

fn csv_curves(out: &mut String, name: &str, curves: &[(&str, Curve)]) {
    for (key, curve) in curves {
        for (index, (x, y)) in curve.x.iter().zip(&curve.y).enumerate() {
            let _ = write!(out, "{name},{key},{x},{y}");
            let _ = match &curve.band {
                Some(band) => writeln!(out, ",{},{}", band.lower[index], band.upper[index]),
                None => writeln!(out, ",,"),
            };
        }
    }
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        return format!("\"{}\"", name.replace('"', "\"\""));
    }
    name.to_owned()
}

/// Returns the whole analysis as one object; `saved` is the report.
pub fn json(analysis: &Analysis, saved: Option<&str>) -> Value {
    let compared = analysis.compared().iter().enumerate();
    let mut compared = compared.map(|(index, subject)| {
        let mut object = subject_json(subject);
        if let Some(differences) = analysis.differences.get(index) {
            object.extend(differences_json(differences));
        }
        Value::Object(object)
    });
    let (files, average) = if analysis.averaged {
        let average = compared.next();
        let members = analysis.compared().iter().flat_map(|s| &s.members);
        (
            members.map(member_json).map(Value::Object).collect(),
            average,
        )
    } else {
        (compared.collect::<Vec<Value>>(), None)
    };
    let against = analysis.reference().map(|subject| {
        let mut object = subject_json(subject);
        if subject.average {
            let members: Vec<_> = subject.members.iter().map(member_json).collect();
            object.insert("files".to_owned(), json!(members));
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

/// An object of values by their names.
type Object = Map<String, Value>;

fn object<'a, T: Serialize>(pairs: impl IntoIterator<Item = (&'a str, T)>) -> Object {
    let pairs = pairs.into_iter();
    let pairs = pairs.map(|(key, value)| (key.to_owned(), json!(value)));
    pairs.collect()
}

fn values(measures: &[Measure]) -> Object {
    object(measures.iter().map(|own| (own.key.as_str(), own.value)))
}

fn member_json(member: &Member) -> Object {
    let mut map = values(&member.measures);
    map.extend(object([
        ("file", json!(member.name)),
        ("samples", json!(member.samples)),
        ("region", json!(member.region)),
        ("format", json!(member.format.to_string())),
        ("radius_known", json!(member.has_radius)),
        ("valid", json!(member.valid)),
    ]));
    map
}

/// Returns the measures and curves of a set or of an average.
fn subject_json(subject: &Subject) -> Object {
    let mut map = match subject.members.as_slice() {
        [member] if !subject.average => member_json(member),
        members => object([
            ("sets", json!(members.len())),
            ("region", json!(subject.region)),
            (
                "measures",
                json!(object(subject.measures.iter().map(mean_json))),
            ),
        ]),
    };
    map.extend(object([
        ("label", json!(subject.label)),
        (
            "curves",
            json!(object(
                subject.curves.iter().map(|(key, curve)| (*key, curve))
            )),
        ),
    ]));
    map
}

fn mean_json(measure: &Measure) -> (&str, Value) {
    let of = |value: fn(&Spread) -> f64| measure.spread.as_ref().map(value);
    let mean = json!({
        "mean": measure.value,
        "standard_error": of(|spread| spread.standard_error),
        "lower": of(|spread| spread.band[0]),
        "upper": of(|spread| spread.band[1]),
        "least": of(|spread| spread.least),
        "most": of(|spread| spread.most),
    });
    (measure.key.as_str(), mean)
}

fn differences_json(differences: &Differences) -> Object {
    let each = differences.measures.iter();
    let mut all = object(
        each.clone()
            .map(|one| (one.measure.key.as_str(), one.value)),
    );
    all.extend(values(&differences.of_curves));
    let errors =
        object(each.filter_map(|one| Some((one.measure.key.as_str(), one.standard_error?))));
    let curves = object(differences.curves.iter().map(|(key, curve)| (*key, curve)));
    let mut map = object([("differences", all), ("curves_of_differences", curves)]);
    if !errors.is_empty() {
        map.extend(object([("standard_errors_of_differences", errors)]));
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_break_csv() {
        assert_eq!(quoted("a,\"b\".csv"), "\"a,\"\"b\"\".csv\"");
        assert_eq!(quoted("a b.csv"), "a b.csv");
    }
}
