//! The constants that shaders share with Rust. WGSL declarations are emitted from these, so the two cannot differ.

use std::fmt::Write as _;

use tilescope_core::stages::darts::{GAP_SIDE, POISSON};
use tilescope_core::stages::detect::{DETECTOR_REACH, NEARER_SLACK};
use tilescope_core::stages::uniform::SLACK;
use tilescope_core::windows::{CELL_BITS, PAD};
use tilescope_core::{R, Stream};

use crate::layout::counter;

/// Invocations of a workgroup.
pub const WORKGROUP: u32 = 64;

/// Workgroups in a row of a dispatch.
pub const GROUP_COLUMNS: u32 = 1024;

/// Cells along the side of a tile. For each tile the images of blocks that reach it are listed.
pub const TILE_SIDE: u32 = 8;

/// Words of a tile's list: a count and room for 19 images. Blocks have sides of at least 6r. Each block that, enlarged
/// by r, comes within r of a tile of 8r contains a 6 x 6 r square that touches the tile's surrounding square of 12r;
/// these squares lie within 24 x 24 r, which hold at most 16 of them.
pub const TILE_WORDS: u32 = 20;

/// The most samples tiled in a cell: at most 6 blocks reach it (as above, 15 x 15 r), and of each at most four
/// samples, conflict-free, lie in a square of r.
pub const MAX_FOUND: u32 = 24;

/// The most samples that may make a candidate in a pixel. They lie in a ring of 0.18r whose radius is below 3.7r,
/// farther than r from each other: fewer than 24.
pub const MAX_SITES: u32 = 32;

/// Elements of a list that one invocation sums up in a scan.
pub const SCAN_EACH: u32 = 16;
/// Elements that one workgroup sums up.
pub const SCAN_PART: u32 = SCAN_EACH * WORKGROUP;

/// The binary logarithm of the side of a pixel, which is an eighth of a cell wide.
const PIXEL_BITS: u32 = CELL_BITS - 3;

/// The largest distance of a point in a pixel from its centre: 2048 units on each axis, which make 2896.3, and one unit
/// to spare.
const HALF_DIAGONAL: f32 = 2_897.5;

/// How much farther from a candidate its own samples may be than the nearest sample. Their squared distances differ by
/// less than 22 R (12 R by definition, 9.7 R by rounding), which is 11 units at distances above R; the rest allows for
/// f32.
const SITE_SLACK: f32 = 12.5;

/// Faults that shaders report. None of them can happen in a correct program, except `FAULT_TILED`.
pub const FAULTS: &[(&str, u32)] = &[
    ("FAULT_IMAGES", 1),
    ("FAULT_CROWDED", 2),
    ("FAULT_TILED", 3),
    ("FAULT_FULL", 4),
    ("FAULT_SITES", 5),
];

/// The fault that more room for tiled samples mends.
pub const FAULT_TILED: u32 = 3;

/// A flag of `prepare`: also note that all unsure cells have been spread.
pub const PREPARE_SPREAD: u32 = 1;
/// A flag of `prepare`: also go on to the next level of uniform insertion.
pub const PREPARE_LEVEL: u32 = 2;

/// A flag of `prepare_darts`: the cells for the next level become the open ones.
pub const PREPARE_NEXT_CELLS: u32 = 1;
/// A flag of `prepare_darts`: all open cells have thrown their darts.
pub const PREPARE_THROWN: u32 = 2;
/// A flag of `prepare_darts`: all darts are linked.
pub const PREPARE_LINKED: u32 = 4;
/// A flag of `prepare_darts`: a throw begins, so that its questions are asked whatever the round before changed.
pub const PREPARE_FIRST: u32 = 8;

/// The binary logarithm of the side of marked cells, which is R.
pub const MARK_BITS: u32 = CELL_BITS;

/// The bits of a dart's label that hold four times its level plus its throw: at most 60.
pub const THROW_BITS: u32 = 6;
/// Stands for the pattern's sample of a dart that was thrown here.
pub const NO_SAMPLE: u32 = u32::MAX;
/// A bit of a dart's state: it is a sample, as things stand.
pub const DART_PRESENT: u32 = 1;
/// A bit of a dart's state: the answer about it may be another than in the pattern.
pub const DART_QUESTION: u32 = 2;

/// The state of a proposal that was inserted.
pub const PROPOSAL_INSERTED: u32 = 4;

/// Stands for the missing samples of a proposal that fewer than three made.
pub const NO_SITE: u32 = 0x7fff_ffff;

/// The bits of a tiled sample's word that hold its offset in the cell.
pub const POSITION_MASK: u32 = 0x3fff_ffff;
/// The bits that hold its fate.
pub const FATE_MASK: u32 = 0xc000_0000;
/// The sample was kept and is in the grid.
pub const FATE_KEPT: u32 = 0x4000_0000;
/// The sample was eliminated or dropped.
pub const FATE_LOST: u32 = 0x8000_0000;

/// Flags of a cell of the grid: some of its samples are unknown, since they depend on samples beyond the frame.
pub const FLAG_UNSURE: u32 = 4;
/// The cell is next to an unsure one, or unsure itself.
pub const FLAG_HOT: u32 = 16;
/// A sample was eliminated or dropped in the cell.
pub const FLAG_LOST: u32 = 32;
/// A sample inserted last may make candidates in it.
pub const FLAG_FRESH: u32 = 64;

/// The mark of a detector in a slot of the grid.
pub const DETECTOR: u32 = 0x4000_0000;

/// The number of samples in the last word of a cell of the grid.
pub const COUNT_MASK: u32 = 3;

