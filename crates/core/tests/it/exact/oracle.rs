//! The definition of exact tiling, written down again: all darts of all blocks, in the order of their arrival, each a sample
//! unless an earlier sample covers it. Cells that one sample covers are left out with their darts, which would be refused.

use tilescope_core::stages::blocks::split;
use tilescope_core::stages::darts::{LAST_LEVEL, POISSON, throw_key, throws};
use tilescope_core::{
    Key, Parameters, Point, R, Rect, SampleGrid, Shape, Stream, below, covers_offset,
};

/// How copies of one dart follow each other.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Ties {
    /// By their places in the domain: the definition.
    Domain,
    /// By their places in the pattern, which goes on beyond its border: wrong.
    Clip,
}

/// A block, and what of the repeated pattern it has.
struct Clip {
    rect: Rect,
    symmetry: u8,
    /// The place of the repeated pattern, turned, on the block's lowest place.
    start: [i64; 2],
}

/// A cell of a pattern's copy: copies are counted along the turned axes.
#[derive(Clone, Copy)]
struct CopyCell {
    clip: usize,
    copy: [i64; 2],
    min: [i64; 2],
}

/// The pattern's turned copy: places of it, and of the domain.
struct Copies<'a> {
    /// Lattice points along a side, and the period, which is 0 of a bounded pattern.
    points: i64,
    period: i64,
    clips: &'a [Clip],
}

impl Copies<'_> {
    /// Returns where the repeated pattern has a place of the pattern.
    fn turned(&self, cell: &CopyCell, [x, y]: [i64; 2]) -> [i64; 2] {
        let symmetry = self.clips[cell.clip].symmetry;
        let mirrored = |v: i64, bit: u8| {
            if symmetry & bit == 0 {
                v
            } else {
                self.points - 1 - v
            }
        };
        let (x, y) = (mirrored(x, 1), mirrored(y, 2));
        let [x, y] = if symmetry & 4 == 0 { [x, y] } else { [y, x] };
        [
            x + cell.copy[0] * self.period,
            y + cell.copy[1] * self.period,
        ]
    }

    /// Returns where the domain has it.
    fn placed(&self, cell: &CopyCell, place: [i64; 2]) -> [i64; 2] {
        let Clip { rect, start, .. } = &self.clips[cell.clip];
        let [x, y] = self.turned(cell, place);
        [
            x - start[0] + i64::from(rect.min.x),
            y - start[1] + i64::from(rect.min.y),
        ]
    }

    /// Returns what of a cell lies in its block, in the domain.
    fn held(&self, cell: &CopyCell, side: i64) -> Option<Rect> {
        let last = cell.min.map(|v| (v + side).min(self.points) - 1);
        let (a, b) = (self.placed(cell, cell.min), self.placed(cell, last));
        let Rect { min, max } = self.clips[cell.clip].rect;
        let low = |k: usize, min: i32| a[k].min(b[k]).max(min.into()) as i32;
        let high = |k: usize, max: i32| (a[k].max(b[k]) + 1).min(max.into()) as i32;
        let held = Rect {
            min: Point::new(low(0, min.x), low(1, min.y)),
            max: Point::new(high(0, max.x), high(1, max.y)),
        };
        let is_in_pattern = cell.min.iter().all(|&v| v < self.points);
        (is_in_pattern && held.width() > 0 && held.height() > 0).then_some(held)
    }
}

/// A shape by its rings, for the definition alone.
pub struct Rings<'a> {
    /// The corners of each ring.
    pub rings: &'a [Vec<Point>],
    /// The shape that is tested, of which single places are asked alone.
    pub shape: &'a Shape,
}

impl Rings<'_> {
    /// Returns whether some place of a rectangle may lie inside: a corner does, or an edge comes near.
    fn may_hold(&self, rect: &Rect) -> bool {
        let [low, high] = [rect.min, rect.max].map(|p| [f64::from(p.x), f64::from(p.y)]);
        let middle = [0, 1].map(|axis| f64::midpoint(low[axis], high[axis]));
        let reach = (high[0] - low[0]).hypot(high[1] - low[1]) / 2.0 + 1.0;

        let mut edges = self.rings.iter().flat_map(|ring| {
            let nexts = ring.iter().cycle().skip(1);
            ring.iter().zip(nexts)
        });
        let is_near = |(from, to): (&Point, &Point)| {
            let [a, b] = [from, to].map(|p| [f64::from(p.x), f64::from(p.y)]);
            let along = [b[0] - a[0], b[1] - a[1]];
            let across = along[0] * (middle[1] - a[1]) - along[1] * (middle[0] - a[0]);
            let length = along[0].hypot(along[1]).max(1.0);
            let is_beside = |k: usize| {
                a[k].min(b[k]) <= middle[k] + reach && a[k].max(b[k]) >= middle[k] - reach
            };
            across.abs() <= reach * length && is_beside(0) && is_beside(1)
        };
        self.shape.inside(rect.min) || edges.any(is_near)
    }
}

/// Returns the samples of an exact tiling in canonical order.
pub fn defined(parameters: &Parameters, ties: Ties) -> Vec<Point> {
    defined_in(parameters, ties, None)
}

