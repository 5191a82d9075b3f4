//! Elimination (paper, Algorithm 4, first loop), in rounds, and the grid of the survivors. The decision is in
//! `shaders/eliminate.wgsl`.

use super::{Command, Pass, Size, alternating, atomic, prepare, read, run, uniform_of, write};
use crate::layout::Name;
use crate::plan::WindowPlan;

/// Rounds between two readings of the counters, an even number (`alternating`). Chosen, not measured.
const ROUNDS: u32 = 8;

pub(super) const ELIMINATE: Pass = Pass {
    name: "eliminate",
    shader: "eliminate",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        read(Name::Images),
        read(Name::Starts),
        atomic(Name::Places),
        read(Name::Origins),
        read(Name::Heads).named("list"),
        atomic(Name::Counters),
    ],
};

pub(super) const ATTRIBUTE: Pass = Pass {
    name: "attribute",
    shader: "attribute",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Images),
        read(Name::Starts),
        read(Name::Places),
        read(Name::Origins),
        write(Name::By),
    ],
};

pub(super) const SURVIVE: Pass = Pass {
    name: "survive",
    shader: "survive",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Starts),
        read(Name::Places),
        write(Name::Grid),
        write(Name::Unsure),
        atomic(Name::Counters),
    ],
};

/// Records the first rounds.
pub(crate) fn eliminate() -> Vec<Command> {
    let (mut commands, is_first) = (vec![prepare(0)], true);
    commands.extend(alternating(
        &ELIMINATE,
        "ARGUMENT_CONTESTED",
        ROUNDS,
        is_first,
    ));
    commands
}

/// Records further rounds, for cells that are still contested.
pub(crate) fn rounds() -> Vec<Command> {
    let is_first = false;
    alternating(&ELIMINATE, "ARGUMENT_CONTESTED", ROUNDS, is_first)
}

/// Records the end of the stage. With `by` the pass notes which sample eliminated which.
pub(crate) fn survive(plan: &WindowPlan, by: bool) -> Vec<Command> {
    let cells = Size::Invocations(plan.cells());
    let mut commands = Vec::new();
    if by {
        commands.push(run(&ATTRIBUTE, cells));
    }
    commands.push(run(&SURVIVE, cells));
    // The contested cells are no longer needed; the buffer holds proposals next.
    commands.push(Command::Clear(Name::Heads, None));
    commands
}
