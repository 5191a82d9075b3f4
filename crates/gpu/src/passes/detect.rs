//! Gap detection (paper, Theorem 3.2 and Algorithm 3): which samples are detectors, which cells may hold gaps,
//! and the candidates in them.

use super::{
    Command, Pass, Size, argument, atomic, clear_counter, prepare, read, run, run_with, uniform_of,
    update, write,
};
use crate::constants::PREPARE_SPREAD;
use crate::layout::{Name, counter};
use crate::plan::WindowPlan;

pub(super) const DETECTORS: Pass = Pass {
    name: "detectors",
    shader: "detectors",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Starts),
        read(Name::Places),
        update(Name::Grid),
    ],
};

pub(super) const SPREAD: Pass = Pass {
    name: "spread",
    shader: "spread",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        read(Name::Unsure),
        atomic(Name::Grid),
        atomic(Name::Counters),
    ],
};

pub(super) const OPEN: Pass = Pass {
    name: "open",
    shader: "open",
    bindings: &[
        uniform_of(Name::Frame),
        atomic(Name::Grid),
        write(Name::List),
        write(Name::Unsure),
        atomic(Name::Counters),
    ],
};

pub(super) const REOPEN: Pass = Pass {
    name: "reopen",
    shader: "reopen",
    bindings: &[
        uniform_of(Name::Frame),
        atomic(Name::Grid),
        read(Name::List),
        write(Name::Unsure),
        atomic(Name::Counters),
    ],
};

pub(super) const CANDIDATES: Pass = Pass {
    name: "candidates",
    shader: "candidates",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        read(Name::Grid),
        read(Name::List),
        write(Name::Proposals),
        atomic(Name::Counters),
    ],
};

pub(super) const SETTLE: Pass = Pass {
    name: "settle",
    shader: "settle",
    bindings: &[
        uniform_of(Name::Frame),
        update(Name::Grid),
        read(Name::Counters),
    ],
};

/// Records the choice of the detectors of iteration 1.
pub(crate) fn detectors(plan: &WindowPlan) -> Vec<Command> {
    vec![run(&DETECTORS, Size::Invocations(plan.cells()))]
}

/// Records the detection of iteration 1. Unsure cells affect those within `reach` cells.
pub(crate) fn detect(plan: &WindowPlan, reach: u32) -> Vec<Command> {
    let mut commands = spread(reach);
    commands.push(open(plan));
    commands.extend(candidates(plan, 1));
    commands
}

/// Records the detection of a later iteration.
pub(crate) fn redetect(plan: &WindowPlan, reach: u32, iteration: u32) -> Vec<Command> {
    let mut commands = spread(reach);
    commands.push(run(&REOPEN, argument("ARGUMENT_OPEN")));
    commands.extend(candidates(plan, iteration));
    commands
}

/// Records the marking of the surroundings of unsure cells.
pub(super) fn spread(reach: u32) -> Vec<Command> {
    vec![
        prepare(0),
        run_with(&SPREAD, [reach, 0, 0, 0], argument("ARGUMENT_UNSURE")),
        prepare(PREPARE_SPREAD),
    ]
}

/// Records the pass that opens cells. Uniform insertion needs it only to mark unsure cells.
pub(super) fn open(plan: &WindowPlan) -> Command {
    run(&OPEN, Size::Invocations(plan.inner_cells()))
}

/// Finds the candidates of an iteration. The workgroups are computed anew from the counters before each pass.
fn candidates(plan: &WindowPlan, iteration: u32) -> Vec<Command> {
    vec![
        prepare(0),
        clear_counter(counter::PROPOSALS),
        run_with(
            &CANDIDATES,
            [iteration, 0, 0, 0],
            argument("ARGUMENT_OPEN_ROWS"),
        ),
        prepare(0),
        run(&SETTLE, Size::Invocations(plan.cells())),
    ]
}
