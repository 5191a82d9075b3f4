//! Spreads weighted samples of the unit torus onto a fine grid: onto a strip of its lines at a time, or onto the whole
//! grid band by band. Samples are sorted by tile first, and even bands go before odd ones, so that sums have one order,
//! and strips the bits of the whole grid. Indices do not wrap: the grid has margins, and readers fold them back.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use super::kernel::{Kernel, WIDTH};

/// Grid lines of a band; at least the kernel's width, so that a band reaches only into the next.
const BAND: usize = 32;

/// Bands of a strip.
const BANDS_EACH: usize = 2;

/// Grid lines of a strip. Samples that reach into two strips are spread twice, a sixth of them; longer strips do not
/// stay in the caches until they are transformed.
pub(super) const STRIP: usize = BANDS_EACH * BAND;

/// Grid points of a tile along a line: a tile with the kernel's margin takes 27 KiB per component.
const TILE: usize = 64;

/// Lines, or points of a line, behind the last that kernels reach.
const MARGIN: usize = WIDTH + 1;

/// A sample of the unit torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// From 0 to 1, both included.
    pub at: DVec2,
    pub weight: f64,
}

/// A sample in grid points.
#[derive(Clone, Copy)]
struct SpreadSample<const C: usize> {
    /// The grid point of [`first_grid_point`], along the slow axis x and along y.
    first: [u32; 2],
    /// How far that point lies behind the kernel's lower end, in grid points.
    ahead: [f64; 2],
    value: [f64; C],
}

impl<const C: usize> Default for SpreadSample<C> {
    fn default() -> Self {
        Self {
            first: [0; 2],
            ahead: [0.0; 2],
            value: [0.0; C],
        }
    }
}

/// Samples sorted by tile, to be spread.
pub(super) struct Spread<const C: usize> {
    kernel: Kernel,
    /// Grid points along x and y, without margins.
    sizes: [usize; 2],
    samples: Vec<SpreadSample<C>>,
    /// Where the samples of each band begin.
    starts: Vec<usize>,
}

/// Which samples lie in which tile.
pub(super) struct Tiles {
    /// The tile of each sample.
    keys: Vec<u32>,
    /// Where the samples of each tile begin, sorted by tile.
    starts: Vec<usize>,
    /// Where those of each band begin.
    bands: Vec<usize>,
}

impl Tiles {
    /// Returns the tile of each sample on a grid of these sizes, and where each tile begins.
    pub fn of(samples: &[Sample], sizes: [usize; 2]) -> Self {
        // A first grid point is at most the grid's size, so that there may be one tile more than the grid is divided
        // into.
        let tiles_of_band = sizes[1] / TILE + 1;
        let band_count = sizes[0] / BAND + 1;
        let tile_of = |[x, y]: [u32; 2]| x as usize / BAND * tiles_of_band + y as usize / TILE;
        let keys: Vec<u32> = (samples.par_iter())
            .map(|sample| tile_of(first_grid_point(sample.at, sizes).0) as u32)
            .collect();

        // A counting sort: samples of a tile keep their sequence.
        let mut starts = vec![0_usize; tiles_of_band * band_count + 1];
        for &key in &keys {
            starts[key as usize + 1] += 1;
        }
        for tile in 1..starts.len() {
            starts[tile] += starts[tile - 1];
        }

        let bands = starts.iter().copied().step_by(tiles_of_band).collect();
        Self {
            keys,
            starts,
            bands,
        }
    }

    /// The indices of the samples, sorted by tile.
    pub fn order(self) -> Vec<u32> {
        let (mut order, mut cursors) = (vec![0; self.keys.len()], self.starts);
        for (index, key) in self.keys.into_iter().enumerate() {
            let cursor = &mut cursors[key as usize];
            order[*cursor] = index as u32;
            *cursor += 1;
        }
        order
    }
}

/// Lines of a grid with margins, of `C` components that follow each other line by line.
pub(super) struct SpreadGrid<const C: usize> {
    /// The number of values from one line to the next.
    stride: usize,
    /// The lines that are held: all, or those of a strip.
    lines: Range<usize>,
    cells: Vec<f64>,
}

impl<const C: usize> SpreadGrid<C> {
    fn new(stride: usize, lines: Range<usize>) -> Self {
        Self {
            stride,
            cells: vec![0.0; lines.len() * C * stride],
            lines,
        }
    }

    /// The components of a line along y. Values beyond the grid's size belong to its start.
    pub fn line(&self, index: usize) -> [&[f64]; C] {
        let first = (index - self.lines.start) * C;
        std::array::from_fn(|component| {
            &self.cells[(first + component) * self.stride..][..self.stride]
        })
    }
}

