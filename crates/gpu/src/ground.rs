//! Where the rows of a buffer lie in the plane: it reads what tells rows their cells. It never guesses: a row behind the
//! end of its list has no place.

use tilescope_core::windows::{CELL_BITS, PAD};
use tilescope_core::{Point, R, Rect, Stage};

use crate::constants::{PLACE_MASK, TILE_SIDE};
use crate::error::GpuError;
use crate::layout::{Access, Frame, Name, counter};
use crate::spots::{Spot, Spots, Unplaced};
use crate::table::Table;
use crate::work::Work;

/// What lies on the device between two passes that tells rows of buffers their places.
#[derive(Clone, Debug)]
pub struct Ground {
    frame: Frame,
    /// The stage of the pass that is looked at: a buffer serves several.
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

impl Ground {
    pub(crate) async fn read(work: &Work, stage: Stage) -> Result<Self, GpuError> {
        let device = &work.device;
        let written = written(work);
        let mut ground = Self {
            // The device's own: shaders go by it, whatever became of it.
            frame: bytemuck::try_pod_read_unaligned(
                &device.bytes(Name::Frame, frame_bytes()).await?,
            )
            .unwrap_or(work.plan.uniform),
            stage,
            level: work.level(),
            counters: device
                .words(Name::Counters, 0..counter::COUNT.into())
                .await?,
            cells: Vec::new(),
            places: Vec::new(),
            result: Vec::new(),
            written,
        };
        if ground.is_written(Name::Places) {
            let cells = work.plan.cells();
            let starts = device.words(Name::Starts, 0..cells + 1).await?;
            let tiled = u64::from(ground.counter(counter::TILED));
            ground.places = device.words(Name::Places, 0..tiled).await?;
            ground.cells = cells_of(&starts, ground.places.len());
        }
        if ground.is_written(Name::Result) {
            let kept = u64::from(ground.counter(counter::KEPT));
            ground.result = device.words(Name::Result, 0..2 * kept).await?;
        }
        Ok(ground)
    }

    /// Returns the frame through which rows are seen.
    #[must_use]
    pub const fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Returns the same buffers seen through another frame: what if it lay elsewhere?
    #[must_use]
    pub const fn with_frame(mut self, frame: Frame) -> Self {
        self.frame = frame;
        self
    }

    /// Returns the spots of the rows of a buffer, read between the same two passes.
    #[must_use]
    pub fn spots(&self, name: Name, table: &Table) -> Spots {
        let mut spots = Spots {
            unplaced: self.unplaced(name),
            are_cells: match name {
                Name::Starts | Name::Grid | Name::TileImages => true,
                Name::Heads => !self.heads_are_listed(),
                _ => false,
            },
            ..Spots::default()
        };
        if spots.unplaced.is_none() {
            spots.ends.reserve(table.rows.len());
            for (row, values) in table.rows.iter().enumerate() {
                self.row(name, row, values, &mut spots.all);
                spots.ends.push(spots.all.len() as u32);
            }
        }
        spots
    }

    /// Returns a spot moved by whole periods so that its first place lies in the domain; as it is where the plane does
    /// not repeat.
    #[must_use]
    pub fn wrapped(&self, spot: Spot) -> Spot {
        let first = match spot {
            Spot::Point(p) | Spot::Link([p, _]) => p,
            Spot::Rect(rect) => rect.min,
        };
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
        match spot {
            Spot::Point(p) => Spot::Point(moved(p)),
            Spot::Link(ends) => Spot::Link(ends.map(moved)),
            Spot::Rect(Rect { min, max }) => Spot::Rect(Rect {
                min: moved(min),
                max: moved(max),
            }),
        }
    }

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

    fn is_written(&self, name: Name) -> bool {
        self.written.contains(&name)
    }

    /// Tiling and elimination keep the list of contested cells there; later each cell has a row.
    fn heads_are_listed(&self) -> bool {
        self.stage <= Stage::Eliminate
    }

