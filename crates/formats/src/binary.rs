//! Reads little- and big-endian scalars from a byte slice; leaving its bounds is a typed error.
//!
//! Sizes stated by a header are multiplied with overflow checks and compared with the bytes that are there *before*
//! anything is allocated. Nothing here panics.

use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};

/// Byte order of stored numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

/// A position in a file's bytes.
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    offset: usize,
    format: Format,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8], offset: usize, format: Format) -> Self {
        Self {
            bytes,
            offset,
            format,
        }
    }

    pub(crate) fn offset(&self) -> u64 {
        self.offset as u64
    }

    pub(crate) fn take(&mut self, count: u64) -> Result<&'a [u8], FormatError> {
        let rest = self.bytes.get(self.offset..).unwrap_or_default();
        if count > rest.len() as u64 {
            return Err(FormatError::Truncated {
                format: self.format,
                offset: self.offset(),
                needed: count,
                available: rest.len() as u64,
            });
        }
        self.offset += count as usize;
        Ok(&rest[..count as usize])
    }

    pub(crate) fn u32(&mut self) -> Result<u32, FormatError> {
        let mut word = [0; 4];
        word.copy_from_slice(self.take(4)?);
        Ok(u32::from_le_bytes(word))
    }

    /// The next `rows` records of `width` bytes each. A product that overflows is reported as truncated, too.
    pub(crate) fn records(&mut self, rows: u64, width: u64) -> Result<&'a [u8], FormatError> {
        self.take(rows.saturating_mul(width))
    }

    pub(crate) fn finish(&self) -> Result<(), FormatError> {
        let extra = self.bytes.len().saturating_sub(self.offset);
        if extra == 0 {
            return Ok(());
        }
        Err(FormatError::Trailing {
            format: self.format,
            offset: self.offset(),
            extra: extra as u64,
        })
    }
}

/// The coordinate stored in `bytes`, which are `precision.bytes()` long.
pub(crate) fn coordinate(bytes: &[u8], precision: Precision, endian: Endian) -> f64 {
    match precision {
        Precision::Single => {
            let word = array::<4>(bytes);
            f64::from(match endian {
                Endian::Little => f32::from_le_bytes(word),
                Endian::Big => f32::from_be_bytes(word),
            })
        }
        Precision::Double => {
            let word = array::<8>(bytes);
            match endian {
                Endian::Little => f64::from_le_bytes(word),
                Endian::Big => f64::from_be_bytes(word),
            }
        }
    }
}

/// The first `N` bytes, padded with zeros.
pub(crate) fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut word = [0; N];
    for (to, from) in word.iter_mut().zip(bytes) {
        *to = *from;
    }
    word
}

/// `value` itself, or [`FormatError::NotFinite`] naming point `index`.
pub(crate) fn finite(value: f64, format: Format, index: u64) -> Result<f64, FormatError> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(FormatError::NotFinite {
        format,
        place: FilePlace::Point(index),
        value,
    })
}

/// [`FormatError::NotFinite`] if a coordinate is not finite. `first` is the index in the file of the first point given:
/// the error names a point by its index in the file.
pub(crate) fn all_finite(
    points: &[[f64; 2]],
    first: u64,
    format: Format,
) -> Result<(), FormatError> {
    // Without a branch for each coordinate the compiler compares several at once.
    let and_finite = |all: bool, value: &f64| all & value.is_finite();
    if points.as_flattened().iter().fold(true, and_finite) {
        return Ok(());
    }

    // Only a set with a fault is searched for the value at fault.
    let mut each = points.iter().zip(first..);
    each.try_for_each(|(point, index)| {
        let mut values = point.iter();
        values.try_for_each(|&value| finite(value, format, index).map(drop))
    })
}

/// Points of row-major pairs; bytes behind the last whole pair are ignored. `first` is the index in the file of the
/// first pair: the error for a number that is not finite names a point by its index in the file.
pub(crate) fn pairs(
    data: &[u8],
    first: u64,
    precision: Precision,
    endian: Endian,
    format: Format,
) -> Result<Vec<[f64; 2]>, FormatError> {
    let points: Vec<_> = if (precision, endian) == (Precision::Double, Endian::Little) {
        // Nearly all files hold little-endian f64. This loop for them does not look at precision and byte order in each
        // row.
        let (words, _) = data.as_chunks::<8>();
        let (rows, _) = words.as_chunks::<2>();
        rows.iter().map(|row| row.map(f64::from_le_bytes)).collect()
    } else {
        let rows = data.chunks_exact(2 * precision.bytes());
        rows.map(|row| {
            let (x, y) = row.split_at(precision.bytes());
            [x, y].map(|bytes| coordinate(bytes, precision, endian))
        })
        .collect()
    };

    all_finite(&points, first, format)?;
    Ok(points)
}

/// Appends coordinates in little-endian order.
pub(crate) fn push(out: &mut Vec<u8>, values: &[f64], precision: Precision) {
    for &value in values {
        match precision {
            Precision::Single => out.extend_from_slice(&(value as f32).to_le_bytes()),
            Precision::Double => out.extend_from_slice(&value.to_le_bytes()),
        }
    }
}

/// Appends points as row-major pairs, little-endian.
pub(crate) fn push_pairs(out: &mut Vec<u8>, points: &[[f64; 2]], precision: Precision) {
    let (start, size) = (out.len(), 2 * precision.bytes());
    out.resize(start + points.len() * size, 0);
    let rows = out[start..].chunks_exact_mut(size).zip(points);
    match precision {
        Precision::Single => rows.for_each(|(row, point)| {
            let point = point.map(|value| (value as f32).to_le_bytes());
            row.copy_from_slice(point.as_flattened());
        }),
        Precision::Double => rows.for_each(|(row, point)| {
            row.copy_from_slice(point.map(f64::to_le_bytes).as_flattened());
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_huge_claim_is_refused_before_any_allocation() {
        let mut cursor = Cursor::new(&[0; 24], 20, Format::UtkBinary);
        let error = cursor.records(u64::MAX, 16).expect_err("four bytes");
        assert!(matches!(
            error,
            FormatError::Truncated {
                offset: 20,
                available: 4,
                needed: u64::MAX,
                ..
            }
        ));
    }

    #[test]
    fn endianness_and_width_are_honoured() {
        for value in [0.1_f64, -3.5, 1e-300] {
            assert_eq!(
                coordinate(&value.to_be_bytes(), Precision::Double, Endian::Big).to_bits(),
                value.to_bits()
            );
        }
        let single = 0.1_f32;
        let read = coordinate(&single.to_be_bytes(), Precision::Single, Endian::Big);
        assert_eq!(read.to_bits(), f64::from(single).to_bits());
        assert!((read - 0.1).abs() > 0.0, "f32 has rounded it");
    }

    #[test]
    fn surplus_and_nan_are_refused() {
        assert!(Cursor::new(&[0; 3], 1, Format::Npy).finish().is_err());
        let nan = [f64::NAN.to_le_bytes(), 0.5_f64.to_le_bytes()].concat();
        let error = pairs(&nan, 0, Precision::Double, Endian::Little, Format::Npy);
        assert!(matches!(
            error,
            Err(FormatError::NotFinite {
                place: FilePlace::Point(0),
                ..
            })
        ));
    }
}