impl<const C: usize> Spread<C> {
    /// Sorts samples by band and tile; `value` gives their weights, in components.
    pub fn new(
        samples: &[Sample],
        sizes: [usize; 2],
        value: impl Fn(&Sample) -> [f64; C] + Sync,
    ) -> Self {
        let Tiles {
            keys,
            starts: mut cursors,
            bands,
        } = Tiles::of(samples, sizes);

        // Within a tile samples keep their sequence, so that sums have one order.
        let mut sorted = vec![SpreadSample::default(); samples.len()];

        for (sample, key) in samples.iter().zip(keys) {
            let (first, ahead) = first_grid_point(sample.at, sizes);
            let cursor = &mut cursors[key as usize];
            sorted[*cursor] = SpreadSample {
                first,
                ahead,
                value: value(sample),
            };
            *cursor += 1;
        }

        Self {
            kernel: Kernel::new(),
            sizes,
            samples: sorted,
            starts: bands,
        }
    }

    /// How many samples are spread.
    pub fn count(&self) -> usize {
        self.samples.len()
    }

    /// Returns room for a strip of lines.
    pub fn room(&self) -> SpreadGrid<C> {
        SpreadGrid::new(self.stride(), 0..STRIP)
    }

    /// Fills `room` with the lines from `strip` times [`STRIP`] on: with all samples that reach them, and with the
    /// lines beyond the end of the grid that are folded into them. Returns how many samples begin in these lines.
    pub fn spread_strip(&self, strip: usize, room: &mut SpreadGrid<C>) -> usize {
        let first = strip * STRIP;
        let lines = first..self.sizes[0].min(first + STRIP);
        self.spread_lines(lines.clone(), room);

        // Lines beyond the last one are the first ones.
        if strip == 0 {
            let beyond = self.sizes[0]..self.sizes[0] + MARGIN;
            let mut margin = SpreadGrid::new(room.stride, beyond.clone());
            self.spread_lines(beyond, &mut margin);
            for (value, extra) in room.cells.iter_mut().zip(margin.cells) {
                *value += extra;
            }
        }

        // The last strip has the bands behind it, too: kernels may begin on the line after the last.
        let last = if lines.end == self.sizes[0] {
            self.bands()
        } else {
            (strip + 1) * BANDS_EACH
        };
        self.starts[last] - self.starts[strip * BANDS_EACH]
    }

    /// Makes `room` some lines of the grid, before any is folded.
    fn spread_lines(&self, lines: Range<usize>, room: &mut SpreadGrid<C>) {
        room.cells.fill(0.0);
        room.lines = lines.clone();

        // The kernel of a sample reaches lines behind the first of its band.
        let bands = lines.start.saturating_sub(WIDTH - 1) / BAND..lines.end.div_ceil(BAND);
        // The order of the sums is that of the whole grid, where bands of one parity are spread at the same time.
        for parity in [0, 1] {
            for band in bands.clone().filter(|band| band % 2 == parity) {
                self.add(self.of_band(band), &lines, room.stride, &mut room.cells);
            }
        }
    }

    /// Returns the whole grid before any sample is spread onto it.
    pub fn empty_grid(&self) -> SpreadGrid<C> {
        SpreadGrid::new(self.stride(), 0..(self.bands() + 1) * BAND)
    }

    /// The values of a line: kernels reach beyond its last point.
    fn stride(&self) -> usize {
        self.sizes[1] + MARGIN
    }

    /// How many bands the samples are sorted by.
    pub fn bands(&self) -> usize {
        self.starts.len() - 1
    }

    /// Spreads the samples of the band that comes at an index, the even bands before the odd ones, onto the whole grid. Returns
    /// how many there are.
    pub fn spread_band(&self, index: usize, grid: &mut SpreadGrid<C>) -> usize {
        let even = self.bands().div_ceil(2);
        let band = if index < even {
            2 * index
        } else {
            2 * (index - even) + 1
        };

        let samples = self.of_band(band);
        let lines = grid.lines.clone();
        self.add(samples, &lines, grid.stride, &mut grid.cells);
        samples.len()
    }

    /// Adds the lines beyond the last to the first ones, to which they belong, once all bands are spread.
    pub fn fold(&self, grid: &mut SpreadGrid<C>) {
        let line = C * grid.stride;
        let (home, margin) = grid.cells.split_at_mut(self.sizes[0] * line);
        for (value, extra) in home.iter_mut().zip(&margin[..MARGIN * line]) {
            *value += extra;
        }
    }

