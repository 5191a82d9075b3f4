//! A part of a window, made alone from the base cells around it.
//!
//! The cells of the last layer throw no darts: any of their places may have a sample, at any time. A dart that one of these may be
//! near is *in doubt*, and so is a dart near an earlier one in doubt, unless a sample that is certain is near it. All others are
//! decided as in the whole set. A part of a cell of which every dart would be in doubt is given up, and stands for its darts.

// An inlined function is compiled for the instructions of the function that asks for it.
#![allow(clippy::inline_always)]

use fearless_simd::{Simd, dispatch};
use glam::{I64Vec2, IVec2};

use super::around::{CellsAround, PlaneSquare};
use crate::chains::Chain;
use crate::instructions::InstructionSet;
use crate::lattice::{Point, Window};
use crate::random::{Key, Stream};
use crate::stages::darts::{DartDraws, cell_darts, throw_key, throws};
use crate::stages::disks::Cell;
use crate::varying::field::RadiusField;
use crate::varying::near::{NearSamples, QuarterTest};
use crate::varying::rule::{is_thinned, most_reach};
use crate::varying::shape::{Class, Shape};

/// A sample in the order of arrival in the whole set: by level, throw and rank, and of equal ranks by place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct WindowArrival {
    level: u32,
    throw: u32,
    rank: u32,
    /// Its y and x in the domain.
    place: (i32, i32),
    /// Whether it lies outside of the window, and may be near a place of it. Those inside come first.
    pub is_around: bool,
}

impl WindowArrival {
    /// Returns whether two are one sample of the whole set.
    pub fn is_same(&self, other: &Self) -> bool {
        (self.level, self.throw, self.rank, self.place)
            == (other.level, other.throw, other.rank, other.place)
    }

    /// Returns where it lies in the domain.
    pub const fn point(&self) -> Point {
        Point::new(self.place.1, self.place.0)
    }
}

/// Places in doubt: a square of the plane, down to the one place of a dart.
#[derive(Clone, Copy)]
struct DoubtSquare {
    square: PlaneSquare,
    /// The greatest radius in it.
    greatest: i32,
    /// Whether it is a part that was given up. Parts near it go on: otherwise all parts would be given up one after another.
    is_given_up: bool,
}

/// An active part of a base cell. Its side follows from the level.
#[derive(Clone, Copy)]
struct PlanePart {
    /// The number of its base cell.
    cell: u32,
    /// Its lowest place in the domain.
    min: Point,
    class: Class,
}

/// A dart that no sample so far is near.
struct WindowDart {
    rank: u32,
    at: Point,
    radius: i32,
    /// The number of its base cell.
    cell: u32,
}

/// The process of darts in some base cells of the plane.
pub(super) struct WindowPiece<'a> {
    field: &'a RadiusField,
    shape: &'a Shape,
    window: &'a Window,
    around: &'a CellsAround<'a>,
    key: Key,
    parts: Vec<PlanePart>,
    near: NearSamples,
    /// Of each base cell but those of the last layer, the samples that can be near its places.
    lists: Vec<Chain>,
    /// Of each of these base cells, the places in doubt that can be near its places.
    doubts: Vec<Vec<DoubtSquare>>,
    arrived: Vec<WindowArrival>,
    /// Whether places in doubt can be near a place of a base cell of the window.
    is_doubtful: bool,
}

impl<'a> WindowPiece<'a> {
    /// Returns the samples of a window and of its surroundings, in the order of their arrival, or `None` if the layers of
    /// cells around the window are too few to decide about them.
    pub fn made(
        field: &'a RadiusField,
        shape: &'a Shape,
        key: Key,
        window: &'a Window,
        around: &'a CellsAround<'a>,
    ) -> Option<Vec<WindowArrival>> {
        let [least, greatest] = field.extremes();
        let known = around.near.len();
        let parts = (0..)
            .zip(&around.cells[..known])
            .map(|(cell, base)| PlanePart {
                cell,
                min: base.min,
                class: base.class,
            });

        let mut piece = Self {
            field,
            shape,
            window,
            around,
            key,
            parts: parts.collect(),
            near: NearSamples::for_lists(known, least == greatest),
            lists: vec![Chain::EMPTY; known],
            doubts: vec![Vec::new(); known],
            arrived: Vec::new(),
            is_doubtful: false,
        };
        piece.doubt_beyond();
        dispatch!(InstructionSet::best().level(), simd => piece.run(simd));
        (!piece.is_doubtful).then_some(piece.arrived)
    }

