//! The compute passes, in the order of the stages. Each names its shader and the buffers that it binds. A stage is
//! recorded as a list of commands; recording needs no device.

mod blocks;
mod detect;
mod eliminate;
mod exact;
mod finish;
mod insert;
mod tile;
mod uniform;

use crate::layout::{Access, Binding, Job, Name, counter};
use crate::shader::FILES;

pub(crate) use blocks::blocks;
pub(crate) use detect::{detect, detectors, redetect};
pub(crate) use eliminate::{eliminate, rounds, survive};
pub(crate) use exact::{Throw, begin, collect, end, finish_exact, lay, rounds_of};
pub(crate) use finish::finish;
pub(crate) use insert::{choose, insert, unlink};
pub(crate) use tile::tile;
pub(crate) use uniform::{level, split, start};

/// A compute pass: its shader and the buffers that it binds.
#[derive(Debug, PartialEq, Eq)]
pub struct Pass {
    /// Its name in reports.
    pub name: &'static str,
    /// The shader file with its entry point.
    pub shader: &'static str,
    /// The buffers that it binds, numbered in this order.
    pub bindings: &'static [Binding],
}

/// How many invocations a dispatch has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// One for each of this many elements.
    Invocations(u64),
    /// This many workgroups of `WORKGROUP` invocations.
    Workgroups(u64),
    /// A number that the pass `prepare` computed for an argument, given by its index in `ARGUMENTS`.
    Indirect(u32),
}

/// A command of a stage, recorded before it is submitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Runs a pass once.
    Dispatch {
        /// The pass that runs.
        pass: &'static Pass,
        /// The numbers that its shader reads.
        job: Job,
        /// How many invocations it has.
        size: Size,
    },
    /// Sets words of a buffer to 0: a half-open range, or all.
    Clear(Name, Option<(u32, u32)>),
    /// Swaps the lists of active cells of this level and the next.
    SwapActive,
    /// Swaps the lists of open cells of this level and the next, of an exact tiling.
    SwapOpen,
}

/// Every pass, in the order of the stages: those of randomized tiling, then those of exact tiling.
pub const ALL: &[&Pass] = &[
    &PREPARE,
    &blocks::BLOCKS,
    &blocks::SORT_BLOCKS,
    &tile::COUNT,
    &tile::SCAN_STARTS,
    &tile::SCAN_SUMS,
    &tile::ADD_STARTS,
    &tile::TILE,
    &eliminate::ELIMINATE,
    &eliminate::ATTRIBUTE,
    &eliminate::SURVIVE,
    &detect::DETECTORS,
    &detect::SPREAD,
    &detect::OPEN,
    &detect::REOPEN,
    &detect::CANDIDATES,
    &detect::SETTLE,
    &insert::LINK,
    &insert::CHOOSE,
    &insert::PLACE,
    &insert::UNLINK,
    &uniform::GAP_CELLS,
    &uniform::THROW,
    &uniform::SPLIT,
    &finish::TALLY,
    &finish::SCAN_HEADS,
    &finish::ADD_HEADS,
    &finish::GATHER,
    &finish::SOURCES,
    &exact::PREPARE_DARTS,
    &exact::LAY,
    &exact::LINK_DARTS,
    &exact::CUT_CELLS,
    &exact::CUT_FRESH_CELLS,
    &exact::THROW_DARTS,
    &exact::ENLIST,
    &exact::JUDGE,
    &exact::WARN,
    &exact::DECIDE,
    &exact::UNLINK_DARTS,
    &exact::COUNT_SAMPLES,
    &exact::COLLECT,
];

/// Returns the description of the pass of this name: the head of its shader, as one text. `None` if there is no such
/// pass.
#[must_use]
pub fn meaning(name: &str) -> Option<String> {
    let pass = ALL.iter().find(|pass| pass.name == name)?;
    let (_, source) = FILES.iter().find(|(file, _)| *file == pass.shader)?;
    let remarks = source.lines().map_while(|line| line.strip_prefix("// "));
    let head = remarks.take_while(|line| !line.starts_with("import:"));
    Some(head.collect::<Vec<_>>().join(" "))
}

/// Computes the workgroups of indirect dispatches from counters.
const PREPARE: Pass = Pass {
    name: "prepare",
    shader: "prepare",
    bindings: &[
        uniform_of(Name::Frame),
        uniform_of(Name::Job),
        update(Name::Counters),
        write(Name::Arguments),
    ],
};

const fn binding(name: Name, access: Access) -> Binding {
    Binding {
        name,
        access,
        alias: None,
    }
}

const fn uniform_of(name: Name) -> Binding {
    binding(name, Access::Uniform)
}

const fn read(name: Name) -> Binding {
    binding(name, Access::Read)
}

const fn write(name: Name) -> Binding {
    binding(name, Access::Write)
}

const fn update(name: Name) -> Binding {
    binding(name, Access::Update)
}

const fn atomic(name: Name) -> Binding {
    binding(name, Access::Atomic)
}

impl Binding {
    /// Returns the binding with another name in the shader.
    const fn named(self, alias: &'static str) -> Self {
        Self {
            alias: Some(alias),
            ..self
        }
    }
}

/// Returns the command that runs a pass whose shader reads no numbers of a job.
fn run(pass: &'static Pass, size: Size) -> Command {
    run_with(pass, [0; 4], size)
}

/// Returns the command that runs a pass with the numbers of its job.
fn run_with(pass: &'static Pass, [a, b, c, d]: [u32; 4], size: Size) -> Command {
    let job = Job { a, b, c, d };
    Command::Dispatch { pass, job, size }
}

/// Returns the command that updates the workgroups of indirect dispatches. `flags` are those of `PREPARE_*`, and 0 asks
/// for nothing else.
fn prepare(flags: u32) -> Command {
    run_with(&PREPARE, [flags, 0, 0, 0], Size::Workgroups(1))
}

/// Returns the command that sets a counter to 0.
const fn clear_counter(counter: u32) -> Command {
    Command::Clear(Name::Counters, Some((counter, counter + 1)))
}

/// Returns `rounds` rounds of a pass, an even number, so that the last one counts in the second counter, which the host
/// reads, and further rounds begin with the first again. Each begins by setting its counter to 0. The round that
/// `is_first` of its stage has no round before, and always runs.
fn alternating(pass: &'static Pass, size: &str, rounds: u32, is_first: bool) -> Vec<Command> {
    // Two counters in turn: a round reads whether the round before left anything, while it writes its own.
    let round = |k: u32| {
        let is_first = u32::from(is_first && k == 0);
        [
            clear_counter(counter::UNDECIDED + k % 2),
            run_with(pass, [k % 2, is_first, 0, 0], argument(size)),
        ]
    };
    (0..rounds).flat_map(round).collect()
}

/// Returns the size of an indirect dispatch by the name of its argument.
///
/// # Panics
///
/// When there is no argument of this name. A test that records all lists finds that.
fn argument(name: &str) -> Size {
    let index = crate::constants::ARGUMENTS
        .iter()
        .position(|argument| *argument == name);
    Size::Indirect(index.expect("arguments are named in constants.rs") as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pass_says_what_it_does() {
        for pass in ALL {
            let meaning = meaning(pass.name).expect(pass.name);
            assert!(
                meaning.ends_with('.') && meaning.len() > 20,
                "{}: {meaning}",
                pass.name
            );
            assert!(!meaning.contains("import"), "{}: {meaning}", pass.name);
        }
        assert_eq!(meaning("nothing"), None);
    }
}
