//! Computes where the rows of a buffer lie in the plane, from the frame, the counters and the cells of the tiled
//! samples as they are on the device between two passes. A row past the end of its list has no place.

use glam::I64Vec2;
use tilescope_core::windows::{CELL_BITS, PAD};
use tilescope_core::{Point, R, Rect, Stage};

use crate::buffer_rows::BufferRows;
use crate::constants::{POSITION_MASK, TILE_SIDE};
use crate::error::GpuError;
use crate::layout::{Access, Frame, Name, counter};
use crate::row_places::{RowPlace, RowPlaces, Unplaced};
use crate::window_run::WindowRun;

/// Device data, read between two passes, from which the places of buffer rows are computed.
#[derive(Clone, Debug)]
pub struct RowLocator {
    frame: Frame,
    /// The stage of the inspected pass. The same buffer holds different data in different stages.
    stage: Stage,
    /// The level of the active cells of uniform insertion.
    level: u32,
    counters: Vec<u32>,
    /// The cell of each tiled sample.
    cells: Vec<u32>,
    places: Vec<u32>,
    result: Vec<u32>,
    written: Vec<Name>,
}

impl RowLocator {
    /// Reads what places follow from, between two passes. `stage` is that of the inspected pass.
    pub(crate) async fn read(work: &WindowRun, stage: Stage) -> Result<Self, GpuError> {
        let device = &work.device;
        // The frame is read back from the device, since shaders use that one. A range is cut off at the buffer's end.
        let frame = device.bytes(Name::Frame, 0..u64::MAX).await?;
        let mut locator = Self {
            // Where the buffer is missing, the frame of the plan stands for it.
            frame: bytemuck::try_pod_read_unaligned(&frame).unwrap_or(work.plan.uniform),
            stage,
            level: work.level(),
            counters: device
                .words(Name::Counters, 0..counter::COUNT.into())
                .await?,
            cells: Vec::new(),
            places: Vec::new(),
            result: Vec::new(),
            written: written(work),
        };

        if locator.is_written(Name::Places) {
            // Tiled samples lie cell by cell, so that the starts of cells give the cell of each.
            let cells = work.plan.cells();
            let starts = device.words(Name::Starts, 0..cells + 1).await?;
            let tiled = u64::from(locator.counter(counter::TILED));
            locator.places = device.words(Name::Places, 0..tiled).await?;
            locator.cells = cells_of(&starts, locator.places.len());
        }

        if locator.is_written(Name::Result) {
            let kept = u64::from(locator.counter(counter::KEPT));
            locator.result = device.words(Name::Result, 0..2 * kept).await?;
        }

        Ok(locator)
    }

    /// Returns the places of the rows of `table`, which must have been read from the buffer `name` between the same two
    /// passes.
    #[must_use]
    pub fn locate(&self, name: Name, table: &BufferRows) -> RowPlaces {
        let mut places = RowPlaces {
            unplaced: self.unplaced(name),
            // These buffers have a row for every cell or tile. Lists of cells do not count: they have rows for some
            // cells alone.
            are_cells: match name {
                Name::Starts | Name::Grid | Name::TileImages => true,
                Name::Heads => !self.heads_are_listed(),
                _ => false,
            },
            ..RowPlaces::default()
        };

        if places.unplaced.is_none() {
            places.ends.reserve(table.rows.len());
            for (row, values) in table.rows.iter().enumerate() {
                self.row(name, row, values, &mut places.all);
                places.ends.push(places.all.len() as u32);
            }
        }
        places
    }

