//! From the files of the command line to subjects. A file that cannot be used is told of, and the others are used all the same.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tilescope_analysis::measures::Spectrum;

use super::differences::Comparison;
use super::measured::{Member, Request};
use super::subject::{Population, Subject};
use super::{AnalyzeArguments, names};
use crate::{describe, interrupt, output};

/// A file that was not analysed, and why.
pub struct Failure {
    pub name: String,
    pub reason: String,
}

/// Everything that was found out.
pub struct Analysis {
    /// The columns, that of `--against` first.
    pub subjects: Vec<Subject>,
    /// Whether the first is what others are held against.
    pub against: bool,
    /// Whether the files were averaged.
    pub averaged: bool,
    /// How each of the others differs from the first.
    pub comparisons: Vec<Comparison>,
    pub failures: Vec<Failure>,
    /// What else there is to know, a sentence each.
    pub notes: Vec<String>,
}

impl Analysis {
    pub fn reference(&self) -> Option<&Subject> {
        self.subjects.first().filter(|_| self.against)
    }

    /// The subjects but the reference.
    pub fn held(&self) -> &[Subject] {
        &self.subjects[usize::from(self.against)..]
    }

    /// Analyses the files one after another; only Ctrl-C and a useless `--against` end it early.
    pub fn of(arguments: &AnalyzeArguments) -> Result<Self> {
        let paths = arguments.against.iter().chain(&arguments.files);
        let paths: Vec<&Path> = paths.map(PathBuf::as_path).collect();
        let request = Request::new(&arguments.set, arguments.frequencies, &paths);
        let mut analysis = Self {
            subjects: Vec::new(),
            against: !arguments.against.is_empty(),
            averaged: arguments.average,
            comparisons: Vec::new(),
            failures: Vec::new(),
            notes: Vec::new(),
        };
        let reference = analysis.held_against(&arguments.against, &request)?;
        analysis.subjects.extend(reference);
        if arguments.average {
            let average = analysis.average(&arguments.files, &request)?;
            analysis.subjects.extend(average);
        } else {
            analysis.one_by_one(&arguments.files, &request)?;
        }
        analysis.note_shared(arguments);
        analysis.name();
        analysis.note_domains();
        analysis.note_two_sets();
        if arguments.frequencies.is_none() {
            analysis.note_short_spectra();
        }
        analysis.compare()?;
        Ok(analysis)
    }

    /// Returns the reference: a set, or the average of several.
    fn held_against(
        &mut self,
        paths: &[PathBuf],
        request: &Request<'_>,
    ) -> Result<Option<Subject>> {
        match paths {
            [] => Ok(None),
            [path] => {
                let reference = request.measured(path, None).context("--against")?;
                Ok(Some(Subject::one(reference)))
            }
            paths => {
                let average = self.average(paths, request)?;
                Ok(Some(
                    average.context("--against: none of its sets can be used")?,
                ))
            }
        }
    }

    fn one_by_one(&mut self, paths: &[PathBuf], request: &Request<'_>) -> Result<()> {
        for (path, again) in paths.iter().zip(again(paths)) {
            let found = (request.measured(path, None))
                .and_then(|found| self.same_domain(&found.member).map(|()| found));
            match found {
                Ok(found) => {
                    self.subjects.push(Subject::one(found));
                    if let Some(first) = again {
                        let same = same_file(path, first);
                        self.note(format!("{same}: it is analysed twice"));
                    }
                }
                Err(error) => self.fail(path, error)?,
            }
        }
        Ok(())
    }

    /// Averages files, of which it keeps nothing but their numbers.
    fn average(&mut self, paths: &[PathBuf], request: &Request<'_>) -> Result<Option<Subject>> {
        let mut population = Population::default();
        for (path, again) in paths.iter().zip(again(paths)) {
            let added = match again {
                Some(first) => Err(anyhow::anyhow!(
                    "{}: a set counts once in an average",
                    same_file(path, first)
                )),
                None => request
                    .measured(path, population.common())
                    .and_then(|found| {
                        self.same_domain(&found.member)?;
                        Ok(population.add(found)?)
                    }),
            };
            if let Err(error) = added {
                self.fail(path, error)?;
            }
        }
        Ok(population.finish()?)
    }

    fn fail(&mut self, path: &Path, error: anyhow::Error) -> Result<()> {
        if interrupt::requested() {
            return Err(error);
        }
        let reason = describe(&error);
        output::note(&format!("error: {reason}"));
        let name = path.display().to_string();
        self.failures.push(Failure { name, reason });
        Ok(())
    }

    pub fn note(&mut self, note: String) {
        output::note(&format!("note: {note}"));
        self.notes.push(note);
    }

    fn same_domain(&self, found: &Member) -> Result<()> {
        if let Some(reference) = self.reference() {
            ensure!(
                found.region == reference.region,
                "{}: its domain, {}, is not that of {}, {}",
                found.name,
                output::region_text(&found.region),
                reference.name,
                output::region_text(&reference.region)
            );
        }
        Ok(())
    }

