//! When the samples of a pattern arrived.

use std::sync::Arc;

use glam::I64Vec2;
use serde::{Deserialize, Serialize};

use crate::error::SampleError;
use crate::exact::darts::{Arrival, PatternDarts};
use crate::exact::pieces::pieces;
use crate::lattice::Point;
use crate::parameters::{PatternSpec, TilingMethod};
use crate::pattern::Pattern;
use crate::progress::Observer;
use crate::random::Key;
use crate::run::Run;
use crate::samples::Origin;

/// A pattern that knows its darts and the arrivals of its samples: all that exact tiling needs of a pattern, for an engine that
/// throws refused darts again where it needs them. [`super::PatternHistory`] keeps them, and so takes longer to make.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PatternArrivals {
    pattern: Arc<Pattern>,
    darts: PatternDarts,
    arrivals: Vec<Arrival>,
}

impl PatternArrivals {
    /// Returns the arrivals of the pattern that `spec` describes, and makes the pattern if it is not among the last few
    /// that were used ([`Pattern::of_spec`]).
    ///
    /// The observer is called for [`crate::Stage::Pattern`], and may stop it.
    pub fn of_spec(spec: &PatternSpec, observer: &mut dyn Observer) -> Result<Self, SampleError> {
        let pattern = Pattern::of_spec(spec, observer)?;
        Ok(Self::new(pattern, PatternDarts::of_spec(spec)?))
    }

    /// Returns the arrivals of the set that [`crate::reference_sample`] makes of the side, the boundary and the seed of `spec`.
    /// It is not the pattern that `spec` describes, whose darts have a key of their own, so that no pattern repeats the
    /// draws of a run with its seed.
    ///
    /// Fails when the side is out of range. The observer is called for [`crate::Stage::Pattern`], and may stop it.
    ///
    /// ```
    /// use tilescope_core::{Boundary, Domain, PatternArrivals, PatternSpec, Unobserved, reference_sample};
    ///
    /// let spec = PatternSpec { side: 20.0, seed: 7, ..PatternSpec::default() };
    /// let arrived = PatternArrivals::of_reference(&spec, &mut Unobserved)?;
    /// let domain = Domain::from_size([1.0, 1.0], 0.05, Boundary::Periodic)?;
    /// assert_eq!(arrived.pattern().samples(), reference_sample(domain, 7, &mut Unobserved)?);
    /// # Ok::<(), tilescope_core::SampleError>(())
    /// ```
    pub fn of_reference(
        spec: &PatternSpec,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let darts = PatternDarts::of_key(spec, Key::from_seed(spec.seed))?;
        let pattern = Pattern::of_seed(spec, spec.seed, observer)?;
        Ok(Self::new(Arc::new(pattern), darts))
    }

    /// Returns a pattern with the arrivals of its samples, which are among `darts`.
    fn new(pattern: Arc<Pattern>, darts: PatternDarts) -> Self {
        // Later darts at the place of a sample were refused by it.
        let arrivals = pattern.samples().iter().map(|&p| darts.first_at(p));
        Self {
            arrivals: arrivals.collect(),
            pattern,
            darts,
        }
    }

    /// Returns the pattern.
    #[must_use]
    pub const fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Returns all darts of the pattern.
    #[must_use]
    pub const fn darts(&self) -> &PatternDarts {
        &self.darts
    }

    /// Returns the arrivals of the pattern's samples, in their order.
    #[must_use]
    pub fn arrivals(&self) -> &[Arrival] {
        &self.arrivals
    }
}

impl Run {
    /// Returns when a sample arrived, whether it was lost or kept; `None` if there is no such sample, and for every run but a
    /// recorded exact tiling.
    ///
    /// A dart of the pattern has its arrival in every block. It is drawn again here: nothing is searched or kept.
    #[must_use]
    pub fn arrival_of(&self, sample: u32) -> Option<Arrival> {
        // Only recordings keep the tiles, without which an inserted sample's place in the pattern is not known.
        if self.parameters.method != TilingMethod::Exact || self.tiles.is_empty() {
            return None;
        }

        let source = match self.samples.origins.get(sample as usize)? {
            Origin::Tiled { pattern, .. } => *self.pattern.samples().get(*pattern as usize)?,
            Origin::Inserted { .. } => self.pattern_place(self.samples.points[sample as usize])?,
        };
        // Later darts at the same place were refused by this one.
        let darts = PatternDarts::of_spec(&self.parameters.pattern).ok()?;
        Some(darts.first_at(source))
    }

    /// Returns which place of the pattern the block at a place of the domain has there.
    fn pattern_place(&self, place: Point) -> Option<Point> {
        let blocks = self.blocks.leaves.iter().zip(&self.tiles);
        let (block, tile) = blocks
            .into_iter()
            .find(|(block, _)| block.rect.contains(place))?;

        let start = I64Vec2::new(tile.start.x.into(), tile.start.y.into());
        let held = self.pattern.domain().rect();
        let copies = pieces(0, &block.rect, start, tile.symmetry, &held);
        // Of the copies of the pattern in a block exactly one has the place.
        let sources = copies.iter().map(|copy| (copy, copy.source(place)));
        let mut found = sources.filter(|(copy, source)| copy.sources.contains(*source));
        found.next().map(|(_, source)| source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{PatternHistory, exact_recorded};
    use crate::parameters::Parameters;
    use crate::progress::Unobserved;
    use crate::record::Unrecorded;
    use crate::samples::Fate;
    use crate::varying::Shape;

    fn recorded(dihedral: bool) -> Run {
        let parameters = Parameters {
            radius: 0.02,
            leaf: 12.0,
            dihedral,
            method: TilingMethod::Exact,
            pattern: PatternSpec {
                side: 20.0,
                ..PatternSpec::default()
            },
            ..Parameters::default()
        };
        let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let shape = Shape::rectangle();
        exact_recorded(
            &parameters,
            &history,
            &shape,
            &mut Unobserved,
            &mut Unrecorded,
        )
        .unwrap()
    }

    #[test]
    fn a_sample_has_the_arrival_of_its_dart_in_the_pattern() {
        for dihedral in [false, true] {
            let run = recorded(dihedral);
            let mut lacking = 0;
            for (id, origin) in (0..).zip(&run.samples.origins) {
                let place = run.samples.points[id as usize];
                let arrival = run.arrival_of(id).unwrap();
                match *origin {
                    // Where a sample of the pattern was tiled, the block has the place of the pattern that it came from.
                    Origin::Tiled { pattern, .. } => {
                        let source = run.pattern.samples()[pattern as usize];
                        assert_eq!(run.pattern_place(place), Some(source), "{dihedral} {id}");
                    }
                    Origin::Inserted { iteration, .. } => {
                        assert_eq!(arrival.level().max(1), iteration, "{dihedral} {id}");
                        lacking += 1;
                    }
                }
                // What a sample was lost to came first, or at the same time at an earlier place.
                if let Fate::Eliminated { by } = run.samples.fates[id as usize] {
                    assert!(
                        run.arrival_of(by).unwrap() <= arrival,
                        "{dihedral} {id} {by}"
                    );
                }
            }
            assert!(lacking > 20, "{lacking}");
        }
    }

    #[test]
    fn other_runs_and_other_samples_have_no_arrival() {
        let mut run = recorded(false);
        let count = run.samples.origins.len() as u32;
        assert!(run.arrival_of(count - 1).is_some() && run.arrival_of(count).is_none());
        run.parameters.method = TilingMethod::Kdrt;
        assert_eq!(run.arrival_of(0), None);
    }
}
