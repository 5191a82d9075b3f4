//! Reads and checks, or makes, the sets of a layout on all threads.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use anyhow::{Result, ensure};
use serde::Serialize;
use serde_json::{Value, json};
use tilescope_core::Progress;
use tilescope_core::combine::Piece;
use tilescope_core::combine::file::{PieceError, PieceSource, PlacedLayout, PlacedPiece, Set};
use tilescope_sets::{GivenDomain, set_of_piece};

use crate::interrupt;
use crate::parameters::set_of_file;
use crate::paths::InFile;
use crate::progress::bar;

/// The longest file of a set, in bytes: 200 million samples, the most that a result may have, of 40 bytes each.
const MAX_FILE_BYTES: u64 = 8_000_000_000;

/// The number and sources of the pieces.
#[derive(Serialize)]
pub struct Census {
    count: usize,
    sources: Vec<Value>,
    seconds: f64,
    /// From files, by kdrt, by the reference sampler.
    #[serde(skip)]
    pub kinds: [usize; 3],
}

impl Census {
    /// Counts the pieces by where they come from.
    fn new(pieces: &[PlacedPiece], folder: &Path, seconds: f64) -> Self {
        let kind = |piece: &PlacedPiece| match piece.source {
            PieceSource::File { .. } => 0,
            PieceSource::Run { .. } => 1,
            PieceSource::Reference { .. } => 2,
        };
        let source = |piece: &PlacedPiece| described(&piece.source, folder);
        let kinds = [0, 1, 2].map(|k| pieces.iter().filter(|piece| kind(piece) == k).count());
        Self {
            count: pieces.len(),
            sources: pieces.iter().map(source).collect(),
            seconds,
            kinds,
        }
    }

    pub fn text(&self) -> String {
        let names = ["from files", "by kdrt", "by the reference sampler"];
        let kinds: Vec<String> = (self.kinds.into_iter().zip(names))
            .filter(|&(count, _)| count > 0)
            .map(|(n, kind)| format!("{n} {kind}"))
            .collect();
        let (count, kinds) = (self.count, kinds.join(", "));
        format!("{count} pieces in {:.1} ms: {kinds}", self.seconds * 1e3)
    }
}

/// Returns the method and seed, or the file, of a source.
fn described(source: &PieceSource, folder: &Path) -> Value {
    match source {
        PieceSource::File { path, .. } => {
            json!({ "file": folder.join(path).display().to_string() })
        }
        PieceSource::Run { parameters, .. } => json!({ "method": "kdrt", "seed": parameters.seed }),
        PieceSource::Reference { seed, .. } => json!({ "method": "reference", "seed": seed }),
    }
}

/// Makes all pieces of a layout; files are relative to `folder`.
pub fn make(placed: &PlacedLayout, folder: &Path) -> Result<(Vec<Piece>, Census)> {
    let began = Instant::now();
    let bar = bar("pieces", placed.pieces.len() as u64);
    let made = |count: usize| bar.inc(count as u64);
    let pieces = placed.pieces(|source| set(source, folder), made);
    // The bar is cleared before an error is printed, which then stands in a line of its own.
    bar.finish_and_clear();
    // An error names the piece by its place in the JSON of the layout, from 0.
    let of_piece = |PieceError { piece, error }: PieceError<anyhow::Error>| {
        error.context(format!("pieces[{piece}]"))
    };

    let seconds = began.elapsed().as_secs_f64();
    let census = Census::new(&placed.pieces, folder, seconds);
    Ok((pieces.map_err(of_piece)?, census))
}

fn set(source: &PieceSource, folder: &Path) -> Result<Set> {
    let mut observer = |_: Progress| -> ControlFlow<()> { interrupt::flow() };
    set_of_piece(source, &mut observer, |path, given| {
        let path = folder.join(path);
        file(&path, given).in_file(&path)
    })
}

fn file(path: &Path, given: &GivenDomain) -> Result<Set> {
    let about = fs::metadata(path)?;
    ensure!(about.is_file(), "this is not a file");
    ensure!(
        about.len() <= MAX_FILE_BYTES,
        "the file has {} bytes; it may have {MAX_FILE_BYTES}",
        about.len()
    );
    set_of_file(path, given, "its \"radius\"")
}
