//! Exact tiling: the pattern's samples are laid down with the arrivals of their darts, and what follows from the
//! borders of blocks is decided throw by throw, in rounds.
//!
//! *The rule.* A dart is a sample unless an earlier sample covers it. Samples of earlier throws are final. In each round every
//! question of a throw is answered from the samples as they are, and the answers become the new states. The earliest dart is
//! right after the first round, and a dart whose earlier neighbours are right is right after the next one. So rounds come to
//! states that no round changes; by induction over the order of arrival these are the only ones that fulfil the rule.
//!
//! *Which darts are questions.* A sample of the pattern may be lost if it lies within r of its block's border, or if a
//! dart has become a sample within r of it (`warn`). A dart that the pattern refused may become a sample if the sample
//! that refused it lies in another block or was lost: then its cell is marked, and throws its darts (`lay`, `decide`).
//! Superfluous questions, such as those that a wrong state of an earlier round brought up, only cost time: the rule
//! holds for all darts.

use super::tile::{ADD_STARTS, SCAN_STARTS, sum};
use super::{
    Command, Pass, Size, argument, atomic, clear_counter, read, run, run_with, uniform_of, update,
    write,
};
use crate::constants::{PREPARE_FIRST, PREPARE_LINKED, PREPARE_NEXT_CELLS, PREPARE_THROWN};
use crate::layout::{Ground, Name, counter};

pub(super) const PREPARE_DARTS: Pass = Pass {
    name: "prepare darts",
    shader: "prepare_darts",
    bindings: &[
        uniform_of(Name::Ground),
        uniform_of(Name::Job),
        update(Name::Counters),
        write(Name::Arguments),
    ],
};

pub(super) const LAY: Pass = Pass {
    name: "lay",
    shader: "lay",
    bindings: &[
        uniform_of(Name::Ground),
        read(Name::LaidPieces).named("pieces"),
        read(Name::Pattern),
        write(Name::Darts),
        write(Name::States),
        atomic(Name::Marks),
        write(Name::FreshCells),
        atomic(Name::Counters),
    ],
};

pub(super) const LINK_DARTS: Pass = Pass {
    name: "link darts",
    shader: "link_darts",
    bindings: &[
        uniform_of(Name::Ground),
        update(Name::Darts),
        atomic(Name::Heads),
        atomic(Name::Counters),
    ],
};

pub(super) const CUT_CELLS: Pass = Pass {
    name: "cut cells",
    shader: "cut_cells",
    bindings: &[
        uniform_of(Name::Ground),
        uniform_of(Name::Job),
        read(Name::LaidPieces).named("pieces"),
        read(Name::OpenCells).named("cells"),
        write(Name::NextOpenCells).named("cells_out"),
        read(Name::Darts),
        read(Name::Heads),
        read(Name::States),
        atomic(Name::Counters),
    ],
};

pub(super) const CUT_FRESH_CELLS: Pass = Pass {
    name: "cut fresh cells",
    shader: "cut_cells",
    bindings: &[
        uniform_of(Name::Ground),
        uniform_of(Name::Job),
        read(Name::LaidPieces).named("pieces"),
        read(Name::FreshCells).named("cells"),
        write(Name::OpenCells).named("cells_out"),
        read(Name::Darts),
        read(Name::Heads),
        read(Name::States),
        atomic(Name::Counters),
    ],
};

pub(super) const THROW_DARTS: Pass = Pass {
    name: "throw darts",
    shader: "throw_darts",
    bindings: &[
        uniform_of(Name::Ground),
        uniform_of(Name::Job),
        read(Name::LaidPieces).named("pieces"),
        read(Name::OpenCells).named("cells"),
        update(Name::Darts),
        read(Name::Heads),
        update(Name::States),
        write(Name::Questions),
        atomic(Name::Counters),
    ],
};

pub(super) const ENLIST: Pass = Pass {
    name: "enlist",
    shader: "enlist",
    bindings: &[
        uniform_of(Name::Job),
        read(Name::Darts),
        read(Name::States),
        write(Name::Questions),
        atomic(Name::Counters),
    ],
};

