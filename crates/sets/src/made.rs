//! Sets that were made, whatever made them.

use tilescope_analysis::{Control, Report, VerifyError, VerifyOptions, verify, verify_levels};
use tilescope_core::combine::Combined;
use tilescope_core::{Fate, Run, Source};
use tilescope_formats::{CertifiedLevel, PointSet, Provenance};

use crate::facts::{Facts, Stated};

/// A set in user units, with its facts.
#[derive(Clone, Debug)]
pub struct Made {
    /// Its positions, and where each came from, if that is known.
    pub set: PointSet,
    /// How it was made.
    pub facts: Facts,
}

impl Made {
    /// Returns the result of a run, with the run's counts.
    #[must_use]
    pub fn of_run(run: &Run, facts: Facts) -> Self {
        Self {
            set: point_set(run, &run.result),
            facts: Facts {
                summary: Some(run.summary()),
                ..facts
            },
        }
    }

    /// Returns the set of several side by side; `layout` says which, as certificates state it. In its provenance, pieces take
    /// the place of blocks.
    #[must_use]
    pub fn combined(found: &Combined, layout: serde_json::Value) -> Self {
        let parameters = Stated::from([("layout".to_owned(), layout)]);
        Self {
            set: PointSet {
                points: found.positions(),
                provenance: Some(provenance(&found.sources)),
            },
            facts: Facts {
                summary: Some(found.summary().clone()),
                ..Facts::new("combined", parameters, &found.domain)
            },
        }
    }

    /// Returns the verifier's report on the set, whatever it says.
    ///
    /// # Errors
    ///
    /// [`VerifyError`] when there is no verdict.
    pub fn judge(
        &self,
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<Report, VerifyError> {
        if let Some(varying) = &self.facts.varying {
            let (judged, points) = (&varying.judged, &self.set.points);
            return match self.facts.made {
                None => judged.verify(points, options, control),
                // More samples were made, and the set is the first ones of these. It need not cover every place: how
                // far places are from its samples is measured.
                Some(_) => judged.verify_prefix(points, options, control),
            };
        }
        // A set of one radius is whole. Only of stipples the first samples are kept, and the radius of stipples varies.
        let (region, radius) = (self.facts.region, self.facts.radius);
        verify(&self.set.points, region, radius, options, control)
    }

    /// Returns the verdict on each level of nested levels, `report` being that on the whole set.
    ///
    /// # Errors
    ///
    /// [`VerifyError`] when there is no verdict.
    pub fn judge_levels(
        &self,
        report: &Report,
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<Vec<CertifiedLevel>, VerifyError> {
        let claims = &self.facts.levels;
        let levels = verify_levels(&self.set.points, report, claims, options, control)?;
        Ok(levels.iter().map(CertifiedLevel::of).collect())
    }
}

/// Returns sources as point-set files have them.
#[must_use]
pub fn provenance(sources: &[Source]) -> Vec<Provenance> {
    sources.iter().map(|source| source.row().into()).collect()
}

/// Returns samples of a run as a set, with their provenance where the run has blocks.
///
/// # Panics
///
/// If the run has no sample of one of the ids. In debug builds, also if a sample was dropped.
#[must_use]
pub fn point_set(run: &Run, ids: &[u32]) -> PointSet {
    let samples = &run.samples;
    // Dropped samples lie outside of the domain, and no set has them.
    debug_assert!(
        ids.iter()
            .all(|&id| samples.fates[id as usize] != Fate::Dropped)
    );
    let points: Vec<_> = ids.iter().map(|&id| samples.points[id as usize]).collect();
    let source = |&id: &u32| Source::from(samples.origins[id as usize]).row().into();
    // Nested levels are made of several patterns and name no blocks.
    let has_sources = !run.blocks.leaves.is_empty();

    PointSet {
        points: run.domain.users_from_lattice(&points),
        provenance: has_sources.then(|| ids.iter().map(source).collect()),
    }
}
