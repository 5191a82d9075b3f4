//! Compaction: the samples of the window in canonical order.

use super::tile::sum;
use super::{Command, Pass, Size, read, run, uniform_of, update, write};
use crate::layout::{Name, counter};
use crate::plan::WindowPlan;

pub(super) const TALLY: Pass = Pass {
    name: "tally",
    shader: "tally",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Grid),
        write(Name::Heads),
    ],
};

pub(super) const SCAN_HEADS: Pass = Pass {
    name: "scan counts",
    shader: "scan",
    bindings: &[
        uniform_of(Name::Job),
        update(Name::Heads).named("data"),
        write(Name::Sums),
    ],
};

pub(super) const ADD_HEADS: Pass = Pass {
    name: "add counts",
    shader: "scan_add",
    bindings: &[
        uniform_of(Name::Job),
        update(Name::Heads).named("data"),
        read(Name::Sums),
    ],
};

pub(super) const GATHER: Pass = Pass {
    name: "gather",
    shader: "gather",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Grid),
        read(Name::Heads),
        write(Name::Result),
    ],
};

pub(super) const SOURCES: Pass = Pass {
    name: "sources",
    shader: "sources",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Images),
        read(Name::Starts),
        read(Name::Places),
        read(Name::Origins),
        read(Name::Grid),
        read(Name::Heads),
        read(Name::Result),
        write(Name::Tags),
    ],
};

/// Records the stage. With `sources` it writes the source of each sample.
pub(crate) fn finish(plan: &WindowPlan, sources: bool) -> Vec<Command> {
    let cells = Size::Invocations(plan.cells());
    // One entry more than there are cells: its sum is the total, and the end of the last cell.
    let mut commands = vec![run(&TALLY, Size::Invocations(plan.cells() + 1))];
    commands.extend(sum(
        &SCAN_HEADS,
        &ADD_HEADS,
        plan.cells() + 1,
        counter::KEPT,
        // There is no limit, as `gather` itself checks that samples fit the result.
        u32::MAX,
    ));

    commands.push(run(&GATHER, cells));

    if sources {
        commands.push(run(&SOURCES, cells));
    }
    commands
}
