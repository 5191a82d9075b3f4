//! The set of a field and a shape on all threads: the samples, and their order, of the process of darts in
//! [`crate::stages::darts`], which is there to be read and recorded.
//!
//! A *family* is a base cell with its active parts and the samples near it, and a *parcel* all families of a large square. Between
//! two throws the samples stay as they are. So a thread takes a parcel, cuts the active parts, throws their darts, and keeps
//! those that no listed sample is near. Then [`Crowd`] decides which of the darts of all parcels become samples, and with the next
//! throw each parcel takes those that may be near its places.
//!
//! Which cells are active is only a matter of speed: a dart near an earlier sample changes nothing, wherever it is thrown. Here
//! comparisons are a little less sharp than there, so that a few more cells are active.

// An inlined function is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

mod draws;
mod parcel;

use std::ops::Range;

use fearless_simd::dispatch;
use glam::IVec2;
use rayon::prelude::*;

use super::crowd::{Crowd, NewSample, OpenDart};
use super::field::RadiusField;
use super::octaves::octave_of;
use super::shape::Shape;
use crate::error::SampleError;
use crate::instructions::InstructionSet;
use crate::lattice::{Domain, Point};
use crate::pool::Pool;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::stage::Stage;
use crate::stages::darts::{throw_key, throws};
use crate::stages::disks::{Cell, tiling_cells};
use parcel::{Parcel, ParcelBuffers};

/// A parcel is this many of the narrowest base cells wide, as a power of two: with few, more samples are listed by several
/// parcels, and with many, some threads wait for the last one.
const PARCEL_BITS: u32 = 4;

/// Active parts for each thread between two reports to the observer, some 10 ms: all threads wait for the last parcel then.
const PARTS_A_THREAD: u64 = 1 << 16;

/// A throw of all active parts.
#[derive(Clone, Copy)]
struct LevelThrow {
    key: Key,
    level: u32,
    /// Its number in its level, from 0.
    number: u32,
}

/// Where samples are made.
#[derive(Clone, Copy)]
struct Surroundings<'a> {
    field: &'a RadiusField,
    shape: &'a Shape,
}

/// Returns the samples of a seed in the order of their arrival. Fails when `observer` stops it, or
/// the system does not give the memory.
pub(super) fn sample(
    field: &RadiusField,
    shape: &Shape,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    let surroundings = Surroundings { field, shape };
    let crowd = Crowd::new(field)?;
    let mut parcels = Parcels::new(surroundings);
    let mut points = Vec::new();

    let (mut level, mut number) = (0, 0);
    for iteration in 1.. {
        if parcels.are_finished() {
            break;
        }
        let throw = LevelThrow {
            key: throw_key(Key::from_seed(seed), level, number),
            level,
            number,
        };
        parcels.throw(throw, surroundings, iteration, observer)?;

        let darts: Vec<&[OpenDart]> = parcels.all.iter().map(|parcel| &*parcel.darts).collect();
        let kept = crowd.kept(&darts);
        points.extend(in_order(&kept));
        parcels.fresh.of_parcels = kept;

        number += 1;
        if number == throws(level) {
            (level, number) = (level + 1, 0);
        }
    }
    Ok(points)
}

/// Returns the places of the samples of a throw in the order of their arrival.
fn in_order(fresh: &[Vec<NewSample>]) -> impl Iterator<Item = Point> {
    let mut samples = fresh.concat();
    samples.par_sort_unstable_by_key(NewSample::arrival);
    samples.into_iter().map(|sample| sample.at)
}

/// All parcels of a domain, row by row.
struct Parcels {
    all: Vec<Parcel>,
    fresh: FreshSamples,
    buffers: Pool<ParcelBuffers>,
}

impl Parcels {
    /// Returns the parcels before the first throw.
    fn new(surroundings: Surroundings<'_>) -> Self {
        let field = surroundings.field;
        let [least, greatest] = field.extremes().map(|radius| u32::from(octave_of(radius)));
        // No base cell is wider than the octave of the largest radius.
        let bits = greatest.max(least + PARCEL_BITS);

        // The rectangle has the far borders of a bounded domain, too: places on them may need parcels of their own.
        let rect = field.domain().rect();
        let squares: Vec<Cell> = tiling_cells(&rect, 1 << bits).collect();
        let parcel = |&square: &Cell| Parcel::new(square, surroundings);
        Self {
            all: squares.par_iter().map(parcel).collect(),
            fresh: FreshSamples {
                domain: *field.domain(),
                bits,
                columns: ((rect.width() - 1) >> bits) as usize + 1,
                largest: field.extremes()[1],
                of_parcels: vec![Vec::new(); squares.len()],
            },
            buffers: Pool::default(),
        }
    }

