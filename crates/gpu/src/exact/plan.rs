//! The buffers of an exact tiling: what the host writes into them, and how long they are.

use tilescope_core::windows::{CELL_BITS, ExactPiece, exact_pieces};
use tilescope_core::{Domain, MAXIMAL_DENSITY, Parameters, PatternArrivals, R, SampleError};

use crate::adapter::Limits;
use crate::constants::{ARGUMENTS, SCAN_PART, THROW_BITS};
use crate::error::GpuError;
use crate::layout::{Dart, Ground, LaidPiece, Name, PieceCell, counter};

/// Room in the lists whose length is found as they are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DartRoom {
    /// Darts, with the samples that are laid down.
    pub darts: u32,
    /// Cells of each list of cells.
    pub cells: u32,
}

/// The bytes of 2^31 darts, the most that are allowed: half of those that 32 bits can count. A room that is too large
/// for 32 bits saturates, and then lies above this limit.
const MOST_DART_BYTES: u64 = (1 << 31) * size_of::<Dart>() as u64;

/// How many cells of side R a side has.
const fn cells_along(side: i32) -> u32 {
    ((side - 1) / R + 1) as u32
}

impl DartRoom {
    /// Estimates the room that a run needs, with some to spare. A run that needs more is made again.
    pub(super) fn expected(
        parameters: &Parameters,
        arrived: &PatternArrivals,
    ) -> Result<Self, SampleError> {
        let area = parameters.validate()?.area_radii();
        let pattern = arrived.pattern();
        let density = pattern.samples().len() as f64 / pattern.domain().area_radii();

        // Darts are thrown along the borders of blocks. The larger the leaf, the shorter are these borders in an area.
        // For each r^2 of area were measured, at leaves of 6, 20 and 80 r: 0.64, 0.22 and 0.06 darts that became
        // questions, and 0.94, 0.33 and 0.10 cells in the longest list. There is room for a quarter to a half more than
        // that.
        let share = |most: f64, per_leaf: f64| area * (per_leaf / parameters.leaf).min(most);
        // A domain may get 2% more of the pattern's samples than the mean: chosen, not measured. In small domains numbers vary
        // more, and 4,096 entries cost little.
        Ok(Self {
            darts: ((1.02 * density * area + share(0.9, 6.5)) as u32).saturating_add(4096),
            cells: (share(1.3, 10.0) as u32).saturating_add(4096),
        })
    }

    /// Fails if the list of darts does not fit a buffer of a device. This is asked before the run is planned: the plan of a
    /// larger domain would take minutes, and the number of its cells might not fit 32 bits.
    pub(super) fn check(self, parameters: &Parameters, limits: &Limits) -> Result<(), GpuError> {
        let end = parameters.validate()?.rect().max;
        let needed = u64::from(self.darts) * size_of::<Dart>() as u64;
        // Room is counted in 32 bits, and a binding limit may be larger than that.
        let binding = limits.max_storage_buffer_binding_size;
        let (limit, allowed) = if binding <= MOST_DART_BYTES {
            ("maxStorageBufferBindingSize", binding)
        } else {
            ("the number of a dart", MOST_DART_BYTES)
        };
        if needed > allowed {
            return Err(GpuError::ExactTooLarge {
                width: cells_along(end.x),
                height: cells_along(end.y),
                needed,
                unit: "bytes",
                limit,
                allowed,
            });
        }
        Ok(())
    }

    /// Returns twice the room.
    pub(super) const fn doubled(self) -> Self {
        Self {
            darts: self.darts.saturating_mul(2),
            cells: self.cells.saturating_mul(2),
        }
    }
}

/// An exact tiling of a whole domain, as a device gets it.
pub(super) struct ExactPlan {
    pub ground: Ground,
    pub pieces: Vec<LaidPiece>,
    /// Where the samples of each of the pattern's cells begin, one entry more for the end, then four words of each sample.
    pub pattern: Vec<u32>,
    /// How many blocks there are.
    pub blocks: usize,
}

