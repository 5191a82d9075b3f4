//! A run: the data of all stages, filled by an engine. Since samples keep their origin and fate, the state after any
//! stage can be read from the finished run.

use std::ops::Range;
use std::sync::Arc;

use crate::error::SampleError;
use crate::lattice::{Domain, Point};
use crate::parameters::{Parameters, TilingMethod, Variant};
use crate::pattern::Pattern;
use crate::random::Key;
use crate::samples::{Fate, Origin, Sampled, Samples, Sites, Source};
use crate::stage::Stage;
use crate::stages::blocks::{Blocks, split};
use crate::stages::detect::Candidate;
use crate::stages::disks::Cell;
use crate::stages::tile::Tile;
use crate::varying::Locality;

/// The data of one iteration of detection and insertion.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Iteration {
    /// Ids of the gap detectors; empty with uniform insertion.
    pub detectors: Vec<u32>,
    /// The candidates, by position; empty with uniform insertion and in Algorithm 4 as printed, which insert at once.
    pub candidates: Vec<Candidate>,
    /// The active cells of uniform insertion.
    pub cells: Vec<Cell>,
    /// Ids of the inserted samples.
    pub inserted: Range<u32>,
}

/// The status of a sample after a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// It does not exist yet.
    Absent,
    /// It exists, and nothing has been decided.
    Tiled,
    /// It is valid: kept by elimination, or inserted.
    Valid,
    /// It was eliminated by a sample.
    Eliminated {
        /// The id of that sample.
        by: u32,
    },
    /// It lies outside a bounded domain.
    Dropped,
}

/// A run in progress or finished.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Run {
    /// The parameters from which it was made.
    pub parameters: Parameters,
    /// The domain on the lattice.
    pub domain: Domain,
    /// The pattern from which its blocks clip.
    pub pattern: Arc<Pattern>,
    /// The KD-tree; empty before [`Stage::Blocks`].
    pub blocks: Blocks,
    /// A tile per block; empty before [`Stage::Tile`].
    pub tiles: Vec<Tile>,
    /// All samples by id, with those that were dropped or eliminated.
    pub samples: Samples,
    /// The iterations so far.
    pub iterations: Vec<Iteration>,
    /// Ids of the result in canonical order, or of a set that the reference sampler made of darts (in a field, a shape or space)
    /// in the order of arrival; empty before [`Stage::Finish`].
    pub result: Vec<u32>,
    /// The counts of a run that kept only its result ([`crate::Sweep::run`]).
    pub counted: Option<Summary>,
    /// Where its radius depends on the place, or its domain is a shape ([`crate::varying_recorded`]). The engines of exact
    /// tiling leave it out: callers who tile a shape add it.
    pub locality: Option<Arc<Locality>>,
}

/// The counts of a run.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// The number of building blocks.
    pub blocks: usize,
    /// Samples tiled inside the domain.
    pub tiled: usize,
    /// Samples tiled outside a bounded domain.
    pub dropped: usize,
    /// Samples eliminated by another one.
    pub eliminated: usize,
    /// Samples inserted, by iteration, up to the last one that inserted any.
    pub inserted: Vec<usize>,
    /// Samples in the result.
    pub count: usize,
}

impl Run {
    /// Returns a run before its first stage.
    #[must_use]
    pub fn new(parameters: &Parameters, domain: Domain, pattern: Arc<Pattern>) -> Self {
        Self {
            parameters: *parameters,
            domain,
            pattern,
            blocks: Blocks::default(),
            tiles: Vec::new(),
            samples: Samples::default(),
            iterations: Vec::new(),
            result: Vec::new(),
            counted: None,
            locality: None,
        }
    }

    /// Returns a finished run of given samples in canonical order with their sources. It has its blocks, its result and
    /// its counts, but no eliminated samples, iterations and sites. Ids follow the canonical order. Without sources it
    /// would have no samples: callers ask for them.
    ///
    /// Fails when the parameters cannot be sampled.
    pub fn of_result(
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        sampled: Sampled,
        summary: Summary,
    ) -> Result<Self, SampleError> {
        let mut run = Self::new(parameters, parameters.validate()?, Arc::clone(pattern));
        let key = Key::from_seed(parameters.seed);
        run.blocks = split(&run.domain, parameters.leaf_units()?, key);
        let sources = sampled.sources.unwrap_or_default();
        run.set_result(sampled.points, &sources, summary);
        Ok(run)
    }

