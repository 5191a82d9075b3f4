//! `x y z` a line with z = 0, as point-cloud tools read it. `table` reads such files, in which colours and normals may
//! follow.

use crate::error::{FilePlace, FormatError};
use crate::format::Format;
use crate::text::push_line;

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
    use crate::codecs::table;

    #[test]
    fn reads_coloured_planar_points_only() {
        let read = |text: &[u8]| table::read(text, Format::Xyz, None, false);
        let raw = read(b"0.5 0.25 0 255\r\n0.1\t0.2\t0.0 9").expect("planar");
        assert_eq!(raw.set.points, [[0.5, 0.25], [0.1, 0.2]]);
        let message = |text: &[u8]| read(text).err().expect("refused").to_string();
        assert_eq!(
            message(b"0 0 0\n0 0 2.5\n"),
            "XYZ: line 2: z is 2.5, and only planar sets (z = 0) are read"
        );
        assert_eq!(
            message(b"0.5 0.5 0\n0.5 0.5\n"),
            "XYZ: line 2: 2 columns where 3 are needed"
        );
        assert_eq!(
            message(b"0.5\n"),
            "XYZ: line 1: 1 columns where 2 are needed"
        );
    }
}