    /// Returns a place moved by whole periods so that its first point lies in the domain. In a bounded domain it is
    /// unchanged.
    #[must_use]
    pub fn wrapped(&self, place: RowPlace) -> RowPlace {
        let first = match place {
            RowPlace::Point(p) | RowPlace::Link([p, _]) => p,
            RowPlace::Rect(rect) => rect.min,
        };

        // Words of the frame may have been overwritten to inject a fault: a side may be 0, and the sums in `moved` may
        // overflow.
        let back = |at: i32, side: u32| match side {
            0 => 0,
            side => (i64::from(at).rem_euclid(side.into()) - i64::from(at)) as i32,
        };
        let (right, up) = match self.frame.periodic {
            0 => (0, 0),
            _ => (
                back(first.x, self.frame.side_x),
                back(first.y, self.frame.side_y),
            ),
        };

        let moved = |p: Point| Point::new(p.x.wrapping_add(right), p.y.wrapping_add(up));
        match place {
            RowPlace::Point(p) => RowPlace::Point(moved(p)),
            RowPlace::Link(ends) => RowPlace::Link(ends.map(moved)),
            RowPlace::Rect(Rect { min, max }) => RowPlace::Rect(Rect {
                min: moved(min),
                max: moved(max),
            }),
        }
    }

    /// Returns why the rows of a buffer have no places, or `None` if they have some.
    fn unplaced(&self, name: Name) -> Option<Unplaced> {
        match name {
            Name::Frame | Name::Job | Name::Counters | Name::Arguments | Name::Sums => {
                Some(Unplaced::Numbers)
            }
            Name::Pattern => Some(Unplaced::Pattern),
            _ if !self.is_written(name) => Some(Unplaced::Unwritten),
            _ => None,
        }
    }

    /// Returns whether a pass has written a buffer.
    fn is_written(&self, name: Name) -> bool {
        self.written.contains(&name)
    }

    /// Returns whether the buffer `heads` holds a list of contested cells, as in tiling and elimination. Later it has a
    /// row for each cell.
    fn heads_are_listed(&self) -> bool {
        self.stage <= Stage::Eliminate
    }

    /// Returns a counter as the device had it, or 0 if it was not read.
    fn counter(&self, counter: u32) -> u32 {
        self.counters.get(counter as usize).copied().unwrap_or(0)
    }

    /// Returns whether a row lies within a list whose length is in `counter`.
    fn is_listed(&self, row: usize, counter: u32) -> bool {
        (row as u64) < u64::from(self.counter(counter))
    }

    /// Appends the places of row number `row` of a buffer, whose numbers are `values`, to `places`.
    fn row(&self, name: Name, row: usize, values: &[i64], places: &mut Vec<RowPlace>) {
        // A missing value counts as -1, as the values of empty slots do.
        let value = |k: usize| values.get(k).copied().unwrap_or(-1);
        let pair = |k: usize| I64Vec2::new(value(k), value(k + 1));
        let in_list =
            |length, place: Option<RowPlace>| place.filter(|_| self.is_listed(row, length));

        let place = match name {
            Name::Images => self.rect(pair(0), pair(2)),
            // The word has columns in its lower half and rows in its upper half (`plan.rs`).
            Name::Pieces => self.tiles(pair(1), I64Vec2::new(value(3) & 0xffff, value(3) >> 16)),
            Name::TileImages => self.tile(row),
            Name::Heads if self.heads_are_listed() => {
                in_list(counter::CONTESTED, self.cell(value(0)))
            }
            Name::Starts | Name::Heads => self.cell(row as i64),
            Name::List => in_list(counter::OPEN, self.cell(value(0))),
            Name::Unsure => in_list(counter::UNSURE, self.cell(value(0))),
            Name::Grid => {
                // The cell comes first, and then its samples.
                places.extend(self.cell(row as i64));
                // A row has the count, the flags, and four values for each of three slots: the iteration, x, y, and the mark
                // of a detector (`buffer_rows.rs`).
                let columns_of_x = (0..3).map(|slot| 2 + 4 * slot + 1);
                places.extend(columns_of_x.filter_map(|k| self.sample(row as i64, pair(k))));
                None
            }
            Name::Places => self.tiled(row, pair(0)),
            Name::Origins => self.tiled(row, self.offset(row)),
            Name::By => self.link(row, value(0)),
            Name::Proposals => in_list(counter::PROPOSALS, self.point(pair(0))),
            Name::Active => in_list(counter::ACTIVE, self.square(pair(0), self.level)),
            Name::NextActive => in_list(counter::NEXT_ACTIVE, self.square(pair(0), self.level + 1)),
            // The result is in coordinates of the domain already, and not of the frame.
            Name::Result => in_list(counter::KEPT, point(pair(0)).map(RowPlace::Point)),
            Name::Tags => in_list(counter::KEPT, self.of_result(row)),
            Name::Frame
            | Name::Job
            | Name::Pattern
            | Name::Sums
            | Name::Counters
            | Name::Arguments
            // The buffers of exact tiling are not those of a window, whose rows are placed here.
            | Name::Ground
            | Name::LaidPieces
            | Name::Darts
            | Name::States
            | Name::Questions
            | Name::Verdicts
            | Name::Marks
            | Name::FreshCells
            | Name::OpenCells
            | Name::NextOpenCells => None,
        };

        places.extend(place);
    }