    /// Makes given samples in canonical order the result of a run that has its blocks.
    pub(crate) fn set_result(&mut self, points: Vec<Point>, sources: &[Source], counted: Summary) {
        let origin = |(point, source): (&Point, &Source)| match *source {
            Source::Tiled { block, pattern } => Origin::Tiled {
                block,
                pattern,
                // Only the place in the domain is known. A block's margin may reach across a periodic border into the
                // block itself: samples in that overlap count as the block's own here.
                own: self.blocks.leaves[block as usize].rect.contains(*point),
            },
            Source::Inserted { iteration } => Origin::Inserted {
                iteration,
                sites: Sites::Unrecorded,
            },
        };

        let origins: Vec<Origin> = points.iter().zip(sources).map(origin).collect();
        let count = origins.len();

        self.samples = Samples {
            points,
            origins,
            fates: vec![Fate::Kept; count],
        };

        // There are no samples but those of the result, so that an id is an index in it.
        self.result = (0..count as u32).collect();
        self.counted = Some(counted);
    }

    /// Returns a finished run of samples in an order of their own, of which nothing else is known: it has no pattern
    /// and no blocks, and all samples count as tiled.
    #[must_use]
    pub fn of_points(parameters: Parameters, domain: Domain, points: Vec<Point>) -> Self {
        let count = points.len();
        // An origin names a block and a pattern sample, and whether the sample lies in the block's margin. None of
        // these is known: the values are placeholders.
        let origin = Origin::Tiled {
            block: 0,
            pattern: 0,
            own: true,
        };

        let covers_lattice = false;
        let no_pattern = Pattern::of_samples(&domain, Vec::new(), covers_lattice);

        Self {
            parameters,
            domain,
            pattern: Arc::new(no_pattern),
            blocks: Blocks::default(),
            tiles: Vec::new(),
            samples: Samples {
                points,
                origins: vec![origin; count],
                fates: vec![Fate::Kept; count],
            },
            iterations: Vec::new(),
            result: (0..count as u32).collect(),
            counted: Some(Summary {
                blocks: 0,
                tiled: count,
                dropped: 0,
                eliminated: 0,
                inserted: Vec::new(),
                count,
            }),
            locality: None,
        }
    }

    /// Returns the finished run of darts that became samples in this order, throw by throw, with its locality. It has
    /// no pattern and no blocks.
    #[must_use]
    pub fn of_darts(
        parameters: Parameters,
        locality: &Arc<Locality>,
        points: Vec<Point>,
        iterations: Vec<Iteration>,
    ) -> Self {
        let domain = *locality.field.domain();
        Self {
            locality: Some(Arc::clone(locality)),
            ..Self::of_throws(parameters, domain, points, iterations)
        }
    }

    /// Returns the finished run of darts that became samples in this order, throw by throw, in a rectangle. It has no pattern
    /// and no blocks.
    pub(crate) fn of_throws(
        parameters: Parameters,
        domain: Domain,
        points: Vec<Point>,
        iterations: Vec<Iteration>,
    ) -> Self {
        let mut origins = Vec::with_capacity(points.len());
        // The samples of a throw follow those of the throws before it.
        for (number, iteration) in (1..).zip(&iterations) {
            let origin = Origin::Inserted {
                iteration: number,
                sites: Sites::Dart,
            };
            origins.resize(iteration.inserted.end as usize, origin);
        }

        let fates = vec![Fate::Kept; points.len()];
        Self {
            // The order of arrival, not the canonical one: sets of darts have no other.
            result: (0..points.len() as u32).collect(),
            samples: Samples {
                points,
                origins,
                fates,
            },
            iterations,
            // The samples and the iterations are there to be counted.
            counted: None,
            ..Self::of_points(parameters, domain, Vec::new())
        }
    }

