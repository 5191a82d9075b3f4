//! Reads the state on the device back as a `Run` of core: samples with ids, origins and fates, iterations, the result.
//! Ids follow from block and position, not from the order in buffers, which depends on atomics.
//!
//! The window is the whole domain. The halo around it, in the frame, repeats samples of a periodic domain. An *image* is a
//! block where it lies in the frame.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use tilescope_core::stages::blocks::split;
use tilescope_core::stages::detect::{Candidate, Sites};
use tilescope_core::stages::disks::Cell;
use tilescope_core::stages::tile::Tile;
use tilescope_core::windows::{CELL_BITS, PlacedBlock};
use tilescope_core::{
    Fate, Insertion, Iteration, Origin, Pattern, Point, R, Run, Samples, Stage, Symmetry,
};

use crate::constants::{
    FATE_KEPT, FATE_LOST, FATE_MASK, NO_SITE, POSITION_MASK, PROPOSAL_INSERTED,
};
use crate::error::GpuError;
use crate::layout::{Name, Proposal, counter};
use crate::window_run::{IterationBuffers, WindowRun};

/// The buffers, read back, from which a run is rebuilt.
#[derive(Default)]
pub(crate) struct State {
    /// The last completed stage.
    stage: Option<Stage>,
    starts: Vec<u32>,
    places: Vec<u32>,
    origins: Vec<u32>,
    by: Vec<u32>,
    grid: Vec<u32>,
    result: Vec<u32>,
    kept: BTreeMap<u32, IterationBuffers>,
}

/// A tiled sample as it lies on the device.
struct Tiled {
    /// Sort key that gives the ids: block, then row and column of the clip.
    order: (u32, u32, u32),
    point: Point,
    origin: Origin,
    /// Whether it lies in the window; beyond a closed border it is dropped.
    lies_inside: bool,
    /// Its word in the list, which has the fate in its highest bits.
    word: u32,
    /// Its index in the list.
    index: u32,
}

impl State {
    /// Reads the state after the last completed stage.
    pub(crate) async fn read(work: &WindowRun) -> Result<Self, GpuError> {
        let stage = work.last_stage();
        let device = &work.device;
        let cells = work.plan.cells();
        let at_least = |wanted: Stage| stage.is_some_and(|stage| stage >= wanted);
        let mut state = Self {
            stage,
            ..Self::default()
        };

        if at_least(Stage::Tile) {
            state.starts = device.words(Name::Starts, 0..cells + 1).await?;
            // The samples of the last cell end with the list.
            let tiled = state.starts.last().copied().unwrap_or(0).into();
            state.places = device.words(Name::Places, 0..tiled).await?;
            // Recorded runs have sources, so an origin has two words.
            state.origins = device.words(Name::Origins, 0..2 * tiled).await?;
            if at_least(Stage::Eliminate) {
                state.by = device.words(Name::By, 0..tiled).await?;
                // A cell of the grid has four words: three slots for samples and their count.
                state.grid = device.words(Name::Grid, 0..4 * cells).await?;
            }
        }

        for (&k, kept) in work.kept.iter().flatten() {
            if at_least(Stage::Iterate(k)) {
                state.kept.insert(k, kept.clone());
            }
        }

        if at_least(Stage::Finish) {
            // A sample's place has two words.
            let words = 2 * u64::from(work.counter(counter::KEPT));
            state.result = device.words(Name::Result, 0..words).await?;
        }

        Ok(state)
    }

    /// Returns the run as far as the device has made it.
    pub(crate) fn run(&self, work: &WindowRun, pattern: &Arc<Pattern>) -> Result<Run, GpuError> {
        let setup = &work.setup;
        let mut run = Run::new(&setup.parameters, setup.domain, Arc::clone(pattern));
        if self.stage.is_none() {
            return Ok(run);
        }
        // If the device began after elimination, the samples up to there are those of the CPU.
        if let Some((Stage::Iterate(_) | Stage::Finish, base)) = &work.base {
            run = base.clone();
            self.iterations(work, &mut run);
            return Ok(run);
        }

        run.blocks = split(&setup.domain, setup.parameters.leaf_units()?, setup.key);
        // Starts are read back once the device has tiled.
        if !self.starts.is_empty() {
            self.tile(work, &mut run);
        }
        self.iterations(work, &mut run);
        Ok(run)
    }

