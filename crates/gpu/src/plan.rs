//! The plan of a window: the frame around it, the blocks that reach it, and the length of every buffer. Plans need no
//! device.
//!
//! An *image* is a block where it lies in the frame; in a periodic plane, which repeats, a block may have several. A list has
//! *room* for the elements that its buffer can hold.

use tilescope_core::windows::{Frame as CoreFrame, PAD, PlacedBlock, Rect64};
use tilescope_core::{R, Rect, SampleError};

use crate::constants::{SCAN_PART, TILE_SIDE, TILE_WORDS, WORKGROUP};
use crate::layout::{Frame, Image, Name, Proposal, counter};
use crate::setup::Setup;

/// The most cells of a frame, with the padding. Slots, 4 for each cell, are numbered in 31 bits.
pub(crate) const MAX_CELLS: u64 = 1 << 28;

/// The most cells along a side of a frame, so that its coordinates, and those a few radii beyond it, fit 32 bits.
pub(crate) const MAX_SIDE: u64 = 65_000;

/// Phases of a window's computation, which differ in the buffers that they need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Phase {
    /// Tiling and the rounds of elimination.
    Tile,
    /// Detection and insertion; in uniform insertion up to the cells of the first level.
    Fill,
    /// The levels of uniform insertion.
    Levels,
    /// The gathering of the result, when all samples are there.
    Finish,
}

impl Phase {
    const ALL: [Self; 4] = [Self::Tile, Self::Fill, Self::Levels, Self::Finish];

    /// Returns whether a buffer is needed, if stages are not recorded.
    pub(crate) fn needs(self, name: Name, sources: bool) -> bool {
        match name {
            Name::Pieces | Name::TileImages => self == Self::Tile,
            // Detection reads where samples were lost. At the end the sources follow from the places and origins of all
            // samples.
            Name::Places | Name::Origins => sources || self <= Self::Fill,
            Name::Grid => self >= Self::Fill,
            Name::List | Name::Unsure | Name::Proposals | Name::Active => {
                matches!(self, Self::Fill | Self::Levels)
            }
            Name::NextActive => self == Self::Levels,
            Name::Result | Name::Tags => self == Self::Finish,
            // `By` is among these, but only recorded runs have it.
            Name::Frame
            | Name::Job
            | Name::Images
            | Name::Pattern
            | Name::Starts
            | Name::Sums
            | Name::By
            | Name::Heads
            | Name::Counters
            | Name::Arguments => true,

            // Randomized tiling has none of the buffers of exact tiling.
            Name::Ground
            | Name::LaidPieces
            | Name::Darts
            | Name::States
            | Name::Questions
            | Name::Verdicts
            | Name::Marks
            | Name::FreshCells
            | Name::OpenCells
            | Name::NextOpenCells => false,
        }
    }
}

/// Capacities of the lists whose lengths are not known in advance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Room {
    pub tiled: u32,
    pub open: u32,
    pub unsure: u32,
    pub proposals: u32,
    pub active: u32,
    pub result: u32,
}

/// All that must be known of a window before it is computed.
pub(crate) struct WindowPlan {
    /// The frame, as core has it.
    pub frame: CoreFrame,
    /// The same frame as shaders have it, with the room of the lists.
    pub uniform: Frame,
    /// The images of blocks, as core has them and, in the same order, as shaders do.
    pub placed: Vec<PlacedBlock>,
    pub images: Vec<Image>,
    /// The images in pieces, as words: see [`pieces_of`].
    pub pieces: Vec<[u32; 4]>,
}