    /// Returns the result's lattice points, in the order of [`Self::result`].
    #[must_use]
    pub fn points(&self) -> Vec<Point> {
        self.result
            .iter()
            .map(|&id| self.samples.points[id as usize])
            .collect()
    }

    /// Returns the result in user units, in the order of [`Self::result`].
    #[must_use]
    pub fn positions(&self) -> Vec<[f64; 2]> {
        self.domain.users_from_lattice(&self.points())
    }

    /// Returns the stages that have run, in order.
    #[must_use]
    pub fn stages(&self) -> Vec<Stage> {
        // There are five stages besides the iterations: pattern, blocks, tiling, elimination and finish.
        let mut stages = Vec::with_capacity(5 + self.iterations.len());
        // Also runs without a pattern begin with this stage.
        stages.push(Stage::Pattern);

        if !self.blocks.leaves.is_empty() {
            stages.push(Stage::Blocks);
        }

        if !self.tiles.is_empty() {
            stages.push(Stage::Tile);
            // Any fate but these two shows that elimination has run: tiling drops samples, and leaves all others
            // undecided.
            let decided = |fate: &Fate| !matches!(fate, Fate::Undecided | Fate::Dropped);
            // Exact tiling has no stage of elimination: samples are lost in the iterations, when they arrive.
            let eliminates = self.parameters.method == TilingMethod::Kdrt;
            if eliminates && self.samples.fates.iter().any(decided) {
                stages.push(Stage::Eliminate);
            }
        }

        // In Algorithm 4 as printed iteration 1 is part of elimination.
        let arrivals = (1..=self.iterations.len() as u32).map(|k| self.arrival(k));
        stages.extend(arrivals.filter(|&stage| stage != Stage::Eliminate));

        if !self.result.is_empty() {
            stages.push(Stage::Finish);
        }
        stages
    }

    /// Returns the status of sample `id` after `stage`. In Algorithm 4 as printed the samples of iteration 1 are there
    /// after [`Stage::Eliminate`] already, since that loop inserts them. In exact tiling, where samples are lost when
    /// they arrive, each has its last fate from iteration 1 on.
    #[must_use]
    pub fn standing(&self, id: u32, stage: Stage) -> Standing {
        match self.samples.origins[id as usize] {
            Origin::Inserted { iteration, .. } if stage >= self.arrival(iteration) => {
                Standing::Valid
            }
            Origin::Inserted { .. } => Standing::Absent,
            Origin::Tiled { .. } if stage < Stage::Tile => Standing::Absent,
            // A sample is dropped when it is tiled, and its other fates are decided from elimination on.
            Origin::Tiled { .. } => match self.samples.fates[id as usize] {
                Fate::Dropped => Standing::Dropped,
                _ if stage < Stage::Eliminate => Standing::Tiled,
                Fate::Undecided => Standing::Tiled,
                Fate::Kept => Standing::Valid,
                Fate::Eliminated { by } => Standing::Eliminated { by },
            },
        }
    }

    /// Returns the stage that inserts the samples of `iteration`.
    fn arrival(&self, iteration: u32) -> Stage {
        match self.parameters.variant {
            Variant::AsPrinted if iteration == 1 => Stage::Eliminate,
            _ => Stage::Iterate(iteration),
        }
    }

    /// Returns the counts so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        if let Some(counted) = &self.counted {
            return counted.clone();
        }

        let count = |test: fn(&Fate) -> bool| self.samples.fates.iter().filter(|f| test(f)).count();
        let mut inserted: Vec<usize> = self.iterations.iter().map(|i| i.inserted.len()).collect();
        // Uniform insertion also throws in vain, and how often depends on the engine, which may skip covered cells
        // (crates/decisions/arithmetic-and-bits.md).
        while inserted.last() == Some(&0) {
            inserted.pop();
        }

        let dropped = count(|f| *f == Fate::Dropped);
        Summary {
            blocks: self.blocks.leaves.len(),
            tiled: self.samples.len() - dropped - inserted.iter().sum::<usize>(),
            dropped,
            eliminated: count(|f| matches!(f, Fate::Eliminated { .. })),
            inserted,
            count: self.result.len(),
        }
    }
}