    fn counter(&self, counter: u32) -> u32 {
        self.counters.get(counter as usize).copied().unwrap_or(0)
    }

    /// Returns whether a row belongs to a list that a counter counts.
    fn is_listed(&self, row: usize, counter: u32) -> bool {
        (row as u64) < u64::from(self.counter(counter))
    }

    /// Adds the spots of a row.
    fn row(&self, name: Name, row: usize, values: &[i64], spots: &mut Vec<Spot>) {
        let value = |k: usize| values.get(k).copied().unwrap_or(-1);
        let in_list = |counter, spot: Option<Spot>| spot.filter(|_| self.is_listed(row, counter));
        let spot = match name {
            Name::Images => self.rect([value(0), value(1)], [value(2), value(3)]),
            Name::Pieces => self.piece(value(1), value(2), value(3)),
            Name::TileImages => self.tile(row),
            Name::Heads if self.heads_are_listed() => {
                in_list(counter::CONTESTED, self.cell(value(0)))
            }
            Name::Starts | Name::Heads => self.cell(row as i64),
            Name::List => in_list(counter::OPEN, self.cell(value(0))),
            Name::Unsure => in_list(counter::UNSURE, self.cell(value(0))),
            Name::Grid => {
                spots.extend(self.cell(row as i64));
                let slots = (0..3).map(|slot| 3 + 4 * slot);
                spots.extend(
                    slots.filter_map(|k| self.sample(row as i64, [value(k), value(k + 1)])),
                );
                None
            }
            Name::Places => self.tiled(row, [value(0), value(1)]),
            Name::Origins => self.tiled(row, self.place(row)),
            Name::By => self.link(row, value(0)),
            Name::Proposals => in_list(counter::PROPOSALS, self.point([value(0), value(1)])),
            Name::Active => in_list(
                counter::ACTIVE,
                self.square([value(0), value(1)], self.level),
            ),
            Name::NextActive => in_list(
                counter::NEXT_ACTIVE,
                self.square([value(0), value(1)], self.level + 1),
            ),
            Name::Result => in_list(counter::KEPT, point([value(0), value(1)]).map(Spot::Point)),
            Name::Tags => in_list(counter::KEPT, self.of_result(row)),
            _ => None,
        };
        spots.extend(spot);
    }

    /// Returns how far places of the plane are from those of the frame: the window lies in the domain.
    fn shift(&self) -> [i64; 2] {
        let frame = &self.frame;
        let axis = |origin: u32, window: i32, side: u32| {
            let place = origin.wrapping_add(window as u32);
            let place = match (frame.periodic, side) {
                (0, _) | (_, 0) => i64::from(place as i32),
                _ => i64::from(place % side),
            };
            place - i64::from(window)
        };
        [
            axis(frame.origin_x, frame.window_min_x, frame.side_x),
            axis(frame.origin_y, frame.window_min_y, frame.side_y),
        ]
    }

    /// Returns the place of the plane at a place of the frame.
    fn plane(&self, at: [i64; 2]) -> Option<Point> {
        let [right, up] = self.shift();
        point([at[0] + right, at[1] + up])
    }

    fn point(&self, at: [i64; 2]) -> Option<Spot> {
        self.plane(at).map(Spot::Point)
    }

    fn rect(&self, min: [i64; 2], max: [i64; 2]) -> Option<Spot> {
        let is_empty = min[0] >= max[0] || min[1] >= max[1];
        let (min, max) = (self.plane(min)?, self.plane(max)?);
        (!is_empty).then_some(Spot::Rect(Rect { min, max }))
    }

    /// Returns the lowest corner of a cell in the frame.
    fn corner(&self, cell: i64) -> Option<[i64; 2]> {
        let stride = i64::from(self.frame.stride);
        if stride == 0 || !(0..i64::from(self.frame.cells)).contains(&cell) {
            return None;
        }
        let low = |index: i64| (index - i64::from(PAD)) << CELL_BITS;
        Some([low(cell % stride), low(cell / stride)])
    }

