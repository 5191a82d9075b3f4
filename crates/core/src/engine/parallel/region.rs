//! A region: the part of the plane around a window, with its samples and the buffers to compute them. Survivors are
//! stored in cells of side R, at most three to a cell. Cells that may depend on the plane beyond the frame are marked
//! *unsure*.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i32x4, i32x8};
use glam::I64Vec2;

use crate::lattice::{Point, R, R_SQUARED, Rect};

use super::clip::PlacedBlock;
use super::frame::{CELL_BITS, Frame, PAD};
use super::gaps::GapBuffers;

/// Flags of a cell.
pub(crate) mod flag {
    /// The plane beyond the frame begins next to it.
    pub(crate) const EDGE: u8 = 1;
    /// A tiled sample of unknown fate lies in it or in a neighbour.
    pub(crate) const NEAR_UNKNOWN: u8 = 2;
    /// Its samples depend on the plane beyond the frame.
    pub(crate) const UNSURE: u8 = 4;
    /// Candidates in it may depend on samples in unsure cells.
    pub(crate) const REACHED: u8 = 8;
    /// An unknown sample may yet be inserted in it or in a neighbour.
    pub(crate) const HOT: u8 = 16;
}

/// A free slot, and the end of a list.
pub(crate) const NONE: u32 = u32::MAX;

/// Why a tiled sample is not among the survivors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Loss {
    /// Eliminated by a survivor, or dropped outside a bounded domain.
    Certain,
    /// Its fate depends on the plane beyond the frame.
    Unknown,
}

/// A tiled sample that is not among the survivors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LostSample {
    pub x: i32,
    pub y: i32,
    pub loss: Loss,
    /// The next lost sample of the same cell, or [`NONE`].
    next: u32,
}

/// At most three packed positions, then the complement of their count, which as a position is far away.
pub(crate) type Slots = [u32; 4];

const EMPTY_CELL: Slots = [NONE; 4];

/// A region with its buffers, which are reused. With `TAGS` each survivor has a tag of its source.
#[derive(Default)]
pub(crate) struct Region<const TAGS: bool> {
    pub frame: Frame,
    pub slots: Vec<Slots>,
    tags: Vec<[u64; 3]>,
    pub flags: Vec<u8>,
    /// Unsure cells of the frame; those from `spread` on have not yet marked their surroundings.
    pub unsure: Vec<u32>,
    pub spread: usize,
    pub lost: Vec<LostSample>,
    /// The first lost sample of each cell, or [`NONE`].
    lost_first: Vec<u32>,
    pub blocks: Vec<PlacedBlock>,
    /// Samples of a block that are to be decided: position and tag.
    pub waiting: Vec<(i32, i32, u64)>,
    pub contested: Vec<super::claim::Contested>,
    pub gaps: GapBuffers,
    /// The samples of a row of cells, while they are put in order.
    line: Vec<Point>,
    /// The rectangles of cells that are computed again with a wider halo.
    pub repairs: Vec<Rect>,
}

impl<const TAGS: bool> Region<TAGS> {
    /// Empties the region's cells and its lists of lost, unsure and contested samples, and sets its frame. The other
    /// buffers are emptied where they are filled. `reach` is how many cells away an unsure sample can affect a
    /// candidate.
    pub(crate) fn reset(&mut self, frame: Frame, reach: i32) {
        let count = frame.cell_count();
        refill(&mut self.slots, count, EMPTY_CELL);
        if TAGS {
            refill(&mut self.tags, count, [0; 3]);
        }
        refill(&mut self.flags, count, 0);
        refill(&mut self.lost_first, count, NONE);
        self.lost.clear();
        self.unsure.clear();
        self.spread = 0;
        self.contested.clear();
        self.frame = frame;
        self.mark_rim(1, flag::EDGE);
        // The outermost cells may hold samples that depend on those beyond them, as unsure cells do. Such samples
        // affect cells up to `reach` from the outermost ones, which are the outermost `reach + 1`.
        self.mark_rim(reach + 1, flag::REACHED);
    }

    /// Flags the `depth` outermost cells on the sides beyond which the plane continues.
    fn mark_rim(&mut self, depth: i32, flag: u8) {
        let [columns, rows] = self.frame.cells;
        let [[left, right], [bottom, top]] = self.frame.goes_on;
        for row in 0..rows {
            let whole = bottom && row < depth || top && row >= rows - depth;
            let start = self.frame.cell(0, row);
            let cells = &mut self.flags[start..start + columns as usize];
            // A row at the lower or upper rim is flagged as a whole, any other row at its ends.
            if whole {
                set(cells, flag);
                continue;
            }
            // A narrow frame may have fewer columns.
            let ends = depth.min(columns) as usize;
            if left {
                set(&mut cells[..ends], flag);
            }
            if right {
                let first = columns as usize - ends;
                set(&mut cells[first..], flag);
            }
        }
    }

