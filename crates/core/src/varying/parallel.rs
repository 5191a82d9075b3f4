//! The set of a field and a shape on all threads: the samples, and their order, of the process of darts in
//! [`crate::stages::darts`], which is there to be read and recorded.
//!
//! A *family* is a base cell of which some part is active. Between two throws the samples stay as they are. So a thread takes a
//! family, gathers the samples around it once, cuts its active parts, throws their darts, and keeps those that no sample is near.
//! Then [`Crowd`] decides which of the darts of all families become samples.
//!
//! Which cells are active is only a matter of speed: a dart near an earlier sample changes nothing, wherever it is thrown. Here
//! bounds of radii are a little wider than there, so that a few more cells are active.

// What is inlined is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::crowd::{Crowd, OpenDart};
use super::field::{RadiusField, RadiusRange};
use super::near::{NearSamples, Places, QuarterTest};
use super::octaves::Octaves;
use super::quadtree::{VaryingCell, add_base_cells, tops};
use super::rule::is_thinned;
use super::shape::{Class, Shape};
use crate::engine::parallel::instructions::InstructionSet;
use crate::error::SampleError;
use crate::lattice::Point;
use crate::progress::{Meter, Observer};
use crate::random::{Key, Stream};
use crate::stage::Stage;
use crate::stages::darts::{DartDraws, cell_dart, dart_count, throw_key, throws};
use crate::stages::disks::Cell;

/// Families that a thread works on at a time.
const FAMILIES: usize = 256;

/// Parcels for each thread between two reports to the observer.
const PARCELS_A_THREAD: usize = 16;

/// A base cell of which some part is active.
#[derive(Clone, Copy)]
struct Family {
    base: VaryingCell,
    /// The least and the greatest radius in the base cell.
    range: RadiusRange,
    /// How many of its parts are active.
    parts: u32,
}

/// An active part of a base cell. Its side follows from the level.
#[derive(Clone, Copy)]
struct ActivePart {
    min: Point,
    /// Which of its places belong to the shape.
    class: Class,
}

/// Some families, and the darts that they threw last.
#[derive(Default)]
struct Parcel {
    families: Vec<Family>,
    /// The active parts of all families, one family's after another's.
    parts: Vec<ActivePart>,
    darts: Vec<OpenDart>,
    scratch: Scratch,
}

/// Buffers, whose content does not matter between two families or two throws.
#[derive(Default)]
struct Scratch {
    families: Vec<Family>,
    parts: Vec<ActivePart>,
    near: NearSamples,
}

/// A throw of all active parts.
#[derive(Clone, Copy)]
struct Throw {
    key: Key,
    level: u32,
    /// Its number in its level, from 0.
    number: u32,
}

/// What the darts of a throw meet.
#[derive(Clone, Copy)]
struct Surroundings<'a> {
    field: &'a RadiusField,
    shape: &'a Shape,
    samples: &'a Octaves,
}

/// Returns the samples of a seed in the order of their arrival. Fails only when `observer` stops it.
pub(super) fn sample(
    field: &RadiusField,
    shape: &Shape,
    seed: u64,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    let mut samples = Octaves::new(field);
    let crowd = Crowd::new(&samples);
    let mut parcels = parcels(field, shape);
    let mut points = Vec::new();
    let mut darts = Vec::new();

    let (mut level, mut number) = (0, 0);
    for iteration in 1.. {
        if parcels.is_empty() {
            break;
        }
        let throw = Throw {
            key: throw_key(Key::from_seed(seed), level, number),
            level,
            number,
        };
        let surroundings = Surroundings {
            field,
            shape,
            samples: &samples,
        };
        make_throw(&mut parcels, throw, surroundings, iteration, observer)?;

        darts.clear();
        for parcel in &parcels {
            darts.extend_from_slice(&parcel.darts);
        }
        for index in crowd.kept(&darts) {
            let dart = &darts[index as usize];
            // A grid cell of a conflict-free set never fills up.
            let fits = samples.insert(dart.at, dart.radius);
            debug_assert!(fits, "the set is conflict-free");
            points.push(dart.at);
        }

        parcels.retain(|parcel| !parcel.families.is_empty());
        number += 1;
        if number == throws(level) {
            (level, number) = (level + 1, 0);
        }
    }
    Ok(points)
}

/// Makes the throw of an iteration, before which parts are cut if it is the first one of its level.
fn make_throw(
    parcels: &mut [Parcel],
    throw: Throw,
    surroundings: Surroundings<'_>,
    iteration: u32,
    observer: &mut dyn Observer,
) -> Result<(), SampleError> {
    let parts = |parcels: &[Parcel]| parcels.iter().map(|parcel| parcel.parts.len() as u64).sum();
    let mut meter = Meter::begin(observer, Stage::Iterate(iteration), parts(parcels))?;
    let level = InstructionSet::best().level();

    // The observer is called on this thread alone.
    for batch in parcels.chunks_mut(rayon::current_num_threads() * PARCELS_A_THREAD) {
        let pieces = parts(batch);
        batch.par_iter_mut().for_each(|parcel| {
            dispatch!(level, simd => parcel.advance(simd, throw, surroundings));
        });
        meter.count(pieces)?;
    }
    meter.end()
}

/// Returns all base cells as families, by parcels.
fn parcels(field: &RadiusField, shape: &Shape) -> Vec<Parcel> {
    let tops: Vec<Cell> = tops(field).collect();
    let families: Vec<Family> = tops
        .par_iter()
        .flat_map_iter(|&top| {
            let mut families = Vec::new();
            add_base_cells(field, shape, vec![top], &mut |base, range| {
                families.push(Family {
                    base,
                    range,
                    parts: 1,
                });
            });
            families
        })
        .collect();

    let parcel = |families: &[Family]| {
        let part = |family: &Family| ActivePart {
            min: family.base.min,
            class: family.base.class,
        };
        Parcel {
            families: families.to_vec(),
            parts: families.iter().map(part).collect(),
            ..Parcel::default()
        }
    };
    families.par_chunks(FAMILIES).map(parcel).collect()
}

