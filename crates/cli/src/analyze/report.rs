//! Reports: HTML that needs nothing from elsewhere, CSV in long form, JSON of one set.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use super::measured::{Measured, Place};
use super::scalars::scalars;
use super::table::{self, Table};
use super::{Analysis, differences};

/// The curves of a set by their names in CSV and JSON.
fn curves(set: &Measured) -> [(&'static str, Vec<Place>); 3] {
    [
        ("power", set.power()),
        ("anisotropy_db", set.anisotropy()),
        ("pair_correlation", set.correlation()),
    ]
}

/// Returns all numbers, one a line: those of the table have no x.
pub fn csv(analysis: &Analysis) -> String {
    let mut out = "file,measure,x,y,lower,upper\n".to_owned();
    for set in &analysis.sets {
        let name = quoted(&set.name);
        for scalar in scalars(set) {
            if let Some(value) = scalar.value {
                let _ = writeln!(out, "{name},{},,{value},,", scalar.key);
            }
        }
        for (measure, places) in curves(set) {
            for Place { x, y, band } in places {
                let [lower, upper] = band.map_or([const { String::new() }; 2], |band| {
                    band.map(|end| end.to_string())
                });
                let _ = writeln!(out, "{name},{measure},{x},{y},{lower},{upper}");
            }
        }
    }
    out
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        return format!("\"{}\"", name.replace('"', "\"\""));
    }
    name.to_owned()
}

/// Returns the numbers and curves of a set.
pub fn json(set: &Measured) -> Value {
    let scalars = scalars(set).into_iter();
    let mut map: Map<String, Value> = scalars
        .map(|scalar| (scalar.key.to_owned(), json!(scalar.value)))
        .collect();
    map.insert("file".to_owned(), json!(set.name));
    map.insert("samples".to_owned(), json!(set.report.count));
    map.insert("region".to_owned(), json!(set.region));
    map.insert("radius_known".to_owned(), json!(set.certain));
    let valid = set.certain.then(|| set.report.valid());
    map.insert("valid".to_owned(), json!(valid));
    let curves: Map<String, Value> = curves(set)
        .into_iter()
        .map(|(name, places)| (name.to_owned(), curve_json(&places)))
        .collect();
    map.insert("curves".to_owned(), Value::Object(curves));
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

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;color:#1a1d21;margin:2rem auto;max-width:1240px;padding:0 1rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:1rem 0}\
th,td{padding:.2rem .8rem;border-bottom:1px solid #d5dae0;text-align:right}\
th:first-child,td:first-child,td:nth-child(2),th:nth-child(2){text-align:left}\
thead th{border-bottom:2px solid #5b6470}svg{max-width:100%;height:auto}\
pre{background:#f6f7f9;padding:.8rem;overflow-x:auto}.wide{overflow-x:auto}";

/// Returns a page with the tables, the figure and the command that made it.
pub fn html(analysis: &Analysis, svg: &str) -> String {
    let title = "Analysis of point sets";
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    page_table(&mut out, &table::measures(&analysis.sets, analysis.against));
    if let Some(reference) = analysis.reference() {
        out.push_str("<h2>Differences</h2>\n");
        page_table(
            &mut out,
            &differences::table(reference, &analysis.sets[1..]),
        );
    }
    let _ = write!(
        out,
        "<h2>Curves</h2>\n<div class=\"wide\">\n{svg}</div>\n{NOTES}"
    );
    if !analysis.failures.is_empty() {
        out.push_str("<h2>Not analysed</h2>\n<ul>\n");
        for failure in &analysis.failures {
            let _ = writeln!(out, "<li>{}</li>", escaped(&failure.reason));
        }
        out.push_str("</ul>\n");
    }
    let _ = write!(
        out,
        "<h2>Command</h2>\n<pre>{}</pre>\n<p>tilescope {}</p>\n</body>\n</html>\n",
        escaped(&command_line(std::env::args().skip(1))),
        env!("CARGO_PKG_VERSION")
    );
    out
}

const NOTES: &str = "<p>Frequencies are given as nu = |k| / sqrt(N), distances over r_max, the smallest distance in \
the hexagonal lattice of as many samples. The shaded bands hold the true mean power with probability 0.95 where \
frequencies are independent; bounded sets are tapered and have none. Periodograms leave the zero \
frequency out; where it has a cell of its own, a ring marks it.</p>\n";

fn page_table(out: &mut String, table: &Table) {
    let _ = write!(
        out,
        "<div class=\"wide\"><table>\n<thead><tr><th>{}</th><th>unit</th>",
        escaped(&table.head)
    );
    for name in &table.names {
        let _ = write!(out, "<th>{}</th>", escaped(name));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        let _ = write!(out, "<tr><td>{}</td><td>{}</td>", row.label, row.unit);
        for cell in &row.cells {
            let _ = write!(out, "<td>{}</td>", escaped(cell));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            _ => out.push(letter),
        }
    }
    out
}

/// Returns the command as a shell takes it.
fn command_line(arguments: impl Iterator<Item = String>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+,:@%".contains(c);
    let mut line = "tilescope".to_owned();
    for argument in arguments {
        line.push(' ');
        if !argument.is_empty() && argument.chars().all(plain) {
            line.push_str(&argument);
        } else {
            let _ = write!(line, "'{}'", argument.replace('\'', "'\\''"));
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_break_neither_csv_nor_markup_nor_shell() {
        assert_eq!(quoted("a,\"b\".csv"), "\"a,\"\"b\"\".csv\"");
        assert_eq!(quoted("a b.csv"), "a b.csv");
        assert_eq!(escaped("<b>&\""), "&lt;b&gt;&amp;&quot;");
        let words = ["analyze", "it's here.csv", ""].map(str::to_owned);
        let line = command_line(words.into_iter());
        assert_eq!(line, "tilescope analyze 'it'\\''s here.csv' ''");
    }
}
