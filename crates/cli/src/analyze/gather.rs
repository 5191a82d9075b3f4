//! From the files of the command line to subjects. A file that cannot be used is reported, and the others are analysed.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use serde::Serialize;
use tilescope_analysis::measures::Spectrum;

use super::differences::Differences;
use super::measured::{Measurement, Request, Source, check_domain};
use super::subject::{Population, Subject};
use super::{AnalyzeArguments, names};
use crate::output::region_text;
use crate::paths::{InFile, named};
use crate::{describe, interrupt, output};

/// A file that was not analysed, and why.
#[derive(Serialize)]
pub struct Failure {
    #[serde(rename = "file")]
    pub name: String,
    pub reason: String,
}

/// The content of the tables, the charts and the reports.
#[derive(Default)]
pub struct Analysis {
    /// The columns, that of `--against` first.
    pub subjects: Vec<Subject>,
    /// Whether the first is the reference of the others.
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

    /// Analyses the files one after another; only Ctrl-C and an unusable `--against` end it early.
    pub fn of(arguments: &AnalyzeArguments) -> Result<Self> {
        let (files, against) = (&arguments.files, &arguments.against);
        let paths: Vec<&Path> = against.iter().chain(files).map(PathBuf::as_path).collect();
        let request = Request::new(
            (&arguments.set, &arguments.ground),
            arguments.frequencies,
            &paths,
        );
        let mut analysis = Self {
            has_reference: !against.is_empty(),
            averaged: arguments.average,
            ..Self::default()
        };

        // A single set is the reference itself; several are averaged. A file that cannot be read counts as one set: the
        // measurement then reports why.
        if let [path] = &against[..]
            && request.sources(path).map_or(1, |sources| sources.len()) == 1
        {
            // Only the sets of an average have frequencies and bins in common.
            let reference = request
                .measure(Source::whole(path), None)
                .context("--against")?;
            // `Subject::one` returns `None` only for no set at all, and here is one.
            analysis.subjects.extend(Subject::one(reference)?);
        } else if analysis.has_reference {
            let average = (analysis.average(against, &request)?)
                .context("--against: none of its sets can be used")?;
            analysis.subjects.push(average);
        }

        if arguments.average {
            let average = analysis.average(files, &request)?;
            analysis.subjects.extend(average);
        } else {
            analysis.one_by_one(files, &request)?;
        }

        analysis.note_shared(arguments);
        analysis.assign_names();
        analysis.note_domains();
        analysis.note_two_sets();
        if arguments.frequencies.is_none() {
            analysis.note_short_spectra();
        }

        if let Some(reference) = analysis.reference() {
            let each = analysis.compared().iter();
            let differences = each.map(|subject| Differences::of(subject, reference));
            analysis.differences = differences.collect::<Result<_, _>>()?;
        }
        Ok(analysis)
    }

    /// Measures each set by itself. A file that cannot be analysed is noted, and the others are measured. Fails if the
    /// command was asked to end.
    fn one_by_one(&mut self, paths: &[PathBuf], request: &Request<'_>) -> Result<()> {
        for (path, repetition) in paths.iter().zip(repetitions(paths)) {
            // Each set has the frequencies and the bins that suit it.
            let nothing_common = None;
            let set = (request.measure(Source::whole(path), nothing_common))
                .and_then(|set| self.with_domain_of_reference(set));
            match set.and_then(|set| Ok(Subject::one(set)?)) {
                Ok(subject) => {
                    self.subjects.extend(subject);
                    // Two equal columns are only noted, unlike a set that would count twice in an average.
                    if let Some(repetition) = repetition {
                        self.note(format!("{repetition}: it is analysed twice"));
                    }
                }
                Err(error) => self.fail(Source::whole(path), error)?,
            }
        }
        Ok(())
    }

    /// Averages all sets of files and keeps only their numbers. A file or a set that cannot be used is noted and left
    /// out; `None` if no set can be used.
    fn average(&mut self, paths: &[PathBuf], request: &Request<'_>) -> Result<Option<Subject>> {
        let mut population = Population::default();
        for (path, repetition) in paths.iter().zip(repetitions(paths)) {
            let found = match repetition {
                Some(repetition) => Err(anyhow!("{repetition}: a set counts once in an average")),
                None => request.sources(path),
            };
            let sources = match found {
                Ok(sources) => sources,
                Err(error) => {
                    self.fail(Source::whole(path), error)?;
                    continue;
                }
            };

            for source in sources {
                // The first set determines the frequencies and the bins of all.
                let measured = request.measure(source, population.common.as_ref());
                let set = measured.and_then(|set| self.with_domain_of_reference(set));
                if let Err(error) = set.and_then(|set| Ok(population.add(set)?)) {
                    self.fail(source, error)?;
                }
            }
        }
        let is_average = true;
        Ok(population.finish(is_average)?)
    }

    /// Reports that a set is not analysed. Fails with the same error if the command was asked to end.
    fn fail(&mut self, source: Source<'_>, error: anyhow::Error) -> Result<()> {
        // The file then has no fault: its work was stopped, and that of the others is not to begin.
        if interrupt::requested() {
            return Err(error);
        }
        let reason = describe(&error);
        output::note(&format!("error: {reason}"));
        let name = source.name();
        self.failures.push(Failure { name, reason });
        Ok(())
    }