    /// Puts the cells of the last layer in doubt.
    fn doubt_beyond(&mut self) {
        let known = self.around.near.len();
        for (number, near) in self.around.near.iter().enumerate() {
            for &other in near.iter().filter(|other| **other as usize >= known) {
                let other = &self.around.cells[other as usize];
                self.is_doubtful |= number < self.around.own;
                self.doubts[number].push(DoubtSquare {
                    square: other.square,
                    greatest: other.range.greatest,
                    is_given_up: false,
                });
            }
        }
    }

    /// Makes throw after throw, until nothing is left to fill or the window is in doubt.
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S) {
        let mut level = 0;
        while !self.parts.is_empty() {
            for throw in 0..throws(level) {
                self.throw(simd, level, throw);
                if self.is_doubtful {
                    return;
                }
            }
            self.cut(simd, level);
            level += 1;
        }
    }

    /// Makes a throw: decides about its darts by rank.
    #[inline(always)]
    fn throw<S: Simd>(&mut self, simd: S, level: u32, throw: u32) {
        let mut darts = self.darts(simd, level, throw);
        // Equal ranks are decided by place, as in the whole set.
        darts.sort_unstable_by_key(|dart| (dart.rank, dart.at.row_major()));

        for WindowDart {
            rank,
            at,
            radius,
            cell,
        } in darts
        {
            let number = cell as usize;
            let base = &self.around.cells[number];
            let offset = at - base.min;
            // A sample of this throw may be near it.
            if self.near.covers(simd, self.lists[number], offset, radius) {
                continue;
            }

            let place = base.square.min + offset.as_i64vec2();
            let of_dart = PlaneSquare {
                min: place,
                side: 1,
            };
            if self.is_in_doubt(number, &of_dart, radius) {
                self.doubt(number, of_dart, radius, false);
                continue;
            }

            let is_around = !self.window.contains(place);
            if self.add_sample(number, place, radius) || !is_around {
                self.arrived.push(WindowArrival {
                    level,
                    throw,
                    rank,
                    place: at.row_major(),
                    is_around,
                });
            }
        }
    }

    /// Returns the darts of a throw that exist and that no sample before it is near.
    #[inline(always)]
    fn darts<S: Simd>(&self, simd: S, level: u32, throw: u32) -> Vec<WindowDart> {
        let rect = self.field.domain().rect();
        let throw_key = throw_key(self.key, level, throw);
        let mut darts = Vec::new();
        for part in &self.parts {
            let number = part.cell as usize;
            let base = &self.around.cells[number];
            let square = Cell {
                min: part.min,
                side: 1 << (u32::from(base.bits) - level),
            };
            let draws = DartDraws::One.in_cell(square.side);
            for (index, (rank, at)) in cell_darts(throw_key, square, draws).enumerate() {
                // A base cell may reach beyond the domain.
                if !rect.contains(at) {
                    continue;
                }
                let radius = self.field.radius_at(at);
                let offset = at - base.min;
                if self.near.covers(simd, self.lists[number], offset, radius) {
                    continue;
                }
                if part.class == Class::Mixed && !self.shape.inside(at) {
                    continue;
                }

                // The dart of a cell of one point always stays, which makes the set maximal.
                let coin = || {
                    let cell_key = throw_key.derive_at(square.min.x, square.min.y);
                    cell_key.draw(Stream::Thin, index as u32)[0]
                };
                if square.side > 1 && is_thinned(radius, base.bits, coin) {
                    continue;
                }
                darts.push(WindowDart {
                    rank,
                    at,
                    radius,
                    cell: part.cell,
                });
            }
        }
        darts
    }

    /// Lists a sample in the cells where it can be near a place. Returns whether one of them is a cell of the window.
    #[inline(always)]
    fn add_sample(&mut self, cell: usize, place: I64Vec2, radius: i32) -> bool {
        let at = PlaneSquare {
            min: place,
            side: 1,
        };
        let mut is_at_window = false;
        for &other in &self.around.near[cell] {
            let other = other as usize;
            // The cells of the last layer have no darts and no lists.
            let Some(list) = self.lists.get_mut(other) else {
                continue;
            };
            let base = &self.around.cells[other];
            if base.is_reached_from(&at, radius) {
                is_at_window |= other < self.around.own;
                // The offset is short, as the cell is near.
                let offset = (place - base.square.min).as_ivec2();
                self.near.push(list, offset, radius);
            }
        }
        is_at_window
    }

    /// Returns whether a sample may come that is near a place of this radius, before a dart at that place.
    #[inline(always)]
    fn is_in_doubt(&self, cell: usize, place: &PlaneSquare, radius: i32) -> bool {
        self.doubts[cell].iter().any(|doubt| {
            let reach = i64::from(most_reach(doubt.greatest, radius));
            place.gap_squared(&doubt.square) <= reach * reach
        })
    }

    /// Puts a square of a cell in doubt, where no radius is above `greatest`.
    fn doubt(&mut self, cell: usize, square: PlaneSquare, greatest: i32, is_given_up: bool) {
        let doubt = DoubtSquare {
            square,
            greatest,
            is_given_up,
        };
        for &other in &self.around.near[cell] {
            let other = other as usize;
            if let Some(doubts) = self.doubts.get_mut(other)
                && self.around.cells[other].is_reached_from(&square, greatest)
            {
                doubts.push(doubt);
                self.is_doubtful |= other < self.around.own;
            }
        }
    }

    /// Cuts the active parts into quarters. Those that are not covered by a single sample, and may hold places of the shape, are
    /// the active parts of the next level, or are given up.
    #[inline(always)]
    fn cut<S: Simd>(&mut self, simd: S, level: u32) {
        let parts = std::mem::take(&mut self.parts);
        for of_cell in parts.chunk_by(|a, b| a.cell == b.cell) {
            let number = of_cell[0].cell as usize;
            let before = self.parts.len();
            // A part of one point has thrown a dart at it, and is not cut.
            if level < u32::from(self.around.cells[number].bits) {
                for part in of_cell {
                    self.cut_part(simd, part, level);
                }
            }
            // Nothing is asked any more about the samples near it.
            if self.parts.len() == before {
                self.near.close(&mut self.lists[number]);
            }
        }
    }

    /// Cuts a part of a level.
    #[inline(always)]
    fn cut_part<S: Simd>(&mut self, simd: S, part: &PlanePart, level: u32) {
        let number = part.cell as usize;
        let base = &self.around.cells[number];
        let cell = Cell {
            min: part.min,
            side: 1 << (u32::from(base.bits) - level),
        };
        let test = QuarterTest {
            corner: part.min - base.min,
            half: cell.side / 2,
            least: self.field.quarter_bounds(cell).0,
        };
        let covered = self.near.covered_quarters(simd, self.lists[number], &test);

        let rect = self.field.domain().rect();
        for (index, quarter) in cell.quarters().into_iter().enumerate() {
            // A quarter that begins beyond the domain has no place of it.
            if covered >> index & 1 == 1 || !rect.contains(quarter.min) {
                continue;
            }
            // A part that lies inside as a whole has no quarter outside.
            let class = match part.class {
                Class::Inside => Class::Inside,
                Class::Mixed | Class::Outside => self.shape.class(quarter),
            };
            if class == Class::Outside {
                continue;
            }

            let offset: IVec2 = quarter.min - base.min;
            let square = PlaneSquare {
                min: base.square.min + offset.as_i64vec2(),
                side: quarter.side.into(),
            };
            if self.gives_up(number, &square, test.least[index]) {
                self.doubt(number, square, base.range.greatest, true);
            } else {
                self.parts.push(PlanePart {
                    min: quarter.min,
                    class,
                    ..*part
                });
            }
        }
    }

    /// Returns whether all darts of a square would be in doubt, where no radius is below `least`.
    #[inline(always)]
    fn gives_up(&self, cell: usize, square: &PlaneSquare, least: i32) -> bool {
        let mut doubts = self.doubts[cell].iter().filter(|doubt| !doubt.is_given_up);
        doubts.any(|doubt| {
            let reach = i64::from(most_reach(doubt.greatest, least));
            square.farthest_gap_squared(&doubt.square) <= reach * reach
        })
    }
}