/// Arguments of indirect dispatches, numbered by position.
pub const ARGUMENTS: &[&str] = &[
    "ARGUMENT_CONTESTED",
    "ARGUMENT_OPEN",
    "ARGUMENT_OPEN_ROWS",
    "ARGUMENT_PROPOSALS",
    "ARGUMENT_UNSURE",
    "ARGUMENT_ACTIVE",
    "ARGUMENT_OPEN_CELLS",
    "ARGUMENT_FRESH_CELLS",
    "ARGUMENT_THROWN",
    "ARGUMENT_LINKED",
    "ARGUMENT_JUDGED",
];

/// Orders of elimination, numbered as the variants of core's `Order`.
pub const ORDERS: &[&str] = &[
    "ORDER_INDEX",
    "ORDER_RANDOM",
    "ORDER_OWN_BLOCK_FIRST",
    "ORDER_PHASE_GROUP",
];

/// Returns the WGSL declarations of all shared constants.
#[must_use]
pub fn constants() -> String {
    let mut text = String::from("// Emitted by constants.rs.\n");
    // Writing to a string never fails, so the results are ignored.
    for (name, value) in signed() {
        let _ = writeln!(text, "const {name}: i32 = {value};");
    }
    for (name, value) in unsigned() {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    // The debug form of a float has a point even where the value is whole.
    for (name, value) in [("HALF_DIAGONAL", HALF_DIAGONAL), ("SITE_SLACK", SITE_SLACK)] {
        let _ = writeln!(text, "const {name}: f32 = {value:?};");
    }

    let bounds: Vec<String> = POISSON.iter().map(|bound| format!("{bound}u")).collect();
    let (count, bounds) = (bounds.len(), bounds.join(", "));
    let _ = writeln!(text, "const POISSON = array<u32, {count}>({bounds});");
    text
}

/// Returns the constants that shaders declare as `i32`.
fn signed() -> Vec<(&'static str, i32)> {
    vec![
        ("R", R),
        ("PAD", PAD),
        ("PIXEL_SIDE", 1 << PIXEL_BITS),
        ("DETECTOR_REACH", DETECTOR_REACH),
        ("NEARER_SLACK", NEARER_SLACK as i32),
        ("GAP_REACH", R + SLACK),
    ]
}

/// Returns the constants that shaders declare as `u32`.
fn unsigned() -> Vec<(&'static str, u32)> {
    // Shaders alone use the values that have no constant of their own in Rust.
    let mut all = vec![
        ("WORKGROUP", WORKGROUP),
        ("GROUP_COLUMNS", GROUP_COLUMNS),
        ("CELL_BITS", CELL_BITS),
        ("LOW", R as u32 - 1),
        ("PIXEL_BITS", PIXEL_BITS),
        ("TILE_SIDE", TILE_SIDE),
        ("TILE_WORDS", TILE_WORDS),
        ("MAX_FOUND", MAX_FOUND),
        ("MAX_SITES", MAX_SITES),
        ("SCAN_EACH", SCAN_EACH),
        ("SCAN_PART", SCAN_PART),
        ("POSITION_MASK", POSITION_MASK),
        ("FATE_MASK", FATE_MASK),
        // Passes decide a sample by setting the bits of its fate, so that a word without them is undecided.
        ("FATE_UNDECIDED", 0),
        ("FATE_KEPT", FATE_KEPT),
        ("FATE_LOST", FATE_LOST),
        ("FATE_UNKNOWN", FATE_MASK),
        // A free slot is larger than any position, so that it is sorted to the end (gather.wgsl).
        ("FREE", u32::MAX),
        ("DETECTOR", DETECTOR),
        // The mark of a detector, moved up by one bit: a site's key takes the 31 below.
        ("SITE_DETECTOR", 0x8000_0000),
        ("NO_SITE", NO_SITE),
        ("COUNT_MASK", COUNT_MASK),
        ("FLAG_UNSURE", FLAG_UNSURE),
        // The cell is as near to an unsure one as the pass asks (spread.wgsl).
        ("FLAG_REACHED", 8),
        ("FLAG_HOT", FLAG_HOT),
        ("FLAG_LOST", FLAG_LOST),
        ("FLAG_FRESH", FLAG_FRESH),
        ("GAP_SIDE", GAP_SIDE as u32),
        ("POISSON_COUNT", POISSON.len() as u32),
        ("STREAM_DART", Stream::Dart as u32),
        ("PREPARE_SPREAD", PREPARE_SPREAD),
        ("PREPARE_LEVEL", PREPARE_LEVEL),
        ("PREPARE_NEXT_CELLS", PREPARE_NEXT_CELLS),
        ("PREPARE_THROWN", PREPARE_THROWN),
        ("PREPARE_LINKED", PREPARE_LINKED),
        ("PREPARE_FIRST", PREPARE_FIRST),
        ("THROW_BITS", THROW_BITS),
        ("THROW_MASK", (1 << THROW_BITS) - 1),
        ("NO_SAMPLE", NO_SAMPLE),
        ("DART_PRESENT", DART_PRESENT),
        ("DART_QUESTION", DART_QUESTION),
        // The words of a `Proposal` (layout.rs).
        ("PROPOSAL_WORDS", 8),
        ("PROPOSAL_UNDECIDED", 0),
        ("PROPOSAL_KEPT", 1),
        ("PROPOSAL_REJECTED", 2),
        ("PROPOSAL_UNKNOWN", 3),
        ("PROPOSAL_INSERTED", PROPOSAL_INSERTED),
        // An unknown proposal whose cell has been marked; once is enough.
        ("PROPOSAL_NOTED", 5),
    ];

    all.extend(FAULTS);
    all.extend(ARGUMENTS.iter().copied().zip(0..));
    all.extend(ORDERS.iter().copied().zip(0..));
    all.extend(counter::ALL);
    all
}