    /// The samples of a band; none of one behind the last.
    fn of_band(&self, band: usize) -> &[SpreadSample<C>] {
        match [band, band + 1].map(|band| self.starts.get(band)) {
            [Some(&start), Some(&end)] => &self.samples[start..end],
            _ => &[],
        }
    }

    /// Adds samples to the cells of some lines, each sample with the kernel's values times its weights.
    fn add(
        &self,
        samples: &[SpreadSample<C>],
        lines: &Range<usize>,
        stride: usize,
        cells: &mut [f64],
    ) {
        for sample in samples {
            let (first_line, start) = (sample.first[0] as usize, sample.first[1] as usize);
            // Some or all of the lines that a sample reaches may lie outside of `lines`. Those are left out.
            let reached = first_line.max(lines.start)..(first_line + WIDTH).min(lines.end);
            if reached.is_empty() {
                continue;
            }

            let [along_x, along_y] = sample.ahead.map(|ahead| self.kernel.values(ahead));
            let factors = &along_x[reached.start - first_line..reached.end - first_line];

            // Nothing wraps: values beyond the grid go into its margins.
            let reached_cells = &mut cells[(reached.start - lines.start) * C * stride..];
            for (line, factor) in reached_cells.chunks_exact_mut(C * stride).zip(factors) {
                for component in 0..C {
                    let weight = factor * sample.value[component];
                    let from_start = &mut line[component * stride + start..];
                    // The margin makes every line long enough.
                    if let Some(touched) = from_start.first_chunk_mut::<WIDTH>() {
                        for (cell, value) in touched.iter_mut().zip(along_y) {
                            *cell += weight * value;
                        }
                    }
                }
            }
        }
    }
}

/// The first grid point that a sample's kernel reaches, moved up by half a kernel, and how far it lies behind the
/// kernel's lower end. It is at most the grid's size.
pub(super) fn first_grid_point(at: DVec2, sizes: [usize; 2]) -> ([u32; 2], [f64; 2]) {
    let position = at * DVec2::from(sizes.map(|size| size as f64));
    let first = position.ceil();
    let indices = first.to_array().map(|value| value as u32);
    (indices, (first - position).to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples anywhere and at both ends of the axes, whose kernels reach beyond the last lines.
    fn samples() -> Vec<Sample> {
        let sample = |i: u32| Sample {
            at: DVec2::new(f64::from(i) * 0.754_877, f64::from(i) * 0.569_84).fract(),
            weight: 1.0 + f64::from(i % 7),
        };
        let ends = [0.0, 1.0].map(|end| Sample {
            at: DVec2::splat(end),
            weight: 0.3,
        });
        (0..3000).map(sample).chain(ends).collect()
    }

    fn spread(samples: &[Sample], sizes: [usize; 2]) -> Spread<2> {
        Spread::new(samples, sizes, |sample| [sample.weight, -0.5 * sample.at.x])
    }

    /// Returns how many values of the strips' lines have other bits than those of the whole grid.
    fn differences(strips: &Spread<2>, whole: &Spread<2>) -> usize {
        let mut grid = whole.empty_grid();
        for index in 0..whole.bands() {
            whole.spread_band(index, &mut grid);
        }
        whole.fold(&mut grid);

        let [lines, _] = whole.sizes;
        let (mut room, mut different, mut count) = (strips.room(), 0, 0);
        for strip in 0..lines.div_ceil(STRIP) {
            count += strips.spread_strip(strip, &mut room);
            for line in strip * STRIP..lines.min((strip + 1) * STRIP) {
                let found = room.line(line).into_iter().flatten();
                let expected = grid.line(line).into_iter().flatten();
                different += found
                    .zip(expected)
                    .filter(|(a, b)| a.to_bits() != b.to_bits())
                    .count();
            }
        }
        assert_eq!(count, strips.count(), "each sample begins in one strip");
        different
    }

    #[test]
    fn strips_have_the_bits_of_the_whole_grid() {
        let samples = samples();
        // Less than a strip, whole strips, and a rest of a few lines.
        for lines in [24, 64, 128, 150, 200] {
            let sizes = [lines, 90];
            let whole = spread(&samples, sizes);
            assert_eq!(differences(&spread(&samples, sizes), &whole), 0, "{lines}");
            // The control: one sample less shows.
            assert!(
                differences(&spread(&samples[1..], sizes), &whole) > 0,
                "{lines}"
            );
        }
    }
}