    fn cell(&self, cell: i64) -> Option<Spot> {
        let [x, y] = self.corner(cell)?;
        self.rect([x, y], [x + i64::from(R), y + i64::from(R)])
    }

    /// Returns a sample of a cell by its place there.
    fn sample(&self, cell: i64, place: [i64; 2]) -> Option<Spot> {
        let inside = |at: i64| (0..i64::from(R)).contains(&at);
        let [x, y] = self.corner(cell)?;
        let is_there = inside(place[0]) && inside(place[1]);
        is_there.then(|| self.point([x + place[0], y + place[1]]))?
    }

    fn tiled(&self, row: usize, place: [i64; 2]) -> Option<Spot> {
        self.sample(i64::from(*self.cells.get(row)?), place)
    }

    /// Returns where in its cell a tiled sample lies.
    fn place(&self, row: usize) -> [i64; 2] {
        let Some(word) = self.places.get(row).map(|word| word & PLACE_MASK) else {
            return [-1; 2];
        };
        [word & (R as u32 - 1), word >> CELL_BITS].map(i64::from)
    }

    /// Returns the link from a tiled sample to the one that eliminated it, or the sample where none did.
    fn link(&self, row: usize, by: i64) -> Option<Spot> {
        let sample = |row: usize| match self.tiled(row, self.place(row)) {
            Some(Spot::Point(point)) => Some(point),
            _ => None,
        };
        let from = sample(row)?;
        let to = usize::try_from(by - 1).ok().and_then(sample);
        Some(to.map_or(Spot::Point(from), |to| Spot::Link([from, to])))
    }

    /// Returns an active cell of a level, cut where the domain ends.
    fn square(&self, low: [i64; 2], level: u32) -> Option<Spot> {
        let frame = &self.frame;
        let last = i64::from(frame.periodic == 0);
        let Spot::Point(corner) = self.wrapped(self.point(low)?) else {
            return None;
        };
        let side = i64::from(R >> level.min(CELL_BITS));
        let extent = [(corner.x, frame.side_x), (corner.y, frame.side_y)]
            .map(|(at, end)| side.min(i64::from(end) + last - i64::from(at)));
        self.rect(low, [low[0] + extent[0], low[1] + extent[1]])
    }

    fn tiles(&self, column: i64, row: i64, columns: i64, rows: i64) -> Option<Spot> {
        let low = |tile: i64| (tile * i64::from(TILE_SIDE) - i64::from(PAD)) << CELL_BITS;
        self.rect(
            [low(column), low(row)],
            [low(column + columns), low(row + rows)],
        )
    }

    fn tile(&self, tile: usize) -> Option<Spot> {
        let columns = i64::from(self.frame.tile_columns);
        let tile = tile as i64;
        if columns == 0 || tile >= i64::from(self.frame.tiles) {
            return None;
        }
        self.tiles(tile % columns, tile / columns, 1, 1)
    }

    fn piece(&self, column: i64, row: i64, size: i64) -> Option<Spot> {
        self.tiles(column, row, size & 0xffff, size >> 16)
    }

    fn of_result(&self, row: usize) -> Option<Spot> {
        let words = self.result.get(2 * row..2 * row + 2)?;
        point([words[0].into(), words[1].into()]).map(Spot::Point)
    }
}

const fn frame_bytes() -> std::ops::Range<u64> {
    0..size_of::<Frame>() as u64
}

fn point(at: [i64; 2]) -> Option<Point> {
    let [x, y] = at.map(|v| i32::try_from(v).ok());
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
fn written(work: &Work) -> Vec<Name> {
    let mut written = vec![Name::Images, Name::Pieces];
    if work.base.is_some() {
        // Those that the CPU's stages filled are not told apart.
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
