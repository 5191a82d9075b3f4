//! The plane of a run: holds its parameters, computes windows of it (`compute`), and reuses buffers. A window with
//! unsure cells is repaired: these cells are computed again with a wider halo, or read from the run over the whole
//! domain if that is small.

use fearless_simd::dispatch;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, Rect};
use crate::parameters::{Insertion, Order, Parameters};
use crate::pattern::Pattern;
use crate::pool::Pool;
use crate::random::Key;
use crate::stages::order::Ranking;

use super::claim::Turns;
use super::clip::Clipper;
use super::counts::WindowCounts;
use super::frame::{CELL_BITS, Frame};
use super::gaps::Rules;
use super::region::Region;
use super::whole::Whole;
use super::window_maker::{WindowMaker, WindowSamples};
use crate::instructions::InstructionSet;

/// Initial width of the halo in cells. Wider halos would cost more in every window than repairs do in a few.
const HALO: i32 = 6;

/// The most repairs of repairs: a halo of 768 cells. One suffices nearly always; only a pattern from a file with
/// holes everywhere could need more.
const MAX_REPAIRS: usize = 7;

/// Unsure cells at most this many cells from each other are repaired together (chosen, not measured).
const NEIGHBOURS: i32 = 8;

/// The plane of a run, from which any window can be computed alone.
///
/// The samples are exactly those of the run over the whole domain, whatever the window, the number of threads and the
/// instruction set.
///
/// ```
/// use tilescope_core::{Parameters, Pattern, Plane, Unobserved, WindowMaker};
///
/// // A window of a run of two thousand million samples.
/// let parameters = Parameters { radius: 2e-5, ..Parameters::default() };
/// let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
/// let plane = Plane::new(&parameters, &pattern)?;
/// let window = plane.domain().window([0.5, 0.5], [0.501, 0.501])?;
/// let samples = plane.window(&window)?;
/// assert!((1_650..1_850).contains(&samples.len()));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub struct Plane {
    domain: Domain,
    order: Order,
    /// Whether a block may be as long as the periodic domain, and so touch its own image.
    touches_itself: bool,
    clipper: Clipper,
    ranking: Ranking,
    rules: Rules,
    instructions: InstructionSet,
    /// The run over the whole domain, if that is small and periodic.
    whole: Option<Whole>,
    plain: Pool<Scratch<false>>,
    #[cfg(not(tilescope_untagged))]
    tagged: Pool<Scratch<true>>,
}

impl Plane {
    /// Returns the plane of `parameters` with `pattern`, which need not be the one that the parameters
    /// describe.
    ///
    /// Fails when the parameters cannot be sampled, also with this pattern, or ask for Algorithm 4 as printed, which is
    /// one loop over all samples.
    pub fn new(parameters: &Parameters, pattern: &Pattern) -> Result<Self, SampleError> {
        let domain = parameters.validate()?;
        parameters.check_parallel()?;

        let key = Key::from_seed(parameters.seed);
        let leaf = parameters.leaf_units()?;
        let clipper = Clipper::new(domain, leaf, key, pattern, parameters.dihedral);
        clipper.check_blocks()?;
        pattern.check_domain(&domain)?;

        // A side shorter than two leaves is never cut: its blocks are as long as a periodic domain, and touch themselves.
        let short = domain.width() / 2 < leaf || domain.height() / 2 < leaf;
        let rules = Rules {
            domain,
            search: parameters.search,
            key,
            lost_reach: lost_reach(pattern, &domain, parameters.insertion),
            insertion: parameters.insertion,
        };

        Ok(Self {
            domain,
            order: parameters.order,
            touches_itself: domain.is_periodic() && short,
            clipper,
            ranking: Ranking::new(parameters.order, &domain, key),
            rules,
            instructions: InstructionSet::best(),
            whole: Whole::new(parameters, pattern, &domain),
            plain: Pool::default(),
            #[cfg(not(tilescope_untagged))]
            tagged: Pool::default(),
        })
    }

    /// Returns the plane computed with `instructions` instead of the best ones. The points are the same.
    #[must_use]
    pub fn with_instructions(mut self, instructions: InstructionSet) -> Self {
        self.instructions = instructions;
        self
    }

    /// Counts the blocks, so that tags name them.
    pub(super) fn count_blocks(&mut self) {
        self.clipper.count_blocks();
    }

    /// Appends the samples of a window just computed: see [`Region::emit`].
    pub(super) fn emit<const TAGS: bool>(
        &self,
        scratch: &mut Scratch<TAGS>,
        out: &mut Vec<Point>,
        tags: &mut Vec<u64>,
        rows: &mut Vec<u32>,
    ) {
        let region = &mut scratch.0[0];
        dispatch!(self.instructions.level(), _simd => region.emit(out, tags, rows));
    }

