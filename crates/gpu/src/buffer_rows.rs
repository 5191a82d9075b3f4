//! The rows of a buffer, decoded column by column.

use tilescope_core::R;
use tilescope_core::windows::CELL_BITS;

use crate::constants::{COUNT_MASK, FATE_MASK, POSITION_MASK, TILE_WORDS};
use crate::error::GpuError;
use crate::execute::Device;
use crate::layout::{Dart, Frame, Ground, Image, LaidPiece, Name, PieceCell, Proposal, counter};

/// The rows of a buffer as a table of numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BufferRows {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows, with one number for each column.
    pub rows: Vec<Vec<i64>>,
    /// Rows in the buffer; `rows` may hold only the first of them.
    pub total: u64,
}

impl BufferRows {
    /// Returns the first rows of a buffer.
    pub(crate) async fn read(device: &Device, name: Name, rows: u64) -> Result<Self, GpuError> {
        let words = words_of(name);
        let total = device.length(name) / (4 * words);
        let content = device.words(name, 0..words * rows.min(total)).await?;

        Ok(Self {
            columns: columns(name),
            rows: content
                .chunks_exact(words as usize)
                .map(|row| meaning(name, row))
                .collect(),
            total,
        })
    }
}

/// Returns the number of words in a row: one element, or the elements that are about one thing, as about a cell of the
/// grid.
fn words_of(name: Name) -> u64 {
    match name {
        Name::Frame => size_of::<Frame>() as u64 / 4,
        Name::Images => size_of::<Image>() as u64 / 4,
        Name::Proposals => size_of::<Proposal>() as u64 / 4,

        // Structures of exact tiling.
        Name::Ground => size_of::<Ground>() as u64 / 4,
        Name::LaidPieces => size_of::<LaidPiece>() as u64 / 4,
        Name::Darts => size_of::<Dart>() as u64 / 4,
        Name::FreshCells | Name::OpenCells | Name::NextOpenCells => {
            size_of::<PieceCell>() as u64 / 4
        }
        Name::Pieces | Name::Grid => 4,
        Name::TileImages => u64::from(TILE_WORDS),
        Name::Arguments => 3,
        Name::Counters => u64::from(counter::COUNT),
        Name::Origins | Name::Active | Name::NextActive | Name::Result | Name::Tags => 2,
        Name::Job
        | Name::Pattern
        | Name::Starts
        | Name::Sums
        | Name::Places
        | Name::By
        | Name::Heads
        | Name::List
        | Name::Unsure
        | Name::States
        | Name::Questions
        | Name::Verdicts
        | Name::Marks => 1,
    }
}

/// Returns the names of the columns of a buffer's rows, in the order of the numbers that [`meaning`] returns.
fn columns(name: Name) -> Vec<String> {
    let named = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    // `FIELDS` has the structure's name, and its fields with their byte offsets and types.
    let fields = |fields: &[(&str, usize, &str)]| {
        let names = fields.iter().map(|&(name, ..)| name.to_owned());
        names.collect()
    };

    match name {
        Name::Frame => fields(Frame::FIELDS.1),
        Name::Images => fields(Image::FIELDS.1),
        Name::Proposals => fields(Proposal::FIELDS.1),
        Name::Ground => fields(Ground::FIELDS.1),
        Name::LaidPieces => fields(LaidPiece::FIELDS.1),
        Name::Darts => fields(Dart::FIELDS.1),
        Name::FreshCells | Name::OpenCells | Name::NextOpenCells => fields(PieceCell::FIELDS.1),
        Name::States => named(&["state"]),
        Name::Questions => named(&["dart"]),
        Name::Verdicts => named(&["is sample"]),
        Name::Marks => named(&["is marked"]),
        Name::Pieces => named(&["image", "column", "row", "size"]),
        // A cell has three slots: no four samples that are farther than r from each other fit a square of r.
        Name::Grid => ["count", "flags"]
            .map(str::to_owned)
            .into_iter()
            .chain((1..=3).flat_map(|slot| {
                ["iteration", "x", "y", "detector"].map(|column| format!("{column} {slot}"))
            }))
            .collect(),
        Name::TileImages => std::iter::once("count".to_owned())
            .chain((1..TILE_WORDS).map(|k| format!("image {k}")))
            .collect(),
        Name::Arguments => named(&["x", "y", "z"]),
        Name::Counters => counter::ALL
            .iter()
            .map(|(name, _)| name.trim_start_matches("COUNTER_").to_lowercase())
            .collect(),
        Name::Places => named(&["x", "y", "fate"]),
        Name::Origins => named(&["image", "pattern index"]),
        Name::Active | Name::NextActive | Name::Result => named(&["x", "y"]),
        Name::Tags => named(&["block", "pattern index"]),
        Name::List | Name::Unsure => named(&["cell"]),
        Name::Starts | Name::Heads => named(&["first"]),
        Name::By => named(&["by"]),
        Name::Pattern | Name::Sums | Name::Job => named(&["word"]),
    }
}