impl WindowPlan {
    /// Returns the plan of a window with `halo` cells around it. If `room` is `None`, it is estimated.
    ///
    /// Fails when a bounded pattern is too small for a block.
    pub(crate) fn new(
        setup: &Setup,
        window: &Rect,
        halo: i32,
        room: Option<Room>,
    ) -> Result<Self, SampleError> {
        let frame = CoreFrame::new(&setup.domain, window, halo);
        let mut placed = Vec::new();
        setup.clipper.blocks(&frame, &mut placed)?;

        // Only blocks that become images are kept, so that both lists have the same indices.
        let target = frame.tiled();
        placed.retain(|block| enlarged(block).within(&target).is_some());
        let images: Vec<Image> = placed
            .iter()
            .filter_map(|block| image(setup, block, &target))
            .collect();

        let mut uniform = uniform_of(setup, &frame);
        let room = room.unwrap_or_else(|| expected(setup, &uniform, &images));
        uniform.tiled_capacity = room.tiled;
        uniform.list_capacity = room.open;
        uniform.unsure_capacity = room.unsure;
        uniform.proposal_capacity = room.proposals;
        uniform.active_capacity = room.active;
        uniform.result_capacity = room.result;

        let pieces = pieces_of(&uniform, &images);
        Ok(Self {
            frame,
            uniform,
            placed,
            images,
            pieces,
        })
    }

    /// Doubles most of the room, and makes room for all cells to be open. Tiled samples, whose number is estimated
    /// within about a hundredth, get a quarter more, and the result gets no more.
    pub(crate) const fn double_room(&mut self) {
        self.uniform.tiled_capacity += self.uniform.tiled_capacity / 4;
        self.uniform.list_capacity = self.uniform.cells;
        self.uniform.proposal_capacity *= 2;
        self.uniform.unsure_capacity *= 2;
        self.uniform.active_capacity *= 2;
    }

    /// Returns the room that the plan provides.
    pub(crate) const fn room(&self) -> Room {
        Room {
            tiled: self.uniform.tiled_capacity,
            open: self.uniform.list_capacity,
            unsure: self.uniform.unsure_capacity,
            proposals: self.uniform.proposal_capacity,
            active: self.uniform.active_capacity,
            result: self.uniform.result_capacity,
        }
    }

    /// Returns the number of cells, with the padding.
    pub(crate) const fn cells(&self) -> u64 {
        self.uniform.cells as u64
    }

    /// Returns the number of cells without the padding.
    pub(crate) const fn inner_cells(&self) -> u64 {
        self.uniform.columns as u64 * self.uniform.rows as u64
    }

    /// Returns the bytes of all buffers in the phase that needs most.
    pub(crate) fn peak(&self, setup: &Setup) -> u64 {
        let keeps_stages = false;
        let lengths = self.lengths(setup, keeps_stages);
        let in_phase = |phase: Phase| -> u64 {
            let needed = lengths
                .iter()
                .filter(|(name, _)| phase.needs(*name, setup.sources));
            needed.map(|(_, length)| length).sum()
        };
        Phase::ALL.into_iter().map(in_phase).max().unwrap_or(0)
    }

    /// Returns every buffer's length in bytes. With `by` there is also the buffer of which sample eliminated which.
    pub(crate) fn lengths(&self, setup: &Setup, by: bool) -> Vec<(Name, u64)> {
        let inputs = [
            (Name::Images, bytes_of(&self.images)),
            (Name::Pieces, bytes_of(&self.pieces)),
            (Name::Pattern, bytes_of(&setup.pattern)),
        ];
        let mut lengths = lengths(&self.uniform, setup.sources, by);
        lengths.extend(inputs);
        lengths
    }
}

fn bytes_of<T>(items: &[T]) -> u64 {
    size_of_val(items) as u64
}

/// Returns the lengths in bytes of the buffers that grow with the frame, with those of the samples' sources and of what
/// eliminated them (`by`) if they are kept.
pub(crate) fn lengths(frame: &Frame, sources: bool, by: bool) -> Vec<(Name, u64)> {
    let cells = u64::from(frame.cells);
    let tiled = u64::from(frame.tiled_capacity);
    // Cells and points take two words each.
    let active = u64::from(frame.active_capacity) * 8;
    let result = u64::from(frame.result_capacity) * 8;

    let mut lengths = vec![
        (Name::TileImages, 4 * u64::from(frame.tiles * TILE_WORDS)),
        // A cell's samples end where those of the next begin: one entry more is the end of the last cell's. At last `Heads`
        // has such entries for the result.
        (Name::Starts, 4 * (cells + 1)),
        // The scans sum these entries in parts, and keep a sum of each part.
        (Name::Sums, 4 * (cells + 1).div_ceil(SCAN_PART.into())),
        (Name::Places, 4 * tiled),
        (Name::Origins, 4 * tiled * u64::from(frame.origin_words)),
        // Three slots, and a word of counts and flags.
        (Name::Grid, 16 * cells),
        (Name::Heads, 4 * (cells + 1)),
        (Name::List, 4 * u64::from(frame.list_capacity)),
        (Name::Unsure, 4 * u64::from(frame.unsure_capacity)),
        (
            Name::Proposals,
            u64::from(frame.proposal_capacity) * size_of::<Proposal>() as u64,
        ),
        (Name::Active, active),
        (Name::NextActive, active),
        (Name::Counters, 4 * u64::from(counter::COUNT)),
        (
            Name::Arguments,
            // Three words for each dispatch.
            12 * crate::constants::ARGUMENTS.len() as u64,
        ),
    ];

    if by {
        lengths.push((Name::By, 4 * tiled));
    }
    lengths.push((Name::Result, result));
    // A source takes two words, as a point does.
    if sources {
        lengths.push((Name::Tags, result));
    }
    lengths
}

