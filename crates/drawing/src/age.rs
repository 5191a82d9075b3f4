//! The age of samples as a number from 0, early, to 1, late: tiled ones first, in order, then one step for each
//! iteration that inserted some. The colours are in [`crate::palette`].

use tilescope_core::Origin;

use tilescope_session::session::Session;

/// The age of the last tiled sample. Chosen, not measured, as is that of the first inserted ones.
pub const LAST_TILED: f32 = 0.62;
/// The age of the samples of the first iteration, clearly above the tiled ones.
const FIRST_INSERTED: f32 = 0.78;

/// The ages of a session's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ages {
    /// The number of tiled samples, if ids are in the order of tiling; otherwise the number of blocks.
    tiled: Result<u32, u32>,
    /// The number of iterations that inserted samples.
    pub iterations: u32,
    /// The number of samples where ids alone give the order: nested levels, and sets that are made by darts.
    ordered: Option<usize>,
}

impl Ages {
    /// Returns the ages of a session's samples. It takes time logarithmic in their number.
    pub fn of(session: &Session) -> Self {
        let run = session.run();
        let origins = &run.samples.origins;
        let is_tiled = |origin: &Origin| matches!(origin, Origin::Tiled { .. });

        // Ids are in the order of making, so that the first inserted one is found by bisection.
        Self {
            // Without stages samples are ordered by position, so that only the age of their block is known.
            tiled: if session.has_stages() {
                Ok(origins.partition_point(is_tiled) as u32)
            } else {
                Err(run.blocks.leaves.len() as u32)
            },
            // In a field, a shape or space these would be the throws of darts, whose samples have their age by `ordered`.
            iterations: if session.has_own_disks() {
                0
            } else {
                session.summary.inserted.len() as u32
            },
            // All samples, and not those of the result: a run that is cut off before an open question has none.
            ordered: (session.nested.is_some() || session.has_own_disks()).then_some(origins.len()),
        }
    }

    /// Returns the age of the last tiled sample; 1, that of the last sample, where ids alone give the order.
    #[must_use]
    pub fn last_tiled(&self) -> f32 {
        self.ordered.map_or(LAST_TILED, |_| 1.0)
    }

    /// Returns the age of a sample.
    #[must_use]
    pub fn of_sample(&self, id: u32, origin: &Origin) -> f32 {
        if let Some(count) = self.ordered {
            // A single sample has age 0, without a division by zero.
            return id as f32 / count.saturating_sub(1).max(1) as f32;
        }

        match *origin {
            Origin::Tiled { block, .. } => {
                let (before, all) = match self.tiled {
                    Ok(tiled) => (id, tiled),
                    Err(blocks) => (block, blocks),
                };
                let share = before as f32 / all.saturating_sub(1).max(1) as f32;
                // A caller may ask about any id.
                LAST_TILED * share.min(1.0)
            }
            Origin::Inserted { iteration, .. } => self.of_iteration(iteration),
        }
    }

    /// Returns the age of the samples of an iteration, counted from 1.
    #[must_use]
    pub fn of_iteration(&self, iteration: u32) -> f32 {
        let share = match self.iterations {
            0 | 1 => 1.0,
            all => iteration.saturating_sub(1) as f32 / (all - 1) as f32,
        };
        FIRST_INSERTED + (1.0 - FIRST_INSERTED) * share.min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::stages::detect::Sites;

    #[test]
    #[allow(clippy::float_cmp, reason = "the ends of the ramp are exact")]
    fn ages_grow_with_the_order_of_samples() {
        let tiled = |block| Origin::Tiled {
            block,
            pattern: 0,
            own: true,
        };
        let inserted = |iteration| Origin::Inserted {
            iteration,
            sites: Sites::Unrecorded,
        };
        for kept in [Ok(100), Err(9)] {
            let ages = Ages {
                tiled: kept,
                iterations: 3,
                ordered: None,
            };
            let ages = [
                ages.of_sample(0, &tiled(0)),
                ages.of_sample(50, &tiled(4)),
                ages.of_sample(99, &tiled(8)),
                ages.of_sample(100, &inserted(1)),
                ages.of_sample(120, &inserted(2)),
                ages.of_sample(121, &inserted(3)),
            ];
            assert!(ages.windows(2).all(|pair| pair[0] < pair[1]), "{ages:?}");
            assert_eq!((ages[0], ages[2]), (0.0, LAST_TILED));
            assert_eq!((ages[3], ages[5]), (FIRST_INSERTED, 1.0));
        }
        let one = Ages {
            tiled: Ok(1),
            iterations: 1,
            ordered: None,
        };
        assert_eq!(one.of_sample(0, &tiled(0)), 0.0);
        assert_eq!(one.of_iteration(1), 1.0);
    }
}
