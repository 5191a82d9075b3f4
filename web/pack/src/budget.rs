//! The bytes to be downloaded before the program starts, as a table and as a limit. The first page is for readers and not
//! for the program, so that its bytes are counted apart.

use std::fmt;

use anyhow::{Result, ensure};

use crate::compress::Packed;

/// The most bytes, compressed by brotli, that may be needed to start. Chosen, not measured.
pub const MAX_TO_START: usize = 2_550_000;

/// The line of the first page's sizes.
const FIRST_PAGE: &str = "first page, in index.html";

/// A file's sizes in bytes: uncompressed, by gzip, by brotli.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    path: String,
    sizes: [usize; 3],
    to_start: bool,
}

/// The sizes of all files.
#[derive(Clone, Debug)]
pub struct Table {
    rows: Vec<Row>,
    /// The sizes of the first page, which comes within `index.html`.
    first_page: [usize; 3],
}

impl Table {
    /// Returns the table: files needed to start first, then large files before small ones. `first_page` has the sizes of
    /// the first page.
    pub fn of(packed: &[Packed], first_page: [usize; 3]) -> Self {
        let row = |packed: &Packed| Row {
            path: packed.file.path.clone(),
            sizes: [
                packed.file.bytes.len(),
                packed.gzip_len(),
                packed.brotli_len(),
            ],
            to_start: packed.file.to_start,
        };
        let mut rows: Vec<Row> = packed.iter().map(row).collect();
        rows.sort_by_key(|row| (!row.to_start, std::cmp::Reverse(row.sizes[2])));
        Self { rows, first_page }
    }

    /// Returns the total sizes of the files that the start needs, without the first page.
    pub fn to_start(&self) -> [usize; 3] {
        let mut sum = [0; 3];
        for row in self.rows.iter().filter(|row| row.to_start) {
            for (sum, size) in sum.iter_mut().zip(row.sizes) {
                *sum += size;
            }
        }
        // `index.html`, which has the first page, is one of these files.
        for (sum, size) in sum.iter_mut().zip(self.first_page) {
            *sum = sum.saturating_sub(size);
        }
        sum
    }

    /// Fails when the program needs more than `most` bytes, compressed by brotli, to start.
    pub fn check(&self, most: usize) -> Result<()> {
        let [_, gzip, brotli] = self.to_start();
        ensure!(
            brotli <= most,
            "what is needed to start is {brotli} bytes by brotli ({gzip} by gzip), more than {most}; nothing was written"
        );
        Ok(())
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let longest = self.rows.iter().map(|row| row.path.len()).max();
        let width = longest.unwrap_or(0).max(FIRST_PAGE.len());
        let mut line = |name: &str, sizes: [String; 3]| {
            let [plain, gzip, brotli] = sizes;
            writeln!(f, "{name:width$} {plain:>10} {gzip:>10} {brotli:>10}")
        };

        line("file", ["bytes", "gzip", "brotli"].map(str::to_owned))?;
        for row in &self.rows {
            line(&row.path, row.sizes.map(|size| size.to_string()))?;
        }
        line(FIRST_PAGE, self.first_page.map(|size| size.to_string()))?;
        line(
            "needed to start",
            self.to_start().map(|size| size.to_string()),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::File;

    fn packed(path: &str, bytes: usize, brotli: usize, to_start: bool) -> Packed {
        Packed {
            file: File {
                path: path.to_owned(),
                bytes: vec![0; bytes],
                to_start,
                hashed: true,
            },
            gzip: None,
            brotli: Some(vec![0; brotli]),
        }
    }

    #[test]
    fn one_byte_more_than_the_limit_is_too_much() {
        let files = [
            packed("a.wasm", 90, 60, true),
            packed("still.png", 500, 500, false),
            packed("main.js", 20, 10, true),
        ];
        let table = Table::of(&files, [5, 4, 3]);
        // The first page does not count.
        assert_eq!(table.to_start(), [105, 106, 67]);
        let table = Table::of(&files, [0; 3]);
        assert_eq!(table.to_start(), [110, 110, 70]);
        assert!(table.check(70).is_ok());
        let error = table.check(69).unwrap_err().to_string();
        assert!(
            error.contains("70 bytes") && error.contains("more than 69"),
            "{error}"
        );
    }

    #[test]
    fn the_table_has_a_line_a_file_and_the_sum() {
        let files = [packed("b.js", 20, 10, true), packed("a.wasm", 90, 60, true)];
        let text = Table::of(&files, [5, 4, 3]).to_string();
        let first: Vec<&str> = text
            .lines()
            .map(|line| line.split(' ').next().unwrap())
            .collect();
        assert_eq!(first, ["file", "a.wasm", "b.js", "first", "needed"]);
        assert!(text.ends_with("67\n"), "{text}");
    }
}