    /// Adds a survivor. A cell of a conflict-free set never holds more than three.
    #[inline(always)]
    pub(crate) fn insert(&mut self, x: i32, y: i32, tag: u64) {
        let cell = self.frame.cell_at(x, y);
        let index = push(&mut self.slots[cell], pack(x, y));
        if TAGS {
            // The index is at most 2: the compiler sees it by this, and tests nothing.
            self.tags[cell][index.min(2)] = tag;
        }
    }

    /// Removes the sample at (x, y), if there is one.
    pub(crate) fn remove(&mut self, x: i32, y: i32) {
        let cell = self.frame.cell_at(x, y);
        let (slots, packed) = (&mut self.slots[cell], pack(x, y));
        let count = held(slots);
        let Some(index) = slots[..count].iter().position(|&slot| slot == packed) else {
            return;
        };

        // The last one takes its place.
        slots[index] = slots[count - 1];
        slots[count - 1] = NONE;
        slots[3] = !(count as u32 - 1);
        if TAGS {
            self.tags[cell][index] = self.tags[cell][count - 1];
        }
    }

    /// Returns the packed positions of a cell's samples, in canonical order.
    pub(crate) fn sorted_in(&self, cell: usize) -> impl Iterator<Item = u32> + use<TAGS> {
        let mut slots = self.slots[cell];
        let count = held(&slots);
        slots[..count].sort_unstable();
        slots.into_iter().take(count)
    }

    /// Returns whether a survivor covers (x, y), which lies in the frame: the predicate `covers_offset`, for nine cells
    /// at once.
    #[inline(always)]
    pub(crate) fn covered<S: Simd>(&self, simd: S, x: i32, y: i32) -> bool {
        let stride = self.frame.stride();
        let own = self.frame.cell_at(x, y);
        let (x, y) = (x & (R - 1), y & (R - 1));
        row_covers(simd, &self.slots, own - 1, x, y)
            || row_covers(simd, &self.slots, own - 1 - stride, x, y + R)
            || row_covers(simd, &self.slots, own - 1 + stride, x, y - R)
    }

    /// Adds a tiled sample that is not among the survivors; it may lie in the padding.
    #[inline(always)]
    pub(crate) fn lose(&mut self, x: i32, y: i32, loss: Loss) {
        let cell = self.frame.cell_at(x, y);
        let next = self.lost_first[cell];
        self.lost_first[cell] = self.lost.len() as u32;
        self.lost.push(LostSample { x, y, loss, next });
    }

    /// Returns the lost samples of a cell.
    pub(crate) fn lost_in(&self, cell: usize) -> impl Iterator<Item = &LostSample> {
        let mut next = self.lost_first[cell];
        std::iter::from_fn(move || {
            let lost = self.lost.get(next as usize)?;
            next = lost.next;
            Some(lost)
        })
    }

    /// Marks a cell of the frame as unsure.
    pub(crate) fn make_unsure(&mut self, cell: usize) {
        if self.flags[cell] & flag::UNSURE == 0 {
            self.flags[cell] |= flag::UNSURE;
            self.unsure.push(cell as u32);
        }
    }

    /// Flags the 3 x 3 cells around one.
    pub(crate) fn flag_around(&mut self, cell: usize, flag: u8) {
        let stride = self.frame.stride();
        for row in [cell - stride, cell, cell + stride] {
            set(&mut self.flags[row - 1..=row + 1], flag);
        }
    }

    /// Fills `found` with rectangles of cells, which do not overlap and hold all unsure cells of the window. Rectangles
    /// with at most `near` cells between them are joined.
    pub(crate) fn unsure_in_window(&self, near: i32, found: &mut Vec<Rect>) {
        let window = self.frame.window_cells();
        found.clear();
        for &cell in &self.unsure {
            let (column, row) = self.frame.column_row(cell as usize);
            let at = Point::new(column, row);
            if !window.contains(at) {
                continue;
            }
            let mut joined = Rect {
                min: at,
                max: Point::new(column + 1, row + 1),
            };
            // A rectangle that grew may now be near to others.
            while let Some(k) = found
                .iter()
                .position(|other| cells_between(&joined, other) <= near)
            {
                joined = hull(&joined, &found.swap_remove(k));
            }
            found.push(joined);
        }
    }