/// Returns the numbers that the words of a row hold, one for each column.
fn meaning(name: Name, row: &[u32]) -> Vec<i64> {
    // A word holds x and then y in the lower bits, from the lowest corner of the cell; the two highest are the fate of a tiled
    // sample, or the mark of a detector.
    let position = |word: u32| {
        let (x, y) = (word & (R as u32 - 1), (word & POSITION_MASK) >> CELL_BITS);
        [i64::from(x), i64::from(y)]
    };

    match name {
        Name::Places => {
            let [x, y] = position(row[0]);
            vec![x, y, i64::from((row[0] & FATE_MASK) >> 30)]
        }
        Name::Grid => {
            // Three words of samples, then one of what the cell is: the count in bits 0 and 1, flags in bits 2 to 7, and
            // the iterations of the three slots, 8 bits each.
            let count = row[3] & COUNT_MASK;
            let mut values = vec![i64::from(count), i64::from(row[3] & 0xfc)];
            for slot in 0..3 {
                if slot < count {
                    let word = row[slot as usize];
                    let [x, y] = position(word);
                    let iteration = i64::from((row[3] >> (8 + 8 * slot)) & 255);
                    values.extend([iteration, x, y, i64::from(word >> 30 & 1)]);
                } else {
                    // Every row has all columns, so an empty slot fills its own with -1.
                    values.extend([-1; 4]);
                }
            }
            values
        }
        Name::Frame => signed(row, Frame::FIELDS.1),
        Name::Images => signed(row, Image::FIELDS.1),
        Name::Proposals => signed(row, Proposal::FIELDS.1),
        Name::Ground => signed(row, Ground::FIELDS.1),
        Name::LaidPieces => signed(row, LaidPiece::FIELDS.1),
        Name::Darts => signed(row, Dart::FIELDS.1),
        Name::FreshCells | Name::OpenCells | Name::NextOpenCells => {
            signed(row, PieceCell::FIELDS.1)
        }
        // Cells may begin left of the frame or below it. Points of `Result`, below, lie in the domain and are not negative.
        Name::Active | Name::NextActive => row.iter().map(|&w| i64::from(w as i32)).collect(),
        Name::Job
        | Name::Pieces
        | Name::TileImages
        | Name::Pattern
        | Name::Starts
        | Name::Sums
        | Name::Origins
        | Name::By
        | Name::Heads
        | Name::List
        | Name::Unsure
        | Name::States
        | Name::Questions
        | Name::Verdicts
        | Name::Marks
        | Name::Counters
        | Name::Arguments
        | Name::Result
        | Name::Tags => row.iter().map(|&word| i64::from(word)).collect(),
    }
}

/// Returns the words of a structure with these fields, as signed numbers where a field is an `i32`.
fn signed(row: &[u32], fields: &[(&str, usize, &str)]) -> Vec<i64> {
    row.iter()
        .zip(fields)
        .map(|(&word, (_, _, kind))| {
            if *kind == "i32" {
                i64::from(word as i32)
            } else {
                i64::from(word)
            }
        })
        .collect()
}
