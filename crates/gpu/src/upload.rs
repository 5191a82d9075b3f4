//! Uploads a state of the sequential engine in the device's layout. Used for runs whose first stages the CPU computes,
//! to find the stage in which a difference begins.
//!
//! The window is the whole domain. The halo around it, in the frame, repeats samples of a periodic domain. An *image* is a
//! block where it lies in the frame.

use std::collections::HashMap;

use glam::I64Vec2;
use tilescope_core::windows::{CELL_BITS, PAD};
use tilescope_core::{Fate, Insertion, Point, R, Run, Sequential, Stage, Unobserved};

use crate::constants::{
    DETECTOR, FATE_KEPT, FATE_LOST, FLAG_FRESH, FLAG_HOT, FLAG_LOST, FLAG_UNSURE, TILE_WORDS,
};
use crate::error::GpuError;
use crate::layout::{Name, counter};
use crate::window_run::WindowRun;

/// Writes what `engine` has computed before the stage `first`, and lets the device begin with that stage.
pub(crate) fn upload(
    work: &mut WindowRun,
    mut engine: Sequential,
    first: Stage,
) -> Result<(), GpuError> {
    let mut counters = [0_u32; counter::COUNT as usize];
    match first {
        Stage::Tile => {
            let lists = tile_images(work);
            work.device.write(Name::TileImages, bytes(&lists))?;
        }
        // From these stages on the device makes the grid of survivors itself.
        Stage::Eliminate | Stage::Iterate(1) => write_tiled(work, engine.run(), &mut counters)?,
        Stage::Iterate(_) | Stage::Finish => {
            // The run may have ended before this iteration: a step of the engine that finds no gap goes on to the end.
            if engine.next() != Some(first) && first != Stage::Finish {
                return Err(GpuError::FirstStage { stage: first });
            }
            write_tiled(work, engine.run(), &mut counters)?;
            // `write_tiled` has put the list of contested cells into this buffer, and elimination, which would clear it, is
            // not run.
            let heads = vec![0_u32; work.plan.cells() as usize + 1];
            work.device.write(Name::Heads, bytes(&heads))?;
            write_grid(work, engine.run(), first, &mut counters)?;
        }
        // A device that makes all stages needs no upload, and has no regions.
        Stage::Pattern | Stage::Blocks | Stage::Regions => {
            return Err(GpuError::FirstStage { stage: first });
        }
    }

    // The run is copied before `write_work`, which may run the engine one level further.
    let mut base = engine.run().clone();
    if let Stage::Iterate(k) = first
        && k > 1
    {
        write_work(work, &mut engine, k, &mut counters)?;
    }

    work.device.write(Name::Counters, bytes(&counters))?;
    let inserted = base
        .iterations
        .iter()
        .map(|i| i.inserted.len() as u64)
        .collect();
    // The device gathers the result itself.
    base.result.clear();
    work.begin_at(first, inserted, base);
    Ok(())
}

fn bytes(words: &[u32]) -> &[u8] {
    bytemuck::cast_slice(words)
}

/// Returns the list of images for each tile: [`TILE_WORDS`] words, of which the first one counts the images. All images
/// that can reach a tile have room.
fn tile_images(work: &WindowRun) -> Vec<u32> {
    let frame = &work.plan.uniform;
    let mut lists = vec![0; (frame.tiles * TILE_WORDS) as usize];
    // Pieces are in the order of images, so that the lists are sorted, as the pass `sort blocks` leaves them.
    for &[image, column, row, size] in &work.plan.pieces {
        // A piece has its rows of tiles in the upper half of its size, and its columns in the lower (`plan.rs`).
        for up in 0..size >> 16 {
            for right in 0..size & 0xffff {
                let tile = (row + up) * frame.tile_columns + column + right;
                let list = &mut lists[(tile * TILE_WORDS) as usize..][..TILE_WORDS as usize];
                list[0] += 1;
                list[list[0] as usize] = image;
            }
        }
    }
    lists
}

/// Writes the tiled samples with their fates. All cells that hold samples are listed as contested.
fn write_tiled(work: &mut WindowRun, run: &Run, counters: &mut [u32]) -> Result<(), GpuError> {
    let samples = tiled(work, run);
    let cells = work.plan.cells() as usize;
    let mut starts = vec![0_u32; cells + 1];
    for sample in &samples {
        starts[sample.cell + 1] += 1;
    }

    // The engine leaves samples without conflicts undecided, too, so every cell that holds samples is listed. The entry
    // behind a cell has its count, until the counts of all cells before are added.
    let mut contested = Vec::new();
    for cell in 0..cells {
        if starts[cell + 1] > 0 {
            contested.push(cell as u32);
        }
        starts[cell + 1] += starts[cell];
    }

    let places: Vec<u32> = samples.iter().map(|s| s.offset | s.fate).collect();
    let origins: Vec<u32> = samples.iter().flat_map(|s| [s.image, s.pattern]).collect();

    counters[counter::CONTESTED as usize] = contested.len() as u32;
    counters[counter::TILED as usize] = samples.len() as u32;

    let device = &work.device;
    device.write(Name::Starts, bytes(&starts))?;
    device.write(Name::Places, bytes(&places))?;
    device.write(Name::Origins, bytes(&origins))?;
    device.write(Name::Heads, bytes(&contested))
}

