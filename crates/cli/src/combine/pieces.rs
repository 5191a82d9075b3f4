//! The sets of a layout: read and checked, or made, on all threads at once.

use std::collections::HashMap;
use std::fmt;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use serde_json::{Value, json};
use tilescope_analysis::Region;
use tilescope_core::combine::Piece;
use tilescope_core::{Boundary, Domain, Parameters, Pattern, Point, Progress};

use super::entry::Source;
use super::layout::{Place, Placed};
use crate::interrupt;
use crate::options::UNIT_SQUARE;
use crate::parameters::set_of_file;
use crate::pattern_cache;
use crate::progress::Bar;

/// The longest file of a set: as many samples as a result may have, of 40 bytes.
const MAX_FILE_BYTES: u64 = 8_000_000_000;

/// The pieces of a layout.
pub struct Pieces {
    pub pieces: Vec<Piece>,
    pub census: Census,
}

/// What pieces there are.
pub struct Census {
    sources: Vec<Value>,
    seconds: f64,
    pub files: usize,
    pub runs: usize,
    pub references: usize,
}

impl Census {
    fn new(places: &[Place], seconds: f64) -> Self {
        let count =
            |test: fn(&Source) -> bool| places.iter().filter(|place| test(&place.source)).count();
        Self {
            sources: places.iter().map(|place| place.source.json()).collect(),
            seconds,
            files: count(|source| matches!(source, Source::File { .. })),
            runs: count(|source| matches!(source, Source::Run(_))),
            references: count(|source| matches!(source, Source::Reference { .. })),
        }
    }

    pub fn json(&self) -> Value {
        json!({ "count": self.sources.len(), "sources": self.sources, "seconds": self.seconds })
    }
}

impl fmt::Display for Census {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.sources.len();
        write!(f, "{count} pieces in {:.1} ms:", self.seconds * 1e3)?;
        let kinds = [
            (self.files, "from files"),
            (self.runs, "by kdrt"),
            (self.references, "by the reference sampler"),
        ];
        let kinds = kinds.into_iter().filter(|&(count, _)| count > 0);
        let kinds: Vec<String> = kinds.map(|(n, kind)| format!("{n} {kind}")).collect();
        write!(f, " {}", kinds.join(", "))
    }
}

/// A set with the domain that its own units are of.
#[derive(Clone)]
struct Own {
    set: Arc<Pattern>,
    domain: Domain,
}

/// Makes all pieces of a layout. Pieces of one file share its set, so that they may continue each other.
pub fn make(placed: &Placed) -> Result<Pieces> {
    let began = Instant::now();
    let bar = Bar::new("pieces");
    let (done, total) = (AtomicU64::new(0), placed.places.len() as u64);
    let each = distinct(&placed.places);
    bar.set(0, total);
    let sets = each.par_iter().with_max_len(1).map(|sharing| {
        let k = sharing[0];
        let own = set(&placed.places[k].source).with_context(|| format!("pieces[{k}]"));
        let before = done.fetch_add(sharing.len() as u64, Ordering::Relaxed);
        bar.set(before + sharing.len() as u64, total);
        own
    });
    // The first error in the sequence of pieces, whoever met it first.
    let sets: Vec<Result<Own>> = sets.collect();
    bar.clear();
    let mut pieces: Vec<Option<Piece>> = vec![None; placed.places.len()];
    for (own, sharing) in sets.into_iter().zip(&each) {
        let own = own?;
        for &k in sharing {
            let piece = own.placed(&placed.places[k]);
            pieces[k] = Some(piece.with_context(|| format!("pieces[{k}]"))?);
        }
    }
    Ok(Pieces {
        pieces: pieces.into_iter().flatten().collect(),
        census: Census::new(&placed.places, began.elapsed().as_secs_f64()),
    })
}

/// Returns the pieces that share a set, by the first of them. What is made for a rectangle is never shared.
fn distinct(places: &[Place]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut by_file: HashMap<&Path, Vec<usize>> = HashMap::new();
    for (k, place) in places.iter().enumerate() {
        let Source::File { path, .. } = &place.source else {
            groups.push(vec![k]);
            continue;
        };
        let same = by_file.entry(path).or_default();
        let known = same
            .iter()
            .find(|&&g| places[groups[g][0]].source == place.source);
        if let Some(&group) = known {
            groups[group].push(k);
        } else {
            same.push(groups.len());
            groups.push(vec![k]);
        }
    }
    groups
}

fn set(source: &Source) -> Result<Own> {
    let mut observer = |_: Progress| -> ControlFlow<()> { interrupt::flow() };
    match source {
        Source::File {
            path,
            radius,
            size,
            boundary,
        } => file(path, *radius, *size, *boundary).with_context(|| path.display().to_string()),
        Source::Reference { seed, own } => Ok(Own {
            set: Arc::new(Pattern::of_reference(*own, *seed, &mut observer)?),
            domain: *own,
        }),
        Source::Run(parameters) => {
            let parameters: &Parameters = parameters;
            let pattern = pattern_cache::pattern(&parameters.pattern, &mut observer)?;
            let set = Pattern::of_run(parameters, &pattern, &mut observer)?;
            Ok(Own {
                set: Arc::new(set),
                domain: parameters.validate()?,
            })
        }
    }
}

fn file(
    path: &Path,
    radius: Option<f64>,
    [width, height]: [Option<f64>; 2],
    boundary: Option<Boundary>,
) -> Result<Own> {
    let about = fs::metadata(path)?;
    ensure!(about.is_file(), "this is no file");
    ensure!(
        about.len() <= MAX_FILE_BYTES,
        "the file has {} bytes; it may have {MAX_FILE_BYTES}",
        about.len()
    );
    let found = set_of_file(path, radius, "its \"radius\"", |stated| {
        let stated = stated.unwrap_or(UNIT_SQUARE);
        Region {
            width: width.unwrap_or(stated.width),
            height: height.unwrap_or(stated.height),
            boundary: boundary.map_or(stated.boundary, crate::options::judged),
        }
    })?;
    Ok(Own {
        set: Arc::new(found.pattern),
        domain: found.domain,
    })
}

impl Own {
    fn placed(&self, place: &Place) -> Result<Piece> {
        Ok(Piece {
            set: Arc::clone(&self.set),
            rect: place.rect,
            start: self.start(place.offset)?,
        })
    }

    /// Returns the lattice point of a place in the set's own units.
    fn start(&self, offset: [f64; 2]) -> Result<Point> {
        let size = self.domain.size();
        let periodic = self.domain.is_periodic();
        let place = |axis: usize| {
            let (value, side) = (offset[axis], size[axis]);
            let fits = periodic && value.is_finite() || (0.0..=side).contains(&value);
            ensure!(
                fits,
                "the offset {value} is not inside the set, which is {side} long"
            );
            Ok(if periodic {
                value.rem_euclid(side)
            } else {
                value
            })
        };
        let low = [place(0)?, place(1)?];
        // As rectangles begin, so that pieces of one set that are cut where it is cut continue each other.
        Ok(self.domain.rect_from_user(low, low).min)
    }
}
