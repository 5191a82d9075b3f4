//! Elimination (paper, Algorithm 4, first loop), in rounds, and the grid of the survivors.

use super::{
    Command, Pass, Size, argument, atomic, clear_counter, prepare, read, run, uniform_of, write,
};
use crate::layout::{Name, counter};
use crate::plan::Plan;

/// Rounds between two looks at what is left.
const ROUNDS: usize = 8;

pub(super) const ELIMINATE: Pass = Pass {
    name: "eliminate",
    shader: "eliminate",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Images),
        read(Name::Starts),
        atomic(Name::Places),
        read(Name::Origins),
        read(Name::List),
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
    let mut commands = vec![prepare(0)];
    commands.extend(rounds());
    commands
}

/// Records further rounds.
pub(crate) fn rounds() -> Vec<Command> {
    let round = [
        clear_counter(counter::UNDECIDED),
        run(&ELIMINATE, argument("ARGUMENT_CONTESTED")),
    ];
    std::iter::repeat_n(round, ROUNDS).flatten().collect()
}

/// Records the end of the stage; with `by` who eliminated whom is noted, too.
pub(crate) fn survive(plan: &Plan, by: bool) -> Vec<Command> {
    let cells = Size::Invocations(plan.cells());
    let mut commands = Vec::new();
    if by {
        commands.push(run(&ATTRIBUTE, cells));
    }
    commands.push(run(&SURVIVE, cells));
    commands
}
