//! Random choices: the order in which a question shows its list, and the answers of a guesser.

use tilescope_core::{Key, Stream, below};

/// Returns the key of the draws of a question. It depends on the question's name too, so that the questions of one run are
/// not all shuffled alike.
pub(crate) fn key(gate: &str, seed: u64) -> Key {
    let hash = blake3::hash(gate.as_bytes());
    let [a, b, c, d, ..] = *hash.as_bytes();
    Key::from_seed(seed).derive(Stream::Order, u32::from_le_bytes([a, b, c, d]))
}

/// Returns the indices in the file of a number of options in the order in which they are shown, of which one is right. Of as
/// many successive seeds as there are options each shows the right one at another place, so that no place is right more
/// often than the others.
pub(crate) fn balanced(gate: &str, count: usize, right: usize, seed: u64) -> Vec<usize> {
    // `count` successive seeds share one shuffle of the places, and each of them takes another one.
    let mut places: Vec<usize> = (0..count).collect();
    shuffle(&mut places, key(gate, seed / count as u64));
    let place = places[(seed % count as u64) as usize];

    let mut order: Vec<usize> = (0..count).filter(|&option| option != right).collect();
    shuffle(&mut order, key(gate, seed));
    order.insert(place, right);
    order
}

/// Shuffles items by the draws of a key (Fisher and Yates).
pub(crate) fn shuffle<T>(items: &mut [T], draws: Key) {
    for last in (1..items.len()).rev() {
        let other = below(draws.draw(Stream::Order, last as u32)[0], last as u32 + 1);
        items.swap(last, other as usize);
    }
}

/// What a guesser draws an answer from.
pub struct Dice {
    key: Key,
    /// How many answers were drawn before.
    attempt: u32,
}

impl Dice {
    pub(crate) const fn new(key: Key, attempt: u32) -> Self {
        Self { key, attempt }
    }

    fn pair(&self, index: u32) -> [u32; 2] {
        // An answer has fewer than 64 draws, so that those of two attempts differ.
        self.key.draw(Stream::Order, 64 * self.attempt + index)
    }

    /// Returns one of `count` numbers from 0; each index draws anew.
    pub(crate) fn draw(&self, index: u32, count: usize) -> usize {
        below(self.pair(index)[0], count.max(1) as u32) as usize
    }

    /// Returns a number in [0, 1).
    pub(crate) fn share(&self, index: u32) -> f64 {
        f64::from(self.pair(index)[1]) / 4_294_967_296.0
    }
}
