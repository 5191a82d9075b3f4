//! Questions about samples and darts, in the order of arrival. Levels follow each other; while one is decided, more
//! questions of it may come up.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::exact::darts::PlacedDart;
use crate::stages::darts::LAST_LEVEL;

/// A question whose answer may differ from that in the pattern, to be decided when its dart arrives.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Arriving {
    pub(crate) dart: PlacedDart,
    pub(crate) what: What,
}

/// The question that a dart's arrival brings up.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum What {
    /// Whether an earlier sample covers a present one, given by its id.
    Sample(u32),
    /// Whether no earlier sample covers a dart of the tile given by its index.
    Dart(u32),
}

/// All questions, level by level.
#[derive(Default)]
pub(crate) struct Agenda {
    /// The questions of each level.
    levels: [Vec<Arriving>; LAST_LEVEL as usize + 1],
    /// The level that is being decided; none before the first.
    deciding: Option<u32>,
    /// Its questions in the order of arrival, each a word: the first bits of the arrival, then the question's index in the level.
    order: Vec<u64>,
    /// How much of the level that is being decided is done.
    done: usize,
    /// Those questions of that level that came up since it began, as words like those of `order`.
    sudden: BinaryHeap<Reverse<u64>>,
}

impl Agenda {
    /// Removes all questions, so that another tiling can begin.
    pub(crate) fn clear(&mut self) {
        self.levels.iter_mut().for_each(Vec::clear);
        self.sudden.clear();
        self.deciding = None;
    }

    /// Adds a question, to be decided when its dart arrives.
    #[inline]
    pub(crate) fn add(&mut self, dart: PlacedDart, what: What) {
        let level = dart.arrival.level();
        let of_level = &mut self.levels[level as usize];
        if self.deciding == Some(level) {
            let word = word(dart.arrival.when(), of_level.len() as u32);
            self.sudden.push(Reverse(word));
        }
        of_level.push(Arriving { dart, what });
    }

    /// Begins a level, and returns how many questions are known to arrive with it.
    pub(crate) fn begin(&mut self, level: u32) -> usize {
        // Nearly everything is known when a level begins: to sort it once costs less than a heap of all. The first bits of
        // arrivals are sorted, each with its index in one word.
        let known = &self.levels[level as usize];
        let firsts = known.iter().map(|arriving| arriving.dart.arrival.when());
        let words = firsts.zip(0..).map(|(when, index)| word(when, index));
        let has_same = sort_words(words, known.len(), &mut self.order);

        // Those with the same first bits, which are rare, are compared as a whole.
        if has_same {
            self.order_same(level);
        }
        // The level before was decided to its end, so that `sudden` is empty.
        self.deciding = Some(level);
        self.done = 0;
        self.order.len()
    }

    /// Puts the questions with the same first bits in order.
    #[cold]
    fn order_same(&mut self, level: u32) {
        let known = &self.levels[level as usize];
        let is_same = |a: &u64, b: &u64| a >> 32 == b >> 32;
        for same in self.order.chunk_by_mut(is_same) {
            same.sort_unstable_by_key(|word| known[*word as u32 as usize]);
        }
    }

    /// Returns whether nothing is known to arrive with a level and those after it.
    pub(crate) fn is_empty_from(&self, level: u32) -> bool {
        self.levels[level as usize..].iter().all(Vec::is_empty)
    }

    /// Returns what arrives next with the level.
    #[inline]
    pub(crate) fn next(&mut self) -> Option<Arriving> {
        if !self.sudden.is_empty() {
            return self.next_with_sudden();
        }
        self.next_known()
    }

    /// Returns the next of the questions that were known when the level began.
    #[inline]
    fn next_known(&mut self) -> Option<Arriving> {
        let &word = self.order.get(self.done)?;
        self.done += 1;
        Some(self.question(word))
    }

    /// Returns the question of a word of the level that is being decided.
    #[inline]
    fn question(&self, word: u64) -> Arriving {
        let level = self.deciding.expect("a level has begun");
        self.levels[level as usize][word as u32 as usize]
    }

    /// Returns what arrives next, be it known when the level began or not: a question that came up late still comes in its turn.
    #[inline(never)]
    fn next_with_sudden(&mut self) -> Option<Arriving> {
        let &Reverse(sudden) = self.sudden.peek()?;
        // The upper halves of words are the first bits of arrivals.
        match self.order.get(self.done) {
            Some(known) if known >> 32 < sudden >> 32 => return self.next_known(),
            Some(known) if known >> 32 == sudden >> 32 => return self.next_of_same(sudden),
            // The sudden one is earlier, or no known one is left.
            _ => {}
        }

        // Another sudden one may have the same first bits: then all of these are compared as a whole.
        self.sudden.pop();
        let is_same = |Reverse(other): &Reverse<u64>| other >> 32 == sudden >> 32;
        if self.sudden.peek().is_some_and(is_same) {
            self.sudden.push(Reverse(sudden));
            return self.next_of_same(sudden);
        }
        Some(self.question(sudden))
    }