    /// Returns the offset from frame coordinates to plane coordinates. It puts the window into the domain.
    fn shift(&self) -> I64Vec2 {
        let frame = &self.frame;
        let axis = |origin: u32, window: i32, side: u32| {
            let first = origin.wrapping_add(window as u32);
            // A bounded domain does not repeat, and a side of 0 is a fault that was injected.
            let reduced = match (frame.periodic, side) {
                (0, _) | (_, 0) => i64::from(first as i32),
                _ => i64::from(first % side),
            };
            reduced - i64::from(window)
        };
        I64Vec2::new(
            axis(frame.origin_x, frame.window_min_x, frame.side_x),
            axis(frame.origin_y, frame.window_min_y, frame.side_y),
        )
    }

    /// Returns the plane point at frame coordinates.
    fn plane(&self, at: I64Vec2) -> Option<Point> {
        point(at + self.shift())
    }

    fn point(&self, at: I64Vec2) -> Option<RowPlace> {
        self.plane(at).map(RowPlace::Point)
    }

    /// Returns a rectangle by its corners in the frame, or `None` if it is empty or its corners are no points.
    fn rect(&self, min: I64Vec2, max: I64Vec2) -> Option<RowPlace> {
        let is_empty = min.cmpge(max).any();
        let (min, max) = (self.plane(min)?, self.plane(max)?);
        (!is_empty).then_some(RowPlace::Rect(Rect { min, max }))
    }

    /// Returns the lowest corner of a cell in the frame.
    fn corner(&self, cell: i64) -> Option<I64Vec2> {
        let stride = i64::from(self.frame.stride);
        if stride == 0 || !(0..i64::from(self.frame.cells)).contains(&cell) {
            return None;
        }
        let low = |index: i64| (index - i64::from(PAD)) << CELL_BITS;
        Some(I64Vec2::new(low(cell % stride), low(cell / stride)))
    }

    fn cell(&self, cell: i64) -> Option<RowPlace> {
        let low = self.corner(cell)?;
        self.rect(low, low + i64::from(R))
    }

    /// Returns a sample by its cell and its offset in it.
    fn sample(&self, cell: i64, offset: I64Vec2) -> Option<RowPlace> {
        let inside = |at: i64| (0..i64::from(R)).contains(&at);
        let low = self.corner(cell)?;
        let is_there = inside(offset.x) && inside(offset.y);
        is_there.then(|| self.point(low + offset))?
    }

    /// Returns a tiled sample by its row and its offset in its cell.
    fn tiled(&self, row: usize, offset: I64Vec2) -> Option<RowPlace> {
        self.sample(i64::from(*self.cells.get(row)?), offset)
    }

