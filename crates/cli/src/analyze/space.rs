//! `tilescope analyze` of sets in space: their numbers, the power by shells of frequency and in three planes of frequencies, and
//! the pair correlation. The tables, charts and reports are those of planar sets; pictures of planes stand for periodograms.

mod measured;
mod planes;
mod subject;

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::{Value, json};
use tilescope_analysis::BYTE_ORDER_MARK;
use tilescope_drawing::spectra::{self, chart};
use tilescope_figures::chart::{Axis, Figure, Level, Look, Panel, Series};

use super::differences::Differences;
use super::gather::Failure;
use super::measure::Measure;
use super::table::{Column, Table};
use super::{AnalyzeArguments, curves, names, page, report, table};
use crate::paths::named;
use crate::solid::is_in_space;
use crate::{describe, interrupt, output};
use measured::{Measured, Request};
use subject::SolidSubject;

// A sign for the cube root is in none of the fonts of figures.
const FREQUENCY: &str = "frequency \u{3bd} = |k| (volume / N)^(1/3)";
const DISTANCE: &str = "distance / r";

/// The measures of all files.
pub struct InSpace {
    /// What the others are compared with.
    reference: Option<SolidSubject>,
    subjects: Vec<SolidSubject>,
    /// The differences of each subject from the reference; none without one.
    differences: Vec<Differences>,
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
        let request = Request {
            set: &arguments.set,
            most: arguments.frequencies,
        };

