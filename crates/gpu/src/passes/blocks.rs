//! Blocks: lists for each tile of cells the images of blocks that reach it (paper, Algorithm 1; the CPU builds the tree
//! itself).

use super::{Command, Pass, Size, atomic, read, run, run_with, uniform_of, update};
use crate::layout::Name;
use crate::plan::WindowPlan;

pub(super) const BLOCKS: Pass = Pass {
    name: "blocks",
    shader: "blocks",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        read(Name::Pieces),
        atomic(Name::TileImages),
        atomic(Name::Counters),
    ],
};

pub(super) const SORT_BLOCKS: Pass = Pass {
    name: "sort blocks",
    shader: "sort_blocks",
    bindings: &[uniform_of(Name::Frame), update(Name::TileImages)],
};

/// Records the stage. The buffers may have any content before.
pub(crate) fn blocks(plan: &WindowPlan) -> Vec<Command> {
    let pieces = plan.pieces.len() as u32;
    vec![
        Command::Clear(Name::Counters, None),
        Command::Clear(Name::TileImages, None),
        run_with(&BLOCKS, [pieces, 0, 0, 0], Size::Workgroups(pieces.into())),
        run(&SORT_BLOCKS, Size::Invocations(plan.uniform.tiles.into())),
    ]
}