    /// Replaces the samples of the cells `cells` (of this frame) by those of a region in which they are sure. The lists
    /// of lost samples stay as they are: they serve counts, and the other region's samples were counted there. Flags
    /// and the list of unsure cells stay, too, as they are not read once the region is counted.
    pub(crate) fn adopt(&mut self, other: &Self, cells: &Rect) {
        let shift = ((self.frame.origin - other.frame.origin) >> CELL_BITS).as_ivec2();
        for row in cells.min.y..cells.max.y {
            for column in cells.min.x..cells.max.x {
                let (to, from) = (
                    self.frame.cell(column, row),
                    other.frame.cell(column + shift.x, row + shift.y),
                );
                self.slots[to] = other.slots[from];
                if TAGS {
                    self.tags[to] = other.tags[from];
                }
            }
        }
    }

    /// Appends the window's samples in canonical order to `out`, with `TAGS` their tags to `tags`, and after each row
    /// of cells the length of `out` to `rows`.
    #[inline(always)]
    pub(crate) fn emit(&mut self, out: &mut Vec<Point>, tags: &mut Vec<u64>, rows: &mut Vec<u32>) {
        let cells = self.frame.window_cells();
        let width = (cells.max.x - cells.min.x) as usize;
        let window = self.frame.window;

        // If a window ends inside its cells, samples of its outermost cells must be tested.
        let at_cells = |v: i32| v & (R - 1) == 0;
        let ends_at_cells =
            [window.min.x, window.min.y, window.max.x, window.max.y].map(at_cells) == [true; 4];

        // The buffer is taken out of the region, which is read while it changes. A cell has at most three samples, and
        // four places are written for it.
        let mut held_line = std::mem::take(&mut self.line);
        held_line.resize(3 * width + 4, Point::default());
        let line = &mut held_line[..];

        for row in cells.min.y..cells.max.y {
            let start = self.frame.cell(cells.min.x, row);
            let mut count = 0;
            for (slots, k) in self.slots[start..start + width].iter().zip(0..) {
                // Places of the window fit 32 bits, as it lies in the domain; the frame's origin may not. Its low 32 bits
                // are enough: a sum that wraps ends at the right place.
                let (x, y) = (
                    (self.frame.origin[0] as i32).wrapping_add((cells.min.x + k) << CELL_BITS),
                    (self.frame.origin[1] as i32).wrapping_add(row << CELL_BITS),
                );

                // Slots compare by row, then column, and free ones are the largest. The last slot holds the complement
                // of the count: one sample needs no sort.
                let [mut a, mut b, mut c, last] = *slots;
                if !last >= 2 {
                    (a, b) = (a.min(b), a.max(b));
                    (b, c) = (b.min(c), b.max(c));
                    (a, b) = (a.min(b), a.max(b));
                }

                // All four are written, and the next cell overwrites those beyond the count.
                let sorted = [a, b, c, last];
                let xs = sorted.map(|slot| x | slot as i32 & (R - 1));
                let ys = sorted.map(|slot| y | (slot >> CELL_BITS) as i32);
                let points = [0, 1, 2, 3].map(|s| Point::new(xs[s], ys[s]));
                line[count..count + 4].copy_from_slice(&points);
                count += held(slots);
            }

            if TAGS {
                self.emit_tags(start, width, tags);
            }

            let samples = &line[..count];
            // A row of one cell has no inner cells: its first is its last.
            let is_outermost = row == cells.min.y || row == cells.max.y - 1 || width < 2;
            if ends_at_cells {
                out.extend_from_slice(samples);
            } else if TAGS || is_outermost {
                // With tags the whole row is tested at once: `tags` ends with the tags of the whole row, and
                // `emit_inside` expects those of the samples that it is given.
                self.emit_inside(samples, out, tags);
            } else {
                // Of an inner row only the first and the last cell may have samples outside of the window.
                let [first, last] = [start, start + width - 1].map(|cell| held(&self.slots[cell]));
                self.emit_inside(&samples[..first], out, tags);
                out.extend_from_slice(&samples[first..count - last]);
                self.emit_inside(&samples[count - last..], out, tags);
            }

            rows.push(out.len() as u32);
        }

        self.line = held_line;
    }

    /// Appends the tags of a row of cells, in the order in which [`Self::emit`] puts the samples.
    fn emit_tags(&self, start: usize, width: usize, tags: &mut Vec<u64>) {
        for (slots, of_cell) in self.slots[start..start + width]
            .iter()
            .zip(&self.tags[start..])
        {
            let count = held(slots);
            let mut tagged = [0, 1, 2].map(|s| (slots[s], of_cell[s]));
            tagged[..count].sort_unstable();
            tags.extend(tagged[..count].iter().map(|t| t.1));
        }
    }

