//! Sets of balls as runs whose darts are recorded: [`solid_recorded`].

use crate::error::SampleError;
use crate::lattice::{Domain, Point};
use crate::parameters::Parameters;
use crate::progress::Observer;
use crate::random::Key;
use crate::record::{Recorder, RunEvent};
use crate::reference::ended;
use crate::run::{Iteration, Run};
use crate::stages::disks::Cell;

use super::domain::SolidDomain;
use super::process::SolidProcess;

/// The run of a set of balls: its projection to x and y as a planar run, and what the projection lacks.
pub struct SolidRun {
    /// The projections of the samples, in the order of arrival. Its iterations are the throws; their cells are the projections
    /// of the active cubes. It has neither pattern nor blocks.
    pub projected: Run,
    /// Where each sample lies along the third axis, in units.
    pub heights: Vec<i32>,
    /// Of each throw, the lowest place of each active cube along the third axis, in units.
    pub cubes: Vec<Vec<i32>>,
}

/// Makes the set of [`crate::solid_sample`] on this thread, and reports events to `recorder`. Events have the projections of
/// places, and their third coordinate as `z`. `planar` is the domain of the projections, with the lattice of `domain`.
///
/// Of the parameters, the seed alone changes the set. Those of the run say uniform insertion, as all its samples are darts. Fails only
/// when `observer` stops it. The memory is not asked for in advance: callers record small sets only.
pub fn solid_recorded<T: Recorder>(
    domain: SolidDomain,
    planar: Domain,
    parameters: &Parameters,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<SolidRun, SampleError> {
    debug_assert_eq!(
        [planar.width(), planar.height()],
        domain.sides()[..2],
        "one lattice"
    );
    let mut process = SolidProcess::new(Key::from_seed(parameters.seed), &domain);
    let (mut points, mut heights) = (Vec::new(), Vec::new());
    let (mut iterations, mut cubes) = (Vec::new(), Vec::new());

    // This ends: cubes become smaller level by level, and the dart of a cube of one place falls on that place.
    while !process.is_finished() {
        let number = iterations.len() as u32 + 1;
        let first = points.len() as u32;
        // Events count active cubes as detectors, as they do active cells in the plane.
        recorder.record(RunEvent::Iteration {
            number,
            detectors: process.cubes().len() as u32,
        });

        let side = process.side();
        let squares = process.cubes().iter().map(|&[x, y, _]| Cell {
            min: Point::new(x, y),
            side,
        });
        let cells = squares.collect();
        cubes.push(process.cubes().iter().map(|&[.., z]| z).collect());

        let kept = process.step_recorded(number, first, observer, recorder)?;
        recorder.record(RunEvent::IterationEnd {
            number,
            inserted: kept.len() as u32,
        });
        points.extend(kept.iter().map(|&[x, y, _]| Point::new(x, y)));
        heights.extend(kept.iter().map(|&[.., z]| z));
        iterations.push(Iteration {
            cells,
            inserted: first..points.len() as u32,
            ..Iteration::default()
        });
    }

    // `ended` also reports the end of the run, and makes the parameters say uniform insertion.
    let parameters = ended(*parameters, points.len(), recorder);
    Ok(SolidRun {
        projected: Run::of_throws(parameters, planar, points, iterations),
        heights,
        cubes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, R};
    use crate::progress::Unobserved;
    use crate::solid::solid_sample;

    /// Keeps all events.
    struct Kept(Vec<RunEvent>);

    impl Recorder for Kept {
        fn record(&mut self, run_event: RunEvent) {
            self.0.push(run_event);
        }
    }

    #[test]
    fn a_recorded_set_is_the_set_and_has_its_events() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let (size, seed) = ([12.0, 11.0, 5.3], 9);
            let domain = SolidDomain::from_size(size, 1.0, boundary).expect("a box");
            let planar = Domain::from_size([size[0], size[1]], 1.0, boundary).expect("a domain");
            let parameters = Parameters {
                seed,
                ..Parameters::default()
            };
            let mut kept = Kept(Vec::new());
            let run = solid_recorded(domain, planar, &parameters, &mut Unobserved, &mut kept)
                .expect("a set");

            let made = solid_sample(domain, seed, &mut Unobserved).expect("a set");
            let points = run.projected.samples.points.iter();
            let recorded: Vec<[i32; 3]> = points
                .zip(&run.heights)
                .map(|(at, &z)| [at.x, at.y, z])
                .collect();
            assert_eq!(recorded, made);

            // Each insertion follows the dart that became the sample, which was not covered.
            let pairs = kept.0.windows(2);
            let inserted = pairs.filter_map(|pair| match pair {
                &[
                    RunEvent::Dart {
                        point,
                        z,
                        ranked: true,
                        ..
                    },
                    RunEvent::Insert { sample, .. },
                ] => Some((sample, [point.x, point.y, z])),
                _ => None,
            });
            let in_order = made
                .iter()
                .enumerate()
                .map(|(id, &place)| (id as u32, place));
            assert!(inserted.eq(in_order));

            // The first throw is into whole cells of R, and the cubes of a throw are as many as their projections.
            assert_eq!(run.projected.iterations[0].cells[0].side, R);
            for (iteration, cubes) in run.projected.iterations.iter().zip(&run.cubes) {
                assert_eq!(iteration.cells.len(), cubes.len());
            }
        }
    }
}
