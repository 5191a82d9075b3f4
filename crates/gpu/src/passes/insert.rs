//! Insertion (paper, Algorithm 4, second loop): the greedy independent set of the proposals, in rounds.

use super::{
    Command, Pass, alternating, argument, atomic, read, run, run_with, uniform_of, update, write,
};
use crate::layout::{Name, counter};

/// Rounds between two readings of the counters, an even number (`alternating`). Chosen, not measured.
const ROUNDS: u32 = 6;

pub(super) const LINK: Pass = Pass {
    name: "link",
    shader: "link",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        update(Name::Proposals),
        atomic(Name::Heads),
        atomic(Name::Counters),
    ],
};

pub(super) const CHOOSE: Pass = Pass {
    name: "choose",
    shader: "choose",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        atomic(Name::Proposals),
        atomic(Name::Heads),
        read(Name::Grid),
        atomic(Name::Counters),
    ],
};

pub(super) const PLACE: Pass = Pass {
    name: "place",
    shader: "place",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        atomic(Name::Proposals),
        atomic(Name::Grid),
        write(Name::Unsure),
        atomic(Name::Counters),
    ],
};

pub(super) const UNLINK: Pass = Pass {
    name: "unlink",
    shader: "unlink",
    bindings: &[
        uniform_of(Name::Frame),
        read(Name::Proposals),
        write(Name::Heads),
        read(Name::Counters),
    ],
};

/// Records the insertion of `iteration`. Ranks are drawn with `key`; without a key they come with the proposals.
pub(crate) fn insert(iteration: u32, key: Option<[u32; 2]>) -> Vec<Command> {
    let [a, b] = key.unwrap_or_default();
    let ranked = u32::from(key.is_none());
    let mut commands = vec![
        Command::Clear(
            Name::Counters,
            Some((counter::INSERTED, counter::INSERTED_IN_WINDOW + 1)),
        ),
        run_with(&LINK, [a, b, ranked, 0], argument("ARGUMENT_PROPOSALS")),
    ];
    let is_first = true;
    commands.extend(decide(iteration, is_first));
    commands
}

/// Records further rounds, and the insertion of the proposals that they decide.
pub(crate) fn choose(iteration: u32) -> Vec<Command> {
    let is_first = false;
    decide(iteration, is_first)
}

fn decide(iteration: u32, is_first: bool) -> Vec<Command> {
    let mut commands = alternating(&CHOOSE, "ARGUMENT_PROPOSALS", ROUNDS, is_first);
    let proposals = argument("ARGUMENT_PROPOSALS");
    commands.push(run_with(&PLACE, [iteration, 0, 0, 0], proposals));
    commands
}

/// Records the end of an iteration.
pub(crate) fn unlink() -> Command {
    run(&UNLINK, argument("ARGUMENT_PROPOSALS"))
}
