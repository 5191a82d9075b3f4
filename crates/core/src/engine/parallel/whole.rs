//! The run over a whole small periodic domain, for windows that no halo can decide: in a narrow domain the plane
//! repeats every few radii, and uncertainty at one end of a frame may spread to the other through the repetitions.

use glam::I64Vec2;
use std::sync::{Arc, OnceLock};

use crate::engine::sequential::Sequential;
use crate::error::SampleError;
use crate::lattice::{Domain, Rect};
use crate::parameters::Parameters;
use crate::pattern::Pattern;
use crate::progress::Unobserved;
use crate::run::Run;
use crate::samples::{Fate, Origin};

use super::claim::tiled_tag;
use super::counts::WindowCounts;
use super::frame::Frame;
use super::gaps::inserted_tag;
use super::region::Region;

/// The largest domain, in squared radii, that is run as a whole, which cannot be cancelled: about 700,000 samples. The
/// longest domains that are narrow enough to need this are not larger.
const MAX_AREA: f64 = 1_048_576.0;

/// A frame that repeats the domain this often is not worth computing. Chosen, not measured.
const REPETITIONS: f64 = 9.0;

/// The sequential run over a domain, made when it is first needed.
pub(super) struct Whole {
    parameters: Parameters,
    pattern: Arc<Pattern>,
    area: f64,
    run: OnceLock<Result<Run, SampleError>>,
}

impl Whole {
    /// Returns the run of `parameters`, or `None` if the domain is too large, or bounded, so that a halo ends at its
    /// borders.
    pub(super) fn new(parameters: &Parameters, pattern: &Pattern, domain: &Domain) -> Option<Self> {
        let area = domain.area_radii();
        (domain.is_periodic() && area <= MAX_AREA).then(|| Self {
            parameters: *parameters,
            pattern: Arc::new(pattern.clone()),
            area,
            run: OnceLock::new(),
        })
    }

    /// Returns whether `frame` repeats the domain so often that running the whole domain is faster.
    pub(super) fn is_shorter(&self, frame: &Frame) -> bool {
        let [columns, rows] = frame.cells.map(f64::from);
        columns * rows >= REPETITIONS * self.area
    }

    /// Fills `region` with the run's samples in `window`, a rectangle of the domain, and returns their counts.
    pub(super) fn show<const TAGS: bool>(
        &self,
        region: &mut Region<TAGS>,
        domain: &Domain,
        window: &Rect,
    ) -> Result<WindowCounts, SampleError> {
        // The sequential engine uses one thread, so threads that wait here cannot block it.
        let run = self.run.get_or_init(|| {
            let engine = Sequential::new(&self.parameters, Arc::clone(&self.pattern))?;
            let run = engine.finish(&mut Unobserved)?;
            // Iterations are not read here, and need not be kept.
            Ok(Run {
                iterations: Vec::new(),
                ..run
            })
        });
        let run = run.as_ref().map_err(Clone::clone)?;

        // All samples are known, so that the frame needs no halo, and nothing reaches in from beyond it.
        let (halo, reach) = (0, 0);
        region.reset(Frame::new(domain, window, halo), reach);
        let origin = region.frame.origin;

        let mut counts = WindowCounts::default();
        let corners = run.blocks.leaves.iter().map(|block| block.rect.min);
        counts.blocks = corners.filter(|&corner| window.contains(corner)).count() as u64;

        let samples = &run.samples;
        for (id, point) in samples.points.iter().enumerate() {
            if !window.contains(*point) {
                continue;
            }
            let tag = match samples.origins[id] {
                Origin::Tiled { block, pattern, .. } => tiled_tag(block, pattern),
                Origin::Inserted { iteration, .. } => {
                    // Iterations are numbered from 1.
                    counts.insert(iteration as usize - 1, 1);
                    inserted_tag(iteration)
                }
            };

            match samples.fates[id] {
                Fate::Kept => {
                    let at = I64Vec2::from(*point) - origin;
                    region.insert(at.x as i32, at.y as i32, tag);
                }
                Fate::Eliminated { .. } => counts.eliminated += 1,
                // A periodic domain drops no sample, and a finished run has decided all.
                Fate::Dropped | Fate::Undecided => {}
            }
        }

        Ok(counts)
    }
}
