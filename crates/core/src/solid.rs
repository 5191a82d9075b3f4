//! Maximal sets of balls in three dimensions: [`solid_sample`].
//!
//! They are made by the process of the reference sampler ([`crate::stages::darts`]), one dimension up. A level works on
//! active cubes of one side. In a throw each cube gets a Poisson number of darts, which are taken by rank; one that no
//! sample covers becomes a sample. After the level's throws each cube is cut in eight, and the octants that no single
//! sample covers are the cubes of the next level. Cubes of one unit hold one place and throw exactly it, so that no lattice
//! point stays uncovered.
//!
//! *Why it ends soon.* A cube of side s stays active only where the nearest sample is nearly r away, farther than
//! r - O(s). The volume of such places is O(s^4), so that their cubes are O(s) in number: they halve with each level, as
//! in the plane.
//!
//! Read [`process`] first. [`darts`] has the draws, [`balls`] the samples; [`parallel`] makes the
//! same set several times as fast, on all threads. [`space`] has the windows of space without end.

mod arrivals;
mod balls;
mod count;
mod darts;
mod domain;
mod frame;
mod parallel;
mod process;
mod recorded;
mod space;

use crate::error::SampleError;
use crate::memory::{self, Making};
use crate::progress::Observer;
use crate::random::Key;
use crate::stage::Stage;
use process::SolidProcess;

pub use arrivals::{SolidArrivals, SolidLevels};
pub use count::{SolidRequest, SolidSample};
pub use domain::{MAX_VOLUME_RADII, MIN_SIDE_RADII_SOLID, SolidDomain};
pub use recorded::{SolidRun, solid_recorded};
pub use space::{MAX_REACH_RADII, SolidSpace, SolidWindow};

/// A lattice point of space: x, y and z in units.
type Place = [i32; 3];

/// About how many samples there are to a cubed radius in a large maximal set: the density at which random sequential
/// packing of spheres jams, 0.3841307, times 6 / pi.
pub const SOLID_DENSITY: f64 = 0.733_636;

/// Returns a maximal set of balls of `domain`, in the order of their arrival: lattice points x, y, z.
///
/// No two samples are within the radius of each other, and *no lattice point* of the domain is farther from all samples.
/// Equal seeds and domains give equal sequences. Fails only when there is not enough memory or `observer` stops it;
/// progress is reported as [`Stage::Iterate`], one iteration for each throw.
///
/// ```
/// use tilescope_core::{Boundary, SolidDomain, Unobserved, solid_sample, solid_sample_parallel};
///
/// let domain = SolidDomain::from_size([10.0, 10.0, 10.0], 1.0, Boundary::Periodic)?;
/// let samples = solid_sample(domain, 1, &mut Unobserved)?;
/// assert!((690..780).contains(&samples.len()));
/// assert_eq!(samples, solid_sample_parallel(domain, 1, &mut Unobserved)?);
/// let positions = domain.users_from_lattice(&samples);
/// assert!(positions.iter().flatten().all(|value| (0.0..10.0).contains(value)));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub fn solid_sample(
    domain: SolidDomain,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<[i32; 3]>, SampleError> {
    Ok(solid_arrivals(domain, seed, observer)?.places)
}

/// Returns the same samples as [`solid_sample`], several times as fast and on all threads of the current rayon pool.
pub fn solid_sample_parallel(
    domain: SolidDomain,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<[i32; 3]>, SampleError> {
    Ok(solid_arrivals_parallel(domain, seed, observer)?.places)
}

/// Returns the same samples as [`solid_sample`], with the levels at which they arrived.
///
/// Fails as [`solid_sample`].
pub fn solid_arrivals(
    domain: SolidDomain,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<SolidArrivals, SampleError> {
    ask_for_memory(&domain)?;
    let mut process = SolidProcess::new(Key::from_seed(seed), &domain);
    let mut made = SolidArrivals::default();
    let mut throw = 0;
    // This ends: cubes become smaller level by level, and one of a single place throws exactly it.
    while !process.is_finished() {
        throw += 1;
        let level = process.level();
        made.add(level, process.step(Stage::Iterate(throw), observer)?);
    }
    Ok(made)
}

/// Returns the same as [`solid_arrivals`], several times as fast and on all threads of the current rayon pool.
///
/// Fails as [`solid_sample`].
pub fn solid_arrivals_parallel(
    domain: SolidDomain,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<SolidArrivals, SampleError> {
    ask_for_memory(&domain)?;
    parallel::sample(&domain, seed, observer)
}

/// Fails if the system does not give the memory that a set takes.
fn ask_for_memory(domain: &SolidDomain) -> Result<(), SampleError> {
    memory::ask_for(domain.expected_samples(), Making::Solid.bytes_a_sample())?;
    Ok(())
}
