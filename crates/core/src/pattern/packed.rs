//! A pattern as bytes and back: 30 bits a sample, lossless, one form for each pattern.
//! Any bytes may be handed in; what is no packed pattern is refused. A right checksum is believed:
//! only this program writes such bytes, so conflicts and gaps are not looked for again.
//!
//! The form, little-endian: the mark, the version (`u32`), flags (`u32`: 1 bounded, 2 generated from
//! the seed that follows), width and height in lattice units (`u32` each), the seed (`u64`, 0 without
//! one), then bits, lowest first: of each cell of side `R`, rows of cells first, the number of its samples
//! in 2 bits and 30 bits a sample, x within the cell below y. Zeros fill the last byte, and
//! the checksum of everything before it ends the form (`u64`).

use thiserror::Error;

use super::Pattern;
use crate::lattice::{Boundary, Domain, MAX_SIDE_RADII, MIN_SIDE_RADII_BOUNDED, Point, R};

const MARK: [u8; 8] = *b"tilepatt";

/// Raised when the form changes, and when [`Pattern::generate`] makes other samples of a seed: what an
/// older program has kept is then made anew.
const VERSION: u32 = 1;

const BOUNDED: u32 = 1;
const SEEDED: u32 = 2;
const HEADER_BYTES: usize = 32;
const CHECKSUM_BYTES: usize = 8;

/// Bits of a cell's number of samples. Four samples in a cell would conflict: no four points of a
/// square of side `R - 1` are all farther than `R` from each other.
const COUNT_BITS: u32 = 2;

/// Bits of a position within a cell: 15 of y, 15 of x.
const PLACE_BITS: u32 = 30;

/// Sides of any pattern, in units. A quotient of side and radius may be rounded to one unit less.
const MIN_SIDE: u32 = MIN_SIDE_RADII_BOUNDED as u32 * R as u32 - 1;
const MAX_SIDE: u32 = MAX_SIDE_RADII as u32 * R as u32;

impl Pattern {
    /// Returns the pattern in its packed form: about 4.1 bytes a sample. Equal patterns made from
    /// equal seeds give equal bytes.
    ///
    /// ```
    /// use tilescope_core::{Pattern, PatternSpec, Unobserved};
    ///
    /// let spec = PatternSpec { side: 12.5, ..PatternSpec::default() };
    /// let pattern = Pattern::generate(&spec, &mut Unobserved)?;
    /// let unpacked = Pattern::from_packed(&pattern.to_packed()).expect("packed above");
    /// assert_eq!(unpacked, pattern);
    /// assert!(unpacked.is_of(&spec));
    /// # Ok::<(), tilescope_core::SampleError>(())
    /// ```
    #[must_use]
    pub fn to_packed(&self) -> Vec<u8> {
        let mut bits = BitWriter {
            bytes: header(self),
            word: 0,
            held: 0,
        };
        let (columns, rows) = cells(&self.domain);
        let mut rest = &self.samples[..];
        for row in 0..rows {
            for column in 0..columns {
                let cell = cell_of(Point::new(column << 15, row << 15));
                let count = rest.iter().take_while(|&&p| cell_of(p) == cell).count();
                debug_assert!(count < 1 << COUNT_BITS, "samples in conflict");
                bits.put(count as u32, COUNT_BITS);
                for &p in &rest[..count] {
                    bits.put(place_in_cell(p), PLACE_BITS);
                }
                rest = &rest[count..];
            }
        }
        debug_assert!(rest.is_empty(), "samples out of order");
        let mut bytes = bits.finish();
        bytes.extend(checksum(&bytes).to_le_bytes());
        bytes
    }

    /// Returns the pattern of a packed form.
    ///
    /// Whatever the bytes are, nothing panics, and memory is taken for about twice their length.
    /// A pattern that is returned packs to the same bytes; its samples lie in its domain, in
    /// canonical order. That they are conflict-free and maximal is believed of bytes with a right
    /// checksum.
    pub fn from_packed(bytes: &[u8]) -> Result<Self, PackedError> {
        let body = checked_body(bytes)?;
        let word = |at: usize| u32::from_le_bytes(array(&bytes[at..]));
        let flags = word(12);
        let seed = u64::from_le_bytes(array(&bytes[24..]));
        let seeded = flags & SEEDED != 0;
        if flags > BOUNDED | SEEDED || (seed != 0 && !seeded) {
            return Err(PackedError::Flags { flags, seed });
        }
        let boundary = if flags & BOUNDED == 0 {
            Boundary::Periodic
        } else {
            Boundary::Bounded
        };
        let side = |name, at| side(name, word(at));
        let domain = Domain::from_units(side("width", 16)?, side("height", 20)?, boundary);
        Ok(Self {
            domain,
            samples: unpack_samples(&domain, body)?,
            seed: seeded.then_some(seed),
            // A given set's bytes do not tell.
            covers_lattice: seeded,
        })
    }
}

