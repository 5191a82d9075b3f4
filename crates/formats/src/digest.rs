//! BLAKE3 digests of files and of positions.
//!
//! A file's digest finds any changed byte; a positions digest finds a changed position whatever the
//! file format, so a JSON document can certify itself. A digest is no
//! signature: anybody can compute that of an altered file.

use crate::binary;
use crate::format::Precision;

/// The BLAKE3 digest of `bytes`, as `blake3:` and 64 hexadecimal digits.
#[must_use]
pub fn bytes_digest(bytes: &[u8]) -> String {
    format!("blake3:{}", blake3::hash(bytes).to_hex())
}

/// The text of a finished hash.
pub(crate) fn digest_text(hasher: &blake3::Hasher) -> String {
    format!("blake3:{}", hasher.finalize().to_hex())
}

/// The BLAKE3 digest of positions: the little-endian bytes of x and y of each point in order.
///
/// Two sets have the same digest exactly when they agree to the bit and in order. [`solid_digest`] is that of sets in space.
#[must_use]
pub fn positions_digest(points: &[[f64; 2]]) -> String {
    let mut hasher = blake3::Hasher::new();
    add_positions(&mut hasher, points);
    digest_text(&hasher)
}

/// The BLAKE3 digest of positions in space: the little-endian bytes of x, y and z of each point in order.
#[must_use]
pub fn solid_digest(points: &[[f64; 3]]) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut buffer = Vec::with_capacity(CHUNK.min(points.len()) * 24);
    for chunk in points.chunks(CHUNK) {
        buffer.clear();
        binary::push(&mut buffer, chunk.as_flattened(), Precision::Double);
        hasher.update(&buffer);
    }
    digest_text(&hasher)
}

/// The digest of positions that pass by: that of [`positions_digest`] of all of them together.
///
/// ```
/// use tilescope_formats::{PassingDigest, positions_digest};
/// let mut digest = PassingDigest::default();
/// digest.add(&[[0.0, 0.5]]);
/// digest.add(&[[0.25, 0.75]]);
/// assert_eq!(digest.text(), positions_digest(&[[0.0, 0.5], [0.25, 0.75]]));
/// ```
#[derive(Clone, Debug, Default)]
pub struct PassingDigest(blake3::Hasher);

impl PassingDigest {
    /// Adds points, which come after those before.
    pub fn add(&mut self, points: &[[f64; 2]]) {
        add_positions(&mut self.0, points);
    }

    /// Returns the digest of the points so far.
    #[must_use]
    pub fn text(&self) -> String {
        digest_text(&self.0)
    }
}

/// Adds points to the hash of [`positions_digest`].
pub(crate) fn add_positions(hasher: &mut blake3::Hasher, points: &[[f64; 2]]) {
    let mut buffer = Vec::with_capacity(CHUNK.min(points.len()) * 16);
    for chunk in points.chunks(CHUNK) {
        buffer.clear();
        binary::push_pairs(&mut buffer, chunk, Precision::Double);
        hasher.update(&buffer);
    }
}

/// Points hashed at a time: 64 KiB, enough that BLAKE3 works on whole subtrees.
const CHUNK: usize = 4096;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_digest_is_the_published_one() {
        let empty = "blake3:af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";
        assert_eq!(bytes_digest(b""), empty);
        assert_eq!(positions_digest(&[]), empty);
    }

    #[test]
    fn order_sign_and_last_bit_count() {
        let digest = positions_digest(&[[0.0, 0.5], [0.25, 0.75]]);
        assert_ne!(digest, positions_digest(&[[0.25, 0.75], [0.0, 0.5]]));
        assert_ne!(digest, positions_digest(&[[-0.0, 0.5], [0.25, 0.75]]));
        let next = 0.5_f64.next_up();
        assert_ne!(digest, positions_digest(&[[0.0, next], [0.25, 0.75]]));
    }

    #[test]
    fn chunking_does_not_show() {
        let points: Vec<_> = (0..5000).map(|i| [f64::from(i), 0.5]).collect();
        let bytes: Vec<u8> = points
            .iter()
            .flatten()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        assert_eq!(positions_digest(&points), bytes_digest(&bytes));
    }
}