    /// Computes a window in the region number `depth` of `scratch`, and adds its counts to `counts`. Depth 0 is the
    /// window that was asked for, each further one a repair of the one before, with twice its halo. The window is not
    /// empty and lies in the domain.
    pub(super) fn compute<const TAGS: bool>(
        &self,
        scratch: &mut Scratch<TAGS>,
        depth: usize,
        window: &Rect,
        counts: &mut WindowCounts,
    ) -> Result<(), SampleError> {
        let is_beyond_repair = depth > MAX_REPAIRS;
        if is_beyond_repair && self.whole.is_none() {
            return Err(SampleError::Entangled {
                radii: f64::from(HALO << MAX_REPAIRS),
            });
        }

        while scratch.0.len() <= depth {
            scratch.0.push(Box::default());
        }

        let region = &mut *scratch.0[depth];
        let frame = Frame::new(&self.domain, window, HALO << depth);
        // Uncertainty may spread around a small periodic domain without end, whatever the halo: such a domain is run
        // as a whole. The first halo, which nearly always suffices, is tried in any case.
        if let Some(whole) = &self.whole
            && (is_beyond_repair || depth > 0 && whole.is_shorter(&frame))
        {
            counts.add(&whole.show(region, &self.domain, window)?);
            return Ok(());
        }

        region.reset(frame, self.rules.reach());
        self.clipper.blocks(&region.frame, &mut region.blocks)?;
        let turns = Turns::new(self.order, self.touches_itself, &self.ranking);
        dispatch!(self.instructions.level(), simd => {
            region.claim(simd, &self.clipper, &turns);
            match self.rules.insertion {
                Insertion::Circumcentre => region.fill(simd, &self.rules),
                Insertion::Uniform => region.fill_uniformly(simd, &self.rules),
            }
        });

        // The list is taken out of the region, since the repairs below need all of `scratch`, to which they add
        // regions.
        let mut unsure = std::mem::take(&mut region.repairs);
        region.unsure_in_window(NEIGHBOURS, &mut unsure);
        region.count(&unsure, counts);

        // One window in some hundred has unsure cells, which are computed again with a wider halo. A halo that always
        // suffices would cost all windows more than repairs cost those few.
        for cells in &unsure {
            let region = &scratch.0[depth];
            let part = part_of(&region.frame, cells, window);
            self.compute(scratch, depth + 1, &part, counts)?;
            let (known, wider) = scratch.0.split_at_mut(depth + 1);
            known[depth].adopt(&wider[0], cells);
        }

        scratch.0[depth].repairs = unsure;
        Ok(())
    }
}

/// Returns how many cells away from a lost sample places may lie that no sample covers and that the
/// sequential engine would find.
#[must_use]
pub fn lost_reach(pattern: &Pattern, domain: &Domain, insertion: Insertion) -> i32 {
    match insertion {
        // A place that is not covered was covered by a lost sample, which is within 1 r.
        _ if pattern.covers_lattice() => 1,
        // A place may also be one that the pattern itself missed, near a detector near a lost sample:
        // 4r, or 5.5r near closed borders, and a few units.
        Insertion::Circumcentre if domain.is_periodic() => 5,
        Insertion::Circumcentre => 6,
        // Or in a cell of the dart process that a lost sample's surroundings touch: at most two cells away.
        Insertion::Uniform => 2,
    }
}

/// Returns the intersection of `cells` of a frame and `window`, in the domain.
fn part_of(frame: &Frame, cells: &Rect, window: &Rect) -> Rect {
    // A frame may reach beyond the domain, where coordinates may be too large for 32 bits, or below 0.
    let at = |cell: i32, axis: usize| {
        (frame.origin[axis] + (i64::from(cell) << CELL_BITS)).clamp(0, i32::MAX.into()) as i32
    };
    Rect {
        min: Point::new(
            at(cells.min.x, 0).max(window.min.x),
            at(cells.min.y, 1).max(window.min.y),
        ),
        max: Point::new(
            at(cells.max.x, 0).min(window.max.x),
            at(cells.max.y, 1).min(window.max.y),
        ),
    }
}

impl WindowMaker for Plane {
    // In cells. Smaller windows compute more halo for each sample.
    const MAX_SIDE: i32 = 320;

    fn domain(&self) -> &Domain {
        &self.domain
    }

    fn fill(
        &self,
        window: &Rect,
        with_tags: bool,
        out: &mut WindowSamples,
    ) -> Result<(), SampleError> {
        out.clear();
        // The package for npm asks for no tags. Built without them, it contains the engine for plain samples alone, not
        // a second copy for tagged ones: both would exceed the package's limit of bytes (`web/sampler/build`).
        #[cfg(not(tilescope_untagged))]
        if with_tags {
            return self.fill_from(&self.tagged, window, out);
        }
        #[cfg(tilescope_untagged)]
        assert!(!with_tags, "this build has no tags");

        self.fill_from(&self.plain, window, out)
    }
}

