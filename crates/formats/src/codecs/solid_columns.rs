//! What tables and PLY hold of each sample of a set in space besides its place: when it arrived.

use super::kept::ColumnUse;
use super::{ply, table};
use crate::error::FormatError;
use crate::format::Format;

/// The names of the columns.
pub(super) const ARRIVAL: &str = "arrival";
pub(super) const LEVEL: &str = "level";

/// The last level of the process: its cubes have sides of 2^15 units at level 0, and of one unit at this one.
const LAST_LEVEL: u8 = 15;

/// When the samples of a set in space arrived. CSV and PLY hold it, as columns of these names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolidColumns {
    /// The place of each sample in the order of arrival, from 0; nothing if that is not known.
    pub arrival: Vec<u32>,
    /// The level at which each sample arrived, from 0 to 15: how often the cubes that threw it were halved. Nothing if that
    /// is not known.
    pub level: Vec<u8>,
}

impl SolidColumns {
    /// Returns whether there is no column.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.arrival.is_empty() && self.level.is_empty()
    }

    /// Keeps the columns of the first `count` samples.
    pub fn truncate(&mut self, count: usize) {
        self.arrival.truncate(count);
        self.level.truncate(count);
    }

    /// Exchanges two samples. A column that has no entry for both of them stays as it is: it is refused when it is written.
    pub(crate) fn swap(&mut self, a: usize, b: usize) {
        let last = a.max(b);
        if last < self.arrival.len() {
            self.arrival.swap(a, b);
        }
        if last < self.level.len() {
            self.level.swap(a, b);
        }
    }

    /// Refuses columns with more or fewer entries than there are points.
    pub(super) fn check(&self, points: usize) -> Result<(), FormatError> {
        let lengths = [(ARRIVAL, self.arrival.len()), (LEVEL, self.level.len())];
        let wrong = |&(_, found): &(&str, usize)| found > 0 && found != points;
        match lengths.into_iter().find(wrong) {
            Some((name, found)) => Err(FormatError::Column {
                name,
                found,
                points,
            }),
            None => Ok(()),
        }
    }

    /// Returns the names of the columns that are there, in the order in which files have them.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let lengths = [(ARRIVAL, self.arrival.len()), (LEVEL, self.level.len())];
        let present = lengths.into_iter().filter(|&(_, count)| count > 0);
        present.map(|(name, _)| name)
    }

    /// Returns the numbers of a sample, in the order of [`Self::names`].
    pub(super) fn of(&self, index: usize) -> impl Iterator<Item = u32> {
        let arrival = self.arrival.get(index).copied();
        let level = self.level.get(index).map(|&level| u32::from(level));
        arrival.into_iter().chain(level)
    }
}

/// Returns the columns of a file, whose points were read already.
pub(super) fn read(bytes: &[u8], format: Format) -> SolidColumns {
    let column = |name| match format {
        Format::Csv | Format::Xyz => table::column(bytes, format, None, name, ColumnUse::Order),
        Format::PlyAscii | Format::PlyBinary => ply::column(bytes, format, name, ColumnUse::Order),
        // The others have nothing beside the coordinates.
        _ => Ok(Vec::new()),
    };
    // Another program's columns of these names may hold anything, and are no fault of the file: unless all of their numbers can be
    // those of this program, the set has no such column.
    let whole = |name, last: u32| {
        let values = column(name).unwrap_or_default();
        let is_own =
            |&value: &f64| value.fract() == 0.0 && (0.0..=f64::from(last)).contains(&value);
        if values.iter().all(is_own) {
            values
        } else {
            Vec::new()
        }
    };

    // PLY has these numbers as 32-bit integers with a sign.
    let numbers = whole(ARRIVAL, i32::MAX as u32).into_iter();
    let levels = whole(LEVEL, LAST_LEVEL.into()).into_iter();
    SolidColumns {
        arrival: numbers.map(|value| value as u32).collect(),
        level: levels.map(|value| value as u8).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::solid::{decode, encode, has_columns};
    use super::super::{Hint, keep_rows};
    use super::*;
    use crate::format::Precision;

    const POINTS: [[f64; 3]; 3] = [[0.5, 0.25, 0.125], [0.1, 1.0 / 3.0, 0.7], [0.0, 0.9, 1e-9]];

    fn columns() -> SolidColumns {
        SolidColumns {
            arrival: vec![2, 0, 536_870_912],
            level: vec![0, 15, 3],
        }
    }

    #[test]
    fn tables_and_ply_have_what_is_written_and_keep_it_with_a_point() {
        let of_level = SolidColumns {
            arrival: Vec::new(),
            ..columns()
        };
        for (format, written) in Format::ALL
            .iter()
            .flat_map(|format| [(*format, columns()), (*format, of_level.clone())])
        {
            let Ok(bytes) = encode(&POINTS, &written, format, Precision::Double) else {
                // A planar format.
                continue;
            };
            let hint = Hint {
                format: Some(format),
                ..Hint::default()
            };
            let raw = decode(&bytes, &hint).expect("own file");
            assert_eq!(raw.points, POINTS, "{format}");
            if !has_columns(format) {
                assert!(raw.columns.is_empty(), "{format}");
                continue;
            }
            assert_eq!(raw.columns, written, "{format}");

            // A file of some of the points has their numbers.
            let hint = Hint {
                any_z: true,
                ..hint
            };
            let kept = keep_rows(&bytes, &hint, &[true, false, true]).expect("rows");
            let kept = decode(&kept.bytes, &hint).expect("kept rows").columns;
            assert_eq!(kept.level, [0, 3], "{format}");
            let numbers = [2, 536_870_912];
            let arrival = numbers.get(..written.arrival.len().min(2)).expect("two");
            assert_eq!(kept.arrival, arrival, "{format}");
        }
    }

    #[test]
    fn columns_of_other_programs_are_no_fault_and_no_levels() {
        let of = |text: &str| {
            let hint = Hint {
                format: Some(Format::Csv),
                ..Hint::default()
            };
            decode(text.as_bytes(), &hint).expect("a table").columns
        };
        assert_eq!(of("x,y,z,level\n1,2,3,4\n").level, [4]);
        assert_eq!(of("Level;z;x;y;Arrival\n4;3;2;1;9\n").arrival, [9]);
        for other in ["16", "-1", "0.5", "high", "", "nan"] {
            let found = of(&format!(
                "x,y,z,level,arrival\n1,2,3,4,0\n1,2,4,{other},1\n"
            ));
            assert!(found.level.is_empty(), "{other}");
            assert_eq!(found.arrival, [0, 1], "{other}");
        }
        assert!(of("x,y,z\n1,2,3\n").is_empty());
    }

    #[test]
    fn columns_of_another_length_are_refused() {
        let wrong = SolidColumns {
            level: vec![0; 2],
            ..columns()
        };
        let said = encode(&POINTS, &wrong, Format::Csv, Precision::Double);
        let said = said.expect_err("two levels").to_string();
        assert_eq!(said, "2 entries of level for 3 points");
    }
}
