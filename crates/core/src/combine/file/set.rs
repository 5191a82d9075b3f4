//! Turns the sets of a layout into pieces: each set is made once, several in parallel, and placed. The caller makes or
//! reads the sets.

use std::collections::HashMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::{LayoutError, PieceSource, PlacedLayout, PlacedPiece};
use crate::combine::Piece;
use crate::error::{PatternError, SampleError};
use crate::lattice::{Boundary, Domain, Point};
use crate::parameters::Parameters;
use crate::pattern::Pattern;
use crate::progress::Observer;

/// A set with its domain in its own units.
#[derive(Clone, Debug)]
pub struct Set {
    /// The samples of the set.
    pub pattern: Arc<Pattern>,
    /// Its domain, in its own units.
    pub domain: Domain,
}

/// An error in the set of a piece.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("pieces[{piece}]: {error}")]
pub struct PieceError<E> {
    /// The piece, counted from 0.
    pub piece: usize,
    /// The error of its set.
    pub error: E,
}

impl PlacedLayout {
    /// Returns the pieces of the layout, with sets made by `make`. Pieces of one file that is read with one radius and size
    /// share its set, so that they may continue each other; sets made for a rectangle are not shared. `made` is called
    /// after each set, whether it could be made or not, with the number of its pieces. Uses the current rayon pool.
    ///
    /// Fails with the error of the first set, in the order of the sets' first pieces, that cannot be made or placed.
    pub fn pieces<E: From<LayoutError> + Send>(
        &self,
        make: impl Fn(&PieceSource) -> Result<Set, E> + Sync,
        made: impl Fn(usize) + Sync,
    ) -> Result<Vec<Piece>, PieceError<E>> {
        let groups = groups_by_set(&self.pieces);

        // A set may take long: each is a task of its own.
        let tasks = groups.par_iter().with_max_len(1).map(|sharing| {
            let set = make(&self.pieces[sharing[0]].source);
            made(sharing.len());
            set
        });
        let sets: Vec<Result<Set, E>> = tasks.collect();

        // Sets are looked at in the order of their groups, so that the same error is reported whatever thread was
        // first.
        let mut pieces: Vec<Option<Piece>> = vec![None; self.pieces.len()];
        for (set, sharing) in sets.into_iter().zip(&groups) {
            let in_piece = |piece: usize| move |error: E| PieceError { piece, error };
            let set = set.map_err(in_piece(sharing[0]))?;

            for &k in sharing {
                let piece = set.placed(&self.pieces[k]);
                pieces[k] = Some(piece.map_err(|error| in_piece(k)(error.into()))?);
            }
        }

        // Each piece is in one group, so that all have been placed.
        Ok(pieces.into_iter().flatten().collect())
    }
}

/// Returns groups of the indices of pieces that share a set, in the order of their first pieces.
fn groups_by_set(pieces: &[PlacedPiece]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    // The groups whose sets are read from a file, by its path.
    let mut by_file: HashMap<&str, Vec<usize>> = HashMap::new();

    for (k, piece) in pieces.iter().enumerate() {
        let PieceSource::File { path, .. } = &piece.source else {
            // Sets that are made for a piece are not shared.
            groups.push(vec![k]);
            continue;
        };

        let of_file = by_file.entry(path).or_default();
        // The same file may be read with another radius or size; these are different sets.
        let known = of_file
            .iter()
            .find(|&&g| pieces[groups[g][0]].source == piece.source);

        if let Some(&group) = known {
            groups[group].push(k);
        } else {
            of_file.push(groups.len());
            groups.push(vec![k]);
        }
    }
    groups
}

impl Set {
    /// Returns a set of given positions on `[0, size[0]] x [0, size[1]]`.
    ///
    /// Fails as [`Pattern::from_positions`].
    pub fn from_positions(
        positions: &[[f64; 2]],
        size: [f64; 2],
        radius: f64,
        boundary: Boundary,
    ) -> Result<Self, PatternError> {
        let pattern = Pattern::from_positions(positions, size, radius, boundary)?;
        Ok(Self {
            pattern: Arc::new(pattern),
            domain: Domain::from_size(size, radius, boundary)?,
        })
    }

    /// Returns a set by the reference sampler.
    ///
    /// Fails as [`Pattern::of_reference`].
    pub fn of_reference(
        own: Domain,
        seed: u64,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        Ok(Self {
            pattern: Arc::new(Pattern::of_reference(own, seed, observer)?),
            domain: own,
        })
    }

    /// Returns a set by randomized tiling that clips from `pattern`.
    ///
    /// Fails as [`Pattern::of_run`].
    pub fn of_run(
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        Ok(Self {
            pattern: Arc::new(Pattern::of_run(parameters, pattern, observer)?),
            domain: parameters.validate()?,
        })
    }

    /// Returns a piece of this set.
    fn placed(&self, piece: &PlacedPiece) -> Result<Piece, LayoutError> {
        Ok(Piece {
            set: Arc::clone(&self.pattern),
            rect: piece.rect,
            start: self.start(piece.offset)?,
        })
    }

    /// Returns the lattice point at an offset in the set's own units. A periodic set repeats, and has a point at every
    /// finite offset. Fails when the offset is not finite, and when it is not in the domain of a bounded set.
    fn start(&self, offset: [f64; 2]) -> Result<Point, LayoutError> {
        let size = self.domain.size();
        let periodic = self.domain.is_periodic();

        let along = |axis: usize| {
            let (value, side) = (offset[axis], size[axis]);
            let fits = periodic && value.is_finite() || (0.0..=side).contains(&value);
            if !fits {
                return Err(LayoutError::Offset { value, side });
            }

            Ok(if periodic {
                value.rem_euclid(side)
            } else {
                value
            })
        };

        let low = [along(0)?, along(1)?];
        // Rounded as the corners of rectangles are, so that pieces of one set with matching cuts continue each other.
        Ok(self.domain.rect_from_user(low, low).min)
    }
}