impl Parcel {
    /// Cuts the active parts, if the throw is the first one of a level, and throws darts into them.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S, throw: Throw, surroundings: Surroundings<'_>) {
        self.darts.clear();
        let is_cut = throw.level > 0 && throw.number == 0;
        if !is_cut {
            for (family, part) in self.families.iter().zip(&self.parts) {
                // In level 0 a base cell is its only part. Few darts find a list of samples longer than their own search.
                throw_darts(
                    family,
                    &[*part],
                    throw,
                    surroundings,
                    &mut self.darts,
                    |dart| {
                        surroundings
                            .samples
                            .covers(dart.at, dart.radius, dart.sight)
                    },
                );
            }
            return;
        }

        let Scratch {
            families,
            parts,
            near,
        } = &mut self.scratch;
        families.clear();
        parts.clear();
        let mut rest = &self.parts[..];
        for family in &self.families {
            let (own, others) = rest.split_at(family.parts as usize);
            rest = others;

            let first = parts.len();
            // A part of one point has thrown that point.
            if throw.level > u32::from(family.base.base_bits) {
                continue;
            }
            family.cut(simd, own, throw.level, surroundings, near, parts);
            if parts.len() == first {
                continue;
            }

            let kept = &parts[first..];
            families.push(Family {
                parts: kept.len() as u32,
                ..*family
            });
            let origin = family.base.min;
            throw_darts(family, kept, throw, surroundings, &mut self.darts, |dart| {
                near.covers(simd, dart.at - origin, dart.radius)
            });
        }
        std::mem::swap(&mut self.families, families);
        std::mem::swap(&mut self.parts, parts);
    }
}

impl Family {
    /// Gathers the samples near parts of the level before this one, and appends their quarters that hold places of the domain
    /// and are not covered by a single sample.
    #[inline(always)]
    fn cut<S: Simd>(
        &self,
        simd: S,
        parts: &[ActivePart],
        level: u32,
        surroundings: Surroundings<'_>,
        near: &mut NearSamples,
        out: &mut Vec<ActivePart>,
    ) {
        let Surroundings { field, shape, .. } = surroundings;
        let (half, origin) = (1 << (u32::from(self.base.base_bits) - level), self.base.min);
        let places = places_of(parts, origin, 2 * half);
        near.gather(
            surroundings.samples,
            origin,
            places,
            self.range.greatest,
            self.base.sight,
        );

        let rect = field.domain().rect();
        for part in parts {
            let cell = Cell {
                min: part.min,
                side: 2 * half,
            };
            let (least, _) = field.quarter_bounds(cell);
            let covered = near.covered_quarters(
                simd,
                &QuarterTest {
                    corner: part.min - origin,
                    half,
                    least,
                },
            );

            for (index, quarter) in cell.quarters().into_iter().enumerate() {
                // A quarter that begins beyond the domain has no place of it.
                if covered >> index & 1 == 1 || !rect.contains(quarter.min) {
                    continue;
                }
                // A part that lies inside as a whole has no quarter outside.
                let class = match part.class {
                    Class::Inside => Class::Inside,
                    Class::Mixed | Class::Outside => shape.class(quarter),
                };
                if class != Class::Outside {
                    out.push(ActivePart {
                        min: quarter.min,
                        class,
                    });
                }
            }
        }
    }
}

/// Returns the rectangle around some parts of a family.
fn places_of(parts: &[ActivePart], origin: Point, side: i32) -> Places {
    let first = parts[0].min - origin;
    let (lowest, last) = parts.iter().fold((first, first), |(low, high), part| {
        let offset = part.min - origin;
        (low.min(offset), high.max(offset))
    });
    Places {
        lowest,
        highest: last + (side - 1),
    }
}

/// Throws the darts of parts of a family, and appends those that exist and that no sample is near, as `covers` says.
#[inline(always)]
fn throw_darts(
    family: &Family,
    parts: &[ActivePart],
    throw: Throw,
    surroundings: Surroundings<'_>,
    out: &mut Vec<OpenDart>,
    covers: impl Fn(&OpenDart) -> bool,
) {
    let Surroundings { field, shape, .. } = surroundings;
    let (rect, base_bits) = (field.domain().rect(), family.base.base_bits);
    let side = 1 << (u32::from(base_bits) - throw.level);
    let draws = DartDraws::One.in_cell(side);

    for part in parts {
        let cell = Cell {
            min: part.min,
            side,
        };
        let cell_key = throw.key.derive_at(part.min.x, part.min.y);
        for index in 0..dart_count(cell_key, side) {
            let (rank, at) = cell_dart(cell_key, cell, draws, index);
            if !rect.contains(at) {
                continue;
            }
            let dart = OpenDart {
                rank,
                at,
                radius: field.radius_at(at),
                sight: family.base.sight,
            };

            // Most darts are covered, and that is cheaper to say than whether they exist at all. The dart of a cell of one
            // point always stays, which makes the set maximal.
            let coin = || cell_key.draw(Stream::Thin, index)[0];
            if covers(&dart)
                || part.class == Class::Mixed && !shape.inside(at)
                || side > 1 && is_thinned(dart.radius, base_bits, coin)
            {
                continue;
            }
            out.push(dart);
        }
    }
}
