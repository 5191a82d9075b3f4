//! From the files of the command line to subjects. A file that cannot be used is reported, and the others are used all the same.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use serde::Serialize;
use tilescope_analysis::measures::Spectrum;

use super::differences::Differences;
use super::measured::{Member, Request};
use super::subject::{Population, Subject};
use super::{AnalyzeArguments, names};
use crate::output::region_text;
use crate::{describe, interrupt, output};

/// A file that was not analysed, and why.
#[derive(Serialize)]
pub struct Failure {
    #[serde(rename = "file")]
    pub name: String,
    pub reason: String,
}

/// All that the tables, the charts and the reports show.
pub struct Analysis {
    /// The columns, that of `--against` first.
    pub subjects: Vec<Subject>,
    /// Whether the first is the one that others are compared with.
    pub has_reference: bool,
    /// Whether the files were averaged.
    pub averaged: bool,
    /// How each of the others differs from the reference.
    pub differences: Vec<Differences>,
    pub failures: Vec<Failure>,
    /// Remarks for the reader, a sentence each.
    pub notes: Vec<String>,
}

impl Analysis {
    pub fn reference(&self) -> Option<&Subject> {
        self.subjects.first().filter(|_| self.has_reference)
    }

    /// Returns the subjects but the reference.
    pub fn compared(&self) -> &[Subject] {
        &self.subjects[usize::from(self.has_reference)..]
    }

    /// Analyses the files one after another; only Ctrl-C and a useless `--against` end it early.
    pub fn of(arguments: &AnalyzeArguments) -> Result<Self> {
        let (files, against) = (&arguments.files, &arguments.against);
        let paths: Vec<&Path> = against.iter().chain(files).map(PathBuf::as_path).collect();
        let request = Request::new(&arguments.set, arguments.frequencies, &paths);
        let mut analysis = Self {
            subjects: Vec::new(),
            has_reference: !against.is_empty(),
            averaged: arguments.average,
            differences: Vec::new(),
            failures: Vec::new(),
            notes: Vec::new(),
        };
        match &against[..] {
            [] => {}
            [path] => {
                let reference = request.measure(path, None).context("--against")?;
                analysis.subjects.push(Subject::one(reference));
            }
            paths => {
                let average = analysis.average(paths, &request)?;
                let average = average.context("--against: none of its sets can be used")?;
                analysis.subjects.push(average);
            }
        }
        if arguments.average {
            let average = analysis.average(files, &request)?;
            analysis.subjects.extend(average);
        } else {
            analysis.one_by_one(files, &request)?;
        }
        analysis.note_shared(arguments);
        analysis.name();
        analysis.note_domains();
        analysis.note_two_sets();
        if arguments.frequencies.is_none() {
            analysis.note_short_spectra();
        }
        if let Some(reference) = analysis.reference() {
            let each = analysis.compared().iter();
            let each = each.map(|subject| Differences::of(subject, reference));
            analysis.differences = each.collect::<Result<_, _>>()?;
        }
        Ok(analysis)
    }

    fn one_by_one(&mut self, paths: &[PathBuf], request: &Request<'_>) -> Result<()> {
        for (path, same) in paths.iter().zip(repetitions(paths)) {
            let measured = request.measure(path, None);
            match measured.and_then(|set| self.same_domain(&set.member).map(|()| set)) {
                Ok(set) => {
                    self.subjects.push(Subject::one(set));
                    if let Some(same) = same {
                        self.note(format!("{same}: it is analysed twice"));
                    }
                }
                Err(error) => self.fail(path, error)?,
            }
        }
        Ok(())
    }