    /// Fills in iterations and the result.
    fn iterations(&self, work: &WindowRun, run: &mut Run) {
        let mut ids = ids_of(&run.samples);
        for (&k, kept) in &self.kept {
            self.iterate(work, k, kept, &mut ids, run);
        }
        let id = |p: &[u32]| ids.get(&Point::new(p[0] as i32, p[1] as i32)).copied();
        // A sample without an id is left out, so that a comparison with the CPU shows the fault.
        run.result = self.result.chunks_exact(2).filter_map(id).collect();
    }

    /// Fills in tiles and tiled samples, with their fates once elimination is done.
    fn tile(&self, work: &WindowRun, run: &mut Run) {
        let mut tiled = self.tiled(work);
        tiled.sort_unstable_by_key(|sample| sample.order);
        let point_of: HashMap<u32, Point> = self.points_by_index(work);
        let mut ids = HashMap::new();

        for (sample, id) in tiled.iter().zip(0..) {
            let fate = self.fate(sample);
            if fate == Fate::Kept {
                ids.insert(sample.point, id);
            }
            run.samples.push(sample.point, sample.origin, fate);
        }

        // All ids are known only now: a sample may be eliminated by one with a higher id.
        for (sample, fate) in tiled.iter().zip(&mut run.samples.fates) {
            if let Fate::Eliminated { by } = fate {
                // Indices are stored plus one; 0 stands for none.
                let winner = self.by[sample.index as usize].wrapping_sub(1);
                // No sample has the id that stands for a missing one, so that a comparison with the CPU shows the fault.
                *by = point_of
                    .get(&winner)
                    .and_then(|point| ids.get(point))
                    .copied()
                    .unwrap_or(u32::MAX);
            }
        }

        run.tiles = tiles(&work.plan.placed, &tiled);
    }

    /// Returns the fate of a tiled sample, as far as it is decided.
    fn fate(&self, sample: &Tiled) -> Fate {
        let decided = self.stage >= Some(Stage::Eliminate);
        match sample.word & FATE_MASK {
            _ if !sample.lies_inside => Fate::Dropped,
            FATE_KEPT if decided => Fate::Kept,
            // `tile` fills in the winner, once all ids are known.
            FATE_LOST if decided => Fate::Eliminated { by: 0 },
            _ => Fate::Undecided,
        }
    }

    /// Returns the domain's point of every tiled sample of the frame, by its index in the list.
    fn points_by_index(&self, work: &WindowRun) -> HashMap<u32, Point> {
        let mut points = HashMap::new();
        for cell in 0..work.plan.cells() as usize {
            for index in self.starts[cell]..self.starts[cell + 1] {
                let [x, y] = unpack(work, cell, self.places[index as usize]);
                points.insert(index, work.plan.frame.point(x, y));
            }
        }
        points
    }

    /// Returns the samples tiled in the window, and those dropped beyond closed borders.
    fn tiled(&self, work: &WindowRun) -> Vec<Tiled> {
        let (plan, mut tiled) = (&work.plan, Vec::new());
        for cell in 0..plan.cells() as usize {
            for index in self.starts[cell]..self.starts[cell + 1] {
                let word = self.places[index as usize];
                let [x, y] = unpack(work, cell, word);
                let inside = plan.frame.holds(x, y);
                // The window is the whole domain. Samples of the halo repeat those of the window and are left out; dropped
                // ones, outside of a bounded domain, repeat none.
                if inside && !plan.frame.window.contains(Point::new(x, y)) {
                    continue;
                }

                // An origin is two words: the index of the image, and that of the pattern's sample.
                let image = &plan.images[self.origins[2 * index as usize] as usize];
                // A sample is its block's own unless it lies in the margin around the block.
                let own = (image.own_min_x..image.own_max_x).contains(&x)
                    && (image.own_min_y..image.own_max_y).contains(&y);

                tiled.push(Tiled {
                    // Differences are taken modulo 2^32, as on the device: positions in a clip are smaller.
                    order: (
                        image.block,
                        (y as u32).wrapping_sub(image.corner_y),
                        (x as u32).wrapping_sub(image.corner_x),
                    ),
                    point: plan.frame.point(x, y),
                    origin: Origin::Tiled {
                        block: image.block,
                        pattern: self.origins[2 * index as usize + 1],
                        own,
                    },
                    lies_inside: inside,
                    word,
                    index,
                });
            }
        }
        tiled
    }

