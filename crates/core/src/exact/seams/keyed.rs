//! Lists of what belongs to samples of a tile, found by the tile and the last bits of a sample's number.

/// How many lists there are. A power of two, and about the number of a window's entries.
const LISTS: usize = 4096;

/// Behind the last entry of a list.
const END: u32 = u32::MAX;

/// The samples of a tile whose numbers end in the same eight bits.
#[derive(Clone, Copy, PartialEq, Eq)]
struct SampleKey(u32);

impl SampleKey {
    /// No frame has 2^24 tiles.
    const fn new(tile: u32, number: u32) -> Self {
        Self(tile << 8 | (number % 256))
    }

    const fn list(self) -> usize {
        self.0 as usize % LISTS
    }
}

/// Entries by samples of tiles. What a sample has may come with entries of other samples.
pub(super) struct KeyedLists<T> {
    /// Each with its key, and the next one of its list.
    entries: Vec<(T, SampleKey, u32)>,
    firsts: Vec<u32>,
}

impl<T> Default for KeyedLists<T> {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
            firsts: Vec::new(),
        }
    }
}

impl<T: Copy> KeyedLists<T> {
    /// Removes all entries.
    pub(super) fn clear(&mut self) {
        self.entries.clear();
        self.firsts.clear();
        self.firsts.resize(LISTS, END);
    }

    /// Adds an entry to a sample of a tile, of whose number the last eight bits are enough.
    #[inline]
    pub(super) fn add(&mut self, tile: u32, number: u32, entry: T) {
        let key = SampleKey::new(tile, number);
        let first = &mut self.firsts[key.list()];
        let next = std::mem::replace(first, self.entries.len() as u32);
        self.entries.push((entry, key, next));
    }

    /// Returns the entries of a sample of a tile, and perhaps some of other samples.
    #[inline]
    pub(super) fn of(&self, tile: u32, number: u32) -> impl Iterator<Item = T> {
        let key = SampleKey::new(tile, number);
        let mut index = self.firsts[key.list()];
        let in_list = std::iter::from_fn(move || {
            let (entry, held, next) = self.entries.get(index as usize)?;
            index = *next;
            Some((*entry, *held))
        });
        let of_key = in_list.filter(move |(_, held)| *held == key);
        of_key.map(|(entry, _)| entry)
    }
}