/// A tiled sample as the device stores it. Sorted by these fields in turn, samples are in the sequence of the device's
/// list: cell by cell, then image by image, then row by row.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct TiledWords {
    cell: usize,
    /// The index of the image that lays the sample down.
    image: u32,
    /// The place in the cell: the row in the high bits, the column in the low ones.
    offset: u32,
    fate: u32,
    /// The index of the pattern's sample.
    pattern: u32,
}

/// Returns the samples tiled in the frame, in the order of the device's list.
fn tiled(work: &WindowRun, run: &Run) -> Vec<TiledWords> {
    let (plan, clipper) = (&work.plan, &work.setup.clipper);
    let mut offsets_by_block: HashMap<u32, Vec<(i64, i64)>> = HashMap::new();
    let mut tiled = Vec::new();

    for (placed, index) in plan.placed.iter().zip(0..) {
        // A block's clip has the samples of the pattern that are laid on the block and up to r beyond it.
        let enlarged = placed.rect.grown(R.into(), R.into());
        // A block numbers the samples of its clip from `first` on, row by row: how many offsets of the whole clip come
        // before a sample's own gives its id. The frame below may cut the clip off.
        let offsets = offsets_by_block
            .entry(placed.index)
            .or_insert_with(|| clip_of(work, placed));
        let first = run.tiles[placed.index as usize].samples.start;

        clipper.clip(placed, &enlarged, &plan.frame.tiled(), |x, y, pattern| {
            let offset = (i64::from(y) - enlarged.min.y, i64::from(x) - enlarged.min.x);
            let id = first + offsets.partition_point(|p| *p < offset) as u32;
            let fate = match run.samples.fates[id as usize] {
                // Without a bit of a fate a sample is undecided.
                Fate::Undecided => 0,
                Fate::Kept => FATE_KEPT,
                Fate::Eliminated { .. } | Fate::Dropped => FATE_LOST,
            };
            let cell = plan.frame.cell_at(x, y);
            tiled.push(TiledWords {
                cell,
                image: index,
                offset: pack(x, y),
                fate,
                pattern,
            });
        });
    }

    tiled.sort_unstable();
    tiled
}

/// Returns the offsets of a whole block's clip, row first, sorted.
fn clip_of(work: &WindowRun, placed: &tilescope_core::windows::PlacedBlock) -> Vec<(i64, i64)> {
    let clipper = &work.setup.clipper;
    let mut moved = *placed;
    // The block is moved so that its clip, which begins r before it, begins at (0, 0): positions are then offsets. They
    // fit 32 bits, as longer blocks are refused earlier: they are too large to run in one go.
    moved.rect.min = I64Vec2::splat(R.into());
    moved.rect.max = placed.rect.max - placed.rect.min + i64::from(R);

    let whole = moved.rect.grown(R.into(), R.into());
    let target = tilescope_core::Rect {
        min: Point::new(0, 0),
        max: Point::new(i32::MAX, i32::MAX),
    };

    let mut offsets = Vec::new();
    clipper.clip(&moved, &whole, &target, |x, y, _| {
        offsets.push((i64::from(y), i64::from(x)));
    });
    offsets.sort_unstable();
    offsets
}

/// Returns the place of a sample in its cell as the device stores it.
fn pack(x: i32, y: i32) -> u32 {
    ((y & (R - 1)) << CELL_BITS | x & (R - 1)) as u32
}

/// Writes the grid of all valid samples; those inserted last are the detectors.
fn write_grid(
    work: &mut WindowRun,
    run: &Run,
    first: Stage,
    counters: &mut [u32],
) -> Result<(), GpuError> {
    let frame = &work.plan.frame;
    let cells = work.plan.cells() as usize;
    // Three free slots, and a word of the count and the flags.
    let mut grid = vec![[u32::MAX, u32::MAX, u32::MAX, 0]; cells];
    let last = run.iterations.len() as u32;

    let samples = run.samples.points.iter().zip(&run.samples.fates);
    for (id, (&point, &fate)) in samples.enumerate() {
        let iteration = run
            .iterations
            .iter()
            .position(|i| i.inserted.contains(&(id as u32)))
            .map_or(0, |index| index as u32 + 1);
        let detector = if iteration > 0 && iteration == last {
            DETECTOR
        } else {
            0
        };

        for [x, y] in images(work, point) {
            let slots = &mut grid[frame.cell_at(x, y)];
            if fate == Fate::Kept {
                let count = slots[3] & 3;
                slots[count as usize] = pack(x, y) | detector;
                // Iterations take a byte for each slot, above the count and the flags.
                slots[3] = (slots[3] + 1) | iteration << (8 + 8 * count);
            } else {
                // Eliminated or dropped: since elimination no sample is undecided.
                slots[3] |= FLAG_LOST;
            }
        }
    }

    let mut unsure = Vec::new();
    for (cell, slots) in grid.iter_mut().enumerate() {
        let (column, row) = frame.column_row(cell);
        let to_edge = rim(work, column, row);
        // The flag lets the device search a cell. Only detectors make candidates, so that searching every cell finds no
        // more than searching those near them.
        slots[3] |= FLAG_FRESH;

        // As on the device, the cells at the frame's edge are unsure, since samples beyond it are unknown. These cells
        // and those beside them are hot: samples inserted there may depend on unsure cells.
        if to_edge == 0 {
            slots[3] |= FLAG_UNSURE;
            unsure.push(cell as u32);
        }
        if to_edge <= 1 {
            slots[3] |= FLAG_HOT;
        }
    }

    counters[counter::UNSURE as usize] = unsure.len() as u32;
    // In uniform insertion, and at the end, no pass spreads unsure cells any more, so all of them count as spread.
    if work.setup.parameters.insertion == Insertion::Uniform || first == Stage::Finish {
        counters[counter::SPREAD as usize] = unsure.len() as u32;
    }

    work.device.write(Name::Unsure, bytes(&unsure))?;
    work.device.write(Name::Grid, bytemuck::cast_slice(&grid))
}

