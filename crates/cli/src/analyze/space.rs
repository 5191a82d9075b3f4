//! `tilescope analyze` of sets in space: their numbers, the power by shells of frequency, and the pair correlation. The tables,
//! charts and reports are those of planar sets; there are no periodograms, and no differences from a reference.

mod measured;

use std::path::PathBuf;

use anyhow::Result;
use serde_json::{Value, json};
use tilescope_analysis::measures::{Average, Spectrum};
use tilescope_analysis::{BYTE_ORDER_MARK, SolidShell};
use tilescope_drawing::spectra::{self, chart};
use tilescope_figures::chart::{Axis, Figure, Level, Look, Series};

use super::curve::Curve;
use super::gather::Failure;
use super::measure::Measure;
use super::table::{Column, Table};
use super::{AnalyzeArguments, curves, names, page, report, table};
use crate::paths::named;
use crate::solid::{box_text, is_in_space, refuse};
use crate::{describe, interrupt, output};
use measured::{Measured, Request};

// A sign for the cube root is in none of the fonts of figures.
const FREQUENCY: &str = "frequency \u{3bd} = |k| (volume / N)^(1/3)";
const DISTANCE: &str = "distance / r";

/// A column of the table and a curve in each chart: a set, or the average of several.
struct Subject {
    /// The path of the file, or what is averaged.
    name: String,
    label: String,
    /// The domain, and where the radius is from.
    words: [String; 2],
    numbers: Vec<Measure>,
    curves: [(&'static str, Curve); 3],
}

/// The measures of all files.
pub struct InSpace {
    subjects: Vec<Subject>,
    /// The sets behind an average; none if each set is a subject.
    members: Vec<Measured>,
    failures: Vec<Failure>,
}

/// Whether the files are sets in space. All must be, or none.
pub fn is_asked(arguments: &AnalyzeArguments) -> Result<bool> {
    let is_solid = |path: &&PathBuf| is_in_space(&arguments.set, path);
    let all = || arguments.files.iter().chain(&arguments.against);
    let Some(solid) = all().find(is_solid) else {
        return Ok(false);
    };
    if let Some(planar) = all().find(|path| !is_solid(path)) {
        anyhow::bail!(
            "{} is a set in space, and {} is a planar one: analyze them one by one",
            named(solid),
            named(planar)
        );
    }
    Ok(true)
}

impl InSpace {
    /// Measures the sets of some files; a file that cannot be measured is named, and the others are measured.
    pub fn of(arguments: &AnalyzeArguments) -> Result<Self> {
        let no_reference = "sets in space are not compared with a reference";
        refuse(
            &[("--against", !arguments.against.is_empty())],
            no_reference,
        )?;
        let request = Request {
            set: &arguments.set,
            most: arguments.frequencies,
        };

        let mut measured: Vec<Measured> = Vec::new();
        let mut failures = Vec::new();
        for path in &arguments.files {
            // An average has the frequencies and the distances of its first set.
            let first = measured.first().filter(|_| arguments.average);
            match request.measure(path, first) {
                Ok(one) => measured.push(one),
                // The file has no fault where the command was asked to end.
                Err(error) if interrupt::requested() => return Err(error),
                Err(error) => {
                    let reason = describe(&error);
                    output::note(&format!("error: {reason}"));
                    let name = path.display().to_string();
                    failures.push(Failure { name, reason });
                }
            }
        }

        let (subjects, members) = if arguments.average && !measured.is_empty() {
            (vec![Subject::average(&measured)?], measured)
        } else {
            let names: Vec<String> = measured.iter().map(|one| one.name.clone()).collect();
            let labels = names::numbered(&names::short(&names));
            let subjects = measured.into_iter().zip(labels);
            (
                subjects
                    .map(|(one, label)| Subject::one(one, label))
                    .collect(),
                Vec::new(),
            )
        };
        Ok(Self {
            subjects,
            members,
            failures,
        })
    }

    /// Whether every file could be measured.
    pub fn is_fine(&self) -> bool {
        self.failures.is_empty()
    }

    /// Whether no file could be measured.
    pub fn is_empty(&self) -> bool {
        self.subjects.is_empty()
    }

    /// Returns the numbers as a table.
    pub fn text(&self) -> String {
        table::text(&self.table())
    }

    fn table(&self) -> Table {
        let rows = self
            .subjects
            .first()
            .map_or(&[][..], |first| &first.numbers);
        let words = ["domain", "radius is"].map(|label| (label.to_owned(), ""));
        let labels = rows.iter().map(|own| (own.label.clone(), own.unit));

        let mut columns = Vec::new();
        for subject in &self.subjects {
            let mean = subject.numbers.iter().map(|own| own.text(own.value, 0));
            columns.push(Column::new(
                &subject.label,
                subject.words.iter().cloned().chain(mean),
            ));
            if subject.numbers.iter().any(|own| own.spread.is_some()) {
                // Errors are smaller than their numbers, so that they have one more decimal.
                let error =
                    |own: &Measure| own.text(own.spread.map(|spread| spread.standard_error), 1);
                let cells = subject.numbers.iter().map(error);
                columns.push(Column::new(
                    "standard error",
                    subject.words.iter().map(|_| String::new()).chain(cells),
                ));
            }
        }

        Table {
            head: "measure".to_owned(),
            rows: words.into_iter().chain(labels).collect(),
            columns,
        }
    }

    /// Returns all numbers and curves as one object; `saved` is the path of the report.
    pub fn json(&self, saved: Option<&str>) -> Value {
        let numbers = |all: &[Measure]| -> serde_json::Map<String, Value> {
            let pair = |own: &Measure| (own.key.clone(), json!(own.value));
            all.iter().map(pair).collect()
        };
        let subject = |one: &Subject| {
            let curves = one
                .curves
                .iter()
                .map(|(key, curve)| ((*key).to_owned(), curve.json()));
            json!({
                "file": one.name,
                "label": one.label,
                "measures": numbers(&one.numbers),
                "curves": curves.collect::<serde_json::Map<_, _>>(),
            })
        };
        let member = |one: &Measured| json!({ "file": one.name, "region": one.region, "measures": numbers(&one.numbers) });

        let all: Vec<Value> = self.subjects.iter().map(subject).collect();
        let is_average = !self.members.is_empty();
        let files = if is_average {
            self.members.iter().map(member).collect()
        } else {
            all.clone()
        };
        json!({
            "files": files,
            "average": if is_average { all.first() } else { None },
            "failures": self.failures,
            "report": saved,
        })
    }

    /// Returns all numbers as CSV, in the form of planar sets.
    pub fn csv(&self) -> String {
        let mut out = format!("{BYTE_ORDER_MARK}file,measure,x,y,lower,upper\n");
        for one in &self.members {
            report::csv_measures(&mut out, &report::quoted(&one.name), &one.numbers);
        }
        for one in &self.subjects {
            let name = report::quoted(&one.name);
            report::csv_measures(&mut out, &name, &one.numbers);
            report::csv_curves(&mut out, &name, &one.curves);
        }
        out
    }

    /// Returns a page with the table and the curves.
    pub fn html(&self, figures: &[String]) -> String {
        let mut out = page::opening();
        page::page_table(&mut out, &self.table());
        page::curves(&mut out, figures);
        out.push_str(NOTES);
        let reasons = self.failures.iter().map(|failure| &failure.reason);
        page::list(&mut out, "Not analysed", reasons);
        page::close(&mut out);
        out
    }

    /// Returns the figure of the curves.
    pub fn figure(&self) -> Figure {
        let series = |number_of_curve: usize| -> Vec<Series> {
            let each = self.subjects.iter().enumerate();
            let lines = each.filter_map(|(index, subject)| {
                let (_, curve) = &subject.curves[number_of_curve];
                curves::series(&subject.label, Look::Numbered(index), curve)
            });
            lines.collect()
        };
        let [powers, anisotropies, correlations] = [0, 1, 2].map(series);

        let power =
            spectra::radial_mean(FREQUENCY, curves::cut("power P(\u{3bd})", &powers), powers);
        // In a set without a preferred direction the powers of a shell have a deviation as large as their mean: 0 dB.
        // This does not depend on how many powers there are, and averages are means of such curves.
        let none = vec![Level {
            name: "no preferred direction".to_owned(),
            y: 0.0,
        }];
        let axis = Axis::new("anisotropy, dB");
        let anisotropy = chart("Anisotropy", FREQUENCY, axis, anisotropies, none);
        let noise = vec![Level {
            name: "white noise".to_owned(),
            y: 1.0,
        }];
        let axis = curves::cut("g(r)", &correlations);
        let pairs = chart("Pair correlation", DISTANCE, axis, correlations, noise);

        let title = match self.subjects.as_slice() {
            [one] => format!("Analysis of {}", one.label),
            several => format!("Analysis of {} sets", several.len()),
        };
        let rows = vec![curves::drawn([power, anisotropy]), curves::drawn([pairs])];
        curves::of_rows(title, rows)
    }
}

const NOTES: &str = "<p>Powers are means over shells of frequencies, of which large shells have up to 256 drawn ones (down to 32 of large sets, and fewer in flat boxes). Frequencies are \
given as nu = |k| / cbrt(N / volume). Shaded bands hold the true mean with probability 0.95: those of one set follow from the \
scatter between its frequencies, and those of an average from the spread between sets.</p>\n";

impl Subject {
    /// Returns the column of one set.
    fn one(set: Measured, label: String) -> Self {
        let [power, anisotropy, pairs] = set.curves();
        // 1.96 standard errors to both sides hold the mean with probability 0.95.
        let band =
            |shell: &SolidShell| [-1.96, 1.96].map(|by| shell.power + by * shell.standard_error);
        let bands = set.spectrum.shells.iter().map(band).collect();
        Self {
            words: words(&set),
            name: set.name,
            label,
            numbers: set.numbers,
            // Of one set only the powers have a known error: the other two curves have no bands.
            curves: named_curves([
                Curve::new(power, Some(bands)),
                Curve::new(anisotropy, None),
                Curve::new(pairs, None),
            ]),
        }
    }

    /// Returns the column of the average of some sets, at least one.
    fn average(sets: &[Measured]) -> Result<Self> {
        // All sets have the same numbers, of which some may be undefined.
        let numbers = (0..sets[0].numbers.len()).map(|index| {
            let all: Vec<&Measure> = sets.iter().map(|set| &set.numbers[index]).collect();
            Measure::mean(&all)
        });
        let curves: Vec<[Vec<[f64; 2]>; 3]> = sets.iter().map(Measured::curves).collect();
        let [power, anisotropy, pairs] = [0, 1, 2].map(|which| {
            let of_sets: Vec<&[[f64; 2]]> = curves.iter().map(|own| &own[which][..]).collect();
            mean_curve(&of_sets)
        });

        let names: Vec<&str> = sets.iter().map(|set| set.name.as_str()).collect();
        Ok(Self {
            // All have the box of the first set. Where its radius is from is said for it alone: its radius is the unit
            // of all distances.
            words: words(&sets[0]),
            name: names::pattern(&names),
            label: format!("mean of {}", sets.len()),
            numbers: numbers.collect::<Result<_, _>>()?,
            curves: named_curves([power?, anisotropy?, pairs?]),
        })
    }
}

/// Returns the words of a set in the table.
fn words(set: &Measured) -> [String; 2] {
    let origin = if set.has_radius {
        "known"
    } else {
        "smallest distance"
    };
    [box_text(&set.region), origin.to_owned()]
}

/// Returns curves with the names that those of planar sets have in files.
fn named_curves([power, anisotropy, pairs]: [Curve; 3]) -> [(&'static str, Curve); 3] {
    [
        ("power", power),
        ("anisotropy", anisotropy),
        ("pair_correlation", pairs),
    ]
}

/// Returns the mean of some curves with its band.
fn mean_curve(curves: &[&[[f64; 2]]]) -> Result<Curve> {
    // Rounding may cost one of them the last shell.
    let length = curves.iter().map(|curve| curve.len()).min().unwrap_or(0);
    let [mut x, mut y] = [Average::new(length), Average::new(length)];
    for curve in curves {
        let column =
            |axis: usize| -> Vec<f64> { curve[..length].iter().map(|point| point[axis]).collect() };
        x.add(&column(0))?;
        y.add(&column(1))?;
    }
    let points = x.means().iter().zip(y.means()).map(|(x, y)| [*x, *y]);
    Ok(Curve::new(points.collect(), y.band(Spectrum::LEVEL)?))
}