    /// Averages files and keeps only their numbers.
    fn average(&mut self, paths: &[PathBuf], request: &Request<'_>) -> Result<Option<Subject>> {
        let mut population = Population::default();
        for (path, same) in paths.iter().zip(repetitions(paths)) {
            let measured = match same {
                Some(same) => Err(anyhow!("{same}: a set counts once in an average")),
                None => request.measure(path, population.common()),
            };
            let added = measured.and_then(|set| {
                self.same_domain(&set.member)?;
                Ok(population.add(set)?)
            });
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

    fn same_domain(&self, member: &Member) -> Result<()> {
        if let Some(reference) = self.reference() {
            ensure!(
                member.region == reference.region,
                "{}: its domain, {}, is not that of {}, {}",
                member.name,
                region_text(&member.region),
                reference.name,
                region_text(&reference.region)
            );
        }
        Ok(())
    }

    /// Bands of differences are right for independent sets.
    fn note_shared(&mut self, arguments: &AnalyzeArguments) {
        let against: Vec<PathBuf> = arguments
            .against
            .iter()
            .map(|path| canonical(path))
            .collect();
        let mut shared = (arguments.files.iter()).filter(|path| against.contains(&canonical(path)));
        if let Some(first) = shared.next() {
            let stand = match shared.count() {
                0 => " stands".to_owned(),
                more => format!(" and {more} more stand"),
            };
            self.note(format!(
                "{}{stand} on both sides: bands of differences take them for independent",
                first.display()
            ));
        }
    }

    /// Curves of different domains are in one chart, each over its own frequencies.
    fn note_domains(&mut self) {
        let named =
            |subject: &Subject| format!("{} ({})", subject.label, region_text(&subject.region));
        let Some(first) = self.subjects.first() else {
            return;
        };
        let others = (self.subjects.iter()).filter(|subject| subject.region != first.region);
        let others: Vec<String> = others.map(named).collect();
        if !others.is_empty() {
            let (others, first) = (others.join(", "), named(first));
            self.note(format!("the domains differ: {others} beside {first}"));
        }
    }

    /// Student's quantile of one degree of freedom is 12.7.
    fn note_two_sets(&mut self) {
        self.note_each(|subject| {
            (subject.members.len() == 2).then(|| {
                format!(
                    "{}: two sets hardly tell their spread; bands from it are 12.7 standard errors wide on either side, with three \
                     sets 4.3",
                    subject.label
                )
            })
        });
    }

    /// The spectra of large sets end before their first ring.
    fn note_short_spectra(&mut self) {
        self.note_each(|subject| {
            let [x, y] = subject.spectrum.picture_reach;
            let reach = x.min(y);
            (reach < 0.9 * Spectrum::MAX_NU).then(|| {
                format!(
                    "{}: frequencies are looked at up to nu = {reach:.2}, {} cycles along a side; \
                     --frequencies asks for more",
                    subject.label,
                    Spectrum::MAX_CYCLES
                )
            })
        });
    }

    fn note_each(&mut self, note: impl Fn(&Subject) -> Option<String>) {
        let notes: Vec<String> = self.subjects.iter().filter_map(note).collect();
        for note in notes {
            self.note(note);
        }
    }

    /// Gives every subject names of its own; that of the reference may be a file's as well.
    fn name(&mut self) {
        // Two averages are told apart by their files.
        let is_average = |subject: &&mut Subject| subject.average;
        if self.subjects.iter_mut().filter(is_average).count() > 1 {
            for subject in self.subjects.iter_mut().filter(is_average) {
                let files = subject.members.iter().map(|member| member.name.as_str());
                let files = names::pattern(&files.collect::<Vec<&str>>());
                subject.name = format!("{}: {files}", subject.name);
            }
        }
        let each = self.subjects.iter();
        let names: Vec<String> = each.map(|subject| subject.name.clone()).collect();
        let labels = names::short(&names);
        let (reference, others) = self.subjects.split_at_mut(usize::from(self.has_reference));
        for subject in &mut *reference {
            subject.label.clone_from(&labels[0]);
            subject.title = format!("{} (reference)", subject.label);
            if names[1..].contains(&subject.name) {
                subject.name.push_str(" (reference)");
            }
        }
        let numbered = |all: &[String]| names::numbered(&all[reference.len()..]);
        for (subject, name) in others.iter_mut().zip(numbered(&names)) {
            subject.name = name;
        }
        for (subject, label) in others.iter_mut().zip(numbered(&labels)) {
            subject.title.clone_from(&label);
            subject.label = label;
        }
    }
}

/// Returns the canonical path of a file, or the path itself if there is no such file.
pub fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Returns, for each path of the same file as an earlier one, a sentence that says so.
fn repetitions(paths: &[PathBuf]) -> Vec<Option<String>> {
    let canonicals: Vec<PathBuf> = paths.iter().map(|path| canonical(path)).collect();
    let repetition = |(index, path): (usize, &PathBuf)| {
        let mut earlier = canonicals[..index].iter();
        let first = &paths[earlier.position(|other| *other == canonicals[index])?];
        Some(if path == first {
            format!("{} is given more than once", path.display())
        } else {
            format!("{} is the file {} again", path.display(), first.display())
        })
    };
    paths.iter().enumerate().map(repetition).collect()
}
