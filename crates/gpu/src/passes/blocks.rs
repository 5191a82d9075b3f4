//! Blocks: tells each tile of cells which images of blocks reach it (paper, Algorithm 1; the tree itself is
//! cut on the CPU).

use super::{Command, Pass, Size, atomic, read, run, uniform_of, write};
use crate::layout::Name;
use crate::plan::Plan;

pub(super) const BLOCKS: Pass = Pass {
    name: "blocks",
    shader: "blocks",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Pieces),
        atomic(Name::TileImages),
        atomic(Name::Counters),
    ],
};

pub(super) const SORT_BLOCKS: Pass = Pass {
    name: "sort blocks",
    shader: "sort_blocks",
    bindings: &[uniform_of(Name::Frame), write(Name::TileImages)],
};

/// Records the stage, from buffers of any content.
pub(crate) fn blocks(plan: &Plan) -> Vec<Command> {
    vec![
        Command::Clear(Name::Counters, None),
        Command::Clear(Name::TileImages, None),
        run(&BLOCKS, Size::Workgroups(plan.pieces.len() as u64)),
        run(&SORT_BLOCKS, Size::Invocations(plan.uniform.tiles.into())),
    ]
}
