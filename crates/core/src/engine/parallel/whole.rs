//! The run over a whole small periodic domain, for windows that no halo makes known: in a narrow domain the plane
//! repeats every few radii, and what is unsure at one end of a frame may reach the other through the repetitions.

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
use super::counts::Counts;
use super::frame::Frame;
use super::gaps::inserted_tag;
use super::region::Region;

/// The largest domain, in squared radii, that is run as a whole, which nobody can stop: about 700,000 samples. The longest
/// domains that are narrow enough to need it are not larger.
const MAX_AREA: f64 = 1_048_576.0;

/// How many times a domain lies in a frame that is not worth computing any more.
const REPETITIONS: f64 = 9.0;

/// The sequential run over a domain, made when it is first asked for.
pub(super) struct Whole {
    parameters: Parameters,
    pattern: Arc<Pattern>,
    area: f64,
    run: OnceLock<Result<Run, SampleError>>,
}

impl Whole {
    /// Returns the run of `parameters`, or `None` where the domain is too large for it, or is bounded: there a halo
    /// ends at the borders.
    pub(super) fn new(parameters: &Parameters, pattern: &Pattern, domain: &Domain) -> Option<Self> {
        let area = domain.area_radii();
        (domain.is_periodic() && area <= MAX_AREA).then(|| Self {
            parameters: *parameters,
            pattern: Arc::new(pattern.clone()),
            area,
            run: OnceLock::new(),
        })
    }

    /// Returns whether `frame` repeats the domain so often that the run is the shorter way.
    pub(super) fn is_shorter(&self, frame: &Frame) -> bool {
        let [columns, rows] = frame.cells.map(f64::from);
        columns * rows >= REPETITIONS * self.area
    }

    /// Lays `region` over `window`, a rectangle of the domain, shows there what the run has, and returns its counts.
    pub(super) fn show<const TAGS: bool>(
        &self,
        region: &mut Region<TAGS>,
        domain: &Domain,
        window: &Rect,
    ) -> Result<Counts, SampleError> {
        // The sequential engine is one thread: none that waits here can be the one that it waits for.
        let run = self.run.get_or_init(|| {
            let engine = Sequential::new(&self.parameters, Arc::clone(&self.pattern))?;
            let run = engine.finish(&mut Unobserved)?;
            Ok(Run {
                iterations: Vec::new(),
                ..run
            })
        });
        let run = run.as_ref().map_err(Clone::clone)?;
        region.reset(Frame::new(domain, window, 0), 0);
        let origin = region.frame.origin;
        let mut counts = Counts::default();
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
                    counts.insert(iteration as usize - 1, 1);
                    inserted_tag(iteration)
                }
            };
            match samples.fates[id] {
                Fate::Kept => {
                    let x = i64::from(point.x) - origin[0];
                    let y = i64::from(point.y) - origin[1];
                    region.insert(x as i32, y as i32, tag);
                }
                Fate::Eliminated { .. } => counts.eliminated += 1,
                Fate::Dropped | Fate::Undecided => {}
            }
        }
        Ok(counts)
    }
}