fn header(pattern: &Pattern) -> Vec<u8> {
    let domain = &pattern.domain;
    let bounded = if domain.is_periodic() { 0 } else { BOUNDED };
    let seeded = if pattern.seed.is_some() { SEEDED } else { 0 };
    let mut bytes = MARK.to_vec();
    let words = [
        VERSION,
        bounded | seeded,
        domain.width() as u32,
        domain.height() as u32,
    ];
    bytes.extend(words.into_iter().flat_map(u32::to_le_bytes));
    bytes.extend(pattern.seed.unwrap_or(0).to_le_bytes());
    bytes
}

/// Returns the bits of the samples, once mark, version and checksum are right.
fn checked_body(bytes: &[u8]) -> Result<&[u8], PackedError> {
    if !bytes.starts_with(&MARK) {
        return Err(PackedError::Mark);
    }
    if bytes.len() < HEADER_BYTES + CHECKSUM_BYTES {
        return Err(PackedError::TooShort {
            bytes: bytes.len(),
            minimum: HEADER_BYTES + CHECKSUM_BYTES,
        });
    }
    let found = u32::from_le_bytes(array(&bytes[8..]));
    if found != VERSION {
        return Err(PackedError::Version {
            found,
            known: VERSION,
        });
    }
    let (content, stated) = bytes.split_at(bytes.len() - CHECKSUM_BYTES);
    let (stated, computed) = (u64::from_le_bytes(array(stated)), checksum(content));
    if stated != computed {
        return Err(PackedError::Checksum { stated, computed });
    }
    Ok(&content[HEADER_BYTES..])
}

fn side(name: &'static str, units: u32) -> Result<i32, PackedError> {
    if !(MIN_SIDE..=MAX_SIDE).contains(&units) {
        return Err(PackedError::Side {
            name,
            units,
            minimum: MIN_SIDE,
            maximum: MAX_SIDE,
        });
    }
    Ok(units as i32)
}

fn unpack_samples(domain: &Domain, body: &[u8]) -> Result<Vec<Point>, PackedError> {
    let mut bits = BitReader {
        bytes: body.iter(),
        word: 0,
        held: 0,
    };
    let (columns, rows) = cells(domain);
    let inside = domain.rect();
    let mut samples = Vec::with_capacity(body.len() / 4);
    for row in 0..rows {
        for column in 0..columns {
            let ended = PackedError::Ended {
                samples: samples.len(),
            };
            let mut least = 0;
            for _ in 0..bits.take(COUNT_BITS).ok_or(ended)? {
                let index = samples.len();
                let place = bits.take(PLACE_BITS);
                let place = place.ok_or(PackedError::Ended { samples: index })?;
                if place < least {
                    return Err(PackedError::Order { index });
                }
                least = place + 1;
                let (x, y) = (place as i32 & (R - 1), place as i32 >> 15);
                let p = Point::new(column << 15 | x, row << 15 | y);
                if !inside.contains(p) {
                    return Err(PackedError::Outside { index, point: p });
                }
                samples.push(p);
            }
        }
    }
    match (bits.finish(), samples.is_empty()) {
        (Err(left), _) => Err(PackedError::Trailing { bytes: left }),
        (Ok(()), true) => Err(PackedError::Empty),
        (Ok(()), false) => Ok(samples),
    }
}

/// Returns the columns and rows of cells of side `R` that hold the domain's lattice points.
fn cells(domain: &Domain) -> (i32, i32) {
    let beyond = domain.rect().max;
    let count = |beyond: i32| ((beyond - 1) >> 15) + 1;
    (count(beyond.x), count(beyond.y))
}

/// Returns the part of the canonical key that names the cell.
fn cell_of(p: Point) -> u64 {
    p.canonical() >> PLACE_BITS
}

/// Returns the part of the canonical key that says where in its cell a point is.
fn place_in_cell(p: Point) -> u32 {
    (p.canonical() & ((1 << PLACE_BITS) - 1)) as u32
}