        let reference = reference(&arguments.against, &request)?;
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
            (vec![SolidSubject::average(&measured)?], measured)
        } else {
            let names: Vec<String> = measured.iter().map(|one| one.name.clone()).collect();
            let labels = names::numbered(&names::short(&names));
            let subjects = measured.into_iter().zip(labels);
            (
                subjects
                    .map(|(one, label)| SolidSubject::one(one, label))
                    .collect(),
                Vec::new(),
            )
        };
        // Each subject is compared with the reference, and an average as a whole.
        let differences = match &reference {
            None => Vec::new(),
            Some(base) => {
                let each = subjects.iter().map(|subject| subject.less(base));
                each.collect::<Result<_>>()?
            }
        };
        Ok(Self {
            reference,
            subjects,
            differences,
            members,
            failures,
        })
    }

    /// Returns all columns, that of the reference first.
    fn all(&self) -> impl Iterator<Item = &SolidSubject> {
        self.reference.iter().chain(&self.subjects)
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
        let mut out = table::text(&self.table());
        if let Some(differences) = self.table_of_differences() {
            out.push('\n');
            out += &table::text(&differences);
        }
        out
    }

    /// Returns the differences from the reference as a table, if there is a reference.
    fn table_of_differences(&self) -> Option<Table> {
        let reference = self.reference.as_ref()?;
        let labels = self.subjects.iter().map(|one| one.label.as_str());
        Some(table::differences(
            &reference.label,
            labels,
            &self.differences,
        ))
    }

    fn table(&self) -> Table {
        let rows = self.all().next().map_or(&[][..], |first| &first.numbers);
        // The rows of words come first, in the order of `SolidSubject::words`.
        let rows_of_words = ["domain", "radius is"].map(|label| (label.to_owned(), ""));
        let rows_of_numbers = rows.iter().map(|own| (own.label.clone(), own.unit));

        let mut columns = Vec::new();
        for subject in self.all() {
            let values = subject.numbers.iter().map(|own| own.text(own.value, 0));
            columns.push(Column::new(
                &subject.label,
                subject.words.iter().cloned().chain(values),
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
            rows: rows_of_words.into_iter().chain(rows_of_numbers).collect(),
            columns,
        }
    }

    /// Returns all numbers and curves as one object; `saved` is the path of the report.
    pub fn json(&self, saved: Option<&str>) -> Value {
        let numbers = |all: &[Measure]| -> serde_json::Map<String, Value> {
            let pair = |own: &Measure| (own.key.clone(), json!(own.value));
            all.iter().map(pair).collect()
        };
        let subject = |one: &SolidSubject| {
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

        let mut all: Vec<Value> = self.subjects.iter().map(subject).collect();
        for (object, differences) in all.iter_mut().zip(&self.differences) {
            report::add_differences(object, differences);
        }
        // The sets of an average have numbers of their own, but its curves alone are shown.
        let is_average = !self.members.is_empty();
        let files = if is_average {
            self.members.iter().map(member).collect()
        } else {
            all.clone()
        };
        json!({
            "files": files,
            "average": if is_average { all.first() } else { None },
            "against": self.reference.as_ref().map(subject),
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
        for one in self.all() {
            let name = report::quoted(&one.name);
            report::csv_measures(&mut out, &name, &one.numbers);
            report::csv_curves(&mut out, &name, &one.curves);
        }
        // The difference of a measure has no line, as it follows from the two measures. The difference of two curves
        // has lines, and so have the numbers that are measured from it (`of_curves`).
        for (one, of) in self.subjects.iter().zip(&self.differences) {
            let name = report::quoted(&one.name);
            report::csv_measures(&mut out, &name, &of.of_curves);
            report::csv_curves(&mut out, &name, &of.curves);
        }
        out
    }

    /// Returns a page with the table and the curves.
    pub fn html(&self, figures: &[String]) -> String {
        let mut out = page::opening();
        page::page_table(&mut out, &self.table());
        if let Some(differences) = self.table_of_differences() {
            out.push_str("<h2>Differences</h2>\n");
            page::page_table(&mut out, &differences);
        }
        page::curves(&mut out, figures);
        out.push_str(NOTES);
        let reasons = self.failures.iter().map(|failure| &failure.reason);
        page::list(&mut out, "Not analysed", reasons);
        page::close(&mut out);
        out
    }

    /// Returns one figure with all curves and the planes of as many sets as it has room for, and how many sets have no planes
    /// in it.
    pub fn figure(&self) -> (Figure, usize) {
        let sets: Vec<&SolidSubject> = self.all().collect();
        let shown = sets.len().min(planes::MAX_SETS);
        let left_out = sets.len() - shown;

        let mut title = self.title();
        // The picture may be seen without the note that the command prints.
        if left_out > 0 {
            let all = sets.len();
            let _ = write!(title, "; planes of {left_out} of {all} sets are left out");
        }
        let mut rows = self.curve_rows();
        // Curves are what one compares, and come before the pictures.
        rows.extend(sets[..shown].iter().map(|set| planes::row(set)));
        (curves::of_rows(title, rows), left_out)
    }

    /// Returns the figures of a page: the curves, and the planes of all sets.
    pub fn figures(&self) -> Vec<Figure> {
        let (whole, left_out) = self.figure();
        if left_out == 0 {
            return vec![whole];
        }
        // A page has any number of figures, so that the planes of all sets have their place.
        let sets: Vec<&SolidSubject> = self.all().collect();
        let of_curves = curves::of_rows(self.title(), self.curve_rows());
        std::iter::once(of_curves)
            .chain(planes::figures(&sets))
            .collect()
    }

    fn title(&self) -> String {
        match self.subjects.as_slice() {
            [one] => format!("Analysis of {}", one.label),
            several => format!("Analysis of {} sets", several.len()),
        }
    }

    /// Returns the rows of all charts with curves.
    fn curve_rows(&self) -> Vec<Vec<Panel>> {
        let series = |number_of_curve: usize| -> Vec<Series> {
            let each = self.all().enumerate();
            let lines = each.filter_map(|(index, subject)| {
                // The reference comes first, with a look of its own, and the others count from 0.
                let number = index.checked_sub(usize::from(self.reference.is_some()));
                let look = number.map_or(Look::Reference, Look::Numbered);
                let (_, curve) = &subject.curves[number_of_curve];
                curves::series(&subject.label, look, curve)
            });
            lines.collect()
        };
        let [powers, anisotropies, correlations] = [0, 1, 2].map(series);

        let power =
            spectra::radial_mean(FREQUENCY, curves::cut("power P(\u{3bd})", &powers), powers);
        // If a set has no preferred direction, the powers of a shell deviate by as much as their mean: 0 dB. The number
        // of powers in the shell does not matter. The curve of an average is the mean of the sets' curves, so that its
        // level is 0 dB, too.
        let no_direction = vec![Level {
            name: "no preferred direction".to_owned(),
            y: 0.0,
        }];
        let axis = Axis::new("anisotropy, dB");
        let anisotropy = chart("Anisotropy", FREQUENCY, axis, anisotropies, no_direction);
        let noise = vec![Level {
            name: "white noise".to_owned(),
            y: 1.0,
        }];
        let axis = curves::cut("g(r)", &correlations);
        let pairs = chart("Pair correlation", DISTANCE, axis, correlations, noise);

        let labels = self.subjects.iter().map(|subject| &subject.label);
        let each: Vec<(&String, &Differences)> = labels.zip(&self.differences).collect();
        vec![
            curves::drawn([power, anisotropy]),
            curves::drawn([pairs]),
            curves::differences(&each, [FREQUENCY, DISTANCE]),
        ]
    }
}

/// Measures what the sets are compared with: one set, or the average of several. Returns `None` without paths.
fn reference(paths: &[PathBuf], request: &Request<'_>) -> Result<Option<SolidSubject>> {
    let mut measured: Vec<Measured> = Vec::new();
    for path in paths {
        // An average has the frequencies and the distances of its first set.
        let one = request.measure(path, measured.first());
        measured.push(one.context("--against")?);
    }
    // One set is the reference itself, with the scatter between its frequencies; several are averaged.
    if let [_] = &measured[..] {
        let one = measured.remove(0);
        let label = format!(
            "{} (reference)",
            names::short(std::slice::from_ref(&one.name))[0]
        );
        return Ok(Some(SolidSubject::one(one, label)));
    }
    let average = (!measured.is_empty()).then(|| SolidSubject::average(&measured));
    average.transpose().context("--against")
}

const NOTES: &str = "<p>Powers are means over shells of frequencies, of which large shells have up to 256 drawn ones (down to 32 of large sets, and fewer in flat boxes). Frequencies are \
given as nu = |k| / cbrt(N / volume). Shaded bands hold the true mean with probability 0.95: those of one set follow from the \
scatter between its frequencies, and those of an average from the spread between sets. Each picture has all frequencies without a cycle along \
one axis: white where there is no power, and black from three times the power of white noise on. The zero frequency is left out; if it has a cell \
of its own, a ring marks it.</p>\n";