pub(super) const JUDGE: Pass = Pass {
    name: "judge",
    shader: "judge",
    bindings: &[
        uniform_of(Name::Ground),
        read(Name::Darts),
        read(Name::Heads),
        read(Name::States),
        read(Name::Questions),
        write(Name::Verdicts),
        read(Name::Counters),
    ],
};

pub(super) const WARN: Pass = Pass {
    name: "warn",
    shader: "warn",
    bindings: &[
        uniform_of(Name::Ground),
        read(Name::Darts),
        read(Name::Heads),
        atomic(Name::States),
        update(Name::Questions),
        read(Name::Verdicts),
        atomic(Name::Counters),
    ],
};

pub(super) const DECIDE: Pass = Pass {
    name: "decide",
    shader: "decide",
    bindings: &[
        uniform_of(Name::Ground),
        read(Name::LaidPieces).named("pieces"),
        read(Name::Darts),
        update(Name::States),
        read(Name::Questions),
        read(Name::Verdicts),
        atomic(Name::Marks),
        write(Name::FreshCells),
        atomic(Name::Counters),
    ],
};

pub(super) const UNLINK_DARTS: Pass = Pass {
    name: "unlink darts",
    shader: "unlink_darts",
    bindings: &[
        uniform_of(Name::Ground),
        update(Name::Darts),
        update(Name::Heads),
        read(Name::States),
    ],
};

pub(super) const COUNT_SAMPLES: Pass = Pass {
    name: "count samples",
    shader: "count_samples",
    bindings: &[
        uniform_of(Name::Ground),
        read(Name::Darts),
        read(Name::Heads),
        write(Name::Starts),
    ],
};

pub(super) const COLLECT: Pass = Pass {
    name: "collect",
    shader: "collect",
    bindings: &[
        uniform_of(Name::Ground),
        read(Name::LaidPieces).named("pieces"),
        read(Name::Darts),
        read(Name::Heads),
        read(Name::Starts),
        write(Name::Result),
        write(Name::Tags),
    ],
};

/// A throw of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Throw {
    /// The level, whose cells have sides of 2 to the power of `side_bits`.
    pub level: u32,
    /// The number of the throw in its level.
    pub number: u32,
    /// The binary logarithm of the side of the level's cells.
    pub side_bits: u32,
    /// The words of the key from which its darts follow.
    pub key: [u32; 2],
}

impl Throw {
    /// Returns the throw as the labels of darts have it.
    const fn label(self) -> u32 {
        4 * self.level + self.number
    }
}

/// Records the laying down of the pattern's samples. The buffers may have any content before.
pub(crate) fn lay(ground: &Ground) -> Vec<Command> {
    vec![
        Command::Clear(Name::Counters, None),
        Command::Clear(Name::Heads, None),
        Command::Clear(Name::Marks, None),
        run(&LAY, Size::Invocations(ground.marks.into())),
        prepare_darts(0),
        run(&LINK_DARTS, argument("ARGUMENT_LINKED")),
        prepare_darts(PREPARE_LINKED),
    ]
}

/// Records the beginning of a throw: its cells, its darts and its questions. The first `own` darts are the pattern's samples.
pub(crate) fn begin(throw: Throw, own: u32) -> Vec<Command> {
    let mut commands = vec![clear_counter(counter::THROWN)];
    // When a level begins, the open cells are cut into cells of that level. Level 0 has no open cells yet: `thrown`
    // lists its first ones, the marked cells, which are as wide as that level needs.
    if throw.number == 0 && throw.level > 0 {
        let Throw { side_bits, .. } = throw;
        // The throw, the binary logarithms of the sides before and after, and the counter of the cells that are cut.
        let job = [throw.label(), side_bits + 1, side_bits, counter::OPEN_CELLS];
        commands.extend([
            prepare_darts(0),
            clear_counter(counter::NEXT_OPEN_CELLS),
            run_with(&CUT_CELLS, job, argument("ARGUMENT_OPEN_CELLS")),
            // The cells that were cut are the open ones from here on.
            prepare_darts(PREPARE_NEXT_CELLS),
            Command::SwapOpen,
        ]);
    }

    // The pattern's samples of this throw come first, then its darts.
    commands.extend([
        clear_counter(counter::QUESTIONS),
        run_with(
            &ENLIST,
            [throw.label(), own, 0, 0],
            Size::Invocations(own.into()),
        ),
    ]);
    commands.extend(thrown(throw, PREPARE_FIRST));
    commands
}

