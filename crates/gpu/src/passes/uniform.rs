//! Uniform insertion: the keyed dart process in the gaps, level by level.

use super::detect::{open, spread};
use super::{
    Command, Pass, Size, argument, atomic, clear_counter, insert, prepare, read, run, run_with,
    uniform_of, unlink, write,
};
use crate::constants::PREPARE_LEVEL;
use crate::layout::{Name, counter};
use crate::plan::WindowPlan;

pub(super) const GAP_CELLS: Pass = Pass {
    name: "gap cells",
    shader: "gap_cells",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Starts),
        read(Name::Places),
        read(Name::Grid),
        write(Name::Active),
        atomic(Name::Counters),
    ],
};

pub(super) const THROW: Pass = Pass {
    name: "throw",
    shader: "throw",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        read(Name::Grid),
        read(Name::Active),
        write(Name::Proposals),
        atomic(Name::Counters),
    ],
};

pub(super) const SPLIT: Pass = Pass {
    name: "split",
    shader: "split",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        read(Name::Grid),
        read(Name::Active),
        write(Name::NextActive),
        atomic(Name::Counters),
    ],
};

/// Records the listing of the first level's cells. Unsure cells affect those within `reach` cells.
pub(crate) fn start(plan: &WindowPlan, reach: u32) -> Vec<Command> {
    let mut commands = spread(reach);
    commands.extend([
        open(plan),
        run(&GAP_CELLS, Size::Invocations(plan.inner_cells())),
        prepare(0),
    ]);
    commands
}

/// Records a level: darts are thrown with a key, of the words `a` and `b`, into cells of side 2^`side_bits`, and
/// inserted.
pub(crate) fn level(level: u32, side_bits: u32, [a, b]: [u32; 2]) -> Vec<Command> {
    let mut commands = vec![
        prepare(0),
        clear_counter(counter::PROPOSALS),
        run_with(&THROW, [a, b, side_bits, 0], argument("ARGUMENT_ACTIVE")),
        prepare(0),
    ];
    // Darts have their ranks already, so that no key is needed to draw them.
    commands.extend(insert(level, None));
    commands
}

/// Records the step to the next level.
pub(crate) fn split(side_bits: u32) -> Vec<Command> {
    vec![
        unlink(),
        clear_counter(counter::NEXT_ACTIVE),
        run_with(&SPLIT, [0, 0, side_bits, 0], argument("ARGUMENT_ACTIVE")),
        prepare(PREPARE_LEVEL),
        Command::SwapActive,
    ]
}
