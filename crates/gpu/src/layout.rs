//! The layout of data on the device: the buffers and their WGSL types, the structures shared by Rust and WGSL, the
//! counters. Declarations in shaders are emitted from here.

use std::fmt::Write as _;

/// A structure's fields: names, byte offsets, types.
pub type Fields = &'static [(&'static str, usize, &'static str)];

/// Declares a structure of 32-bit scalars once for Rust and WGSL.
macro_rules! shared {
    ($(#[$attributes:meta])* $name:ident { $($(#[$field_attributes:meta])* $field:ident: $kind:ident,)* }) => {
        $(#[$attributes])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $($(#[$field_attributes])* pub $field: $kind,)* }

        impl $name {
            /// The structure's name, and its fields with their byte offsets and types.
            pub const FIELDS: (&'static str, Fields) = (
                stringify!($name),
                &[$((stringify!($field), std::mem::offset_of!($name, $field), stringify!($kind)),)*],
            );
        }
    };
}

shared! {
    /// Constants of the run and of the window's rectangle of cells, for every pass.
    Frame {
        /// Cells on the horizontal axis, without the padding.
        columns: i32,
        /// Cells on the vertical axis, without the padding.
        rows: i32,
        /// Cells from one row to the next, with the padding.
        stride: u32,
        /// Cells in all, with the padding.
        cells: u32,
        /// The first abscissa beyond the frame.
        end_x: i32,
        /// The first ordinate beyond the frame.
        end_y: i32,
        /// The lowest abscissa of the window, in the frame's coordinates.
        window_min_x: i32,
        /// The lowest ordinate of the window.
        window_min_y: i32,
        /// The first abscissa beyond the window.
        window_max_x: i32,
        /// The first ordinate beyond the window.
        window_max_y: i32,
        /// The domain's abscissa at the frame's (0, 0): to be added, then wrapped.
        origin_x: u32,
        /// The domain's ordinate at the frame's (0, 0).
        origin_y: u32,
        /// The width of the domain in units.
        side_x: u32,
        /// The height of the domain in units.
        side_y: u32,
        /// 1 if the plane repeats.
        periodic: u32,
        /// Bits 1, 2, 4, 8: the plane continues to the left, right, below, above the frame.
        goes_on: u32,
        /// Tiles of 8 x 8 cells in a row of the frame with its padding.
        tile_columns: u32,
        /// Tiles of the frame in all.
        tiles: u32,
        /// The order of elimination, as `ORDER_*`.
        order: u32,
        /// The first word of the key of random ranks.
        order_key_x: u32,
        /// The second word of this key.
        order_key_y: u32,
        /// The width of a phase group's cells, in units.
        phase_cell_x: i32,
        /// The height of a phase group's cells, in units.
        phase_cell_y: i32,
        /// Cells of phase groups in a row.
        phase_count_x: i32,
        /// Rows of cells of phase groups.
        phase_count_y: i32,
        /// The order of the groups, four bits each.
        phase_sequence: u32,
        /// Words stored for a tiled sample's origin: 1 for the block's image alone, 2 with the pattern index.
        origin_words: u32,
        /// The largest distance, in cells, from a lost sample to an uncovered place that must be found.
        lost_reach: i32,
        /// The largest distance of a candidate's samples from its detector, in units, far from closed borders.
        search: i32,
        /// The same near closed borders.
        search_border: i32,
        /// Room in the list of open cells.
        list_capacity: u32,
        /// Room in the list of unsure cells.
        unsure_capacity: u32,
        /// Room in the list of proposals.
        proposal_capacity: u32,
        /// Room for active cells of uniform insertion.
        active_capacity: u32,
        /// Room for tiled samples.
        tiled_capacity: u32,
        /// Room for the result.
        result_capacity: u32,
    }
}

shared! {
    /// The arguments of one dispatch.
    Job {
        /// The first number of the dispatch; each pass has its own use for the four.
        a: u32,
        /// The second number of the dispatch.
        b: u32,
        /// The third number of the dispatch.
        c: u32,
        /// The fourth number of the dispatch.
        d: u32,
    }
}

shared! {
    /// A block, or an image of it, that reaches into the frame.
    Image {
        /// The lowest abscissa of the block itself, in the frame's coordinates, clamped to fit 32 bits.
        own_min_x: i32,
        /// The lowest ordinate of the block itself.
        own_min_y: i32,
        /// The first abscissa beyond the block itself.
        own_max_x: i32,
        /// The first ordinate beyond the block itself.
        own_max_y: i32,
        /// The lowest abscissa of the clip: of the block enlarged by r, inside the frame.
        clip_min_x: i32,
        /// The lowest ordinate of the clip.
        clip_min_y: i32,
        /// The first abscissa beyond the clip.
        clip_max_x: i32,
        /// The first ordinate beyond the clip.
        clip_max_y: i32,
        /// The lowest abscissa of the enlarged block, modulo 2^32.
        corner_x: u32,
        /// The lowest ordinate of the enlarged block, modulo 2^32.
        corner_y: u32,
        /// The pattern's abscissa at the lowest corner of the clip.
        start_x: i32,
        /// The pattern's ordinate at the lowest corner of the clip.
        start_y: i32,
        /// The word at which the variant's shape begins in the pattern buffer.
        shape: u32,
        /// A number that grows with the block's index and is equal for its images.
        sequence: u32,
        /// The block's index, if blocks were counted.
        block: u32,
        /// Fills the structure up to a multiple of 16 bytes.
        unused: u32,
    }
}

shared! {
    /// A point at which a sample may be inserted: a candidate or a dart.
    Proposal {
        /// The abscissa in the frame.
        x: i32,
        /// The ordinate in the frame.
        y: i32,
        /// Its rank in the order of insertion.
        rank: u32,
        /// The next proposal of its cell, plus one.
        next: u32,
        /// The first sample that made it: cell times four plus slot, or `NO_SITE`.
        site_a: u32,
        /// The second sample that made it.
        site_b: u32,
        /// The third sample that made it.
        site_c: u32,
        /// Its fate, as `PROPOSAL_*`.
        state: u32,
    }
}

shared! {
    /// Constants of an exact tiling of a whole domain, for every pass of it.
    Ground {
        /// The first abscissa beyond the domain.
        end_x: i32,
        /// The first ordinate beyond the domain.
        end_y: i32,
        /// Cells of side R in a row.
        columns: u32,
        /// Cells in all.
        cells: u32,
        /// 1 if opposite ends are joined.
        periodic: u32,
        /// Pieces in all.
        pieces: u32,
        /// Marks in all: one for each cell of the pattern in each piece.
        marks: u32,
        /// Cells of the pattern in a row.
        pattern_columns: u32,
        /// The word at which the pattern's samples begin, four words each; before it are the starts of cells.
        pattern_points: u32,
        /// Room in the list of darts, and in those of questions and answers.
        dart_capacity: u32,
        /// Room in each list of cells.
        cell_capacity: u32,
        /// Fills the structure up to a multiple of 16 bytes.
        unused: u32,
    }
}

shared! {
    /// A dart of an exact tiling, or a sample of the pattern that was laid down.
    Dart {
        /// The abscissa in the domain.
        x: i32,
        /// The ordinate in the domain.
        y: i32,
        /// The index of its piece, above six bits for four times its level plus its throw.
        label: u32,
        /// Its rank in the throw.
        rank: u32,
        /// Its abscissa in the pattern.
        source_x: i32,
        /// Its ordinate in the pattern.
        source_y: i32,
        /// The index of the pattern's sample, or `NO_SAMPLE` of a dart that was thrown here.
        sample: u32,
        /// The next dart of its cell, plus one.
        next: u32,
    }
}

shared! {
    /// The part of a block that one copy of the pattern fills.
    LaidPiece {
        /// The lowest abscissa of the pattern in it.
        source_min_x: i32,
        /// The lowest ordinate of the pattern in it.
        source_min_y: i32,
        /// The first abscissa beyond that part of the pattern.
        source_max_x: i32,
        /// The first ordinate beyond that part of the pattern.
        source_max_y: i32,
        /// The lowest abscissa of the block in the domain.
        block_min_x: i32,
        /// The lowest ordinate of the block.
        block_min_y: i32,
        /// The first abscissa beyond the block.
        block_max_x: i32,
        /// The first ordinate beyond the block.
        block_max_y: i32,
        /// Where the domain has the pattern's place 0: its abscissa, modulo 2^32.
        origin_x: i32,
        /// Its ordinate, modulo 2^32.
        origin_y: i32,
        /// The symmetry that turns the pattern.
        symmetry: u32,
        /// The index of the block.
        block: u32,
        /// The first mark of its cells.
        first_mark: u32,
        /// Marks in a row of its cells.
        mark_columns: u32,
        /// The first piece of the block.
        first_piece: u32,
        /// The first piece of the next block.
        end_piece: u32,
    }
}

shared! {
    /// A cell of the pattern in a piece. Its side depends on the level.
    PieceCell {
        /// The index of the piece.
        piece: u32,
        /// The cell's lowest abscissa in the pattern, a multiple of its side.
        x: i32,
        /// The cell's lowest ordinate in the pattern.
        y: i32,
    }
}

/// The structures that Rust and shaders share.
pub const STRUCTURES: &[(&str, Fields)] = &[
    Frame::FIELDS,
    Job::FIELDS,
    Image::FIELDS,
    Proposal::FIELDS,
    Ground::FIELDS,
    Dart::FIELDS,
    LaidPiece::FIELDS,
    PieceCell::FIELDS,
];

/// Returns the WGSL declarations of the shared structures.
#[must_use]
pub fn structures() -> String {
    let mut text = String::from("// Emitted by layout.rs.\n");
    for (name, fields) in STRUCTURES {
        let _ = writeln!(text, "struct {name} {{");
        for (field, _, kind) in *fields {
            let _ = writeln!(text, "    {field}: {kind},");
        }
        text.push_str("}\n");
    }
    text
}

/// Numbers that passes count up and the host reads, by their index in the buffer of counters.
pub mod counter {
    macro_rules! counters {
        ($($(#[$attributes:meta])* $name:ident,)*) => {
            counters!(@ 0u32; $($(#[$attributes])* $name,)*);
            /// All counters with their indices, as shaders name them.
            pub const ALL: &[(&str, u32)] = &[$((concat!("COUNTER_", stringify!($name)), $name),)*];
        };
        (@ $index:expr; $(#[$attributes:meta])* $name:ident, $($rest:tt)*) => {
            $(#[$attributes])*
            pub const $name: u32 = $index;
            counters!(@ $index + 1; $($rest)*);
        };
        (@ $index:expr;) => {
            /// How many counters there are.
            pub const COUNT: u32 = $index;
        };
    }
    counters! {
        /// The code of a fault, or 0.
        FAULT,
        /// Cells with contested samples.
        CONTESTED,
        /// Whether the last even round left anything undecided.
        UNDECIDED,
        /// Whether the last odd round left anything undecided.
        UNDECIDED_ODD,
        /// Cells that may hold an uncovered place.
        OPEN,
        /// Cells in which some samples are unknown.
        UNSURE,
        /// Unsure cells that have been spread to their surroundings.
        SPREAD,
        /// Unsure cells that the window touches.
        UNSURE_IN_WINDOW,
        /// Candidates of the iteration, or darts of the level.
        PROPOSALS,
        /// Samples inserted last, in the frame.
        INSERTED,
        /// Samples inserted last, in the window.
        INSERTED_IN_WINDOW,
        /// Active cells of the level.
        ACTIVE,
        /// Active cells of the level to come.
        NEXT_ACTIVE,
        /// Samples eliminated in the window.
        ELIMINATED,
        /// Dropped samples that are nearest to the window.
        DROPPED,
        /// Samples tiled in the frame.
        TILED,
        /// Samples of the result.
        KEPT,
        /// Darts of an exact tiling, with the samples that were laid down.
        DARTS,
        /// Darts that are linked into the lists of their cells.
        LINKED,
        /// Questions of the throw.
        QUESTIONS,
        /// Questions that are answered in this round; none once the answers are right.
        JUDGED,
        /// Answers of the last round that are others than before.
        CHANGED,
        /// Cells that were marked and not cut yet.
        FRESH_CELLS,
        /// Cells that throw the darts of the throw. It follows the counter of the cells that become open ones by a cut.
        OPEN_CELLS,
        /// Open cells of the level to come; it follows the counter of those that are cut for it.
        NEXT_OPEN_CELLS,
        /// Open cells that have thrown their darts.
        THROWN,
    }
}

/// A buffer of a run.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Name {
    /// The frame, a uniform.
    Frame,
    /// The dispatch's numbers, a uniform.
    Job,
    /// Images of blocks that reach into the frame.
    Images,
    /// Pieces of images: image, first tile, last tile.
    Pieces,
    /// For each tile of cells the images that reach it.
    TileImages,
    /// The pattern's variants by cells.
    Pattern,
    /// For each cell the index of its first tiled sample.
    Starts,
    /// Sums of the parts of a list, in a prefix sum.
    Sums,
    /// Tiled samples, cell by cell: position in the cell and fate.
    Places,
    /// The origins of tiled samples: image of a block, pattern index.
    Origins,
    /// For each tiled sample the one that eliminated it.
    By,
    /// Valid samples: for each cell three slots and a word of counts and flags.
    Grid,
    /// First the contested cells; later, for each cell, its first proposal plus one; at last, for each cell, its first
    /// sample in the result.
    Heads,
    /// Cells that may hold an uncovered place.
    List,
    /// Cells in which some samples are unknown.
    Unsure,
    /// Candidates of the iteration, or darts of the level.
    Proposals,
    /// Active cells of uniform insertion.
    Active,
    /// Active cells of the next level.
    NextActive,
    /// Numbers that passes count up.
    Counters,
    /// Workgroups of indirect dispatches.
    Arguments,
    /// The samples of the window, in canonical order.
    Result,
    /// The sources of the result's samples.
    Tags,
    /// The constants of an exact tiling, a uniform.
    Ground,
    /// The parts of blocks that one copy of the pattern fills each.
    LaidPieces,
    /// The pattern's samples that were laid down, then the darts that were thrown.
    Darts,
    /// For each dart whether it is a sample as things stand, and whether it is a question.
    States,
    /// The darts about which a throw asks whether an earlier sample covers them.
    Questions,
    /// For each question the answer of the last round.
    Verdicts,
    /// For each cell of the pattern in each piece whether its darts are thrown.
    Marks,
    /// Cells that were marked and not cut yet.
    FreshCells,
    /// Cells that throw the darts of the throw.
    OpenCells,
    /// Cells that throw the darts of the next level.
    NextOpenCells,
}

impl Name {
    /// Returns the name in shaders, labels and reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Job => "job",

            Self::Images => "images",
            Self::Pieces => "pieces",
            Self::TileImages => "tile_images",
            Self::Pattern => "pattern",

            Self::Starts => "starts",
            Self::Sums => "sums",
            Self::Places => "places",
            Self::Origins => "origins",
            Self::By => "by",

            Self::Grid => "grid",
            Self::Heads => "heads",
            Self::List => "list",
            Self::Unsure => "unsure",
            Self::Proposals => "proposals",

            Self::Active => "active_cells",
            Self::NextActive => "next_active_cells",
            Self::Counters => "counters",
            Self::Arguments => "arguments",

            Self::Result => "result",
            Self::Tags => "tags",

            Self::Ground => "ground",
            Self::LaidPieces => "pieces_laid",
            Self::Darts => "darts",
            Self::States => "states",
            Self::Questions => "questions",
            Self::Verdicts => "verdicts",
            Self::Marks => "marks",
            Self::FreshCells => "fresh_cells",
            Self::OpenCells => "open_cells",
            Self::NextOpenCells => "next_open_cells",
        }
    }

    /// Returns the WGSL type of an element.
    const fn element(self) -> &'static str {
        match self {
            Self::Frame => "Frame",
            Self::Job => "Job",
            Self::Images => "Image",
            Self::Proposals => "Proposal",
            Self::Active | Self::NextActive => "vec2<i32>",
            Self::Pieces => "vec4<u32>",
            Self::Result | Self::Tags => "vec2<u32>",

            Self::Ground => "Ground",
            Self::LaidPieces => "LaidPiece",
            Self::Darts => "Dart",
            Self::FreshCells | Self::OpenCells | Self::NextOpenCells => "PieceCell",
            Self::TileImages
            | Self::Pattern
            | Self::Starts
            | Self::Sums
            | Self::Places
            | Self::Origins
            | Self::By
            | Self::Grid
            | Self::Heads
            | Self::List
            | Self::Unsure
            | Self::States
            | Self::Questions
            | Self::Verdicts
            | Self::Marks
            | Self::Counters
            | Self::Arguments => "u32",
        }
    }
}

/// How a pass uses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// It is a uniform.
    Uniform,
    /// The pass only reads it.
    Read,
    /// It is written, by one invocation an element.
    Write,
    /// It is read and written, by one invocation an element.
    Update,
    /// Several invocations may write an element: elements are atomic 32-bit words.
    Atomic,
}

/// A buffer of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The buffer that the pass binds.
    pub name: Name,
    /// How it is used.
    pub access: Access,
    /// The name in the shader, if it differs.
    pub alias: Option<&'static str>,
}

/// Returns the WGSL declarations of the bindings of a pass, numbered in this order.
#[must_use]
pub fn declarations(bindings: &[Binding]) -> String {
    let mut text = String::new();
    for (index, binding) in bindings.iter().enumerate() {
        let (space, kind) = match binding.access {
            Access::Uniform => ("uniform", binding.name.element().to_owned()),
            Access::Read => (
                "storage, read",
                format!("array<{}>", binding.name.element()),
            ),
            Access::Write | Access::Update => (
                "storage, read_write",
                format!("array<{}>", binding.name.element()),
            ),
            Access::Atomic => ("storage, read_write", "array<atomic<u32>>".to_owned()),
        };

        // A shader that several passes share has one name for their different buffers, as `data` in the scans. Other
        // shaders name a buffer by what it holds in their pass: `heads` is first a list of contested cells.
        let name = binding.alias.unwrap_or(binding.name.as_str());
        // Writing to a string never fails.
        let _ = writeln!(
            text,
            "@group(0) @binding({index}) var<{space}> {name}: {kind};"
        );
    }
    text
}
