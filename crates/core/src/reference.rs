//! The reference sampler: maximal Poisson-disk sets from scratch (Ebeida et al. 2012), on the lattice. It is the
//! reference for quality, the baseline for speed, and makes the patterns. It does not use tiling.

use crate::error::SampleError;
use crate::lattice::{Domain, Point};
use crate::parameters::{Insertion, Parameters};
use crate::progress::Observer;
use crate::random::Key;
use crate::record::{Recorder, RunEvent, Unrecorded};
use crate::stage::Stage;
use crate::stages::darts::{DartGround, DartProcess};

/// Returns a maximal Poisson-disk set of `domain` in canonical order.
///
/// No two samples cover each other, and *no lattice point* of the domain is uncovered, which is stricter than the
/// promise of KDRT. Equal seeds and domains give equal sets. Fails only when `observer` stops it; progress is reported
/// as [`Stage::Iterate`], one iteration for each throw.
pub fn reference_sample(
    domain: Domain,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    let mut samples = reference_recorded(domain, seed, observer, &mut Unrecorded)?;
    samples.sort_unstable_by_key(|p| p.canonical());
    Ok(samples)
}

/// Like [`reference_sample`], and reports events to `recorder`. The samples are in the order of their insertion, which is
/// that of the ids in the events.
pub fn reference_recorded<T: Recorder>(
    domain: Domain,
    seed: u64,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<Vec<Point>, SampleError> {
    let process = DartProcess::everywhere(Key::from_seed(seed), domain);
    finished(process, observer, recorder)
}

/// Returns the samples of a process in the order of their arrival, which is that of the ids in the events.
pub(crate) fn finished<G: DartGround, T: Recorder>(
    mut process: DartProcess<G>,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<Vec<Point>, SampleError> {
    let mut samples = Vec::new();
    let mut number = 0;

    // The process ends: cells become smaller level by level, and a cell of a single point throws that point for certain.
    while !process.is_finished() {
        number += 1;
        throw(&mut process, number, &mut samples, observer, recorder)?;
    }
    Ok(samples)
}

/// Makes the throw of this number, from 1, and appends its samples to those so far.
pub(crate) fn throw<G: DartGround, T: Recorder>(
    process: &mut DartProcess<G>,
    number: u32,
    samples: &mut Vec<Point>,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<(), SampleError> {
    // The active cells take the place of detectors, as in uniform insertion.
    recorder.record(RunEvent::Iteration {
        number,
        detectors: process.active_cells().len() as u32,
    });

    let first_id = samples.len() as u32;
    let stage = Stage::Iterate(number);
    let inserted = process.step_recorded(stage, observer, first_id, recorder)?;
    recorder.record(RunEvent::IterationEnd {
        number,
        inserted: inserted.len() as u32,
    });
    samples.extend(inserted);
    Ok(())
}

/// Reports the end of a run of darts that has this number of samples, and returns its parameters: they say uniform insertion, whose
/// iterations are throws of darts, too.
pub(crate) fn ended<T: Recorder>(
    parameters: Parameters,
    samples: usize,
    recorder: &mut T,
) -> Parameters {
    recorder.record(RunEvent::Begin(Stage::Finish));
    recorder.record(RunEvent::Finish {
        count: samples as u32,
    });
    Parameters {
        insertion: Insertion::Uniform,
        ..parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::progress::Unobserved;
    use crate::stages::disks::DiskGrid;

    fn density(boundary: Boundary, side: f64) -> (usize, f64) {
        let domain = Domain::from_size([side, side], 1.0, boundary).unwrap();
        let samples = reference_sample(domain, 7, &mut Unobserved).unwrap();
        for (k, &a) in samples.iter().enumerate() {
            assert!(samples[k + 1..].iter().all(|&b| !domain.covers(a, b)));
        }
        let mut disks = DiskGrid::new(domain);
        assert!(samples.iter().all(|&p| disks.insert(p)));
        assert_eq!(disks.uncovered_point(0), None);
        (samples.len(), samples.len() as f64 / domain.area_radii())
    }

    #[test]
    fn sets_are_conflict_free_and_cover_every_lattice_point() {
        let (count, periodic) = density(Boundary::Periodic, 60.0);
        assert!(count > 2400);
        assert!((0.68..0.71).contains(&periodic), "{periodic}");
        let (_, bounded) = density(Boundary::Bounded, 60.3);
        assert!((0.70..0.74).contains(&bounded), "{bounded}");
    }

    #[test]
    fn cancelling_is_an_error_that_says_where() {
        let domain = Domain::from_size([20.0; 2], 1.0, Boundary::Periodic).unwrap();
        let mut stop = |_| std::ops::ControlFlow::Break(());
        assert_eq!(
            reference_sample(domain, 0, &mut stop),
            Err(SampleError::Cancelled {
                stage: Stage::Iterate(1)
            })
        );
    }
}
