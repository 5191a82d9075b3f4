//! Exact tiling of any window of a plane, from the blocks around it alone, and of a whole run by windows on all threads. Samples
//! that depend on blocks beyond those looked at are in *doubt*.

use std::sync::Arc;

use crate::engine::parallel::clip::Clipper;
use crate::engine::parallel::sweep::Sweep;
use crate::engine::parallel::window_maker::{WindowMaker, WindowSamples};
use crate::error::SampleError;
use crate::exact::agreement::Agreement;
use crate::exact::engine::clipper;
use crate::exact::ground::Ground;
use crate::exact::history::PatternHistory;
use crate::exact::seams::SeamTiling;
use crate::lattice::{Domain, Point, Rect};
use crate::parameters::Parameters;
use crate::pool::Pool;
use crate::progress::Observer;
use crate::run::{Run, Summary};
use crate::samples::Sampled;
use crate::varying::Shape;

/// The first width of the halo in cells. Along 460,800 r of border nothing farther than 7 r was in doubt, and 23 samples and zones
/// farther than 6.5 r (`what_is_unknown_reaches_less_far_than_a_halo`).
const HALO: i32 = 7;

/// The widest halo in cells. No window has been seen to need a second one.
const MAX_HALO: i32 = HALO << 7;

/// The plane of an exact tiling, from which any window can be computed alone.
///
/// The samples are exactly those of [`crate::exact_sample`] over the whole domain, whatever the window and the number of
/// threads. A window has a halo around it. The plane beyond is unknown, and so are samples that depend on it; if one of
/// them lies in the window, the halo grows.
///
/// ```
/// use tilescope_core::{ExactPlane, Parameters, PatternHistory, Unobserved, WindowMaker};
///
/// // A window of a run of two thousand million samples.
/// let parameters = Parameters { radius: 2e-5, ..Parameters::default() };
/// let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
/// let plane = ExactPlane::new(&parameters, &history)?;
/// let window = plane.domain().window([0.5, 0.5], [0.501, 0.501])?;
/// let samples = plane.window(&window)?;
/// assert!((1_650..1_850).contains(&samples.len()));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub struct ExactPlane<'a> {
    domain: Domain,
    history: &'a PatternHistory,
    shape: &'a Shape,
    clipper: Arc<Clipper>,
    idle: Pool<SeamTiling<'a>>,
    /// How windows of a whole run are made without following doubt; nothing for single windows.
    alone: Option<Alone>,
}

/// Windows of a whole run that are made without asking their neighbours, and compared with them afterwards.
struct Alone {
    /// The width of the halo in cells.
    halo: i32,
    agreement: Arc<Agreement>,
}

/// The width of the halo of windows that are made alone, in cells. A window must be right up to r beyond its ends, and each that is
/// not costs the whole run again. Along 460,800 r of border, 59 samples differed from 3 to 3.5 r away, three from 3.5 to 4 r, and
/// none farther; half a radius more leaves about a fifth, so that fewer than one in a million windows would be wrong 7 r away.
const ALONE_HALO: i32 = 8;

/// The shape of tilings that have none of their own.
static ALL_PLACES: Shape = Shape::rectangle();

impl<'a> ExactPlane<'a> {
    /// Returns the plane of `parameters` with the pattern of `history`.
    ///
    /// Fails when the parameters cannot be sampled, or a bounded pattern is too small for a block.
    pub fn new(parameters: &Parameters, history: &'a PatternHistory) -> Result<Self, SampleError> {
        let run_clipper = checked_clipper(parameters, history)?;
        Ok(Self::of_clipper(
            parameters.validate()?,
            history,
            Arc::new(run_clipper),
        ))
    }

    fn of_clipper(domain: Domain, history: &'a PatternHistory, clipper: Arc<Clipper>) -> Self {
        Self {
            domain,
            history,
            shape: &ALL_PLACES,
            clipper,
            idle: Pool::default(),
            alone: None,
        }
    }

    /// Returns the plane of the same tiling of a shape, outside of which there are no darts ([`crate::exact_in_shape`]).
    #[must_use]
    pub fn in_shape(self, shape: &'a Shape) -> Self {
        Self {
            shape,
            // Buffers are those of the shape before.
            idle: Pool::default(),
            ..self
        }
    }

