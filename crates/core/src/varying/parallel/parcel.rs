//! The families of a large square, which one thread works on at a time.

mod listing;

use fearless_simd::Simd;

use super::draws::DrawnDarts;
use super::{LevelThrow, Surroundings};
use crate::chains::Chain;
use crate::lattice::Point;
use crate::random::Stream;
use crate::stages::disks::Cell;
use crate::varying::crowd::OpenDart;
use crate::varying::field::{RadiusField, RadiusRange};
use crate::varying::near::{NearSamples, QuarterTest};
use crate::varying::octaves::Sight;
use crate::varying::quadtree::add_base_cells;
use crate::varying::rule::{is_thinned, most_reach};
use crate::varying::shape::Class;

/// The number of no family.
const NO_FAMILY: u16 = u16::MAX;

/// A base cell with its radii.
struct Family {
    min: Point,
    /// The binary logarithm of the base cell's side.
    bits: u8,
    sight: Sight,
    /// The least and the greatest radius in the base cell.
    range: RadiusRange,
}

/// An active part of a base cell. Its side follows from the level.
#[derive(Clone, Copy)]
pub(super) struct ActivePart {
    pub min: Point,
    /// The number of its family in the parcel, which has at most 64 x 64.
    pub family: u16,
    /// Which of its places belong to the shape.
    pub class: Class,
}

/// The buffers of a thread, whose content does not matter between two parcels.
#[derive(Default)]
pub(super) struct ParcelBuffers {
    parts: Vec<ActivePart>,
    drawn: DrawnDarts,
    darts: Vec<OpenDart>,
}

/// All families of a square.
pub(super) struct Parcel {
    square: Cell,
    families: Box<[Family]>,
    /// Of each family the samples that can be near its places; closed if no part of it is active. They are apart from the families,
    /// as many samples are listed in many of them.
    lists: Box<[Chain]>,
    /// The family of each square of two to the power `bits` units, row by row: as wide as the narrowest base cell.
    family_at: Vec<u16>,
    bits: u32,
    /// Whether all families are equally wide.
    has_one_width: bool,
    /// Whether all families have the same largest radius.
    has_one_greatest: bool,
    /// Whether all of its places are in the domain.
    is_whole: bool,
    /// The largest radius in the parcel.
    greatest: i32,
    near: NearSamples,
    /// The active parts of all families, one family's after another's.
    parts: Box<[ActivePart]>,
    /// The darts of the last throw that no sample before it is near.
    pub darts: Box<[OpenDart]>,
}

impl Parcel {
    /// Returns the parcel of a square before the first throw.
    pub fn new(square: Cell, surroundings: Surroundings<'_>) -> Self {
        let (mut families, mut parts) = (Vec::new(), Vec::new());
        let Surroundings { field, shape } = surroundings;
        add_base_cells(field, shape, vec![square], &mut |base, range| {
            parts.push(ActivePart {
                min: base.min,
                family: families.len() as u16,
                class: base.class,
            });
            families.push(Family {
                min: base.min,
                bits: base.bits,
                sight: base.sight,
                range,
            });
        });

        // A square that holds no place of the shape has no families: it is finished, and its two numbers below are not used.
        let widths = families.iter().map(|family| u32::from(family.bits));
        let bits = widths.min().unwrap_or_else(|| square.side.ilog2());
        let radii = families.iter().map(|family| family.range.greatest);
        let greatest = radii.max().unwrap_or(0);
        let is_narrow = |family: &Family| u32::from(family.bits) == bits;
        let is_greatest = |family: &Family| family.range.greatest == greatest;
        let [least, largest] = field.extremes();
        Self {
            square,
            family_at: map_of(&families, square, bits),
            bits,
            has_one_width: families.iter().all(is_narrow),
            has_one_greatest: families.iter().all(is_greatest),
            is_whole: (field.domain().rect().max - square.min).min_element() >= square.side,
            greatest,
            near: NearSamples::for_lists(families.len(), least == largest),
            parts: parts.into(),
            darts: Box::default(),
            lists: vec![Chain::EMPTY; families.len()].into(),
            families: families.into(),
        }
    }

    /// Returns whether nothing in it is left to fill.
    pub const fn is_finished(&self) -> bool {
        self.parts.is_empty()
    }

    pub const fn active_parts(&self) -> u64 {
        self.parts.len() as u64
    }

    /// Returns, for each axis, the first and the last place where a sample may be near one of its places. No sample is larger than
    /// `largest`.
    pub fn reached(&self, largest: i32) -> [[i64; 2]; 2] {
        let reach = i64::from(most_reach(largest, self.greatest));
        let min = self.square.min;
        [min.x, min.y].map(|first| {
            let first = i64::from(first);
            [
                first - reach,
                first + i64::from(self.square.side) - 1 + reach,
            ]
        })
    }

    /// Cuts the active parts at the first throw of a level, and throws darts into them. The parts of level 0 are whole base cells.
    #[inline(always)]
    pub fn advance<S: Simd>(
        &mut self,
        simd: S,
        throw: LevelThrow,
        surroundings: Surroundings<'_>,
        buffers: &mut ParcelBuffers,
    ) {
        if throw.level > 0 && throw.number == 0 {
            self.cut(simd, throw.level, surroundings, &mut buffers.parts);
        }
        self.throw(simd, throw, surroundings, buffers);

        // A finished parcel is not visited again.
        if self.is_finished() {
            self.families = Box::default();
            self.lists = Box::default();
            self.near = NearSamples::for_lists(0, true);
            self.family_at = Vec::new();
        }
    }