/// Returns the rectangle of a block with its margin of r.
fn enlarged(block: &PlacedBlock) -> Rect64 {
    block.rect.grown(R.into(), R.into())
}

/// Returns an image in the layout of shaders, or `None` where it does not reach the target.
fn image(setup: &Setup, block: &PlacedBlock, target: &Rect) -> Option<Image> {
    let clip = enlarged(block).within(target)?;
    let shape = &setup.clipper.variants()[usize::from(block.symmetry)].shape;
    let corner = block.rect.min - i64::from(R);

    // The pattern's place at the corner of the clip follows from its place at the corner of the enlarged block. The pattern
    // repeats.
    let start = |axis: usize, block_start: i32, low: i32, period: i32| {
        (i64::from(block_start) + i64::from(low) - corner[axis]).rem_euclid(period.into()) as i32
    };

    // A long block may exceed 32 bits: it is cut off a few radii beyond the target, farther than any shader reads.
    let beyond = 8 * i64::from(R);
    let cut = |v: i64, low: i32, high: i32| {
        v.clamp(i64::from(low) - beyond, i64::from(high) + beyond) as i32
    };
    let across = |v: i64| cut(v, target.min.x, target.max.x);
    let up = |v: i64| cut(v, target.min.y, target.max.y);

    Some(Image {
        own_min_x: across(block.rect.min.x),
        own_min_y: up(block.rect.min.y),
        own_max_x: across(block.rect.max.x),
        own_max_y: up(block.rect.max.y),
        clip_min_x: clip.min.x,
        clip_min_y: clip.min.y,
        clip_max_x: clip.max.x,
        clip_max_y: clip.max.y,
        // The corner is given modulo 2^32. Shaders compute only positions in a clip from it, which stay exact (turn.wgsl).
        corner_x: corner.x as u32,
        corner_y: corner.y as u32,
        start_x: start(0, block.start.x, clip.min.x, shape.width),
        start_y: start(1, block.start.y, clip.min.y, shape.height),
        shape: Setup::shape_of(block.symmetry),
        sequence: block.sequence,
        block: block.index,
        unused: 0,
    })
}