    /// Returns the whole run at its beginning, to be computed in bands of windows on all threads. With `sources` each sample
    /// has its source, for which all blocks are counted first.
    #[must_use]
    pub fn sweep(mut self, sources: bool) -> Sweep<Self> {
        if sources {
            Arc::make_mut(&mut self.clipper).count_blocks();
        }
        Sweep::of_plane(self, sources)
    }
}

/// Returns the clipper of a run. Fails when a bounded pattern is too small for a block.
fn checked_clipper(
    parameters: &Parameters,
    history: &PatternHistory,
) -> Result<Clipper, SampleError> {
    let run_clipper = clipper(parameters, history.pattern())?;
    run_clipper.check_blocks()?;
    Ok(run_clipper)
}

/// An exact plane with the history that it reads, for owners that have no other place for it.
///
/// ```
/// use tilescope_core::{OwnedExactPlane, Parameters, PatternHistory, Unobserved, WindowMaker};
///
/// let parameters = Parameters { radius: 2e-5, ..Parameters::default() };
/// let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
/// let owned = OwnedExactPlane::new(&parameters, history)?;
/// let plane = owned.plane();
/// let window = plane.domain().window([0.5, 0.5], [0.501, 0.501])?;
/// assert!((1_650..1_850).contains(&plane.window(&window)?.len()));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub struct OwnedExactPlane {
    domain: Domain,
    history: PatternHistory,
    clipper: Arc<Clipper>,
}

impl OwnedExactPlane {
    /// Returns the plane of `parameters` with the pattern of `history`. Fails as [`ExactPlane::new`].
    pub fn new(parameters: &Parameters, history: PatternHistory) -> Result<Self, SampleError> {
        Ok(Self {
            domain: parameters.validate()?,
            clipper: Arc::new(checked_clipper(parameters, &history)?),
            history,
        })
    }

    /// Returns the domain of the whole set.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the plane. It shares what was prepared once, and begins with no buffers of its own.
    #[must_use]
    pub fn plane(&self) -> ExactPlane<'_> {
        ExactPlane::of_clipper(self.domain, &self.history, Arc::clone(&self.clipper))
    }
}

impl WindowMaker for ExactPlane<'_> {
    // Darts arrive all over a window, and the lists of a large one do not fit the cache: at leaf 20 r a sample took 451 ns in
    // windows of 300 cells a side, and 329 ns in windows of 134 cells, though with their halos they have an eighth more area.
    const MAX_SIDE: i32 = 136;

    fn domain(&self) -> &Domain {
        &self.domain
    }

    fn fill(
        &self,
        window: &Rect,
        with_tags: bool,
        out: &mut WindowSamples,
    ) -> Result<(), SampleError> {
        let mut tiling = self
            .idle
            .take_or(|| SeamTiling::new(self.history, self.shape));
        if let Some(Alone { halo, agreement }) = &self.alone {
            let ground = Ground::alone(&self.domain, window, *halo);
            // In a domain hardly larger than the window, places would lie on the ground twice. The window is then made
            // as a single window is, below, and is right without being compared.
            if !ground.repeats() {
                tiling.run(&self.clipper, ground)?;
                let mut around = Vec::new();
                tiling.emit(&self.clipper, with_tags, out, Some(&mut around));
                agreement.add(*window, around);
                self.idle.give(tiling);
                return Ok(());
            }
        }

        let mut halo = HALO;
        loop {
            tiling.run(&self.clipper, Ground::around(&self.domain, window, halo))?;
            // Doubt that stays outside of the window changes none of its samples.
            if !tiling.is_doubtful() {
                break;
            }

            if halo == MAX_HALO {
                // Cells are as wide as the radius.
                let radii = f64::from(halo);
                return Err(SampleError::Entangled { radii });
            }

            halo *= 2;
        }

        // This window is not compared with its neighbours, and the samples around it are not asked for.
        tiling.emit(&self.clipper, with_tags, out, None);
        self.idle.give(tiling);
        Ok(())
    }
}

/// Returns the same run as [`crate::exact_sample`], made on all threads of the current pool.
pub fn exact_sample_parallel(
    parameters: &Parameters,
    history: &PatternHistory,
    observer: &mut dyn Observer,
) -> Result<Run, SampleError> {
    exact_in_shape_parallel(parameters, history, &ALL_PLACES, observer)
}

