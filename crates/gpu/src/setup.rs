//! Data that all windows of a run share: the domain, the tree of blocks, the pattern in the device's layout, the
//! constants of the orders and of detection.

use tilescope_core::stages::order::{RankNumbers, Ranking};
use tilescope_core::windows::{CellPattern, Clipper, lost_reach, reach_cells};
use tilescope_core::{Domain, Insertion, Key, Parameters, Pattern, R, SampleError, Search};

/// Words of a pattern's shape: sides, columns, where its cells and its points begin, whether it repeats.
const SHAPE_WORDS: u32 = 6;

/// Data of a run that does not depend on the window.
pub(crate) struct Setup {
    pub parameters: Parameters,
    pub domain: Domain,
    pub key: Key,
    pub clipper: Clipper,
    pub ranks: RankNumbers,
    /// The largest distance, in cells, from a lost sample to an uncovered place that must be found.
    pub lost_reach: i32,
    /// The pattern's variants as words.
    pub pattern: Vec<u32>,
    /// Samples of the pattern to a squared radius.
    pub density: f64,
    /// Whether the sources of samples are returned.
    pub sources: bool,
}

impl Setup {
    /// Returns the setup of a run.
    ///
    /// Fails when the parameters cannot be sampled or ask for Algorithm 4 as printed.
    pub(crate) fn new(
        parameters: &Parameters,
        pattern: &Pattern,
        sources: bool,
    ) -> Result<Self, SampleError> {
        let domain = parameters.validate()?;
        parameters.check_parallel()?;

        let key = Key::from_seed(parameters.seed);
        let leaf = parameters.leaf_units()?;
        let mut clipper = Clipper::new(domain, leaf, key, pattern, parameters.dihedral);
        clipper.check_blocks()?;
        pattern.check_domain(&domain)?;
        // Only sources name blocks by their index.
        if sources {
            clipper.count_blocks();
        }

        Ok(Self {
            parameters: *parameters,
            domain,
            key,
            ranks: Ranking::new(parameters.order, &domain, key).numbers(),
            lost_reach: lost_reach(pattern, &domain, parameters.insertion),
            pattern: pattern_words(clipper.variants()),
            density: pattern.samples().len() as f64 / pattern.domain().area_radii(),
            clipper,
            sources,
        })
    }

    /// Returns how many cells away an unsure cell can affect the detection of iteration 1. Candidates are up to 2r + 16
    /// units from their samples, 3.5r in bounded domains, and a lost sample 2r + 4 units further makes those samples
    /// detectors: in whole cells of r, 5 or 6. In uniform insertion only samples that covered the place matter.
    pub(crate) fn first_reach(&self) -> u32 {
        match self.parameters.insertion {
            Insertion::Circumcentre if self.domain.is_periodic() => 5.max(self.lost_reach as u32),
            Insertion::Circumcentre => 6.max(self.lost_reach as u32),
            Insertion::Uniform => self.lost_reach as u32,
        }
    }

    /// Returns the same for later iterations.
    pub(crate) fn later_reach(&self) -> u32 {
        reach_cells(self.domain.is_periodic()) as u32
    }

    /// Returns the radius in which detectors search for other samples: far from closed borders, and near them.
    pub(crate) fn search(&self) -> [i32; 2] {
        // Twice the radius in which a detector finds candidates, as in core's `Reach`.
        match self.parameters.search {
            Search::Complete => [4 * R + 32, 7 * R],
            Search::TwoRadii => [2 * R, 2 * R],
        }
    }

    /// Returns how many cells the domain touches on each axis.
    pub(crate) fn cells(&self) -> [u32; 2] {
        let max = self.domain.rect().max;
        [max.x, max.y].map(|side| ((side - 1) / R + 1) as u32)
    }

    /// Returns the word at which a variant's shape begins.
    pub(crate) const fn shape_of(symmetry: u8) -> u32 {
        symmetry as u32 * SHAPE_WORDS
    }
}

/// Returns the variants as words: first all shapes, then for each variant the starts of its cells and its points.
fn pattern_words(variants: &[CellPattern]) -> Vec<u32> {
    let mut words = vec![0; variants.len() * SHAPE_WORDS as usize];
    for (variant, shape_at) in variants.iter().zip((0..).step_by(SHAPE_WORDS as usize)) {
        let starts_at = words.len() as u32;
        words.extend(&variant.starts);
        let points_at = words.len() as u32;
        // `xs` and `ys` are padded for instructions that read eight at once; `ids` ends the list.
        for ((x, y), id) in variant.xs.iter().zip(&variant.ys).zip(&variant.ids) {
            words.extend([x, y, id]);
        }

        let shape = &variant.shape;
        let described = [
            shape.width as u32,
            shape.height as u32,
            variant.columns as u32,
            starts_at,
            points_at,
            u32::from(shape.periodic),
        ];
        words[shape_at..shape_at + described.len()].copy_from_slice(&described);
    }
    words
}
