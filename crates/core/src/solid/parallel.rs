//! Sets of balls on all threads: the samples, and their order, of the process in [`super::process`], which is there to be read
//! and recorded.
//!
//! A *parcel* is a block of cells of side R, with their active cubes and, for each cell, a list of the samples that can cover a
//! place of it. Between two throws the samples stay as they are. So a thread takes a parcel, lists the samples of the last throw,
//! cuts the active cubes, throws their darts, and keeps those that no listed sample covers: these are *contenders*. Then
//! [`contest`] decides which contenders become samples.
//!
//! Which cubes are active is only a matter of speed: a dart that is covered changes nothing, wherever it is thrown. Here cubes
//! are compared with samples by numbers that are rounded, so that very few more are active than there.

// An inlined function is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

mod contest;
mod cover;
mod draws;
mod parcel;
mod parcels;

use fearless_simd::dispatch;
use rayon::prelude::*;

use super::Place;
use super::arrivals::SolidArrivals;
use super::darts::SolidThrow;
use super::domain::SolidDomain;
use crate::error::SampleError;
use crate::instructions::InstructionSet;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::stage::Stage;
use contest::{Contest, NewBall};
use parcel::{CellParcel, ParcelScratch};
use parcels::ParcelGrid;

/// Parcels for each thread between two reports to the observer.
const PARCELS_A_THREAD: usize = 64;

/// Returns the samples of a seed in the order of their arrival, with their levels. Fails only when `observer` stops it.
pub(super) fn sample(
    domain: &SolidDomain,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<SolidArrivals, SampleError> {
    let grid = ParcelGrid::new(domain);
    let numbers = (0..grid.count()).into_par_iter();
    let mut parcels: Vec<CellParcel> = numbers.map(|number| grid.parcel(number)).collect();
    // The samples of the last throw, by parcels.
    let mut fresh: Vec<Vec<NewBall>> = vec![Vec::new(); parcels.len()];
    let mut made = SolidArrivals::default();

    let mut throw = SolidThrow::new(Key::from_seed(seed), 0, 0);
    // This ends: cubes become smaller level by level, and one of a single place throws exactly it.
    for iteration in 1.. {
        if parcels.iter().all(CellParcel::is_finished) {
            break;
        }
        let stage = Stage::Iterate(iteration);
        advance(&mut parcels, &fresh, &grid, throw, stage, observer)?;

        let contest = Contest {
            parcels: &parcels,
            grid: &grid,
        };
        fresh = contest.decided();
        made.add(throw.level(), in_order(&fresh));
        throw = throw.next(Key::from_seed(seed));
    }
    Ok(made)
}

/// Lists the samples of the last throw, cuts the cubes, if the throw is the first one of its level, and throws darts, in all
/// parcels that are not finished.
fn advance(
    parcels: &mut [CellParcel],
    fresh: &[Vec<NewBall>],
    grid: &ParcelGrid,
    throw: SolidThrow,
    stage: Stage,
    observer: &mut dyn Observer,
) -> Result<(), SampleError> {
    let numbered = (0..).zip(parcels);
    let mut active: Vec<(usize, &mut CellParcel)> = numbered
        .filter(|(_, parcel)| !parcel.is_finished())
        .collect();
    let cubes = |parcels: &[(usize, &mut CellParcel)]| -> u64 {
        let counts = parcels.iter().map(|(_, parcel)| parcel.active_cubes());
        counts.sum()
    };

    let mut meter = Meter::begin(observer, stage, cubes(&active))?;
    let level = InstructionSet::best().level();
    // The observer is called on this thread alone.
    for batch in active.chunks_mut(rayon::current_num_threads() * PARCELS_A_THREAD) {
        let pieces = cubes(batch);
        batch
            .par_iter_mut()
            .for_each_init(ParcelScratch::default, |scratch, (number, parcel)| {
                for (other, shift) in grid.around(*number) {
                    parcel.list(&fresh[other], shift);
                }
                dispatch!(level, simd => parcel.throw(simd, throw, scratch));
            });
        meter.count(pieces)?;
    }
    meter.end()
}

/// Returns the places of the samples of a throw in the order of their arrival.
fn in_order(fresh: &[Vec<NewBall>]) -> impl Iterator<Item = Place> {
    let mut balls: Vec<NewBall> = fresh.iter().flatten().copied().collect();
    balls.par_sort_unstable_by_key(NewBall::arrival);
    balls.into_iter().map(|ball| ball.place)
}
