//! Spreads weighted samples of the unit torus onto a fine grid, in bands that fit a cache. Samples are sorted by tile
//! first; even bands go before odd ones, so that sums have one order. Indices do not wrap: the grid has margins, and
//! readers fold them back.

use glam::DVec2;
use rayon::prelude::*;

use super::error::MeasureError;
use super::kernel::{Kernel, WIDTH};
use crate::monitor::Monitor;

/// Grid lines of a band; at least the kernel's width, so that a band reaches only into the next.
const BAND: usize = 32;

/// Grid points of a tile along a line: a tile with the kernel's margin takes 27 KiB per component.
const TILE: usize = 64;

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
    /// Of the slow axis x and of y.
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
        let tiles = sizes[1] / TILE + 1;
        let bands = sizes[0] / BAND + 1;
        let key = |first: [u32; 2]| first[0] as usize / BAND * tiles + first[1] as usize / TILE;
        let keys: Vec<u32> = (samples.par_iter())
            .map(|sample| key(first_grid_point(sample.at, sizes).0) as u32)
            .collect();

        // A counting sort: samples of a tile keep their sequence.
        let mut starts = vec![0_usize; tiles * bands + 1];
        for &key in &keys {
            starts[key as usize + 1] += 1;
        }
        for tile in 1..starts.len() {
            starts[tile] += starts[tile - 1];
        }

        let bands = starts.iter().copied().step_by(tiles).collect();
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

/// A grid with margins, of `C` components that follow each other line by line.
pub(super) struct SpreadGrid<const C: usize> {
    /// The number of values from one line to the next.
    stride: usize,
    cells: Vec<f64>,
}

impl<const C: usize> SpreadGrid<C> {
    /// The components of a line along y. Values beyond the grid's size belong to its start.
    pub fn line(&self, index: usize) -> [&[f64]; C] {
        std::array::from_fn(|component| {
            &self.cells[(index * C + component) * self.stride..][..self.stride]
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

    /// Returns the grid with all samples spread onto it.
    pub fn run(&self, monitor: &Monitor<'_>) -> Result<SpreadGrid<C>, MeasureError> {
        let mut grid = self.empty_grid();
        monitor.advance(self.samples.len() as u64)?;

        // A band writes on its own lines and those of the next: bands of one parity share none.
        for parity in [0, 1] {
            let band_cells = BAND * C * grid.stride;
            let chunks = grid.cells[parity * band_cells..].par_chunks_mut(2 * band_cells);
            chunks.enumerate().try_for_each(|(index, cells)| {
                let band = 2 * index + parity;
                let samples = self.band(band, grid.stride, cells);
                monitor.advance(samples as u64)
            })?;
        }
        self.fold(&mut grid);
        Ok(grid)
    }

    /// Returns the grid before any sample is spread onto it.
    pub fn empty_grid(&self) -> SpreadGrid<C> {
        let stride = self.sizes[1] + WIDTH + 1;
        SpreadGrid {
            stride,
            cells: vec![0.0; (self.bands() + 1) * BAND * C * stride],
        }
    }

    pub fn bands(&self) -> usize {
        self.starts.len() - 1
    }

    /// Spreads the samples of the band that comes at an index, the even bands before the odd ones. Returns how many there are.
    pub fn spread_band(&self, index: usize, grid: &mut SpreadGrid<C>) -> usize {
        let even = self.bands().div_ceil(2);
        let band = if index < even {
            2 * index
        } else {
            2 * (index - even) + 1
        };
        let (stride, start) = (grid.stride, band * BAND * C * grid.stride);
        let end = grid.cells.len().min(start + 2 * BAND * C * stride);
        self.band(band, stride, &mut grid.cells[start..end])
    }

    /// Adds the lines beyond the last to the first ones, to which they belong, once all bands are spread.
    pub fn fold(&self, grid: &mut SpreadGrid<C>) {
        let line = C * grid.stride;
        let (home, margin) = grid.cells.split_at_mut(self.sizes[0] * line);
        for (value, extra) in home.iter_mut().zip(&margin[..(WIDTH + 1) * line]) {
            *value += extra;
        }
    }

    /// Spreads the samples of a band onto its lines and those of the next one, and returns how many there are.
    fn band(&self, band: usize, stride: usize, cells: &mut [f64]) -> usize {
        // Behind the last band lie the lines that it reaches.
        let [Some(&start), Some(&end)] = [band, band + 1].map(|band| self.starts.get(band)) else {
            return 0;
        };
        let samples = &self.samples[start..end];
        self.add(band, samples, stride, cells);
        samples.len()
    }

    /// Adds samples of a band to its cells, each sample with the kernel's values times its weights.
    fn add(&self, band: usize, samples: &[SpreadSample<C>], stride: usize, cells: &mut [f64]) {
        for sample in samples {
            let [along_x, along_y] = sample.ahead.map(|ahead| self.kernel.values(ahead));
            let (line, start) = (
                sample.first[0] as usize - band * BAND,
                sample.first[1] as usize,
            );

            // Nothing wraps: values beyond the grid go into its margins.
            let lines = &mut cells[line * C * stride..][..WIDTH * C * stride];
            for (lines, factor) in lines.chunks_exact_mut(C * stride).zip(along_x) {
                for component in 0..C {
                    let weight = factor * sample.value[component];
                    let cells = &mut lines[component * stride + start..];
                    if let Some(cells) = cells.first_chunk_mut::<WIDTH>() {
                        for (cell, value) in cells.iter_mut().zip(along_y) {
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
