//! Blocks: tells each tile of cells which images of blocks reach it (paper, Algorithm 1; the tree itself is
//! cut on the CPU).

use super::{Command, Pass, Size, atomic, read, run, run_with, uniform_of, update};
use crate::layout::{Job, Name};
use crate::plan::Plan;

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

/// Records the stage, from buffers of any content.
pub(crate) fn blocks(plan: &Plan) -> Vec<Command> {
    let pieces = plan.pieces.len() as u32;
    let job = Job {
        a: pieces,
        ..Job::default()
    };
    vec![
        Command::Clear(Name::Counters, None),
        Command::Clear(Name::TileImages, None),
        run_with(&BLOCKS, job, Size::Workgroups(pieces.into())),
        run(&SORT_BLOCKS, Size::Invocations(plan.uniform.tiles.into())),
    ]
}