/// Returns the constants of a frame as shaders have them, without the capacities of lists.
fn uniform_of(setup: &Setup, frame: &CoreFrame) -> Frame {
    let domain = &setup.domain;
    let [columns, rows] = frame.cells;
    let cells = frame.cell_count() as u32;
    let tiles = [columns, rows].map(|n| ((n + 2 * PAD) as u32).div_ceil(TILE_SIDE));
    let sides = [domain.width(), domain.height()];

    // In a periodic plane the sum of origin and point must fit 32 bits (frame.wgsl), so the origin is reduced first. A
    // frame has no cells beyond a closed border, so that its origin is 0 or above in a bounded domain.
    let origin = |axis: usize| {
        if domain.is_periodic() {
            frame.origin[axis].rem_euclid(sides[axis].into()) as u32
        } else {
            frame.origin[axis] as u32
        }
    };

    let [[left, right], [below, above]] = frame.goes_on.map(|sides| sides.map(u32::from));
    let ranks = &setup.ranks;
    let [key_x, key_y] = ranks.key.words();
    let [search, search_border] = setup.search();
    let groups = ranks.sequence;
    let window = &frame.window;

    Frame {
        columns,
        rows,
        stride: frame.stride() as u32,
        cells,
        end_x: frame.end[0],
        end_y: frame.end[1],
        window_min_x: window.min.x,
        window_min_y: window.min.y,
        window_max_x: window.max.x,
        window_max_y: window.max.y,
        origin_x: origin(0),
        origin_y: origin(1),
        side_x: sides[0] as u32,
        side_y: sides[1] as u32,
        periodic: domain.is_periodic().into(),
        // A bit for each side beyond which the plane goes on.
        goes_on: left | right << 1 | below << 2 | above << 3,
        tile_columns: tiles[0],
        tiles: tiles[0] * tiles[1],
        order: setup.parameters.order as u32,
        order_key_x: key_x,
        order_key_y: key_y,
        phase_cell_x: ranks.cell[0],
        phase_cell_y: ranks.cell[1],
        phase_count_x: ranks.count[0],
        phase_count_y: ranks.count[1],
        // The first group takes the lowest four bits.
        phase_sequence: groups.iter().rev().fold(0, |all, group| all << 4 | group),
        origin_words: if setup.sources { 2 } else { 1 },
        lost_reach: setup.lost_reach,
        search,
        search_border,
        // The capacities are filled in by the plan.
        ..Frame::default()
    }
}

/// Estimates the room that a window needs, with some to spare. A window that needs more is computed again.
fn expected(setup: &Setup, frame: &Frame, images: &[Image]) -> Room {
    let area = |image: &Image| {
        f64::from(image.clip_max_x - image.clip_min_x)
            * f64::from(image.clip_max_y - image.clip_min_y)
    };
    let clipped: f64 = images.iter().map(area).sum::<f64>() / (f64::from(R) * f64::from(R));
    let is_uniform = setup.parameters.insertion == tilescope_core::Insertion::Uniform;

    // Gaps lie along the blocks' borders, so their share of the cells falls as the leaf grows: `per_leaf / leaf`, and `most`
    // for small leaves. Both numbers of each list were measured with every order and many leaves. 1,024 more cost little.
    let leaf = setup.parameters.leaf;
    let share = |most: f64, per_leaf: f64| {
        (f64::from(frame.cells) * (per_leaf / leaf).min(most)) as u32 + 1024
    };

    let rim = 2 * (frame.columns + frame.rows) as u32;

    Room {
        // There is room for a hundredth more than the density implies, and for a sample for each cell at the rim.
        tiled: (clipped * setup.density * 1.01) as u32 + rim + 1024,
        // Uniform insertion lists no open cells, and insertion at circumcentres no active ones: the list that is not
        // used has room for one.
        open: if is_uniform { 1 } else { share(0.8, 7.0) },
        // The cells at the frame's edge are unsure from the beginning (survive.wgsl). There is as much room again, and room
        // for one of 64 cells inside.
        unsure: 2 * rim + frame.cells / 64 + 1024,
        proposals: share(0.15, 0.75),
        active: if is_uniform { share(0.6, 3.2) } else { 1 },
        result: expected_result(setup, frame),
    }
}

/// Estimates the most samples of a window: seldom more than 0.70 to a squared radius, or the pattern's density if that
/// is higher.
fn expected_result(setup: &Setup, frame: &Frame) -> u32 {
    let [width, height] = [
        frame.window_max_x - frame.window_min_x,
        frame.window_max_y - frame.window_min_y,
    ]
    .map(|side| f64::from(side) / f64::from(R));
    // A little more than these densities, and room for what the borders add, which counts most in small windows.
    let density = (1.02 * setup.density).max(0.72);
    (density * width * height + 2.0 * (width + height) + 64.0) as u32
}