/// Returns the distance of a cell, in cells, from the nearest edge of the frame beyond which the plane continues;
/// `i32::MAX` in the padding, and in a frame without such an edge.
fn rim(work: &WindowRun, column: i32, row: i32) -> i32 {
    let frame = &work.plan.frame;
    let [columns, rows] = frame.cells;
    if !(0..columns).contains(&column) || !(0..rows).contains(&row) {
        return i32::MAX;
    }
    let [[left, right], [below, above]] = frame.goes_on;
    let ways = [
        (left, column),
        (right, columns - 1 - column),
        (below, row),
        (above, rows - 1 - row),
    ];
    // Nothing lies beyond a closed border, so that it is no edge.
    let open = ways.into_iter().filter(|(open, _)| *open);
    open.map(|(_, away)| away).min().unwrap_or(i32::MAX)
}

/// Returns all points of the frame that repeat a point in, or close to, the domain.
fn images(work: &WindowRun, point: Point) -> Vec<[i32; 2]> {
    let (frame, domain) = (&work.plan.frame, &work.setup.domain);
    let along = |axis: usize, at: i32| {
        let side = i64::from([domain.width(), domain.height()][axis]);
        let from = i64::from(at) - frame.origin[axis];
        let end = i64::from(frame.end[axis]);
        if !domain.is_periodic() {
            return vec![from as i32];
        }

        // In a periodic domain the frame shows the point again after each side.
        let first = from.rem_euclid(side);
        (first..end)
            .step_by(side as usize)
            .map(|v| v as i32)
            .collect()
    };

    let columns: Vec<i32> = along(0, point.x);
    along(1, point.y)
        .into_iter()
        .flat_map(|y| columns.iter().map(move |&x| [x, y]))
        .filter(|[x, y]| {
            // Dropped samples lie in the padding, at most a radius beyond the border.
            let cell = [x >> CELL_BITS, y >> CELL_BITS];
            cell.iter()
                .zip(frame.cells)
                .all(|(&c, n)| (-PAD..n + PAD).contains(&c))
        })
        .collect()
}

/// Writes the input of iteration `k`: all cells as open ones, or, in uniform insertion, the active cells at which it
/// throws.
fn write_work(
    work: &mut WindowRun,
    engine: &mut Sequential,
    k: u32,
    counters: &mut [u32],
) -> Result<(), GpuError> {
    if work.setup.parameters.insertion == Insertion::Circumcentre {
        let [columns, rows] = work.plan.frame.cells;
        let cell = |row| (0..columns).map(move |column| (column, row));
        // More cells than the open ones do no harm: the device searches each for uncovered pixels, and without any
        // finds no candidate.
        let all: Vec<u32> = (0..rows)
            .flat_map(cell)
            .map(|(column, row)| work.plan.frame.cell(column, row) as u32)
            .collect();
        counters[counter::OPEN as usize] = all.len() as u32;
        return work.device.write(Name::List, bytes(&all));
    }

    // The engine lists the active cells of an iteration only after running it.
    engine.step(&mut Unobserved)?;
    let Some(iteration) = engine.run().iterations.get(k as usize - 1) else {
        return Err(GpuError::FirstStage {
            stage: Stage::Iterate(k),
        });
    };

    let inside = |[x, y]: &[i32; 2]| work.plan.frame.holds(*x, *y);
    let active: Vec<[i32; 2]> = iteration
        .cells
        .iter()
        .flat_map(|cell| images(work, cell.min))
        .filter(inside)
        .collect();

    counters[counter::ACTIVE as usize] = active.len() as u32;
    work.device
        .write(Name::Active, bytemuck::cast_slice(&active))?;
    // The host has this counter and these cells as well. Elsewhere it reads them after a pass that does not run here.
    work.set_counter(counter::ACTIVE, active.len() as u32);
    work.keep_active(k, &active);
    Ok(())
}