impl ExactPlan {
    /// Returns the plan of a run with so much room.
    ///
    /// Fails when the parameters cannot be sampled, or a bounded pattern is too small for a block.
    pub(super) fn new(
        parameters: &Parameters,
        arrived: &PatternArrivals,
        room: DartRoom,
    ) -> Result<Self, SampleError> {
        let domain = parameters.validate()?;
        // Blocks are found by the host: their tree is cut one node after the other.
        let (placed, blocks) = exact_pieces(parameters, arrived.pattern())?;
        let (pieces, marks) = laid(&placed);
        let (pattern, pattern_points) = pattern_words(arrived);
        let end = domain.rect().max;
        let [columns, rows] = [end.x, end.y].map(cells_along);

        let ground = Ground {
            end_x: end.x,
            end_y: end.y,
            // The last cells may reach beyond the domain.
            columns,
            cells: columns * rows,
            periodic: domain.is_periodic().into(),
            pieces: pieces.len() as u32,
            marks,
            pattern_columns: cells_along(pattern_rect(arrived).width()),
            pattern_points,
            dart_capacity: room.darts,
            cell_capacity: room.cells,
            unused: 0,
        };
        Ok(Self {
            ground,
            pieces,
            pattern,
            blocks,
        })
    }

    /// Returns the room that the plan has.
    pub(super) const fn room(&self) -> DartRoom {
        DartRoom {
            darts: self.ground.dart_capacity,
            cells: self.ground.cell_capacity,
        }
    }

    /// Returns the length of each buffer in bytes, but for those of the result.
    pub(super) fn lengths(&self) -> Vec<(Name, u64)> {
        let words = |count: u32| 4 * u64::from(count);
        let Ground {
            cells,
            marks,
            dart_capacity,
            cell_capacity,
            ..
        } = self.ground;
        let darts = u64::from(dart_capacity) * size_of::<Dart>() as u64;
        // Three lists of cells: those marked, those of the level, those of the next.
        let listed = u64::from(cell_capacity) * size_of::<PieceCell>() as u64;
        // One entry more is the end of the last cell's samples.
        let starts = 4 * (u64::from(cells) + 1);

        vec![
            (Name::Ground, size_of::<Ground>() as u64),
            (Name::LaidPieces, size_of_val(&*self.pieces) as u64),
            (Name::Pattern, size_of_val(&*self.pattern) as u64),
            (Name::Heads, words(cells)),
            (Name::Darts, darts),
            (Name::States, words(dart_capacity)),
            // No dart is listed twice in a throw, so that as much room as for darts is enough.
            (Name::Questions, words(dart_capacity)),
            (Name::Verdicts, words(dart_capacity)),
            (Name::Marks, words(marks)),
            (Name::FreshCells, listed),
            (Name::OpenCells, listed),
            (Name::NextOpenCells, listed),
            (Name::Starts, starts),
            // A sum for each part; lengths are rounded up to whole words.
            (Name::Sums, starts.div_ceil(SCAN_PART.into())),
            (Name::Counters, words(counter::COUNT)),
            // Three words for each dispatch.
            (Name::Arguments, 12 * ARGUMENTS.len() as u64),
        ]
    }

    /// Returns the lengths of the buffers of a result of so many samples: two words for each place, and two for each source.
    pub(super) fn result_lengths(count: u32) -> [(Name, u64); 2] {
        let bytes = 8 * u64::from(count);
        [(Name::Result, bytes), (Name::Tags, bytes)]
    }