/// Returns the same run as [`crate::exact_in_shape`], made on all threads of the current pool.
pub fn exact_in_shape_parallel(
    parameters: &Parameters,
    history: &PatternHistory,
    shape: &Shape,
    observer: &mut dyn Observer,
) -> Result<Run, SampleError> {
    let sources = true;
    let (sampled, summary) = finished(parameters, history, shape, sources, observer)?;
    Run::of_result(&parameters.as_exact(), history.pattern(), sampled, summary)
}

/// Returns the samples alone of what [`crate::exact_sample`] makes, in canonical order, made on all threads of the current
/// pool.
pub fn exact_points(
    parameters: &Parameters,
    history: &PatternHistory,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    let sources = false;
    let (sampled, _) = finished(parameters, history, &ALL_PLACES, sources, observer)?;
    Ok(sampled.points)
}

/// Returns all samples, made by windows that do not follow what their halos leave in doubt. Should these windows not
/// agree, all are made again by windows that do follow it.
fn finished(
    parameters: &Parameters,
    history: &PatternHistory,
    shape: &Shape,
    sources: bool,
    observer: &mut dyn Observer,
) -> Result<(Sampled, Summary), SampleError> {
    let plane = || ExactPlane::new(parameters, history).map(|plane| plane.in_shape(shape));
    if let Some(made) = made_alone(plane()?, sources, ALONE_HALO, observer)? {
        return Ok(made);
    }
    plane()?.sweep(sources).finish(observer)
}