    /// Fills in iteration `k` from the buffers kept after it, with the samples that it inserted and their ids.
    fn iterate(
        &self,
        work: &WindowRun,
        k: u32,
        kept: &IterationBuffers,
        ids: &mut HashMap<Point, u32>,
        run: &mut Run,
    ) {
        let stored: Vec<Proposal> = bytemuck::pod_collect_to_vec(&kept.proposals);
        let mut proposals: Vec<(Point, Proposal)> = stored
            .into_iter()
            // Proposals of the halo repeat those of the window.
            .filter(|p| work.plan.frame.window.contains(Point::new(p.x, p.y)))
            .map(|p| (work.plan.frame.point(p.x, p.y), p))
            .collect();

        let is_uniform = run.parameters.insertion == Insertion::Uniform;
        // Proposals of uniform insertion are darts, not candidates.
        let candidates = if is_uniform {
            Vec::new()
        } else {
            self.candidates(work, &proposals, ids)
        };

        // Core inserts in the order of ranks, and its ids follow that.
        proposals.retain(|(_, p)| p.state == PROPOSAL_INSERTED);
        proposals.sort_unstable_by_key(|(point, p)| (p.rank, point.row_major()));
        let cells = active_cells(work, k, &kept.active, run.iterations.last());

        // An iteration that neither inserts a sample nor has an active cell is not one of the run, as in the sequential
        // engine.
        if proposals.is_empty() && cells.is_empty() {
            return;
        }

        let detectors = match run.iterations.last() {
            _ if is_uniform => Vec::new(),
            // From iteration 2 on the samples inserted last are the detectors.
            Some(before) => before.inserted.clone().collect(),
            // In iteration 1 they are marked in the grid.
            None => Self::detectors(work, &kept.grid, ids),
        };

        let first = run.samples.len() as u32;
        for (point, _) in &proposals {
            // Candidates are sorted by position. If the sample is not among them, it was a dart.
            let made = candidates.binary_search_by_key(&point.row_major(), |c| c.point.row_major());
            let sites = made.map_or(Sites::Dart, |index| candidates[index].sites);
            ids.insert(*point, run.samples.len() as u32);
            let origin = Origin::Inserted {
                iteration: k,
                sites,
            };
            run.samples.push(*point, origin, Fate::Kept);
        }

        run.iterations.push(Iteration {
            detectors,
            candidates,
            cells,
            inserted: first..run.samples.len() as u32,
        });
    }

    /// Returns the candidates sorted by position. If several sets of sites make the same candidate, the lowest is
    /// kept.
    fn candidates(
        &self,
        work: &WindowRun,
        proposals: &[(Point, Proposal)],
        ids: &HashMap<Point, u32>,
    ) -> Vec<Candidate> {
        // A site is named by its cell, times four, plus its slot.
        let id = |key: u32| {
            let [x, y] = unpack(work, (key / 4) as usize, self.grid[key as usize]);
            ids.get(&work.plan.frame.point(x, y))
                .copied()
                // No sample has this id, so a comparison with the CPU shows the fault.
                .unwrap_or(u32::MAX)
        };

        let mut candidates: Vec<Candidate> = proposals
            .iter()
            .map(|&(point, p)| {
                let sites = match [p.site_a, p.site_b, p.site_c] {
                    [a, NO_SITE, _] => Sites::Corner(id(a)),
                    [a, b, NO_SITE] => Sites::Border(sorted([id(a), id(b)])),
                    [a, b, c] => Sites::Three(sorted([id(a), id(b), id(c)])),
                };
                Candidate { point, sites }
            })
            .collect();

        // The sequence of proposals depends on atomics, and several sets of sites may make one point.
        tilescope_core::stages::insert::unique(&mut candidates);
        candidates
    }

