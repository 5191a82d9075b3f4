//! Which crate needs how many bytes, in which of the two modules: the first one, with which the program starts, or the
//! later one, which is loaded when one of its functions is called. A *stub* stands in the first module for a function
//! of the later one; small functions of the first module have a *copy* in the later one.

use std::collections::BTreeMap;
use std::fmt;

use super::program::Program;
use super::reach::Plan;
use super::rule::crate_of;
use crate::compress;

/// The code of a crate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Weight {
    /// Its bytes in the first and in the later module.
    bytes: [usize; 2],
    /// The bytes of its code in the first module after compression. The code is compressed alone and quickly: in the whole
    /// module it takes less, so that only the share of the sum means something.
    compressed: usize,
}

impl std::ops::Add for Weight {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let [first, later] = self.bytes;
        Self {
            bytes: [first + other.bytes[0], later + other.bytes[1]],
            compressed: self.compressed + other.compressed,
        }
    }
}

/// The code of each crate in the first and in the later module.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Weights {
    crates: BTreeMap<String, Weight>,
}

/// Crates with fewer bytes than this are shown together. Chosen, not measured.
const MIN_SHOWN: usize = 20_000;

impl Weights {
    /// Adds up the code of all functions. Stubs and copies are not counted.
    pub fn of(program: &Program<'_>, plan: &Plan) -> Self {
        let mut codes = BTreeMap::<String, [Vec<u8>; 2]>::new();
        for (index, function) in program.own().zip(&program.functions) {
            let code = codes
                .entry(crate_of(&function.name).to_owned())
                .or_default();
            let is_later = plan.later.contains(&index);
            code[usize::from(is_later)].extend_from_slice(function.body.as_bytes());
        }

        // Crates are compressed one by one: what they have in common counts for each of them.
        let weighed = codes.into_iter().map(|(name, [first, later])| {
            let weight = Weight {
                bytes: [first.len(), later.len()],
                compressed: compress::quick_len(&first),
            };
            (name, weight)
        });
        Self {
            crates: weighed.collect(),
        }
    }
}

impl fmt::Display for Weights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows: Vec<(&str, Weight)> = self
            .crates
            .iter()
            .map(|(name, weight)| (name.as_str(), *weight))
            .collect();
        // The crate with the most code comes first, in whichever module the code is: most can be saved there.
        let sum = |weight: &Weight| weight.bytes[0] + weight.bytes[1];
        rows.sort_by_key(|(_, weight)| std::cmp::Reverse(sum(weight)));

        let (shown, small) =
            rows.split_at(rows.partition_point(|(_, weight)| sum(weight) >= MIN_SHOWN));
        let all = |rows: &[(&str, Weight)]| {
            let weights = rows.iter().map(|(_, weight)| *weight);
            weights.fold(Weight::default(), |sum, weight| sum + weight)
        };

        let [code, share] = ["code, bytes by crate", "of first, compressed"];
        writeln!(f, "{code:26} {:>10} {:>10} {share:>21}", "first", "later")?;
        let others = format!("{} others", small.len());
        let ends = [(others.as_str(), all(small)), ("all", all(&rows))];
        // An empty module has no shares.
        let total = all(&rows).compressed.max(1);
        for (name, weight) in shown.iter().chain(&ends) {
            let [first, later] = weight.bytes;
            let percent = 100.0 * weight.compressed as f64 / total as f64;
            writeln!(f, "{name:26} {first:>10} {later:>10} {percent:>20.1}%")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_what_the_first_module_has_compressed() {
        let weight = |first, later, compressed| Weight {
            bytes: [first, later],
            compressed,
        };
        let crates = [
            ("core", weight(60_000, 0, 300)),
            ("later", weight(0, 90_000, 0)),
            ("small", weight(10, 0, 60)),
            ("tiny", weight(5, 5, 40)),
        ];
        let crates = crates.map(|(name, weight)| (name.to_owned(), weight));
        let text = Weights {
            crates: crates.into(),
        }
        .to_string();
        let rows: Vec<Vec<&str>> = text
            .lines()
            .skip(1)
            .map(|line| line.split_whitespace().collect())
            .collect();
        assert_eq!(
            rows,
            [
                vec!["later", "0", "90000", "0.0%"],
                vec!["core", "60000", "0", "75.0%"],
                vec!["2", "others", "15", "5", "25.0%"],
                vec!["all", "60015", "90005", "100.0%"],
            ]
        );
    }
}