/// Records that the cells marked last are cut, and that all cells that have not thrown in this throw do so. The last
/// preparation gets `flags`, beside that for linked darts.
fn thrown(throw: Throw, flags: u32) -> Vec<Command> {
    let Throw { side_bits, key, .. } = throw;
    // A cell is left out if a sample of an earlier throw covers it. Samples of this throw do not count, as they may
    // still be lost. The four numbers have the same meanings as those of the job in `begin`.
    let cut = [
        throw.label(),
        // Marked cells have sides of R.
        crate::constants::MARK_BITS,
        side_bits,
        counter::FRESH_CELLS,
    ];
    let [a, b] = key;

    // Workgroups are computed anew before each pass over a list that the pass before has made longer.
    vec![
        prepare_darts(0),
        run_with(&CUT_FRESH_CELLS, cut, argument("ARGUMENT_FRESH_CELLS")),
        clear_counter(counter::FRESH_CELLS),
        prepare_darts(0),
        run_with(
            &THROW_DARTS,
            [a, b, side_bits, throw.label()],
            argument("ARGUMENT_THROWN"),
        ),
        // Darts are linked only now, since searches follow the links while darts are thrown.
        prepare_darts(PREPARE_THROWN),
        run(&LINK_DARTS, argument("ARGUMENT_LINKED")),
        prepare_darts(PREPARE_LINKED | flags),
    ]
}

/// Records `rounds` rounds of a throw. A round after one that changed nothing does nothing.
pub(crate) fn rounds_of(throw: Throw, rounds: u32) -> Vec<Command> {
    let judged = || argument("ARGUMENT_JUDGED");
    let round = |_| {
        // All questions are judged by the same states, so that no answer depends on the sequence of invocations.
        let mut commands = vec![
            clear_counter(counter::CHANGED),
            run(&JUDGE, judged()),
            run(&WARN, judged()),
            run(&DECIDE, judged()),
        ];
        // Losses have marked cells, whose darts are questions of the next round.
        let no_flags = 0;
        commands.extend(thrown(throw, no_flags));
        commands
    };
    (0..rounds).flat_map(round).collect()
}

/// Records the end of a throw: no list has a dart that is no sample.
pub(crate) fn end(ground: &Ground) -> Command {
    run(&UNLINK_DARTS, Size::Invocations(ground.cells.into()))
}

/// Records the counting of the samples, cell by cell, and its prefix sums.
pub(crate) fn finish_exact(ground: &Ground) -> Vec<Command> {
    // One entry more than there are cells: its sum is the total, and the end of the last cell.
    let length = u64::from(ground.cells) + 1;
    let mut commands = vec![run(&COUNT_SAMPLES, Size::Invocations(length))];
    let no_limit = u32::MAX;
    commands.extend(sum(
        &SCAN_STARTS,
        &ADD_STARTS,
        length,
        counter::KEPT,
        no_limit,
    ));
    commands
}

/// Records the collection of the samples in canonical order.
pub(crate) fn collect(ground: &Ground) -> Command {
    run(&COLLECT, Size::Invocations(ground.cells.into()))
}

/// Returns the command that updates the workgroups of exact tiling's indirect dispatches. `flags` are those of
/// `PREPARE_*` for darts.
fn prepare_darts(flags: u32) -> Command {
    run_with(&PREPARE_DARTS, [flags, 0, 0, 0], Size::Workgroups(1))
}