    /// Bands take both sides for independent.
    fn note_shared(&mut self, arguments: &AnalyzeArguments) {
        let places: Vec<PathBuf> = arguments.against.iter().map(|path| place(path)).collect();
        let shared: Vec<String> = (arguments.files.iter())
            .filter(|path| places.contains(&place(path)))
            .map(|path| path.display().to_string())
            .collect();
        if let Some(first) = shared.first() {
            let stand = match shared.len() {
                1 => " stands".to_owned(),
                more => format!(" and {} more stand", more - 1),
            };
            self.note(format!(
                "{first}{stand} on both sides: bands of differences take them for independent"
            ));
        }
    }

    /// Curves of different domains lie in one chart, each over its own frequencies.
    fn note_domains(&mut self) {
        let Some(first) = self.subjects.first() else {
            return;
        };
        let (label, region) = (first.label.clone(), first.region);
        let others: Vec<String> = (self.subjects.iter())
            .filter(|subject| subject.region != region)
            .map(|subject| {
                format!(
                    "{} ({})",
                    subject.label,
                    output::region_text(&subject.region)
                )
            })
            .collect();
        if !others.is_empty() {
            self.note(format!(
                "the domains differ: {} beside {label} ({})",
                others.join(", "),
                output::region_text(&region)
            ));
        }
    }

    /// Student's quantile of one degree of freedom is 12.7.
    fn note_two_sets(&mut self) {
        let two = |subject: &&Subject| subject.members.len() == 2;
        let labels = self
            .subjects
            .iter()
            .filter(two)
            .map(|subject| subject.label.clone());
        for label in labels.collect::<Vec<String>>() {
            self.note(format!(
                "{label}: two sets hardly tell their spread; bands from it are 12.7 standard errors wide on either side, with three \
                 sets 4.3"
            ));
        }
    }

    /// The spectra of large sets end before their first ring.
    fn note_short_spectra(&mut self) {
        let reach = |subject: &Subject| {
            let [x, y] = subject.spectrum.picture_reach;
            x.min(y)
        };
        let short = |subject: &&Subject| reach(subject) < 0.9 * Spectrum::MAX_NU;
        let notes: Vec<String> = (self.subjects.iter().filter(short))
            .map(|subject| {
                format!(
                    "{}: frequencies are looked at up to nu = {:.2}, {} cycles along a side; \
                     --frequencies asks for more",
                    subject.label,
                    reach(subject),
                    Spectrum::MAX_CYCLES
                )
            })
            .collect();
        for note in notes {
            self.note(note);
        }
    }

    /// Gives every subject names of its own; that of the reference may be a file's as well.
    fn name(&mut self) {
        // Two averages are told apart by their files.
        if self
            .subjects
            .iter()
            .filter(|subject| subject.average)
            .count()
            > 1
        {
            for subject in self.subjects.iter_mut().filter(|subject| subject.average) {
                let files: Vec<&str> = (subject.members.iter())
                    .map(|member| member.name.as_str())
                    .collect();
                subject.name = format!("{}: {}", subject.name, names::pattern(&files));
            }
        }
        let names: Vec<String> = self
            .subjects
            .iter()
            .map(|subject| subject.name.clone())
            .collect();
        let labels = names::short(&names);
        let from = usize::from(self.against);
        let held = names::numbered(&names[from..]);
        let held_labels = names::numbered(&labels[from..]);
        let (reference, others) = self.subjects.split_at_mut(from);
        for (subject, (name, label)) in others.iter_mut().zip(held.into_iter().zip(held_labels)) {
            (subject.name, subject.label) = (name, label);
        }
        for subject in reference {
            subject.label.clone_from(&labels[0]);
            if names[1..].contains(&subject.name) {
                subject.name.push_str(" (reference)");
            }
        }
    }

    fn compare(&mut self) -> Result<()> {
        if let Some(reference) = self.reference() {
            let each = self.held().iter();
            let each = each.map(|subject| Comparison::of(subject, reference));
            self.comparisons = each.collect::<Result<_, _>>()?;
        }
        Ok(())
    }
}

/// Returns where a file is; what cannot be found is where it is said to be.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn same_file(path: &Path, first: &Path) -> String {
    let (name, first_name) = (path.display(), first.display());
    if path == first {
        return format!("{name} is given more than once");
    }
    format!("{name} is the file {first_name} again")
}

/// Returns, for each path, an earlier one of the same file.
fn again(paths: &[PathBuf]) -> Vec<Option<&PathBuf>> {
    let mut first = std::collections::HashMap::new();
    paths
        .iter()
        .map(|path| match first.entry(place(path)) {
            std::collections::hash_map::Entry::Occupied(entry) => Some(*entry.get()),
            std::collections::hash_map::Entry::Vacant(entry) => {
                entry.insert(path);
                None
            }
        })
        .collect()
}
