//! All numbers for programs: CSV in long form, JSON.

use std::fmt::Write;

use serde_json::{Map, Value, json};
use tilescope_analysis::measures::DifferenceCurve;

use super::differences::Comparison;
use super::gather::Analysis;
use super::measured::Member;
use super::subject::{Number, Place, Subject, places};

/// The curves of a subject by their names in CSV and JSON.
fn curves(subject: &Subject) -> [(&'static str, Vec<Place>); 3] {
    [
        ("power", subject.power()),
        ("anisotropy_db", subject.anisotropy()),
        ("pair_correlation", subject.correlation()),
    ]
}

fn difference_curves(comparison: &Comparison) -> [(&'static str, Vec<Place>); 2] {
    let of = |curve: &DifferenceCurve| places(&curve.places, curve.bands.as_ref());
    [
        ("power_difference", of(&comparison.power)),
        ("pair_correlation_difference", of(&comparison.pairs)),
    ]
}

/// Returns all numbers, one a line: those of the table have no x. A file's come first, then those of its average.
pub fn csv(analysis: &Analysis) -> String {
    let mut out = "file,measure,x,y,lower,upper\n".to_owned();
    for (index, subject) in analysis.subjects.iter().enumerate() {
        if subject.average {
            for member in &subject.members {
                csv_member(&mut out, member);
            }
        }
        let name = quoted(&subject.name);
        for number in &subject.numbers {
            csv_number(&mut out, &name, number);
        }
        for (measure, places) in curves(subject) {
            csv_curve(&mut out, &name, measure, &places);
        }
        let held = index.checked_sub(usize::from(analysis.against));
        if let Some(comparison) = held.and_then(|held| analysis.comparisons.get(held)) {
            csv_comparison(&mut out, &name, comparison);
        }
    }
    out
}

fn csv_member(out: &mut String, member: &Member) {
    let name = quoted(&member.name);
    for scalar in &member.scalars {
        if let Some(value) = scalar.value {
            let _ = writeln!(out, "{name},{},,{value},,", scalar.key);
        }
    }
}

fn csv_number(out: &mut String, name: &str, number: &Number) {
    let (key, Some(value)) = (number.scalar.key, number.scalar.value) else {
        return;
    };
    let Some(spread) = number.spread else {
        let _ = writeln!(out, "{name},{key},,{value},,");
        return;
    };
    let [lower, upper] = spread.band;
    let _ = writeln!(out, "{name},{key},,{value},{lower},{upper}");
    for (what, value) in [
        ("standard_error", spread.standard_error),
        ("least", spread.least),
        ("most", spread.most),
    ] {
        let _ = writeln!(out, "{name},{key}_{what},,{value},,");
    }
}

fn csv_curve(out: &mut String, name: &str, measure: &str, places: &[Place]) {
    for Place { x, y, band } in places {
        let [lower, upper] = band.map_or([const { String::new() }; 2], |band| {
            band.map(|end| end.to_string())
        });
        let _ = writeln!(out, "{name},{measure},{x},{y},{lower},{upper}");
    }
}

fn csv_comparison(out: &mut String, name: &str, comparison: &Comparison) {
    for scalar in comparison.of_curves() {
        if let Some(value) = scalar.value {
            let _ = writeln!(out, "{name},{},,{value},,", scalar.key);
        }
    }
    for (measure, places) in difference_curves(comparison) {
        csv_curve(out, name, measure, &places);
    }
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        return format!("\"{}\"", name.replace('"', "\"\""));
    }
    name.to_owned()
}

/// Returns everything that was found out as one object; `saved` is the report.
pub fn json(analysis: &Analysis, saved: Option<&str>) -> Value {
    let mut held = analysis.held().iter().zip(0..).map(|(subject, index)| {
        let mut object = subject_json(subject);
        if let (Some(comparison), Some(map)) =
            (analysis.comparisons.get(index), object.as_object_mut())
        {
            add_differences(map, comparison);
        }
        object
    });
    let (files, average) = if analysis.averaged {
        let members = analysis.held().iter().flat_map(|subject| &subject.members);
        let files = members.map(|member| Value::Object(member_json(member)));
        (files.collect(), held.next())
    } else {
        (held.collect::<Vec<Value>>(), None)
    };
    let failures: Vec<Value> = (analysis.failures.iter())
        .map(|failure| json!({ "file": failure.name, "reason": failure.reason }))
        .collect();
    json!({
        "files": files,
        "average": average,
        "against": analysis.reference().map(|subject| {
            let mut object = subject_json(subject);
            if subject.average {
                let members = subject.members.iter().map(member_json);
                object["files"] = members.map(Value::Object).collect();
            }
            object
        }),
        "failures": failures,
        "notes": analysis.notes,
        "report": saved,
    })
}

fn member_json(member: &Member) -> Map<String, Value> {
    let mut map: Map<String, Value> = (member.scalars.iter())
        .map(|scalar| (scalar.key.to_owned(), json!(scalar.value)))
        .collect();
    map.insert("file".to_owned(), json!(member.name));
    map.insert("samples".to_owned(), json!(member.samples));
    map.insert("region".to_owned(), json!(member.region));
    map.insert("format".to_owned(), json!(member.format.to_string()));
    map.insert("radius_known".to_owned(), json!(member.certain));
    map.insert("valid".to_owned(), json!(member.valid));
    map
}

/// Returns the numbers and curves of a set or of an average.
fn subject_json(subject: &Subject) -> Value {
    let curves = curves_json(&curves(subject));
    let mut map = match subject.members.as_slice() {
        [member] if !subject.average => member_json(member),
        members => {
            let numbers = subject.numbers.iter();
            let numbers: Map<String, Value> = numbers
                .map(|number| (number.scalar.key.to_owned(), number_json(number)))
                .collect();
            let whole = json!({
                "sets": members.len(),
                "region": subject.region,
                "measures": numbers,
            });
            whole.as_object().cloned().unwrap_or_default()
        }
    };
    map.insert("label".to_owned(), json!(subject.label));
    map.insert("curves".to_owned(), curves);
    Value::Object(map)
}

fn number_json(number: &Number) -> Value {
    json!({
        "mean": number.scalar.value,
        "standard_error": number.spread.map(|spread| spread.standard_error),
        "lower": number.spread.map(|spread| spread.band[0]),
        "upper": number.spread.map(|spread| spread.band[1]),
        "least": number.spread.map(|spread| spread.least),
        "most": number.spread.map(|spread| spread.most),
    })
}

fn add_differences(map: &mut Map<String, Value>, comparison: &Comparison) {
    let numbers = comparison.numbers.iter();
    let mut values: Map<String, Value> = numbers
        .map(|(scalar, difference)| {
            let value = difference.map(|difference| difference.value);
            (scalar.key.to_owned(), json!(value))
        })
        .collect();
    for scalar in comparison.of_curves() {
        values.insert(scalar.key.to_owned(), json!(scalar.value));
    }
    let errors = comparison
        .numbers
        .iter()
        .filter_map(|(scalar, difference)| {
            let error = difference.as_ref()?.standard_error?;
            Some((scalar.key.to_owned(), json!(error)))
        });
    let errors: Map<String, Value> = errors.collect();
    map.insert("differences".to_owned(), Value::Object(values));
    if !errors.is_empty() {
        let name = "standard_errors_of_differences".to_owned();
        map.insert(name, Value::Object(errors));
    }
    let curves = curves_json(&difference_curves(comparison));
    map.insert("curves_of_differences".to_owned(), curves);
}

fn curves_json(curves: &[(&'static str, Vec<Place>)]) -> Value {
    let each = curves.iter();
    let map: Map<String, Value> = each
        .map(|(name, places)| ((*name).to_owned(), curve_json(places)))
        .collect();
    Value::Object(map)
}

fn curve_json(places: &[Place]) -> Value {
    let column = |value: &dyn Fn(&Place) -> Option<f64>| -> Vec<Option<f64>> {
        places.iter().map(value).collect()
    };
    let mut curve = json!({
        "x": column(&|place| Some(place.x)),
        "y": column(&|place| Some(place.y)),
    });
    if places.iter().any(|place| place.band.is_some()) {
        curve["lower"] = json!(column(&|place| place.band.map(|band| band[0])));
        curve["upper"] = json!(column(&|place| place.band.map(|band| band[1])));
    }
    curve
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
