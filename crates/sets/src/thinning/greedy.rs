//! The greedy choice, cell by cell instead of point by point.
//!
//! A point may be decided as soon as all points near it that come earlier are. In each cell the points wait in the order of
//! their ranks; the first open one is kept or refused once no cell around holds an open point of an earlier rank, and is refused
//! as soon as a kept point is near. Whatever the order in which cells are visited, and on whatever threads, each point then
//! meets exactly the kept points that it would meet one by one: the choice is the same.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;
use tilescope_analysis::{Control, Progress};

use super::cells::{Grid, Layer, Place};
use super::near::{Reach, offset};
use super::{Cloud, CloudRadii, ThinError};

/// Decided points between two reports. Chosen, not measured.
const STRIDE: u64 = 1 << 14;

/// Bands for each thread: more would have more borders, over which cells wait for each other, and fewer would leave a thread
/// without work while another one ends.
const BANDS_A_THREAD: usize = 4;

/// A choice in the making: the layers of the cloud, with the points that are decided in them.
struct Choice<'a> {
    cloud: &'a Cloud<'a>,
    layers: Vec<Layer>,
    /// The reach of all pairs, if the radius is the same everywhere.
    reach: Option<Reach>,
    decided: AtomicU64,
    control: Control<'a>,
    is_cancelled: AtomicBool,
}

/// A cell of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cell {
    layer: usize,
    number: u32,
}

/// One of the bands of rows into which each layer is cut.
#[derive(Clone, Copy, Debug)]
struct Band {
    /// Its place among the bands, from the lowest rows up.
    number: u32,
    /// How many bands there are.
    all: u32,
}

/// What visiting a cell came to.
enum Visit {
    /// All of its points are decided.
    Done,
    /// Its first open point waits for an earlier one in this cell.
    Waits(Cell),
}

/// Returns which points are kept. `low` and `size` are of a rectangle around all points.
pub(super) fn choose(
    cloud: &Cloud<'_>,
    low: [f64; 2],
    size: [f64; 2],
    control: Control<'_>,
) -> Result<Vec<bool>, ThinError> {
    let choice = Choice {
        cloud,
        layers: layers(cloud, low, size),
        reach: match cloud.radii {
            CloudRadii::Constant(radius) => Some(Reach::of(radius)),
            CloudRadii::Each(_) => None,
        },
        decided: AtomicU64::new(0),
        control,
        is_cancelled: AtomicBool::new(false),
    };
    choice.report(0);

    // First each thread settles bands of rows. A point that waits for one of another band is left, and so are all that
    // wait for it.
    let all = (rayon::current_num_threads() * BANDS_A_THREAD) as u32;
    (0..all)
        .into_par_iter()
        .for_each(|number| choice.settle_band(Some(Band { number, all })));
    // After the bands, one thread decides the points that waited for those of other bands.
    choice.settle_band(None);
    if choice.is_cancelled.into_inner() {
        return Err(ThinError::Cancelled);
    }

    // Layers are sorted by cell; flags are asked for in the order of the points.
    let mut kept = vec![false; cloud.points.len()];
    for layer in &choice.layers {
        layer.turns.flag(&layer.indices, &mut kept);
    }
    Ok(kept)
}

/// Returns the points by octaves of their radii, each from a radius to its double. In a single grid, points of large radii
/// would search thousands of small cells, or large cells would hold thousands of points of small radii.
fn layers(cloud: &Cloud<'_>, low: [f64; 2], size: [f64; 2]) -> Vec<Layer> {
    let (points, ranks, is_periodic) = (cloud.points, cloud.ranks, cloud.period().is_some());
    let all = 0..points.len() as u32;
    let radii = match cloud.radii {
        CloudRadii::Constant(radius) => {
            let grid = Grid::new(low, size, radius, is_periodic);
            return vec![Layer::new(grid, all.into_par_iter(), points, ranks)];
        }
        CloudRadii::Each(radii) => radii,
    };

    // An octave lists its points in the order of the cloud. `Layer::new` then sorts them by cell and rank.
    let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
    let mut octaves: Vec<Vec<u32>> = Vec::new();
    for index in all {
        let own = octave(radii[index as usize], least);
        if octaves.len() <= own {
            octaves.resize(own + 1, Vec::new());
        }
        octaves[own].push(index);
    }
    // Radii of an octave are below twice its least.
    (octaves.into_iter().zip(0..))
        .map(|(indices, octave)| {
            let grid = Grid::new(low, size, least * 2_f64.powi(octave + 1), is_periodic);
            Layer::new(grid, indices.into_par_iter(), points, ranks)
        })
        .collect()
}

/// Returns how often the least radius can be doubled without exceeding this one.
fn octave(radius: f64, least: f64) -> usize {
    let mut octave = 0;
    while radius >= least * 2_f64.powi(octave + 1) {
        octave += 1;
    }
    octave as usize
}

impl Choice<'_> {
    /// Counts decided points and asks whether to go on.
    fn report(&self, more: u64) {
        let done = self.decided.fetch_add(more, Ordering::Relaxed) + more;
        let total = self.cloud.points.len() as u64;
        if (self.control)(Progress { done, total }) == ControlFlow::Break(()) {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Decides the points of a band, as far as they do not wait for other bands; without a band, all that are left.
    fn settle_band(&self, band: Option<Band>) {
        let mut visitor = Visitor {
            choice: self,
            band,
            around: Vec::new(),
            waiting: Vec::new(),
            decided: 0,
        };

        for (number, layer) in self.layers.iter().enumerate() {
            let cells = band.map_or(0..layer.cells(), |band| {
                layer.cells_of_band(band.number, band.all)
            });
            for cell in cells {
                // Without this, each band would go on to its next report.
                if self.is_cancelled.load(Ordering::Relaxed) {
                    return;
                }
                visitor.settle(Cell {
                    layer: number,
                    number: cell,
                });
            }
        }
        self.report(visitor.decided);
    }
}

/// What a thread needs to visit cells.
struct Visitor<'a> {
    choice: &'a Choice<'a>,
    band: Option<Band>,
    around: Vec<Cell>,
    /// Cells that wait, each for the cell that was pushed after it. The first open point of the later cell has the
    /// earlier rank, so that the list ends.
    waiting: Vec<Cell>,
    /// Points decided since the last report.
    decided: u64,
}

