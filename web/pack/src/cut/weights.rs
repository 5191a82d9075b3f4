//! Which crate needs how many bytes, in which of the two modules.

use std::collections::BTreeMap;
use std::fmt;

use super::program::Program;
use super::reach::Plan;
use super::rule::crate_of;

/// The bytes of code of each crate, in the first and in the later module.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Weights {
    crates: BTreeMap<String, [usize; 2]>,
}

/// Crates with fewer bytes than this are shown together.
const MIN_SHOWN: usize = 20_000;

impl Weights {
    /// Adds up the code of all functions. Stubs and copies are not counted.
    pub fn of(program: &Program<'_>, plan: &Plan) -> Self {
        let mut crates = BTreeMap::<String, [usize; 2]>::new();
        for (index, function) in program.own().zip(&program.functions) {
            let bytes = crates
                .entry(crate_of(&function.name).to_owned())
                .or_default();
            bytes[usize::from(plan.later.contains(&index))] += function.body.as_bytes().len();
        }
        Self { crates }
    }
}

impl fmt::Display for Weights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:26} {:>10} {:>10}",
            "code, bytes by crate", "first", "later"
        )?;
        let mut rows: Vec<(&str, [usize; 2])> = self
            .crates
            .iter()
            .map(|(name, bytes)| (name.as_str(), *bytes))
            .collect();
        let sum = |[first, later]: [usize; 2]| first + later;
        rows.sort_by_key(|(_, bytes)| std::cmp::Reverse(sum(*bytes)));

        let (shown, small) =
            rows.split_at(rows.partition_point(|(_, bytes)| sum(*bytes) >= MIN_SHOWN));
        let all = |rows: &[(&str, [usize; 2])]| {
            rows.iter().fold([0; 2], |[first, later], (_, bytes)| {
                [first + bytes[0], later + bytes[1]]
            })
        };
        let others = format!("{} others", small.len());
        let ends = [(others.as_str(), all(small)), ("all", all(&rows))];
        for (name, [first, later]) in shown.iter().chain(&ends) {
            writeln!(f, "{name:26} {first:>10} {later:>10}")?;
        }
        Ok(())
    }
}