/// Returns the samples of an exact tiling of a shape, if there is one, in canonical order.
pub fn defined_in(parameters: &Parameters, ties: Ties, rings: Option<&Rings<'_>>) -> Vec<Point> {
    let is_inside = |at: Point| rings.is_none_or(|rings| rings.shape.inside(at));
    let domain = parameters.validate().unwrap();
    let spec = &parameters.pattern;
    let period = i64::from(spec.side_units().unwrap());
    let key = Key::from_seed(spec.seed).derive(Stream::Pattern, 0);
    let is_periodic = spec.boundary == tilescope_core::Boundary::Periodic;
    let points = period + i64::from(!is_periodic);
    let clips = clips(parameters, points, is_periodic);
    let copies = Copies {
        points,
        period: if is_periodic { period } else { 0 },
        clips: &clips,
    };

    let mut grid = SampleGrid::with_capacity(domain, 0);
    let mut samples: Vec<Point> = Vec::new();
    let mut active = first_cells(&copies);
    for level in 0..=LAST_LEVEL {
        let side = i64::from(R >> level);
        for throw in 0..throws(level) {
            let key = throw_key(key, level, throw);
            let mut thrown = Vec::new();
            for cell in &active {
                for (rank, place) in darts(key, cell.min, side) {
                    let [x, y] = copies.placed(cell, place);
                    let at = Point::new(x as i32, y as i32);
                    let is_held = place.iter().all(|&v| v < points);
                    if is_held && clips[cell.clip].rect.contains(at) && is_inside(at) {
                        let copy = match ties {
                            Ties::Domain => [y, x],
                            Ties::Clip => copies.turned(cell, place),
                        };
                        thrown.push((rank, [place[1], place[0]], copy, [x, y]));
                    }
                }
            }
            thrown.sort_unstable();
            for (.., [x, y]) in thrown {
                let at = Point::new(x as i32, y as i32);
                if !grid.covers(at) {
                    grid.insert(samples.len() as u32, at);
                    samples.push(at);
                }
            }
        }
        active = quarters(&copies, &grid, &active, side / 2);
        active.retain(|cell| {
            let held = copies.held(cell, side / 2);
            rings.is_none_or(|rings| held.is_some_and(|held| rings.may_hold(&held)))
        });
    }
    samples.sort_by_key(|p| (p.y >> 15, p.x >> 15, p.y, p.x));
    samples
}

/// Returns the blocks' clips: each begins at a drawn place, r before the block on both axes.
fn clips(parameters: &Parameters, points: i64, is_periodic: bool) -> Vec<Clip> {
    let domain = parameters.validate().unwrap();
    let run = Key::from_seed(parameters.seed);
    let blocks = split(&domain, parameters.leaf_units().unwrap(), run);
    let each = blocks.leaves.iter().map(|block| {
        let symmetries = if parameters.dihedral { 8 } else { 1 };
        let symmetry = below(block.key.draw(Stream::Dihedral, 0)[0], symmetries) as u8;
        let [x, y] = block.key.draw(Stream::Offset, 0);
        let start = |word: u32, extent: i32| {
            let fitting = points - i64::from(extent + 2 * R) + 1;
            let starts = if is_periodic { points } else { fitting };
            i64::from(below(word, starts as u32)) + i64::from(R)
        };
        Clip {
            rect: block.rect,
            symmetry,
            start: [start(x, block.rect.width()), start(y, block.rect.height())],
        }
    });
    each.collect()
}

/// Returns all cells of level 0 that hold a place of a block.
fn first_cells(copies: &Copies<'_>) -> Vec<CopyCell> {
    let side = i64::from(R);
    let cells = (copies.points - 1) / side + 1;
    // No block here is longer than four of the smallest patterns.
    let counts = if copies.period == 0 { 1 } else { 6 };
    let mut found = Vec::new();
    for clip in 0..copies.clips.len() {
        for k in 0..counts * counts {
            for c in 0..cells * cells {
                let cell = CopyCell {
                    clip,
                    copy: [k % counts, k / counts],
                    min: [c % cells * side, c / cells * side],
                };
                if copies.held(&cell, side).is_some() {
                    found.push(cell);
                }
            }
        }
    }
    found
}

/// Returns the quarters that hold a place of their block and that no single sample covers.
fn quarters(
    copies: &Copies<'_>,
    grid: &SampleGrid,
    cells: &[CopyCell],
    half: i64,
) -> Vec<CopyCell> {
    let mut left = Vec::new();
    for cell in cells {
        for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let min = [cell.min[0] + right, cell.min[1] + up];
            let quarter = CopyCell { min, ..*cell };
            let Some(held) = copies.held(&quarter, half) else {
                continue;
            };
            let extent = held.max - held.min - 1;
            let is_covered = grid.any_near(held.min, R, |near| {
                let farthest = near.offset.abs().max((near.offset - extent).abs());
                covers_offset(farthest)
            });
            if !is_covered {
                left.push(quarter);
            }
        }
    }
    left
}

/// Returns the darts of a throw in a cell of the pattern, with their ranks.
fn darts(key: Key, min: [i64; 2], side: i64) -> Vec<(u32, [i64; 2])> {
    let cell = key.derive_at(min[0] as i32, min[1] as i32);
    let word = cell.words()[0];
    let count = POISSON.iter().filter(|&&bound| word >= bound).count() as u32;
    let count = if side == 1 { 1 } else { count };
    let dart = |index| {
        let [position, rank] = cell.draw(Stream::Dart, index);
        let [right, up] = [position >> 16, position & 0xffff];
        let scaled = |v: u32| (i64::from(v) * side) >> 16;
        (rank, [min[0] + scaled(right), min[1] + scaled(up)])
    };
    (0..count).map(dart).collect()
}
