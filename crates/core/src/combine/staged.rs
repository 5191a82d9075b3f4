//! Combinations as runs whose blocks are the pieces: with all stages, to be inspected, or with the result alone.

use std::sync::Arc;

use super::glue::{blocks, glue};
use super::{CombineError, CombineOptions, Combined, Piece, Seam, check, layout};
use crate::lattice::{Domain, R};
use crate::parameters::Parameters;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::run::Run;
use crate::stage::Stage;

/// A combination with all its stages.
#[derive(Clone, Debug)]
pub struct Staged {
    /// A finished run. Its blocks are the pieces, in this order, without splits; an origin's index is that in the
    /// piece's own set. Its pattern is the first piece's set. Of its parameters only the domain, the seed, the order,
    /// the insertion and the search are meaningful.
    pub run: Run,
    /// The lines along which different sets meet.
    pub seams: Vec<Seam>,
}

/// Returns the same result as [`super::combine`], bit for bit, with the fate of every sample that the pieces
/// contributed. It considers all samples, while `combine` considers only those near the seams.
///
/// Fails as `combine`.
pub fn combine_in_stages(
    domain: Domain,
    pieces: &[Piece],
    options: &CombineOptions,
    observer: &mut dyn Observer,
) -> Result<Staged, CombineError> {
    check(&domain, pieces)?;

    // All samples count as near: the stages are to be looked at everywhere.
    let glued = glue(i32::MAX, domain, pieces, options, observer)?;

    let meter = Meter::begin(observer, Stage::Finish, 1)?;
    let mut run = empty(domain, pieces, options);
    // No counts are stated: they follow from the samples and the iterations, of which this run has all.
    run.result = glued.samples.kept();
    run.samples = glued.samples;
    run.tiles = glued.tiles;
    run.iterations = glued.iterations;

    let seams = layout::seams(&domain, pieces);
    meter.end()?;
    Ok(Staged { run, seams })
}

impl Combined {
    /// Returns the result as a finished run with its blocks, which are the pieces, its result and its counts, but
    /// without eliminated samples and iterations. Ids follow the canonical order. The pieces and options must be those
    /// that it was made from.
    #[must_use]
    pub fn into_run(self, pieces: &[Piece], options: &CombineOptions) -> Run {
        let mut run = empty(self.domain, pieces, options);
        run.set_result(self.points, &self.sources, self.summary);
        run
    }
}

/// Returns a run that has its domain, parameters and blocks, and no samples.
fn empty(domain: Domain, pieces: &[Piece], options: &CombineOptions) -> Run {
    let [width, height] = domain.size();

    // The leaf is the least length of an edge: here of the shortest edge of a piece. There is at least one piece.
    let sides = pieces.iter().map(|piece| {
        let rect = piece.rect;
        rect.width().min(rect.height())
    });

    let parameters = Parameters {
        width,
        height,
        radius: domain.radius(),
        boundary: domain.boundary(),
        seed: options.seed,
        leaf: f64::from(sides.min().unwrap_or(0)) / f64::from(R),
        order: options.order,
        insertion: options.insertion,
        search: options.search,
        // No pattern is made and no block is clipped from one: the other parameters are without effect.
        ..Parameters::default()
    };

    // A run has one pattern. Here each piece has its own, and the first stands for all of them.
    let mut run = Run::new(&parameters, domain, Arc::clone(&pieces[0].set));
    run.blocks = blocks(pieces, Key::from_seed(options.seed));
    run
}