    fn are_finished(&self) -> bool {
        self.all.iter().all(Parcel::is_finished)
    }

    /// Makes the throw of an iteration. Before the first throw of each level but level 0, parts are cut.
    fn throw(
        &mut self,
        throw: LevelThrow,
        surroundings: Surroundings<'_>,
        iteration: u32,
        observer: &mut dyn Observer,
    ) -> Result<(), SampleError> {
        let Self {
            all,
            fresh,
            buffers,
        } = self;
        let mut active: Vec<&mut Parcel> = all.iter_mut().collect();
        active.retain(|parcel| !parcel.is_finished());
        let total = active.iter().map(|parcel| parcel.active_parts()).sum();

        let mut meter = Meter::begin(observer, Stage::Iterate(iteration), total)?;
        let instructions = InstructionSet::best().level();
        let mut rest = &mut *active;
        while !rest.is_empty() {
            let most = PARTS_A_THREAD * rayon::current_num_threads() as u64;
            let (count, parts) = first_batch(rest, most);
            let (batch, later) = rest.split_at_mut(count);
            rest = later;

            // Other threads may take single parcels over, so that none of them waits long for the last.
            batch.par_iter_mut().with_max_len(1).for_each(|parcel| {
                fresh.list_in(parcel);
                let mut own = buffers.take();
                dispatch!(instructions, simd => parcel.advance(simd, throw, surroundings, &mut own));
                buffers.give(own);
            });
            // The observer is called on this thread alone.
            meter.count(parts)?;
        }
        meter.end()
    }
}

/// Returns how many of some parcels, which are not none, have `most` active parts or a few more, and how many these have.
fn first_batch(parcels: &[&mut Parcel], most: u64) -> (usize, u64) {
    let (mut count, mut parts) = (0, 0);
    while count < parcels.len() && parts < most {
        parts += parcels[count].active_parts();
        count += 1;
    }
    (count, parts)
}

/// The samples of the last throw.
struct FreshSamples {
    domain: Domain,
    /// The binary logarithm of a parcel's side.
    bits: u32,
    /// Parcels of a row.
    columns: usize,
    /// The largest radius of all places.
    largest: i32,
    /// By the parcels in which they lie, row by row.
    of_parcels: Vec<Vec<NewSample>>,
}

impl FreshSamples {
    /// Adds them to the lists of a parcel, as far as they may be near one of its places.
    fn list_in(&self, parcel: &mut Parcel) {
        let [along_x, along_y] = parcel.reached(self.largest);
        for (rows, up) in beside(&self.domain, along_y, self.bits, 1) {
            for (held, right) in beside(&self.domain, along_x, self.bits, 0) {
                for row in rows.clone() {
                    for samples in &self.of_parcels[row * self.columns..][held.clone()] {
                        parcel.list(samples, IVec2::new(right, up));
                    }
                }
            }
        }
    }
}

/// Returns which parcels along an axis hold places from `first` to `last` on it, with what leads from these to those: 0, or a side
/// of a periodic domain. Parcels are two to the power `bits` wide.
fn beside(
    domain: &Domain,
    [first, last]: [i64; 2],
    bits: u32,
    axis: usize,
) -> impl Iterator<Item = (Range<usize>, i32)> + use<> {
    let rect = domain.rect();
    let side = [rect.width(), rect.height()][axis];
    let count = if domain.is_periodic() { 3 } else { 1 };
    [0, side, -side]
        .into_iter()
        .take(count)
        .filter_map(move |shift| {
            let low = (first - i64::from(shift)).max(0);
            let high = (last - i64::from(shift)).min(i64::from(side) - 1);
            // The shifted axis may end before the places.
            (low <= high).then(|| {
                let parcels = (low >> bits) as usize..(high >> bits) as usize + 1;
                (parcels, shift)
            })
        })
}
