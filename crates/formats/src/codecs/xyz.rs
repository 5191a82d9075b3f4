//! `x y z` a line, as point-cloud tools read.
//!
//! Written with z = 0; columns beyond the third (colours, normals) are skipped on reading. A
//! set with z other than 0 is refused.

use super::Raw;
use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};
use crate::text::{data_lines, numbers, push_line, words};

const FORMAT: Format = Format::Xyz;

pub(super) fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
    let mut points = Vec::new();
    for (line, row) in data_lines(bytes) {
        let [x, y, z] = numbers(words(row), FORMAT, line, false)?;
        planar(z, FORMAT, FilePlace::Line(line))?;
        points.push([x, y]);
    }
    Ok(Raw::new(points, Precision::Double))
}

/// Refuses a third coordinate other than 0.
pub(super) fn planar(z: f64, format: Format, place: FilePlace) -> Result<(), FormatError> {
    if z == 0.0 {
        return Ok(());
    }
    Err(FormatError::NotPlanar { format, place, z })
}

pub(super) fn write(points: &[[f64; 2]]) -> Vec<u8> {
    let mut out = Vec::with_capacity(points.len() * 40);
    for &[x, y] in points {
        push_line(&mut out, &[x, y, 0.0], " ");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_coloured_planar_points_only() {
        let raw = read(b"0.5 0.25 0 255 0 0\r\n0.1\t0.2\t0.0").expect("planar");
        assert_eq!(raw.set.points, [[0.5, 0.25], [0.1, 0.2]]);
        let message = |text: &[u8]| read(text).err().expect("refused").to_string();
        assert_eq!(
            message(b"0 0 0\n0 0 2.5\n"),
            "XYZ: line 2: z is 2.5, and only planar sets (z = 0) are read"
        );
        assert_eq!(
            message(b"0.5 0.5\n"),
            "XYZ: line 1: 2 columns where 3 are needed"
        );
    }
}
