//! Clip and tile (paper, Algorithm 2): counts the samples of each cell, sums the counts up, and writes the samples. The
//! index of a sample does not depend on atomics.

use super::{Command, Pass, Size, atomic, read, run, run_with, uniform_of, update, write};
use crate::constants::SCAN_PART;
use crate::layout::{Name, counter};
use crate::plan::WindowPlan;

pub(super) const COUNT: Pass = Pass {
    name: "count",
    shader: "count",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Images),
        read(Name::TileImages),
        read(Name::Pattern),
        write(Name::Starts),
        atomic(Name::Counters),
    ],
};

pub(super) const SCAN_STARTS: Pass = Pass {
    name: "scan starts",
    shader: "scan",
    bindings: &[
        uniform_of(Name::Job),
        update(Name::Starts).named("data"),
        write(Name::Sums),
    ],
};

pub(super) const SCAN_SUMS: Pass = Pass {
    name: "scan sums",
    shader: "scan_sums",
    bindings: &[
        uniform_of(Name::Job),
        update(Name::Sums),
        write(Name::Counters),
    ],
};

pub(super) const ADD_STARTS: Pass = Pass {
    name: "add starts",
    shader: "scan_add",
    bindings: &[
        uniform_of(Name::Job),
        update(Name::Starts).named("data"),
        read(Name::Sums),
    ],
};

pub(super) const TILE: Pass = Pass {
    name: "tile",
    shader: "tile",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Images),
        read(Name::TileImages),
        read(Name::Pattern),
        read(Name::Starts),
        write(Name::Places),
        write(Name::Origins),
        write(Name::Heads).named("list"),
        atomic(Name::Counters),
    ],
};

/// Records the stage: counts, their prefix sums, and the samples.
pub(crate) fn tile(plan: &WindowPlan) -> Vec<Command> {
    // One entry more than there are cells: its sum is the total, and the end of the last cell.
    let mut commands = vec![run(&COUNT, Size::Invocations(plan.cells() + 1))];
    commands.extend(sum(
        &SCAN_STARTS,
        &ADD_STARTS,
        plan.cells() + 1,
        counter::TILED,
        // Where the samples do not fit their list, no cell's share may reach beyond it.
        plan.room().tiled,
    ));

    commands.push(run(&TILE, Size::Invocations(plan.cells())));
    commands
}

/// Records the prefix sum of a list of `length` elements. Sums above `limit` become `limit`, the end of the list that
/// they are indices of; the total, as it is, goes to a counter.
pub(super) fn sum(
    scan: &'static Pass,
    add: &'static Pass,
    length: u64,
    counter: u32,
    limit: u32,
) -> [Command; 3] {
    // The scans have no use for the fourth number of a job.
    let job = [length as u32, counter, limit, 0];
    let parts = length.div_ceil(SCAN_PART.into());

    // One workgroup is enough for the sums of the parts: each of its invocations adds up several.
    [
        run_with(scan, job, Size::Workgroups(parts)),
        run_with(&SCAN_SUMS, job, Size::Workgroups(1)),
        run_with(add, job, Size::Invocations(length)),
    ]
}
