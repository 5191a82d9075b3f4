//! The set of a field and a shape on all threads: the samples, and their order, of the process of darts in
//! [`crate::stages::darts`], which is there to be read and recorded.
//!
//! A *family* is a base cell with its active parts and the samples near it, and a *parcel* all families of a large square. Between
//! two throws the samples stay as they are. So a thread takes a parcel, cuts the active parts, throws their darts, and keeps
//! those that no listed sample is near. Then [`Crowd`] decides which of the darts of all parcels become samples, and these are
//! handed to the parcels around them.
//!
//! Which cells are active is only a matter of speed: a dart near an earlier sample changes nothing, wherever it is thrown. Here
//! comparisons are a little less sharp than there, so that a few more cells are active.

// What is inlined is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

mod draws;
mod parcel;

use fearless_simd::dispatch;
use rayon::prelude::*;

use super::crowd::{Crowd, OpenDart};
use super::field::RadiusField;
use super::octaves::octave_of;
use super::shape::Shape;
use crate::error::SampleError;
use crate::instructions::InstructionSet;
use crate::lattice::{Domain, Point};
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::stage::Stage;
use crate::stages::darts::{throw_key, throws};
use crate::stages::disks::{Cell, tiling_cells};
use parcel::{NewSample, Parcel, ParcelBuffers};

/// A parcel is this many of the narrowest base cells wide, as a power of two: with few, more samples are handed to several
/// parcels, and with many, some threads wait for the last one.
const PARCEL_BITS: u32 = 4;

/// Parcels for each thread between two reports to the observer.
const PARCELS_A_THREAD: usize = 16;

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

/// Returns the samples of a seed in the order of their arrival. Fails only when `observer` stops it.
pub(super) fn sample(
    field: &RadiusField,
    shape: &Shape,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    let surroundings = Surroundings { field, shape };
    let crowd = Crowd::new(field);
    let mut parcels = Parcels::new(surroundings);
    let (mut points, mut darts) = (Vec::new(), Vec::new());

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

        darts.clear();
        for parcel in &parcels.all {
            darts.extend_from_slice(&parcel.darts);
        }
        for index in crowd.kept(&darts) {
            let dart = &darts[index as usize];
            points.push(dart.at);
            parcels.hand_out(field.domain(), dart);
        }

        number += 1;
        if number == throws(level) {
            (level, number) = (level + 1, 0);
        }
    }
    Ok(points)
}

/// All parcels of a domain, row by row.
struct Parcels {
    /// The binary logarithm of a parcel's side.
    bits: u32,
    columns: usize,
    all: Vec<Parcel>,
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
            bits,
            columns: ((rect.width() - 1) >> bits) as usize + 1,
            all: squares.par_iter().map(parcel).collect(),
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
        let mut active: Vec<&mut Parcel> = self.all.iter_mut().collect();
        active.retain(|parcel| !parcel.is_finished());
        let parts = |parcels: &[&mut Parcel]| -> u64 {
            let counts = parcels.iter().map(|parcel| parcel.active_parts() as u64);
            counts.sum()
        };

        let mut meter = Meter::begin(observer, Stage::Iterate(iteration), parts(&active))?;
        let instructions = InstructionSet::best().level();
        // The observer is called on this thread alone.
        for batch in active.chunks_mut(rayon::current_num_threads() * PARCELS_A_THREAD) {
            let pieces = parts(batch);
            batch
                .par_iter_mut()
                .for_each_init(ParcelBuffers::default, |buffers, parcel| {
                    dispatch!(instructions, simd => parcel.advance(simd, throw, surroundings, buffers));
                });
            meter.count(pieces)?;
        }
        meter.end()
    }

    /// Hands a new sample to all parcels in which it may be near a place.
    fn hand_out(&mut self, domain: &Domain, dart: &OpenDart) {
        // A sample is near places up to the harmonic mean of their two radii, which is less than twice its own radius.
        let reach = 2 * i64::from(dart.radius);
        let rect = domain.rect();
        let [width, height] = [rect.width(), rect.height()].map(i64::from);
        let is_periodic = domain.is_periodic();

        for (y, [first_row, last_row]) in images(dart.at.y, reach, height, self.bits, is_periodic) {
            for (x, [first, last]) in images(dart.at.x, reach, width, self.bits, is_periodic) {
                for row in first_row..=last_row {
                    for parcel in &mut self.all[row * self.columns..][first..=last] {
                        parcel.receive(NewSample {
                            x,
                            y,
                            radius: dart.radius,
                        });
                    }
                }
            }
        }
    }
}

/// Returns a coordinate, and those of its images beyond the ends of a periodic axis that reach back into it. The axis
/// is cut into parts that are two to the power `bits` long: with each coordinate come the numbers of the first and the
/// last part that hold a place at most `reach` from it.
fn images(
    at: i32,
    reach: i64,
    side: i64,
    bits: u32,
    is_periodic: bool,
) -> impl Iterator<Item = (i64, [usize; 2])> {
    let at = i64::from(at);
    let below = (is_periodic && at + reach >= side).then_some(at - side);
    let above = (is_periodic && at - reach < 0).then_some(at + side);
    [Some(at), below, above]
        .into_iter()
        .flatten()
        .map(move |image| {
            let ends = [(image - reach).max(0), (image + reach).min(side - 1)];
            (image, ends.map(|place| (place >> bits) as usize))
        })
}