/// Returns all samples of a plane, made by windows that have halos of `halo` cells and do not follow doubt; `None` if the samples
/// around a window are not those that its neighbours made.
fn made_alone(
    plane: ExactPlane<'_>,
    sources: bool,
    halo: i32,
    observer: &mut dyn Observer,
) -> Result<Option<(Sampled, Summary)>, SampleError> {
    let agreement = Arc::new(Agreement::default());
    let alone = Some(Alone {
        halo,
        agreement: Arc::clone(&agreement),
    });
    let plane = ExactPlane { alone, ..plane };
    let domain = plane.domain;

    let (sampled, summary) = plane.sweep(sources).finish(observer)?;
    let is_right = agreement.holds(&domain, &sampled.points);
    Ok(is_right.then_some((sampled, summary)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::parallel::window_maker::pieces;
    use crate::exact::engine::exact_sample;
    use crate::lattice::{Boundary, R};
    use crate::parameters::PatternSpec;
    use crate::progress::Unobserved;

    /// Returns the samples of a window by a halo of so many cells, and whether some are in doubt.
    fn computed(plane: &ExactPlane<'_>, window: &Rect, halo: i32) -> (Vec<Point>, bool) {
        let mut tiling = SeamTiling::new(plane.history, plane.shape);
        let ground = Ground::around(&plane.domain, window, halo);
        tiling.run(&plane.clipper, ground).unwrap();
        let mut samples = WindowSamples::default();
        let with_tags = false;
        tiling.emit(&plane.clipper, with_tags, &mut samples, None);
        (samples.points, tiling.is_doubtful())
    }

    /// Control: windows with too narrow a halo do not agree, and those that agree have made the run.
    #[test]
    fn windows_that_agree_have_made_the_run() {
        let mut agreeing = [0; 9];
        for seed in 0..8 {
            let parameters = Parameters {
                width: 150.0,
                height: 160.3,
                radius: 1.0,
                leaf: 7.0,
                seed,
                boundary: Boundary::of(seed % 4 > 0),
                pattern: PatternSpec {
                    side: 30.0,
                    ..PatternSpec::default()
                },
                ..Parameters::default()
            };
            let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
            let expected = exact_sample(&parameters, &history, &mut Unobserved).unwrap();
            for halo in [1, 2, ALONE_HALO] {
                let plane = ExactPlane::new(&parameters, &history).unwrap();
                let made = made_alone(plane, false, halo, &mut Unobserved);
                if let Some((sampled, summary)) = made.unwrap() {
                    assert_eq!(sampled.points, expected.points(), "{halo} cells, {seed}");
                    assert_eq!(summary, expected.summary());
                    agreeing[halo as usize] += 1;
                }
            }
        }
        assert!(
            agreeing[1] == 0 && agreeing[2] < 8 && agreeing[ALONE_HALO as usize] == 8,
            "{agreeing:?}"
        );
    }

    /// Control: without asking whether samples are in doubt, windows with a narrow halo differ from the whole. Those that
    /// are not in doubt do not.
    #[test]
    fn doubt_is_where_windows_differ() {
        for (seed, dihedral) in [(1, false), (2, true)] {
            let parameters = Parameters {
                width: 240.0,
                height: 216.0,
                radius: 1.0,
                leaf: 7.0,
                seed,
                dihedral,
                pattern: PatternSpec {
                    side: 30.0,
                    ..PatternSpec::default()
                },
                ..Parameters::default()
            };
            let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
            let plane = ExactPlane::new(&parameters, &history).unwrap();
            let windows: Vec<Rect> = pieces(&plane.domain.rect(), 12 * R).collect();

            let mut differing = [0; 6];
            for window in &windows {
                let (wide, is_doubtful) = computed(&plane, window, 16);
                assert!(!is_doubtful);
                for halo in 2..6 {
                    let (narrow, is_doubtful) = computed(&plane, window, halo);
                    let differs = narrow != wide;
                    assert!(!differs || is_doubtful, "{halo} cells around {window:?}");
                    differing[halo as usize] += u32::from(differs);
                }
            }
            assert!(differing[2] > 20 && differing[3] > 0, "{differing:?}");
        }
    }

    /// Counts something by how far from the border it lies, in halves of R.
    fn count_depth(counts: &mut [u32; 24], depth: i32) {
        counts[(2 * depth / R) as usize] += 1;
    }

    /// The evidence for the widths of halos: how far from the border of the known part samples differ from those of the
    /// whole, and how far from it they are in doubt, by half radii. Both must end before the halo does, by r where
    /// windows are compared.
    #[test]
    #[ignore = "takes long: tests/run --slow runs it"]
    fn what_is_unknown_reaches_less_far_than_a_halo() {
        let (mut differing, mut doubtful, mut border) = ([0; 24], [0; 24], 0);
        for (seed, leaf) in (0..12).zip([7.0, 20.0, 40.0].into_iter().cycle()) {
            let parameters = Parameters {
                width: 480.0,
                height: 480.0,
                radius: 1.0,
                leaf,
                seed,
                dihedral: seed % 2 == 1,
                ..Parameters::default()
            };
            let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
            let points = exact_points(&parameters, &history, &mut Unobserved).unwrap();
            let all: std::collections::HashSet<Point> = points.iter().copied().collect();
            let plane = ExactPlane::new(&parameters, &history).unwrap();
            let mut tiling = SeamTiling::new(&history, &ALL_PLACES);

            for window in pieces(&plane.domain.rect(), 24 * R) {
                border += 4 * 24;
                // A window without a halo.
                tiling
                    .run(&plane.clipper, Ground::alone(&plane.domain, &window, 0))
                    .unwrap();
                let (with_tags, mut made) = (false, WindowSamples::default());
                tiling.emit(&plane.clipper, with_tags, &mut made, None);
                let made: std::collections::HashSet<Point> = made.points.into_iter().collect();
                let there = points.iter().filter(|point| window.contains(**point));
                let lacking = there.filter(|point| !made.contains(point));
                for point in made.difference(&all).chain(lacking) {
                    count_depth(&mut differing, window.depth(*point));
                }

                let ground = Ground::around(&plane.domain, &window, 0);
                let frame = ground.rect();
                tiling.run(&plane.clipper, ground).unwrap();
                for place in tiling.doubtful_places() {
                    count_depth(&mut doubtful, frame.depth(place));
                }
            }
        }

        println!("{border} r of border: {differing:?} differ, {doubtful:?} in doubt");
        let deepest = |counts: &[u32; 24]| counts.iter().rposition(|count| *count > 0).unwrap();
        let (differing, doubtful) = (deepest(&differing), deepest(&doubtful));
        assert!(differing < 2 * (ALONE_HALO as usize - 1), "{differing}");
        assert!(doubtful < 2 * HALO as usize, "{doubtful}");
        // Control: narrow halos would not do.
        assert!(differing > 4 && doubtful > 6, "{differing} {doubtful}");
    }
}