/// Returns the first bytes of a slice that is long enough.
fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|k| bytes[k])
}

/// A 64-bit checksum by multiplying words, after FNV-1a. Each step maps hashes one to one, so that a
/// change within one word of eight bytes is always found; the shift lets high bits reach low ones.
fn checksum(bytes: &[u8]) -> u64 {
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    bytes.chunks(8).fold(bytes.len() as u64, |hash, chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        let mixed = (hash ^ u64::from_le_bytes(word)).wrapping_mul(GOLDEN);
        mixed ^ mixed >> 32
    })
}

/// Appends bits to bytes, lowest first.
struct BitWriter {
    bytes: Vec<u8>,
    word: u64,
    held: u32,
}

impl BitWriter {
    fn put(&mut self, value: u32, bits: u32) {
        self.word |= u64::from(value) << self.held;
        self.held += bits;
        while self.held >= 8 {
            self.bytes.push(self.word as u8);
            self.word >>= 8;
            self.held -= 8;
        }
    }

    fn finish(mut self) -> Vec<u8> {
        if self.held > 0 {
            self.bytes.push(self.word as u8);
        }
        self.bytes
    }
}

/// Takes bits from bytes, lowest first.
struct BitReader<'a> {
    bytes: std::slice::Iter<'a, u8>,
    word: u64,
    held: u32,
}

impl BitReader<'_> {
    /// Returns the next `bits` bits, at most 32, or `None` when fewer are left.
    fn take(&mut self, bits: u32) -> Option<u32> {
        while self.held < bits {
            self.word |= u64::from(*self.bytes.next()?) << self.held;
            self.held += 8;
        }
        let value = self.word & ((1 << bits) - 1);
        self.word >>= bits;
        self.held -= bits;
        Some(value as u32)
    }

    /// Fails with the number of bytes that are not used up or filled with other than zeros.
    fn finish(self) -> Result<(), usize> {
        match self.bytes.len() + usize::from(self.word != 0) {
            0 => Ok(()),
            left => Err(left),
        }
    }
}

/// Why bytes are no packed pattern.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PackedError {
    /// The mark is missing.
    #[error("this is no packed pattern: it does not begin with \"tilepatt\"")]
    Mark,
    /// It ends within its header.
    #[error("a packed pattern of {bytes} bytes has no whole header; that takes {minimum}")]
    TooShort {
        /// How many there are.
        bytes: usize,
        /// The fewest possible.
        minimum: usize,
    },
    /// It was packed by another version.
    #[error("the packed pattern has version {found}; this program knows version {known}")]
    Version {
        /// What it says.
        found: u32,
        /// What is known.
        known: u32,
    },
    /// It has changed or was cut off.
    #[error("the packed pattern is damaged: its checksum is {computed:016x}, not {stated:016x}")]
    Checksum {
        /// What it says.
        stated: u64,
        /// What it should say.
        computed: u64,
    },
    /// Flags that mean nothing, or a seed without its flag.
    #[error("the packed pattern's flags are {flags:#x} with seed {seed}; that has no meaning")]
    Flags {
        /// The flags.
        flags: u32,
        /// The seed.
        seed: u64,
    },
    /// A side is out of range.
    #[error("the packed pattern's {name} is {units} units; it must be {minimum} to {maximum}")]
    Side {
        /// Which side.
        name: &'static str,
        /// Its length in lattice units.
        units: u32,
        /// The lower limit.
        minimum: u32,
        /// The upper limit.
        maximum: u32,
    },
    /// The bits end before the last cell.
    #[error("the packed pattern ends after {samples} samples, before its last cell")]
    Ended {
        /// Whole samples before the end.
        samples: usize,
    },
    /// A sample is not inside the domain.
    #[error("sample {index} of the packed pattern, unit ({}, {}), is outside", point.x, point.y)]
    Outside {
        /// Index of the sample.
        index: usize,
        /// Where it is.
        point: Point,
    },
    /// Samples of a cell are not in canonical order, or equal.
    #[error("sample {index} of the packed pattern is not after the one before it")]
    Order {
        /// Index of the second of the two.
        index: usize,
    },
    /// Something follows the last cell.
    #[error("{bytes} bytes follow the packed pattern's last cell")]
    Trailing {
        /// How many.
        bytes: usize,
    },
    /// There is no sample.
    #[error("the packed pattern is empty")]
    Empty,
}

#[cfg(test)]
mod tests;
