//! The words of reports, read from `assets/experiments`: claims, tables, charts, captions and notes, with placeholders
//! for the measurements. Code gives the numbers and the verdicts. `assets/experiments/README.md` describes the files.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;
use serde_json::Value;
use tilescope_figures::chart::{Axis, LineChart, Series};

use crate::numbers::{chance, number, percent, readable, signed};
use crate::outcome::{Cell, Claim, Column, Table, Verdict};

/// The texts of an experiment, by their names.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Words {
    /// Notes, captions, and parts of other texts.
    texts: BTreeMap<String, String>,
    claims: BTreeMap<String, ClaimText>,
    tables: BTreeMap<String, TableText>,
    charts: BTreeMap<String, ChartText>,
    pictures: BTreeMap<String, PictureText>,
}

/// The fields of a [`Claim`]; `here` has the measurement, `rule` the reason of the verdict.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ClaimText {
    claim: String,
    place: String,
    paper: String,
    here: String,
    rule: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TableText {
    title: String,
    /// Long tables are for data files alone.
    #[serde(default)]
    hidden: bool,
    /// A column whose key ends with `?` may be missing.
    columns: Vec<Column>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChartText {
    title: String,
    x: String,
    y: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureText {
    pub title: String,
    pub caption: String,
    /// The quantity of bars.
    #[serde(default)]
    pub axis: String,
}

macro_rules! file {
    ($experiment:literal) => {
        (
            $experiment,
            include_str!(concat!(
                "../../../assets/experiments/",
                $experiment,
                ".toml"
            )),
        )
    };
}

const FILES: [(&str, &str); 12] = [
    file!("density"),
    file!("eq4"),
    file!("fig10"),
    file!("fig11"),
    file!("fig12"),
    file!("fig13"),
    file!("iterations"),
    file!("search"),
    file!("space"),
    file!("stippling"),
    file!("uniformity"),
    file!("varying"),
];

static TEXTS: LazyLock<BTreeMap<&str, Words>> = LazyLock::new(|| {
    let read = |text| toml::from_str(text).expect("the texts of the experiments are valid");
    FILES
        .map(|(experiment, text)| (experiment, read(text)))
        .into()
});

/// Returns the texts of an experiment and the one of them that `id`, such as `eq4/shares`, names. Panics if it is not
/// there: ids are written in code.
fn find<T>(id: &str, of: fn(&Words) -> &BTreeMap<String, T>) -> (&'static Words, &'static T) {
    let found = id.split_once('/').and_then(|(experiment, name)| {
        let texts = TEXTS.get(experiment)?;
        Some((texts, of(texts).get(name)?))
    });
    found.unwrap_or_else(|| panic!("assets/experiments has no text {id}"))
}

/// Returns a note, a caption or a part of another text.
pub fn text(id: &str, values: &Value) -> String {
    let (texts, template) = find(id, |texts| &texts.texts);
    texts.filled(template, values)
}

/// Returns a claim with its verdict.
pub fn claim(id: &str, verdict: Verdict, values: &Value) -> Claim {
    let (texts, template) = find(id, |texts| &texts.claims);
    Claim {
        claim: texts.filled(&template.claim, values),
        place: template.place.clone(),
        paper: texts.filled(&template.paper, values),
        ours: texts.filled(&template.here, values),
        verdict,
        reason: texts.filled(&template.rule, values).trim_end().to_owned(),
    }
}

/// Returns curves over axes that reach as far as their data.
pub fn chart(id: &str, series: Vec<Series>) -> LineChart {
    let (_, text) = find(id, |texts| &texts.charts);
    LineChart {
        title: text.title.clone(),
        x: Axis::new(&text.x),
        y: Axis::new(&text.y),
        series,
        levels: Vec::new(),
    }
}

/// Returns the texts of a picture.
pub fn picture_texts(id: &str, values: &Value) -> PictureText {
    let (texts, template) = find(id, |texts| &texts.pictures);
    PictureText {
        title: texts.filled(&template.title, values),
        caption: texts.filled(&template.caption, values),
        axis: template.axis.clone(),
    }
}

/// Returns a table whose cells are, for each row, those of an object by the keys of the columns. A column whose key
/// has `{n}` is repeated: its cell is an array of pairs, each of a number, which stands for `{n}`, and a cell.
pub fn table<R>(id: &str, rows: impl IntoIterator<Item = R>, cells: impl Fn(R) -> Value) -> Table {
    let (_, text) = find(id, |texts| &texts.tables);
    let objects: Vec<Value> = rows.into_iter().map(cells).collect();

    let mut table = Table {
        name: name(id),
        title: text.title.clone(),
        columns: Vec::new(),
        rows: vec![Vec::new(); objects.len()],
        shown: !text.hidden,
    };

    // Adds a column with its cell of each row; a missing cell is empty.
    let mut add = |column: Column, cell: &dyn Fn(&Value) -> Option<Value>| {
        table.columns.push(column);
        for (row, object) in table.rows.iter_mut().zip(&objects) {
            row.push(Cell::of(cell(object).unwrap_or_default()));
        }
    };

    for column in &text.columns {
        // A question mark at the end says that the column may be missing.
        let key = column.key.trim_end_matches('?');
        let named = |number: &str| Column {
            key: key.replace("{n}", number),
            head: column.head.replace("{n}", number),
            digits: column.digits,
        };

        // All rows have the same keys, so that the first row shows which columns there are. A table without rows may
        // lack any column.
        let optional = key != column.key || objects.is_empty();
        match objects.first().and_then(|object| object.get(key)) {
            // The column is repeated for each pair of the first row.
            Some(Value::Array(pairs)) => {
                for (index, pair) in pairs.iter().enumerate() {
                    let cell = |object: &Value| object[key].get(index).map(|pair| pair[1].clone());
                    add(named(&pair[0].to_string()), &cell);
                }
            }
            // A column that is not repeated has no number.
            Some(_) => add(named(""), &|object| object.get(key).cloned()),
            None => debug_assert!(optional, "{id}: no cells of {key}"),
        }
    }

    // A cell whose column is not in the file would be left out unnoticed.
    for key in objects
        .iter()
        .filter_map(Value::as_object)
        .flat_map(|object| object.keys())
    {
        let known = text
            .columns
            .iter()
            .any(|column| column.key.trim_end_matches('?') == key);
        debug_assert!(known, "{id}: no column for {key}");
    }

    table
}

/// Returns the name of a text within its experiment: that of its table or picture in files.
pub fn name(id: &str) -> String {
    id.split_once('/').map_or(id, |(_, name)| name).to_owned()
}

impl Words {
    /// Fills placeholders: `{@name}` with another text, `{name}` with a value, `{name.0}` with a part of one. What
    /// follows a colon is its format, see [`shown`].
    fn filled(&self, template: &str, values: &Value) -> String {
        let mut out = String::new();
        let mut rest = template;

        while let Some((before, (inside, after))) =
            (rest.split_once('{')).and_then(|(before, rest)| Some((before, rest.split_once('}')?)))
        {
            out.push_str(before);
            rest = after;

            if let Some(part) = inside.strip_prefix('@') {
                out.push_str(&self.filled(&self.texts[part], values));
                continue;
            }

            let (name, format) = inside.split_once(':').unwrap_or((inside, ""));
            let value = values.pointer(&format!("/{}", name.replace('.', "/")));
            // A placeholder without a value is a fault of the file of texts, which tests find.
            debug_assert!(
                value.is_some(),
                "no value for {{{inside}}} of \"{template}\""
            );
            out.push_str(&shown(value.unwrap_or(&Value::Null), format));
        }

        out + rest
    }
}

/// Returns a value for readers: text as it is, whole numbers with thousands apart, other numbers with all digits or in a
/// format: `3` significant digits, `3%` of the value as a percentage, `+3` and `+3%` with a sign, `p` a probability.
fn shown(value: &Value, format: &str) -> String {
    let (Some(value), false) = (value.as_f64(), format.is_empty()) else {
        return match Cell::of(value.clone()) {
            Cell::Number(value) => value.to_string(),
            // Texts and whole numbers need no digits.
            cell => readable(&cell, 0),
        };
    };

    // Only the format `p` has no digits, and it needs none.
    let digits = (format.chars().filter(char::is_ascii_digit))
        .collect::<String>()
        .parse()
        .unwrap_or(0);
    match (format.starts_with('+'), format.ends_with('%')) {
        _ if format == "p" => chance(value),
        (false, false) => number(value, digits),
        (false, true) => percent(value, digits),
        (true, false) => signed(value, digits),
        (true, true) => format!("{} %", signed(100.0 * value, digits)),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn placeholders_take_values_in_their_formats_and_other_texts() {
        let texts = Words {
            texts: [("part".to_owned(), "of {all}".to_owned())].into(),
            ..Words::default()
        };
        let values = json!({
            "all": 12_345, "leaf": 20.0, "share": 0.0242, "ends": [-0.5, 0.25], "none": null, "name": "KDRT", "p": 0.0,
        });
        let filled = |template| texts.filled(template, &values).replace('\u{202f}', " ");
        assert_eq!(filled("{@part}, {leaf} r: {name}"), "of 12 345, 20 r: KDRT");
        assert_eq!(
            filled("{share:2} {share:2%} {share:+3%}"),
            "0.024 2.4 % +2.42 %"
        );
        assert_eq!(filled("{ends.0:+2} to {ends.1}"), "\u{2212}0.50 to 0.25");
        assert_eq!(
            filled("{none:3} {p:p} {all:2}"),
            "\u{2013} below 1e-300 12 000"
        );
        assert_eq!(filled("no end {all"), "no end {all");
    }

    #[test]
    fn every_text_of_every_file_has_only_placeholders_that_end_and_parts_that_exist() {
        for texts in TEXTS.values() {
            let claims = texts.claims.values();
            let claims = claims.flat_map(|one| [&one.claim, &one.paper, &one.here, &one.rule]);
            let pictures = texts
                .pictures
                .values()
                .flat_map(|one| [&one.title, &one.caption]);
            for template in texts.texts.values().chain(claims).chain(pictures) {
                assert_eq!(
                    template.matches('{').count(),
                    template.matches('}').count(),
                    "{template}"
                );
                let parts = template
                    .split("{@")
                    .skip(1)
                    .filter_map(|rest| rest.split_once('}'));
                parts.for_each(|(part, _)| assert!(texts.texts.contains_key(part), "{part}"));
            }
        }
    }
}