    pub fn note(&mut self, note: String) {
        output::note(&format!("note: {note}"));
        self.notes.push(note);
    }

    /// Returns a set unless its domain differs from that of the reference.
    fn with_domain_of_reference(&self, set: Measurement) -> Result<Measurement> {
        if let Some(Subject { name, region, .. }) = self.reference() {
            let member = &set.member;
            check_domain(member.region, name, *region).in_file(Path::new(&member.name))?;
        }
        Ok(set)
    }

    /// Notes files that are on both sides of a comparison: bands of differences are right only for independent sets.
    fn note_shared(&mut self, arguments: &AnalyzeArguments) {
        // A file may be named by several paths.
        let against = canonicals(&arguments.against);
        let mut shared = (arguments.files.iter()).filter(|path| against.contains(&canonical(path)));
        if let Some(first) = shared.next() {
            let stand = match shared.count() {
                0 => " stands".to_owned(),
                more => format!(" and {more} more stand"),
            };
            self.note(format!(
                "{}{stand} on both sides: bands of differences are computed as if sets were independent",
                named(first)
            ));
        }
    }

    /// Notes domains that differ: their curves are in one chart, each over its own frequencies.
    fn note_domains(&mut self) {
        let named = |one: &Subject| format!("{} ({})", one.label, region_text(&one.region));
        let first = self.subjects.first().map(|first| first.region);
        let (same, others): (Vec<&Subject>, Vec<&Subject>) =
            (self.subjects.iter()).partition(|one| Some(one.region) == first);
        if !others.is_empty() {
            let others: Vec<String> = others.into_iter().map(named).collect();
            // The first subject is among those of its own domain.
            let (others, first) = (others.join(", "), named(same[0]));
            self.note(format!("the domains differ: {others} beside {first}"));
        }
    }

    /// Notes averages of two sets, whose bands are wide.
    fn note_two_sets(&mut self) {
        // A band at 0.95 is as wide as Student's quantile at 0.975: of one degree of freedom 12.7, and of two 4.3.
        let remark = "two sets hardly tell their spread; bands from it are 12.7 standard errors wide on either side, \
                      with three sets 4.3";
        self.note_each(|one| (one.members.len() == 2).then(|| format!("{}: {remark}", one.label)));
    }

    /// Notes spectra that end early, as those of large sets do, even before their first ring.
    fn note_short_spectra(&mut self) {
        self.note_each(|one| {
            let [x, y] = one.spectrum.picture_reach;
            let (label, reach, cycles) = (&one.label, x.min(y), Spectrum::MAX_CYCLES);
            let end = format!("nu = {reach:.2}, {cycles} cycles along a side");
            let note = format!("{label}: spectra end at {end}; --frequencies extends them");
            // Less than a tenth short, a chart shows what others show.
            Some(note).filter(|_| reach < 0.9 * Spectrum::MAX_NU)
        });
    }

    fn note_each(&mut self, note: impl Fn(&Subject) -> Option<String>) {
        let notes: Vec<String> = self.subjects.iter().filter_map(note).collect();
        for note in notes {
            self.note(note);
        }
    }

    /// Gives every subject a name and a title that no other has. The reference may be one of the compared files: then
    /// its name says that it is the reference, and the label alone is the same for both.
    fn assign_names(&mut self) {
        // The names of two averages differ by their files.
        let is_average = |subject: &&mut Subject| subject.average;
        if self.subjects.iter_mut().filter(is_average).count() > 1 {
            for subject in self.subjects.iter_mut().filter(is_average) {
                let files = subject.members.iter().map(|member| member.name.as_str());
                let shared = names::pattern(&files.collect::<Vec<&str>>());
                subject.name = format!("{}: {shared}", subject.name);
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

        // Numbers are for files of one name among the compared ones: the reference is marked already, and takes none.
        let numbered_others = |all: &[String]| names::numbered(&all[reference.len()..]);
        let unique = numbered_others(&names)
            .into_iter()
            .zip(numbered_others(&labels));
        for (subject, (name, label)) in others.iter_mut().zip(unique) {
            subject.name = name;
            subject.title.clone_from(&label);
            subject.label = label;
        }
    }
}

/// Returns the canonical path of a file, or the path itself if there is no such file.
pub fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn canonicals(paths: &[PathBuf]) -> Vec<PathBuf> {
    paths.iter().map(|path| canonical(path)).collect()
}

/// Returns a remark for each path whose file occurred before.
fn repetitions(paths: &[PathBuf]) -> Vec<Option<String>> {
    let canonicals = canonicals(paths);
    let repetition = |(index, path): (usize, &PathBuf)| {
        let mut earlier = canonicals[..index].iter();
        let first = &paths[earlier.position(|other| *other == canonicals[index])?];
        Some(if path == first {
            format!("{} is given more than once", named(path))
        } else {
            format!("{} is the file {} again", named(path), named(first))
        })
    };
    paths.iter().enumerate().map(repetition).collect()
}