    /// Returns the first of all questions that have the same first bits as a word, compared as a whole.
    #[cold]
    fn next_of_same(&mut self, word: u64) -> Option<Arriving> {
        // Those that came up since the level began; the one of `word` is among them.
        let mut same = Vec::new();
        while let Some(&Reverse(other)) = self.sudden.peek()
            && other >> 32 == word >> 32
        {
            same.push(other);
            self.sudden.pop();
        }
        let first = (0..same.len()).min_by_key(|&index| self.question(same[index]))?;

        // The questions known when the level began are in order already.
        let known = self
            .order
            .get(self.done)
            .filter(|known| **known >> 32 == word >> 32);
        let is_known_first =
            known.is_some_and(|&known| self.question(known) <= self.question(same[first]));
        let found = if is_known_first {
            self.next_known()
        } else {
            Some(self.question(same.swap_remove(first)))
        };
        // All but the one returned wait on.
        self.sudden.extend(same.into_iter().map(Reverse));
        found
    }
}

/// Returns the word of a question: the first bits of its arrival, then its index in the level.
fn word(when: u32, index: u32) -> u64 {
    u64::from(when) << 32 | u64::from(index)
}

/// The lower bits of a word, in which words of one level differ: two of the throw and 26 of the rank, and below them
/// the 32 of the index.
const LEVEL_BITS: u32 = 2 + 26 + 32;

/// Puts words of one level, as [`Agenda::begin`] makes them, into `out` in ascending order.
///
/// Ranks are uniform draws: one pass puts each word about where it belongs, and few are left to be moved past each other. That
/// takes a quarter of the instructions of a sort that only compares. Returns whether two words have the same upper half.
fn sort_words(words: impl Iterator<Item = u64> + Clone, count: usize, out: &mut Vec<u64>) -> bool {
    // As many buckets as words, or up to twice as many.
    let bits = count.next_power_of_two().ilog2();
    let bucket = |word: u64| ((word & ((1 << LEVEL_BITS) - 1)) >> (LEVEL_BITS - bits)) as usize;

    // Each count stands one place behind its bucket, so that the sums are where the buckets begin.
    let mut next_free = vec![0_u32; (1 << bits) + 1];
    for word in words.clone() {
        next_free[bucket(word) + 1] += 1;
    }
    let mut sum = 0;
    for begin in &mut next_free {
        sum += *begin;
        *begin = sum;
    }

    out.clear();
    out.resize(count, 0);
    for word in words {
        // Each word takes the first free place of its bucket.
        let at = &mut next_free[bucket(word)];
        out[*at as usize] = word;
        *at += 1;
    }

    // Buckets follow each other in order: each word is moved back past the larger ones of its own bucket alone.
    let mut has_same = false;
    for index in 1..count {
        let word = out[index];
        let mut at = index;
        while at > 0 && out[at - 1] > word {
            out[at] = out[at - 1];
            at -= 1;
        }
        out[at] = word;
        // Of words with the same upper half, any but the first meets another one of them when it comes.
        has_same |= at > 0 && out[at - 1] >> 32 == word >> 32;
    }
    has_same
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Key, Stream};

    #[test]
    fn words_are_sorted_whatever_their_number_and_however_crowded() {
        for count in [0, 1, 2, 3, 100, 1025] {
            for level in [0_u64, 1, 15] {
                for kept in [u32::MAX >> 6, 0xff] {
                    let word = |index: u32| {
                        let drawn = Key::from_seed(level).draw(Stream::Order, index)[0] & kept;
                        level << LEVEL_BITS | u64::from(drawn) << 32 | u64::from(index)
                    };
                    let mut sorted = vec![3];
                    let has_same = sort_words((0..count).map(word), count as usize, &mut sorted);
                    let mut expected: Vec<u64> = (0..count).map(word).collect();
                    expected.sort_unstable();
                    assert_eq!(sorted, expected);
                    let meets = |pair: &[u64]| pair[0] >> 32 == pair[1] >> 32;
                    assert_eq!(has_same, expected.windows(2).any(meets));
                }
            }
        }
    }
}