impl Plane {
    /// Computes a window with buffers of `pool`, and puts its samples into `out`.
    fn fill_from<const TAGS: bool>(
        &self,
        pool: &Pool<Scratch<TAGS>>,
        window: &Rect,
        out: &mut WindowSamples,
    ) -> Result<(), SampleError> {
        let mut scratch = pool.take();
        self.compute(&mut scratch, 0, window, &mut out.counts)?;
        self.emit(&mut scratch, &mut out.points, &mut out.tags, &mut out.rows);
        pool.give(scratch);
        Ok(())
    }
}

/// Regions for a window and for the repairs of repairs.
#[derive(Default)]
pub(super) struct Scratch<const TAGS: bool>(Vec<Box<Region<TAGS>>>);

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use tilescope_tests::cases;

    use super::*;
    use crate::lattice::R;
    use crate::progress::{Progress, Unobserved};

    fn plane(leaf: f64) -> Plane {
        let parameters = Parameters {
            radius: 1.0,
            width: 400.0,
            height: 400.0,
            leaf,
            ..Parameters::default()
        };
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        Plane::new(&parameters, &pattern).unwrap()
    }

    /// Computes small windows with a first halo of `HALO << depth` cells.
    fn windows(plane: &Plane, depth: usize) -> (Vec<Vec<Point>>, usize) {
        let mut repaired = 0;
        let mut found = Vec::new();
        // Half of them take twelve seconds in tests.
        let height = if cases(2) == 2 { 400 } else { 200 };
        for y in (0..height).step_by(8) {
            for x in (0..400).step_by(8) {
                let window = Rect {
                    min: Point::new(x * R, y * R),
                    max: Point::new((x + 8) * R, (y + 8) * R),
                };
                let mut scratch = Scratch::<false>::default();
                let counts = &mut WindowCounts::default();
                plane.compute(&mut scratch, depth, &window, counts).unwrap();
                repaired += usize::from(scratch.0.len() > depth + 1);
                let mut points = Vec::new();
                let region = &mut scratch.0[depth];
                region.emit(&mut points, &mut Vec::new(), &mut Vec::new());
                found.push(points);
            }
        }
        (found, repaired)
    }

    #[test]
    fn narrow_halos_are_repaired_to_what_wide_ones_give() {
        let plane = plane(7.0);
        let (narrow, repairs) = windows(&plane, 0);
        let (wide, _) = windows(&plane, 3);
        assert!(
            repairs > 0,
            "no window came out unsure: the test shows nothing"
        );
        assert_eq!(narrow, wide);
    }

    #[test]
    fn a_large_window_can_be_stopped_on_its_way() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .unwrap();
        pool.install(|| {
            let parameters = Parameters {
                radius: 1.0,
                width: 3000.0,
                height: 3000.0,
                ..Parameters::default()
            };
            let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
            let plane = Plane::new(&parameters, &pattern).unwrap();
            let window = plane.domain().window([0.0, 0.0], [3000.0, 700.0]).unwrap();
            let mut asked = 0;
            let mut stop = |progress: Progress| {
                asked += 1;
                if progress.done > 0 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let stopped = plane.observed_window(&window, &mut stop);
            assert!(matches!(stopped, Err(SampleError::Cancelled { .. })));
            assert_eq!(asked, 2, "after the first pieces of 30");
        });
    }

    #[test]
    fn repairs_end_with_the_whole_run_or_an_error() {
        let mut plane = plane(30.0);
        let window = Rect {
            min: Point::new(123_456, 0),
            max: Point::new(123_456 + 40 * R, 30 * R),
        };
        let found = |plane: &Plane, depth: usize| {
            let mut scratch = Scratch::<true>::default();
            let mut counts = WindowCounts::default();
            plane.compute(&mut scratch, depth, &window, &mut counts)?;
            let (mut points, mut tags, mut rows) = (Vec::new(), Vec::new(), Vec::new());
            scratch.0[depth].emit(&mut points, &mut tags, &mut rows);
            Ok((points, tags, rows, counts))
        };
        plane.count_blocks();
        let computed = found(&plane, 0);
        assert!(
            matches!(&computed, Ok((points, .., counts)) if points.len() > 800 && counts.eliminated > 0)
        );
        assert_eq!(found(&plane, MAX_REPAIRS + 1), computed);
        plane.whole = None;
        let refused = Err(SampleError::Entangled { radii: 768.0 });
        assert_eq!(found(&plane, MAX_REPAIRS + 1), refused);
    }
}