/// Returns the images cut into pieces of at most 8 x 8 tiles. The words of a piece are its image, its first column and row of
/// tiles, and how many columns and rows it has.
fn pieces_of(frame: &Frame, images: &[Image]) -> Vec<[u32; 4]> {
    // Each invocation of a workgroup takes a tile.
    const SIDE: u32 = WORKGROUP.isqrt();
    let ends = [frame.tile_columns, frame.tiles / frame.tile_columns];

    // Samples are in conflict up to a distance of r, and images are enlarged by r, so a tile needs all images within 2
    // r.
    let tiles = |low: i32, high: i32, end: u32| {
        let tile = |v: i64| (v.div_euclid(R.into()) + i64::from(PAD)).div_euclid(TILE_SIDE.into());
        let reach = 2 * i64::from(R);
        let first = tile(i64::from(low) - reach).max(0) as u32;
        let last = tile(i64::from(high) + reach - 1).min(i64::from(end) - 1);
        // An image beyond the frame reaches no tile of it.
        (first, (last + 1).max(first.into()) as u32)
    };

    let mut pieces = Vec::with_capacity(images.len() * 2);
    for (image, index) in images.iter().zip(0..) {
        let (left, right) = tiles(image.own_min_x, image.own_max_x, ends[0]);
        let (bottom, top) = tiles(image.own_min_y, image.own_max_y, ends[1]);
        for row in (bottom..top).step_by(SIDE as usize) {
            for column in (left..right).step_by(SIDE as usize) {
                // Columns and rows, at most 8 of each, share a word: rows are in its upper half.
                let size = (right - column).min(SIDE) | (top - row).min(SIDE) << 16;
                pieces.push([index, column, row, size]);
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::{Boundary, Insertion, Parameters, Pattern, Unobserved};

    fn setup(parameters: &Parameters) -> Setup {
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        Setup::new(parameters, &pattern, false).unwrap()
    }

    /// Returns the bytes of all buffers for each sample of a run in one go.
    fn bytes_a_sample(leaf: f64, insertion: Insertion) -> f64 {
        let parameters = Parameters {
            radius: 3.6e-4,
            leaf,
            insertion,
            ..Parameters::default()
        };
        let setup = setup(&parameters);
        let plan = WindowPlan::new(&setup, &setup.domain.rect(), 24, None).unwrap();
        plan.peak(&setup) as f64 / (0.6985 * setup.domain.area_radii())
    }

    #[test]
    fn a_run_in_one_go_takes_at_most_64_bytes_a_sample() {
        for leaf in [6.0, 10.0, 20.0, 40.0, 80.0] {
            let bytes = bytes_a_sample(leaf, Insertion::Circumcentre);
            assert!((40.0..64.0).contains(&bytes), "{bytes} with leaf {leaf}");
            let bytes = bytes_a_sample(leaf, Insertion::Uniform);
            assert!((40.0..64.0).contains(&bytes), "{bytes} with leaf {leaf}");
        }
    }

    #[test]
    fn pieces_tell_every_tile_of_the_images_that_reach_it() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let parameters = Parameters {
                radius: 0.01,
                leaf: 7.0,
                boundary,
                ..Parameters::default()
            };
            let setup = setup(&parameters);
            let plan = WindowPlan::new(&setup, &setup.domain.rect(), 24, None).unwrap();
            let frame = &plan.uniform;
            let (side, pad) = (TILE_SIDE as i32, PAD);
            for tile in 0..frame.tiles {
                let at = [tile % frame.tile_columns, tile / frame.tile_columns];
                let low = at.map(|n| (n as i32 * side - pad - 2) * R);
                let high = at.map(|n| ((n as i32 + 1) * side - pad + 2) * R);
                let reach = |image: &Image| {
                    image.own_min_x < high[0]
                        && image.own_max_x > low[0]
                        && image.own_min_y < high[1]
                        && image.own_max_y > low[1]
                };
                let wanted: Vec<u32> = (0..)
                    .zip(&plan.images)
                    .filter(|(_, image)| reach(image))
                    .map(|(index, _)| index)
                    .collect();
                let covers = |piece: &&[u32; 4]| {
                    let [_, column, row, size] = **piece;
                    (column..column + (size & 0xffff)).contains(&at[0])
                        && (row..row + (size >> 16)).contains(&at[1])
                };
                let told: Vec<u32> = plan
                    .pieces
                    .iter()
                    .filter(covers)
                    .map(|piece| piece[0])
                    .collect();
                assert_eq!(told, wanted);
                assert!(told.len() < TILE_WORDS as usize - 1);
            }
        }
    }
}