    /// Returns the detectors of iteration 1 by id.
    fn detectors(work: &WindowRun, grid: &[u8], ids: &HashMap<Point, u32>) -> Vec<u32> {
        let grid: Vec<u32> = bytemuck::pod_collect_to_vec(grid);
        let mut detectors = Vec::new();
        for (cell, slots) in grid.chunks_exact(4).enumerate() {
            // A cell has three slots and a word whose lowest two bits count the samples in them.
            for &slot in &slots[..(slots[3] & 3) as usize] {
                let [x, y] = unpack(work, cell, slot);
                // Of the bits above the position, a slot of the grid has that of a detector alone.
                if slot & !POSITION_MASK != 0 && work.plan.frame.window.contains(Point::new(x, y)) {
                    detectors.extend(ids.get(&work.plan.frame.point(x, y)));
                }
            }
        }
        detectors.sort_unstable();
        detectors
    }
}

fn sorted<const N: usize>(mut ids: [u32; N]) -> [u32; N] {
    ids.sort_unstable();
    ids
}

/// Returns the ids of the valid samples by point.
fn ids_of(samples: &Samples) -> HashMap<Point, u32> {
    (0..)
        .zip(samples.points.iter().zip(&samples.fates))
        .filter(|(_, (_, fate))| **fate == Fate::Kept)
        .map(|(id, (point, _))| (*point, id))
        .collect()
}

/// Returns the active cells of level `k` that lie in the window, in the sequence in which core visits them. `before` is
/// the iteration of the level before, if there is one.
fn active_cells(work: &WindowRun, k: u32, active: &[u8], before: Option<&Iteration>) -> Vec<Cell> {
    let words: Vec<i32> = bytemuck::pod_collect_to_vec(active);
    let side = R >> k;
    let mut cells: Vec<Point> = words
        .chunks_exact(2)
        .filter(|p| work.plan.frame.window.contains(Point::new(p[0], p[1])))
        .map(|p| work.plan.frame.point(p[0], p[1]))
        .collect();
    cells.sort_unstable_by_key(|p| p.row_major());

    // Core splits the cells of the level before one by one, so they are not in the order of positions. Those of level 1
    // come from the gaps, in that order.
    if let Some(before) = before.filter(|_| k > 1) {
        let known: std::collections::HashSet<Point> = cells.iter().copied().collect();
        let quarters = |cell: &Cell| {
            let Point { x, y } = cell.min;
            [(0, 0), (side, 0), (0, side), (side, side)]
                .map(|(right, up)| Point::new(x + right, y + up))
        };
        cells = before.cells.iter().flat_map(quarters).collect();
        cells.retain(|cell| known.contains(cell));
    }

    cells.into_iter().map(|min| Cell { min, side }).collect()
}

/// Returns the tiles of all blocks.
fn tiles(placed: &[PlacedBlock], tiled: &[Tiled]) -> Vec<Tile> {
    let starts: BTreeMap<u32, (Point, u8)> = placed
        .iter()
        // All images of a block have its index, start and symmetry.
        .map(|block| (block.index, (block.start, block.symmetry)))
        .collect();
    let mut first = 0;

    starts
        .into_iter()
        .map(|(block, (start, symmetry))| {
            let from = first;
            // The samples are sorted by block.
            first = tiled.partition_point(|sample| sample.order.0 <= block) as u32;
            Tile {
                start,
                symmetry: Symmetry(symmetry),
                samples: from..first,
            }
        })
        .collect()
}

/// Returns the frame's point of a packed position of a cell.
fn unpack(work: &WindowRun, cell: usize, word: u32) -> [i32; 2] {
    let (column, row) = work.plan.frame.column_row(cell);
    let low = R as u32 - 1;
    [
        column << CELL_BITS | (word & low) as i32,
        row << CELL_BITS | ((word >> CELL_BITS) & low) as i32,
    ]
}