    /// Appends those samples of `line` that lie inside the window. With `TAGS` the tags of `line` are the last of
    /// `tags`, and of these only the tags of the appended samples are kept.
    fn emit_inside(&self, line: &[Point], out: &mut Vec<Point>, tags: &mut Vec<u64>) {
        let origin = self.frame.origin;
        let inside = |p: &Point| {
            let offset = I64Vec2::from(*p) - origin;
            let at = Point::new(offset.x as i32, offset.y as i32);
            self.frame.window.contains(at)
        };
        if TAGS {
            let first = tags.len() - line.len();
            let kept: Vec<u64> = line
                .iter()
                .zip(&tags[first..])
                .filter_map(|(p, &tag)| inside(p).then_some(tag))
                .collect();
            tags.truncate(first);
            tags.extend(kept);
        }
        out.extend(line.iter().filter(|p| inside(p)));
    }
}

/// Returns how many cells lie between two rectangles, on the axis on which they are farther apart; below 0 if they
/// overlap.
fn cells_between(a: &Rect, b: &Rect) -> i32 {
    let across = (a.min.x - b.max.x).max(b.min.x - a.max.x);
    across.max(a.min.y - b.max.y).max(b.min.y - a.max.y)
}

/// Returns the smallest rectangle that holds two others.
fn hull(a: &Rect, b: &Rect) -> Rect {
    Rect {
        min: Point::new(a.min.x.min(b.min.x), a.min.y.min(b.min.y)),
        max: Point::new(a.max.x.max(b.max.x), a.max.y.max(b.max.y)),
    }
}

fn set(flags: &mut [u8], flag: u8) {
    for f in flags {
        *f |= flag;
    }
}

fn refill<T: Copy>(buffer: &mut Vec<T>, count: usize, value: T) {
    buffer.clear();
    buffer.resize(count, value);
}

/// Adds a sample to a cell, and returns its index there.
#[inline(always)]
pub(crate) fn push(slots: &mut Slots, slot: u32) -> usize {
    let count = held(slots);
    debug_assert!(count < 3, "the survivors are conflict-free");
    slots[count] = slot;
    slots[3] = !(count as u32 + 1);
    count
}

/// Returns how many samples a cell has.
#[inline(always)]
const fn held(slots: &Slots) -> usize {
    !slots[3] as usize & 3
}

/// Returns a position in its cell as a slot holds it.
#[inline(always)]
pub(crate) const fn pack(x: i32, y: i32) -> u32 {
    ((y & (R - 1)) << CELL_BITS | (x & (R - 1))) as u32
}

/// Returns the position in the frame of a slot of the cell (column, row).
#[inline(always)]
pub(crate) const fn unpack(packed: u32, column: i32, row: i32) -> Point {
    let (x, y) = (packed as i32 & (R - 1), (packed >> CELL_BITS) as i32);
    Point::new((column << CELL_BITS) | x, (row << CELL_BITS) | y)
}

/// Returns whether a sample of the three cells from `first` on covers the point at (x, y) from the corner of the middle
/// one. Free slots read as positions more than R away.
#[inline(always)]
fn row_covers<S: Simd>(simd: S, slots: &[Slots], first: usize, x: i32, y: i32) -> bool {
    // The shift of a negative number fills in ones above: the mask takes them away.
    const SHIFTED_BITS: i32 = i32::MAX >> (CELL_BITS - 1);
    let [a, b, c] = [slots[first], slots[first + 1], slots[first + 2]];

    // What to add to an abscissa in its cell, so that it is counted from the point: four times for the left cell, which
    // begins R before the middle one, and four times for the middle one.
    let left = [-R - x, -R - x, -R - x, -R - x, -x, -x, -x, -x];
    let packed = [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]].map(|slot| slot as i32);
    let first_two = i32x8::simd_from(simd, packed);

    // Longer lengths count as R + 1, which is too far as well, so that the squares fit 32 bits. R^2 is taken off before
    // the second square is added, so that the sum fits, too.
    let most = i32x8::splat(simd, R + 1);
    let across = ((first_two & (R - 1)) + i32x8::simd_from(simd, left))
        .abs()
        .min(most);
    let up = (((first_two >> CELL_BITS) & SHIFTED_BITS) - y)
        .abs()
        .min(most);
    let beyond = across * across - R_SQUARED as i32 + up * up;
    let covers = beyond.simd_le(i32x8::splat(simd, 0)).any_true();

    // The same for the right cell, which begins R behind the middle one.
    let third = i32x4::simd_from(simd, c.map(|slot| slot as i32));
    let most = i32x4::splat(simd, R + 1);
    let across = ((third & (R - 1)) + (R - x)).abs().min(most);
    let up = (((third >> CELL_BITS) & SHIFTED_BITS) - y).abs().min(most);
    let beyond = across * across - R_SQUARED as i32 + up * up;
    covers | beyond.simd_le(i32x4::splat(simd, 0)).any_true()
}

/// The widest search of a cell's surroundings stays in the padding.
pub(crate) const MAX_REACH: i32 = PAD;