    /// Fails if the run does not fit the limits of a device, or the memory that may be used.
    pub(super) fn check(&self, limits: &Limits, memory: u64) -> Result<(), GpuError> {
        let Ground {
            end_x,
            end_y,
            cells,
            ..
        } = self.ground;
        // The result is about as long as that of any maximal set.
        let expected = (f64::from(cells) * MAXIMAL_DENSITY) as u32;
        let mut lengths = self.lengths();
        lengths.extend(Self::result_lengths(expected));
        // Each buffer is bound as a whole.
        let longest = lengths.iter().map(|(_, length)| *length).max().unwrap_or(0);
        let sum = lengths.iter().map(|(_, length)| length).sum();

        // The label of a dart holds the index of its piece beside its throw.
        let pieces = u64::from(self.ground.pieces);
        let most_pieces: u64 = 1 << (32 - THROW_BITS);
        let checks = [
            (
                pieces,
                "pieces of blocks",
                "the label of a dart",
                most_pieces,
            ),
            (
                longest,
                "bytes",
                "maxStorageBufferBindingSize",
                limits.max_storage_buffer_binding_size,
            ),
            (longest, "bytes", "maxBufferSize", limits.max_buffer_size),
            (sum, "bytes", "the memory to be used", memory),
        ];
        for (needed, unit, limit, allowed) in checks {
            if needed > allowed {
                return Err(GpuError::ExactTooLarge {
                    width: cells_along(end_x),
                    height: cells_along(end_y),
                    needed,
                    unit,
                    limit,
                    allowed,
                });
            }
        }
        Ok(())
    }
}

/// Returns pieces as shaders have them, and how many marks they have.
fn laid(placed: &[ExactPiece]) -> (Vec<LaidPiece>, u32) {
    let mut pieces: Vec<LaidPiece> = Vec::with_capacity(placed.len());
    let mut marks = 0;
    let of_block = |a: &ExactPiece, b: &ExactPiece| a.block == b.block;

    // A lost sample marks cells in all pieces of its block, which each piece therefore names.
    for block in placed.chunk_by(of_block) {
        let first_piece = pieces.len() as u32;
        for piece in block {
            let (sources, rect) = (&piece.sources, &piece.block_rect);
            let cells =
                |min: i32, max: i32| (((max - 1) >> CELL_BITS) - (min >> CELL_BITS) + 1) as u32;
            // Cells are those of the pattern, so that a piece has parts of cells at its ends.
            let mark_columns = cells(sources.min.x, sources.max.x);
            pieces.push(LaidPiece {
                source_min_x: sources.min.x,
                source_min_y: sources.min.y,
                source_max_x: sources.max.x,
                source_max_y: sources.max.y,
                block_min_x: rect.min.x,
                block_min_y: rect.min.y,
                block_max_x: rect.max.x,
                block_max_y: rect.max.y,
                origin_x: piece.origin[0],
                origin_y: piece.origin[1],
                symmetry: piece.symmetry.0.into(),
                block: piece.block,
                first_mark: marks,
                mark_columns,
                first_piece,
                end_piece: first_piece + block.len() as u32,
            });
            marks += mark_columns * cells(sources.min.y, sources.max.y);
        }
    }
    (pieces, marks)
}

fn pattern_rect(arrived: &PatternArrivals) -> tilescope_core::Rect {
    let domain: &Domain = arrived.pattern().domain();
    domain.rect()
}

/// Returns the pattern as words, and the word at which its samples begin: place, throw and rank of each. Samples are in canonical
/// order, which is that of their cells.
fn pattern_words(arrived: &PatternArrivals) -> (Vec<u32>, u32) {
    let samples = arrived.pattern().samples();
    let rect = pattern_rect(arrived);
    let [columns, rows] = [rect.width(), rect.height()].map(cells_along);

    let mut words = Vec::with_capacity((columns * rows) as usize + 1 + 4 * samples.len());
    let mut first = 0;
    for row in 0..rows as i32 {
        for column in 0..columns as i32 {
            words.push(first as u32);
            // Canonical order has the cells one after the other, and the samples of each together.
            let is_here = |at: &&tilescope_core::Point| (at.x / R, at.y / R) == (column, row);
            first += samples[first..].iter().take_while(is_here).count();
        }
    }
    words.push(first as u32);

    // A sample keeps its index, by which sources name it.
    let points = words.len() as u32;
    for (arrival, place) in arrived.arrivals().iter().zip(samples) {
        // The number of a throw among those of all levels. A level has at most four throws.
        let throw = 4 * arrival.level() + arrival.throw();
        words.extend([place.x as u32, place.y as u32, throw, arrival.rank()]);
    }
    (words, points)
}
