//! Where a whole domain has each place of the pattern, for an engine that lays down the samples elsewhere.

use glam::I64Vec2;

use crate::error::SampleError;
use crate::exact::engine::clipper;
use crate::exact::ground::Ground;
use crate::exact::pieces::pieces;
use crate::lattice::Rect;
use crate::parameters::Parameters;
use crate::pattern::{Pattern, Symmetry};

/// The part of a block that one copy of the pattern fills, in a whole domain.
///
/// A place `p` of the pattern in [`Self::sources`] lies at `origin + symmetry.turn(p)` of the domain, where sums keep their low
/// 32 bits. Darts of the pattern in it are the darts of the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactPiece {
    /// The index of its block. The pieces of a block follow each other.
    pub block: u32,
    /// The block's places in the domain.
    pub block_rect: Rect,
    /// The places of the pattern that the piece has.
    pub sources: Rect,
    /// How the copy is turned.
    pub symmetry: Symmetry,
    /// Where the domain has the pattern's place 0 in x and y, if the copy went on so far; modulo 2^32.
    pub origin: [i32; 2],
}

/// Returns the pieces of all blocks of an exact tiling, block by block, and how many blocks there are.
///
/// Fails when the parameters cannot be sampled, or a bounded pattern is too small for a block.
pub fn exact_pieces(
    parameters: &Parameters,
    pattern: &Pattern,
) -> Result<(Vec<ExactPiece>, usize), SampleError> {
    let mut run_clipper = clipper(parameters, pattern)?;
    run_clipper.check_blocks()?;
    // A piece names its block by the index, which blocks have only once they are counted.
    run_clipper.count_blocks();

    let ground = Ground::whole(&parameters.validate()?);
    let mut blocks = Vec::new();
    run_clipper.blocks(&ground.frame, &mut blocks)?;

    let held = pattern.domain().rect();
    let mut all = Vec::with_capacity(blocks.len());
    let mut count = 0;
    for block in &blocks {
        // Images of blocks beyond a periodic domain's ends reach into it with their margins alone.
        let Some(rect) = block.rect.within(&ground.rect()) else {
            continue;
        };

        // `block.start` is where the turned pattern has the lowest corner of the block enlarged by r. `start` is where
        // it has that of `rect` enlarged by r.
        let start = I64Vec2::from(block.start) + I64Vec2::from(rect.min) - block.rect.min;
        let symmetry = Symmetry(block.symmetry);
        let placed = pieces(count, &rect, start, symmetry, &held);
        all.extend(placed.into_iter().map(|piece| ExactPiece {
            block: block.index,
            block_rect: rect,
            sources: piece.sources,
            symmetry: piece.symmetry,
            origin: piece.origin.to_array(),
        }));
        count += 1;
    }
    Ok((all, count as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::parameters::PatternSpec;
    use crate::progress::Unobserved;

    /// Pieces are apart and fill the domain, so that each dart of a block is one of the run, once.
    #[test]
    fn pieces_fill_a_domain_once() {
        for (boundary, dihedral) in [(Boundary::Periodic, true), (Boundary::Bounded, false)] {
            let parameters = Parameters {
                width: 31.0,
                height: 22.3,
                radius: 1.0,
                leaf: 7.0,
                boundary,
                dihedral,
                pattern: PatternSpec {
                    side: 10.5,
                    ..PatternSpec::default()
                },
                ..Parameters::default()
            };
            let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
            let (pieces, blocks) = exact_pieces(&parameters, &pattern).unwrap();
            // Blocks are longer than the pattern, so that some have several pieces.
            assert!(blocks > 5 && pieces.len() > blocks);

            let area = |rect: &Rect| i64::from(rect.width()) * i64::from(rect.height());
            let rect = parameters.validate().unwrap().rect();
            let sum: i64 = pieces.iter().map(|piece| area(&piece.sources)).sum();
            assert_eq!(sum, area(&rect));
            for piece in &pieces {
                let min = piece.sources.min;
                let turned = piece.symmetry.turn(glam::IVec2::new(min.x, min.y));
                let [x, y] = piece.origin;
                let place =
                    crate::lattice::Point::new(x.wrapping_add(turned.x), y.wrapping_add(turned.y));
                assert!(piece.block_rect.contains(place) && rect.contains(place));
            }
        }
    }
}