impl Visitor<'_> {
    /// Decides all points of a cell, and before them those that they wait for.
    fn settle(&mut self, cell: Cell) {
        self.waiting.push(cell);
        while let Some(&cell) = self.waiting.last() {
            match self.visit(cell) {
                Visit::Done => {
                    self.waiting.pop();
                }
                Visit::Waits(earlier) if self.may_visit(earlier) => self.waiting.push(earlier),
                // All that waits for another band is marked, so that no cell follows the same way again.
                Visit::Waits(_) => {
                    for cell in self.waiting.drain(..) {
                        let stuck = &self.choice.layers[cell.layer].turns.stuck;
                        stuck[cell.number as usize].store(true, Ordering::Relaxed);
                    }
                }
            }

            if self.decided >= STRIDE {
                self.choice.report(std::mem::take(&mut self.decided));
                if self.choice.is_cancelled.load(Ordering::Relaxed) {
                    return;
                }
            }
        }
    }

    /// Returns whether a cell is of this band and does not wait for another one.
    fn may_visit(&self, cell: Cell) -> bool {
        let Some(band) = self.band else {
            return true;
        };
        let layer = &self.choice.layers[cell.layer];
        let is_stuck = layer.turns.stuck[cell.number as usize].load(Ordering::Relaxed);
        layer.band(layer.place(cell.number).row, band.all) == band.number && !is_stuck
    }

    /// Decides the open points of a cell until one waits.
    fn visit(&mut self, cell: Cell) -> Visit {
        let layer = &self.choice.layers[cell.layer];
        let place = layer.place(cell.number);
        let mut has_looked = false;
        while let Some(open) = layer.turns.head(cell.number) {
            // Where radii differ, the cells around depend on the point; else they are the same for all points of a cell.
            if !(has_looked && self.choice.reach.is_some()) {
                self.look_around(cell, place, layer.points[open as usize]);
                has_looked = true;
            }

            let is_kept = match self.meets(layer, open) {
                // This holds whatever else is open: a kept point that is near came before this one.
                Meeting::Kept => false,
                Meeting::Open(Some(earlier)) => return Visit::Waits(earlier),
                Meeting::Open(None) => true,
            };
            layer.turns.decide(cell.number, is_kept);
            self.decided += 1;
        }
        Visit::Done
    }

    /// Collects the cells in which points near a point may lie.
    fn look_around(&mut self, own: Cell, place: Place, point: [f64; 2]) {
        let around = &mut self.around;
        around.clear();
        for (number, layer) in self.choice.layers.iter().enumerate() {
            let at = if number == own.layer {
                place
            } else {
                layer.grid.place(point)
            };
            // Two points that are near are at most twice the smaller radius apart, and at most the larger one. Cells
            // are as wide as the largest radius of their octave, and layers follow each other by their octaves: one
            // step is enough in a layer whose radii are as large as the point's or larger, and two in one of smaller
            // radii.
            let steps = if own.layer <= number { 1 } else { 2 };
            layer.add_around(at, steps, |cell| {
                around.push(Cell {
                    layer: number,
                    number: cell,
                });
            });
        }

        // Most points are refused, and most of these by a point of their own cell, which is therefore asked first.
        if let Some(at) = around.iter().position(|cell| *cell == own) {
            around.swap(0, at);
        }
    }

    /// Returns what an open point meets around it: a kept point that is near, or else the cell of the earliest open point
    /// that comes before it.
    fn meets(&self, layer: &Layer, open: u32) -> Meeting {
        let (choice, open) = (self.choice, open as usize);
        let (point, rank) = (layer.points[open], layer.ranks[open]);
        // The rank and the cell of the earliest open point that comes before this one.
        let mut earliest: Option<(u32, Cell)> = None;
        for &cell in &self.around {
            let layer_there = &choice.layers[cell.layer];
            // The head is read before the kept points, since another thread may decide points of the cell meanwhile.
            // Read the other way round, an earlier point that is kept between the two readings would be missed by both.
            if let Some(head) = layer_there.turns.head(cell.number) {
                let before = layer_there.ranks[head as usize];
                if before < rank && earliest.is_none_or(|(least, _)| before < least) {
                    earliest = Some((before, cell));
                }
            }

            for other in layer_there.turns.kept(cell.number) {
                let other = other as usize;
                // Where radii differ, each pair has a distance of its own.
                let reach = choice.reach.unwrap_or_else(|| {
                    let of = |layer: &Layer, at: usize| {
                        choice.cloud.radii.of(layer.indices[at] as usize)
                    };
                    Reach::between(of(layer, open), of(layer_there, other))
                });
                if reach.holds(offset(
                    point,
                    layer_there.points[other],
                    choice.cloud.period(),
                )) {
                    return Meeting::Kept;
                }
            }
        }
        Meeting::Open(earliest.map(|(_, cell)| cell))
    }
}

/// What an open point meets.
enum Meeting {
    /// A kept point is near.
    Kept,
    /// None is; and this cell has the earliest open point that comes before it, if one does.
    Open(Option<Cell>),
}