    /// Returns the offset of a tiled sample in its cell.
    fn offset(&self, row: usize) -> I64Vec2 {
        let Some(word) = self.places.get(row).map(|word| word & POSITION_MASK) else {
            return I64Vec2::NEG_ONE;
        };
        [word & (R as u32 - 1), word >> CELL_BITS]
            .map(i64::from)
            .into()
    }

    /// Returns the link from a tiled sample to the one that eliminated it, or the sample alone if it was not
    /// eliminated.
    fn link(&self, row: usize, by: i64) -> Option<RowPlace> {
        let sample = |row: usize| match self.tiled(row, self.offset(row)) {
            Some(RowPlace::Point(point)) => Some(point),
            _ => None,
        };
        let from = sample(row)?;
        // Indices are stored plus one; 0 stands for none.
        let to = usize::try_from(by - 1).ok().and_then(sample);
        Some(to.map_or(RowPlace::Point(from), |to| RowPlace::Link([from, to])))
    }

    /// Returns an active cell of a level, cut at the edge of the domain.
    fn square(&self, low: I64Vec2, level: u32) -> Option<RowPlace> {
        let frame = &self.frame;
        // The border of a bounded domain belongs to it.
        let last = i64::from(frame.periodic == 0);

        let RowPlace::Point(corner) = self.wrapped(self.point(low)?) else {
            return None;
        };
        let side = i64::from(R >> level.min(CELL_BITS));
        let extent = [(corner.x, frame.side_x), (corner.y, frame.side_y)]
            .map(|(at, end)| side.min(i64::from(end) + last - i64::from(at)));
        self.rect(low, low + I64Vec2::from(extent))
    }

    fn tiles(&self, first: I64Vec2, count: I64Vec2) -> Option<RowPlace> {
        let low = |tile: I64Vec2| (tile * i64::from(TILE_SIDE) - i64::from(PAD)) << CELL_BITS;
        self.rect(low(first), low(first + count))
    }

    /// Returns a tile by its number.
    fn tile(&self, tile: usize) -> Option<RowPlace> {
        let columns = i64::from(self.frame.tile_columns);
        let tile = tile as i64;
        if columns == 0 || tile >= i64::from(self.frame.tiles) {
            return None;
        }
        self.tiles(I64Vec2::new(tile % columns, tile / columns), I64Vec2::ONE)
    }

    fn of_result(&self, row: usize) -> Option<RowPlace> {
        let words = self.result.get(2 * row..2 * row + 2)?;
        point(I64Vec2::new(words[0].into(), words[1].into())).map(RowPlace::Point)
    }
}

fn point(at: I64Vec2) -> Option<Point> {
    let [x, y] = at.to_array().map(|v| i32::try_from(v).ok());
    Some(Point::new(x?, y?))
}

/// Returns the cell of each of the first `rows` tiled samples.
fn cells_of(starts: &[u32], rows: usize) -> Vec<u32> {
    let mut cells = vec![u32::MAX; rows];
    for (range, cell) in starts.windows(2).zip(0..) {
        let range = range[0] as usize..(range[1] as usize).min(rows);
        if let Some(part) = cells.get_mut(range) {
            part.fill(cell);
        }
    }
    cells
}

/// Returns the buffers that the host or a pass has written.
fn written(work: &WindowRun) -> Vec<Name> {
    // Of the buffers that the host writes, these have places.
    let mut written = vec![Name::Images, Name::Pieces];
    // With a base the CPU made the first stages, and their results were uploaded.
    if work.base.is_some() {
        // It is not recorded which buffers the upload filled, so count all of them.
        written.extend(work.device.lengths().into_iter().map(|(name, _)| name));
    }

    let reports = work.device.reports.iter().flatten();
    for &(name, access, _) in reports.flat_map(|report| &report.bindings) {
        let writes = !matches!(access, Access::Uniform | Access::Read);
        if writes && !written.contains(&name) {
            written.push(name);
        }
    }
    written
}