    /// Cuts the parts of the level before this one: their quarters are active that are not covered by a single sample, and may hold places
    /// of the shape. `open` is a buffer.
    #[inline(always)]
    fn cut<S: Simd>(
        &mut self,
        simd: S,
        level: u32,
        surroundings: Surroundings<'_>,
        open: &mut Vec<ActivePart>,
    ) {
        open.clear();
        for parts in self.parts.chunk_by(|a, b| a.family == b.family) {
            let number = usize::from(parts[0].family);
            let (family, list) = (&self.families[number], &mut self.lists[number]);
            let before = open.len();

            // A part of one point has thrown a dart at it, and is not cut.
            if level <= u32::from(family.bits) {
                let half = 1 << (u32::from(family.bits) - level);
                for part in parts {
                    family.cut(part, half, surroundings, open, |test| {
                        self.near.covered_quarters(simd, *list, test)
                    });
                }
            }
            if open.len() == before {
                self.near.close(list);
            }
        }
        // Exactly as much memory as is needed, as all parcels have parts at the same time.
        self.parts = open.as_slice().into();
    }

    /// Throws darts into all active parts, and keeps those in the shape that the coin leaves and that no sample is near.
    #[inline(always)]
    fn throw<S: Simd>(
        &mut self,
        simd: S,
        throw: LevelThrow,
        surroundings: Surroundings<'_>,
        buffers: &mut ParcelBuffers,
    ) {
        let ParcelBuffers { drawn, darts, .. } = buffers;
        let Surroundings { field, shape } = surroundings;
        let rect = field.domain().rect();
        for parts in self.parts.chunks(DrawnDarts::PARTS) {
            drawn.draw(
                simd,
                throw.key,
                parts,
                #[inline(always)]
                |part| u32::from(self.families[usize::from(part.family)].bits) - throw.level,
            );
            for dart in &drawn.darts {
                let part = &parts[usize::from(dart.part)];
                // A base cell may reach beyond the domain.
                if !self.is_whole && !rect.contains(dart.at) {
                    continue;
                }

                // Most darts are covered, which is found sooner than whether they are in the shape or left out by the coin.
                let number = usize::from(part.family);
                let family = &self.families[number];
                let radius = family.radius_at(dart.at, field);
                let offset = dart.at - family.min;
                if self.near.covers(simd, self.lists[number], offset, radius) {
                    continue;
                }
                if part.class == Class::Mixed && !shape.inside(dart.at) {
                    continue;
                }
                // The dart of a cell of one point always stays, which makes the set maximal.
                let base_bits = family.bits;
                let coin = || dart.cell_key.draw(Stream::Thin, dart.index)[0];
                if throw.level < u32::from(base_bits) && is_thinned(radius, base_bits, coin) {
                    continue;
                }
                darts.push(OpenDart::new(dart.rank, dart.at, radius, family.sight));
            }
        }
        // Exactly as much memory as is needed, as in `cut`: all parcels keep their darts until the throw is decided.
        self.darts = darts.drain(..).collect();
    }
}

impl Family {
    /// Returns the radius at one of its places.
    #[inline(always)]
    fn radius_at(&self, at: Point, field: &RadiusField) -> i32 {
        if self.range.least == self.range.greatest {
            self.range.least
        } else {
            field.radius_at(at)
        }
    }

    /// Appends the quarters of a part, `half` units wide, that are not covered by a single sample and may hold places of the shape.
    /// `covered` returns those that are, a bit each.
    #[inline(always)]
    fn cut(
        &self,
        part: &ActivePart,
        half: i32,
        surroundings: Surroundings<'_>,
        open: &mut Vec<ActivePart>,
        covered: impl FnOnce(&QuarterTest) -> u32,
    ) {
        let Surroundings { field, shape } = surroundings;
        let cell = Cell {
            min: part.min,
            side: 2 * half,
        };
        let least = if self.range.least == self.range.greatest {
            [self.range.least; 4]
        } else {
            let (least, _greatest) = field.quarter_bounds(cell);
            least
        };
        let test = QuarterTest {
            corner: part.min - self.min,
            half,
            least,
        };
        let covered_bits = covered(&test);

        let rect = field.domain().rect();
        for (index, quarter) in cell.quarters().into_iter().enumerate() {
            // A quarter that begins beyond the domain has no place of it.
            if covered_bits >> index & 1 == 1 || !rect.contains(quarter.min) {
                continue;
            }
            // A part that lies inside as a whole has no quarter outside.
            let class = match part.class {
                Class::Inside => Class::Inside,
                Class::Mixed | Class::Outside => shape.class(quarter),
            };
            if class != Class::Outside {
                open.push(ActivePart {
                    min: quarter.min,
                    class,
                    ..*part
                });
            }
        }
    }
}

/// Returns the family of each small square of a square, row by row, or [`NO_FAMILY`] where there is none. Small squares
/// are two to the power `bits` units wide.
fn map_of(families: &[Family], square: Cell, bits: u32) -> Vec<u16> {
    // A parcel without families is finished from the start, and nothing is looked up in its map.
    if families.is_empty() {
        return Vec::new();
    }

    let columns = (square.side >> bits) as usize;
    let mut map = vec![NO_FAMILY; columns * columns];
    for (number, family) in (0..).zip(families) {
        let corner = (family.min - square.min) >> bits as i32;
        let width = 1 << (u32::from(family.bits) - bits);
        for row in corner.y as usize..corner.y as usize + width {
            let start = row * columns + corner.x as usize;
            map[start..start + width].fill(number);
        }
    }
    map
}
