//! The plane of a run of nested levels: the whole, computed as one frame, and its windows, each computed by itself.
//!
//! A window needs each level in a frame around it that shrinks from level to level by the halo of the level. A window in
//! which unknowns remain is computed again with a halo twice as wide.

use glam::I64Vec2;

use crate::count::{radius_estimate, search_radius};
use crate::engine::parallel::side_by_side::compute_each;
use crate::engine::parallel::widened::WidenedWindow;
use crate::engine::parallel::window_maker::{parts, pieces};
use crate::error::{ParameterError, SampleError};
use crate::lattice::{
    Boundary, Domain, MIN_SIDE_RADII_BOUNDED, MIN_SIDE_RADII_PERIODIC, Point, R, Rect, Window,
};
use crate::parameters::{
    Insertion, Order, Parameters, Search, TilingMethod, Variant, check_sequential,
};
use crate::pattern::Symmetry;
use crate::pool::Pool;
use crate::progress::{Meter, Observer, Progress};
use crate::radius::Radius;
use crate::random::{Key, Stream};
use crate::stage::Stage;

use super::blocks::BlockDraws;
use super::check_levels;
use super::frame::LevelFrame;
use super::nested::{Nested, WithinLevel};
use super::pattern::{LevelClip, NestedPattern};
use super::region::LevelRegion;

/// Width of the finest level's halo in its radii, at first. Where blocks are small beside the radius, unknowns reach
/// farther.
const HALO: i64 = 6;

/// By how much each level's halo is wider than that of the next, in its radii. Coarse levels have few samples.
const MORE_HALO: i64 = 2;

/// How often the halo is doubled.
const MAX_REPAIRS: u32 = 5;

/// Side of the windows into which larger ones are cut, in units: 512 finest radii.
const WINDOW_SIDE: i32 = 512 * R;

/// How often a radius is tried that should give a count of samples.
const MAX_TRIES: u32 = 16;

/// The largest domain that is made whole for a window, in squared radii: about 700,000 samples.
const MAX_WHOLE_AREA: f64 = 1_048_576.0;

/// The choices for nested levels besides the parameters of a run. Certificates state it by these names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct NestedRequest {
    /// How many levels are to be made, at most [`crate::MAX_LEVELS`].
    pub levels: u32,
    /// How the samples that a level adds follow each other.
    pub order_within: WithinLevel,
    /// How many samples, if the radius of the parameters is not to be used (see [`NestedPlane::exactly`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exactly: Option<usize>,
}

impl NestedRequest {
    /// Returns why these levels cannot be made with `parameters`, without making a pattern.
    ///
    /// # Errors
    ///
    /// As [`NestedPlane::new`] and [`radius_estimate`], [`ParameterError::OneLevel`] and
    /// [`ParameterError::TooFewForLevels`].
    pub fn check(&self, parameters: &Parameters) -> Result<(), ParameterError> {
        self.check_exactly()?;

        let mut parameters = *parameters;
        if let Some(count) = self.exactly {
            parameters.radius = radius_estimate(&parameters, count as u64)?;
        }

        let checked = check(&parameters, self.levels).map(|_| ());
        checked.map_err(|error| self.as_of_count(error))
    }

    /// Returns the error to show for an error of [`check`]. If the wanted number of samples gave the radius, too many
    /// levels become too few samples for the levels: the user chose no radius that could be smaller. Other errors stay.
    fn as_of_count(&self, error: ParameterError) -> ParameterError {
        match (self.exactly, error) {
            (
                Some(count),
                ParameterError::TooManyLevels {
                    name,
                    levels,
                    radii,
                    minimum,
                },
            ) => ParameterError::TooFewForLevels {
                count,
                levels,
                name,
                radii,
                minimum,
            },
            (_, error) => error,
        }
    }

    const fn check_exactly(&self) -> Result<(), ParameterError> {
        match (self.exactly, self.levels) {
            (Some(count), 1) => Err(ParameterError::OneLevel { count }),
            _ => Ok(()),
        }
    }

    /// Returns the samples. Uses the current rayon pool.
    ///
    /// Fails as [`Self::check`], [`NestedPlane::whole`] and [`NestedPlane::exactly`].
    pub fn make(
        &self,
        parameters: &Parameters,
        observer: &mut dyn Observer,
    ) -> Result<Nested, SampleError> {
        self.check(parameters)?;

        let mut made = match self.exactly {
            Some(count) => NestedPlane::exactly(parameters, self.levels, count, observer)?,
            None => NestedPlane::new(parameters, self.levels, observer)?.whole(observer)?,
        };

        self.arrange(&mut made, observer)?;
        Ok(made)
    }

    /// Returns the samples of the radius that gives `count` of them in the last level, to within 1% or one sample. Neither the
    /// radius of `parameters` nor [`Self::exactly`] is used.
    ///
    /// Fails as [`Self::make`] and [`search_radius`].
    pub fn of_count(
        &self,
        parameters: &Parameters,
        count: u64,
        observer: &mut dyn Observer,
    ) -> Result<Nested, SampleError> {
        // Making a pattern takes long, so that all other errors are found before it.
        let radius = radius_estimate(parameters, count)?;
        let estimated = Parameters {
            radius,
            ..*parameters
        };
        check(&estimated, self.levels)?;

        let pattern = NestedPattern::generate(&parameters.pattern, self.levels, observer)?;

        let mut made = search_radius(parameters, count, |radius| -> Result<_, SampleError> {
            let parameters = Parameters {
                radius,
                ..*parameters
            };
            let plane = NestedPlane::with_pattern(&parameters, &pattern)?;
            let made = plane.whole(observer)?;
            Ok((made.points().len() as u64, made))
        })?;

        self.arrange(&mut made, observer)?;
        Ok(made)
    }

    /// Puts the samples of each level into the order that is asked for.
    fn arrange(&self, made: &mut Nested, observer: &mut dyn Observer) -> Result<(), SampleError> {
        match self.order_within {
            WithinLevel::Random => Ok(()),
            WithinLevel::Farthest => made.order_by_distance(observer),
        }
    }
}

/// A run of nested levels, of which any window can be computed alone.
///
/// ```
/// use tilescope_core::{NestedPlane, Parameters, Unobserved};
///
/// let parameters = Parameters { radius: 0.01, ..Parameters::default() };
/// let plane = NestedPlane::new(&parameters, 4, &mut Unobserved)?;
/// let nested = plane.whole(&mut Unobserved)?;
/// // Each level has about twice the samples of the one before.
/// assert_eq!(nested.ends().len(), 4);
/// assert!((800..950).contains(&nested.ends()[0]));
/// assert!((6_700..7_300).contains(&nested.points().len()));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub struct NestedPlane {
    draws: BlockDraws,
    levels: u32,
    key: Key,
    /// The pattern by symmetry, and by level.
    variants: Vec<Vec<LevelClip>>,
    /// Side of the windows into which larger ones are cut, in units.
    window_side: i32,
    idle: Pool<LevelRegion>,
}

impl NestedPlane {
    /// Returns the plane of `levels` levels of which the finest has the radius of the parameters, and each one before it
    /// a radius larger by the root of 2. The pattern is made here (see [`NestedPattern`]).
    ///
    /// Fails when the parameters cannot be sampled, there are no or more than [`crate::MAX_LEVELS`] levels, the domain is too
    /// small for the coarsest radius, or a choice other than the default is made for the method of tiling, the order of
    /// elimination, insertion, search, variant or the pattern's boundary.
    pub fn new(
        parameters: &Parameters,
        levels: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        check(parameters, levels)?;
        let pattern = NestedPattern::generate(&parameters.pattern, levels, observer)?;
        Self::with_pattern(parameters, &pattern)
    }

    /// Returns the plane of the levels of `pattern`.
    ///
    /// Fails as [`Self::new`].
    pub fn with_pattern(
        parameters: &Parameters,
        pattern: &NestedPattern,
    ) -> Result<Self, SampleError> {
        let levels = pattern.levels().len() as u32;
        let domain = check(parameters, levels)?;

        let symmetries = if parameters.dihedral { 8 } else { 1 };
        let key = Key::from_seed(parameters.seed);

        Ok(Self {
            draws: BlockDraws {
                domain,
                leaf: parameters.leaf_units()?,
                key,
                symmetries: symmetries.into(),
                period: pattern.side(),
            },
            levels,
            key,
            // The pattern is turned once, for all windows.
            variants: (0..symmetries)
                .map(|s| pattern.variant(Symmetry(s)))
                .collect(),
            window_side: WINDOW_SIDE,
            idle: Pool::default(),
        })
    }

    /// Returns the plane with large windows cut into ones of `radii` finest radii a side instead of 512. The samples are
    /// the same.
    #[must_use]
    pub fn with_windows(mut self, radii: u16) -> Self {
        self.window_side = i32::from(radii.max(1)) * R;
        self
    }

    /// Returns exactly `count` samples: the first of a run whose finest set has at least as many. Its radius is
    /// estimated, and made smaller until the set has as many; the radius of `parameters` is not used.
    ///
    /// There is no maximal set of exactly `count` samples in general. [`Nested::guarantee`] has the guarantees of
    /// these. Fails as [`Self::new`], or when there is no such radius.
    pub fn exactly(
        parameters: &Parameters,
        levels: u32,
        count: usize,
        observer: &mut dyn Observer,
    ) -> Result<Nested, SampleError> {
        let wanted = count as u64;
        let pattern = NestedPattern::generate(&parameters.pattern, levels, observer)?;

        let (mut radius, mut nearest) = (radius_estimate(parameters, wanted)?, 0);
        for _ in 0..MAX_TRIES {
            let tried = Parameters {
                radius,
                ..*parameters
            };

            let mut nested = Self::with_pattern(&tried, &pattern)?.whole(observer)?;
            let found = nested.points().len();

            // A prefix of nested levels is good wherever it ends.
            if found >= count {
                nested.truncate(count);
                return Ok(nested);
            }

            nearest = nearest.max(found as u64);
            // Counts go as the inverse square of the radius. The radius shrinks by a thousandth more than the missing share
            // implies, since a try must reach the count.
            radius *= 0.999 * (found as f64 / count as f64).sqrt();
        }

        Err(ParameterError::CountMissed {
            count: wanted,
            nearest,
        }
        .into())
    }

    /// Returns the domain. Its radius is the finest.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.draws.domain
    }

    /// Returns the radius of a level in user units: that of the domain times the root of 2 for each finer level.
    #[must_use]
    pub fn radius(&self, level: u32) -> f64 {
        let halvings = self.levels - 1 - level;
        self.domain().radius() * f64::from(1_u32 << halvings).sqrt()
    }

    /// Returns the samples of the whole run in `window`, level by level, in the order of the whole. A window beyond the
    /// end of a periodic domain shows its repetition, with the positions of the domain.
    ///
    /// Computes only the window and the surroundings on which its samples depend. Fails when that is too much, which
    /// happens where blocks are small beside the coarsest radius and the domain is too large to be made whole instead.
    /// Uses the current rayon pool.
    pub fn window(
        &self,
        window: &Window,
        observer: &mut dyn Observer,
    ) -> Result<Nested, SampleError> {
        self.compute_parts(parts(self.domain(), window), observer)
    }

    /// Returns `window` with a margin around it, with the samples of the set `S_level`.
    ///
    /// Fails as [`Self::window`].
    pub fn widened(
        &self,
        window: &Window,
        level: u32,
        observer: &mut dyn Observer,
    ) -> Result<WidenedWindow, SampleError> {
        let samples = |wide: &Window| {
            let mut found = self.window(wide, observer)?;
            found.truncate(found.ends()[level as usize]);
            Ok(found.points().to_vec())
        };
        WidenedWindow::of(window, self.domain(), self.units(level).units, samples)
    }

    /// Returns the whole run. Uses the current rayon pool, and some 120 bytes a sample.
    ///
    /// Fails when the domain would hold more samples than the sequential engine accepts, or `observer` stops it.
    pub fn whole(&self, observer: &mut dyn Observer) -> Result<Nested, SampleError> {
        check_sequential(self.domain())?;

        let mut region = LevelRegion::default();
        let mut meter = Meter::begin(observer, Stage::Regions, self.levels.into())?;
        self.compute_whole(&mut region, &mut meter)?;

        let levels = split_by_level(&region);
        meter.end()?;
        let is_run = true;
        Ok(self.in_order(levels, is_run))
    }

    /// Returns the samples of all `parts`, which lie in the domain, level by level in the order of the whole.
    fn compute_parts(
        &self,
        parts: impl Iterator<Item = Rect>,
        observer: &mut dyn Observer,
    ) -> Result<Nested, SampleError> {
        let windows: Vec<Rect> = parts
            .flat_map(|part| pieces(&part, self.window_side))
            .collect();

        let (stage, total) = (Stage::Regions, windows.len() as u64);
        let progress = |done: usize| Progress {
            stage,
            done: done as u64,
            total,
        };
        let computed = compute_each(&windows, observer, progress, |window, observer| {
            self.piece(window, observer)
        })?;

        let mut levels = vec![Vec::new(); self.levels as usize];
        let mut add = |piece: Vec<Vec<Point>>| {
            for (all, mut found) in levels.iter_mut().zip(piece) {
                all.append(&mut found);
            }
        };

        let mut cheaper_whole = Vec::new();
        for (piece, window) in computed.into_iter().zip(&windows) {
            match piece? {
                Some(piece) => add(piece),
                None => cheaper_whole.push(window),
            }
        }

        // The whole run is made once, and serves all windows that would be more work than it. All windows count as
        // done: the meter only lets the observer stop this work, too.
        let mut meter = Meter::resume(observer, stage, total, total)?;
        if !cheaper_whole.is_empty() {
            let mut region = LevelRegion::default();
            self.compute_whole(&mut region, &mut meter)?;
            for window in cheaper_whole {
                add(collect(&region, window));
            }
        }

        meter.end()?;
        let is_run = false;
        Ok(self.in_order(levels, is_run))
    }

    /// Returns the samples that each level adds as a nested set. `is_run` says whether these are all samples of the
    /// run.
    fn in_order(&self, levels: Vec<Vec<Point>>, is_run: bool) -> Nested {
        Nested::in_random_order(*self.domain(), levels, self.key, is_run)
    }

    /// Returns the samples that each level adds in a window that lies in the domain, or `None` if the whole is computed
    /// sooner.
    fn piece(
        &self,
        window: &Rect,
        observer: &mut dyn Observer,
    ) -> Result<Option<Vec<Vec<Point>>>, SampleError> {
        let mut region = self.idle.take();

        for repair in 0..=MAX_REPAIRS {
            // Unknowns remain in few windows. A halo that suffices for these would cost time in every other window.
            let halo = HALO << repair;
            if self.is_shorter_whole(window, halo) {
                self.idle.give(region);
                return Ok(None);
            }

            if self.compute(&mut region, window, halo, observer)? {
                let shown = Rect {
                    min: Point::default(),
                    max: Point::new(window.width(), window.height()),
                };

                let levels = collect(&region, &shown);
                self.idle.give(region);
                return Ok(Some(levels));
            }
        }

        // How far the frame of the coarsest level, the widest, reached beyond the window, in whole radii of the finest level.
        let widest = self.halo(0, HALO << MAX_REPAIRS);
        Err(SampleError::Entangled {
            radii: (widest / i64::from(R)) as f64,
        })
    }

    /// Returns whether computing the whole domain is less work than a window with its halo.
    fn is_shorter_whole(&self, window: &Rect, halo: i64) -> bool {
        let domain = self.domain();
        let halos = 2 * self.halo(0, halo);
        let area = (i64::from(window.width()) + halos) as f64
            * (i64::from(window.height()) + halos) as f64;

        let whole = f64::from(domain.width()) * f64::from(domain.height());
        domain.area_radii() <= MAX_WHOLE_AREA && whole <= area
    }

    /// Returns by how many units the frame of a level is larger than its window on each side.
    fn halo(&self, level: u32, halo: i64) -> i64 {
        let width = |level: u32| {
            let halvings = i64::from(self.levels - 1 - level);
            (halo + MORE_HALO * halvings) * i64::from(self.units(level).units)
        };
        (level..self.levels).map(width).sum()
    }

    const fn units(&self, level: u32) -> Radius {
        Radius::before(self.levels - 1 - level)
    }

    /// Computes all levels in a window with a halo of `halo` radii for the finest level and wider ones for the others, and
    /// returns whether all its samples are known. In the region coordinates begin at the window's corner.
    fn compute(
        &self,
        region: &mut LevelRegion,
        window: &Rect,
        halo: i64,
        observer: &mut dyn Observer,
    ) -> Result<bool, SampleError> {
        let domain = self.domain();

        let frame_of = |level: u32| {
            let margin = self.halo(level, halo);
            // On each axis the plane goes on below and above the frame, unless it ends at a border there.
            let mut frame = LevelFrame {
                goes_on: [[true; 2]; 2],
                ..LevelFrame::at(domain, window.min.into())
            };
            let size = I64Vec2::new(window.width().into(), window.height().into());
            let (mut low, mut high) = (I64Vec2::splat(-margin), size + margin);

            // A bounded plane ends at the domain's border: a frame that reaches the border is cut there and misses nothing.
            // In the frame's coordinates the domain lies from `first` to `end`.
            if !frame.periodic {
                let first = -frame.origin;
                let end = first + I64Vec2::from(domain.rect().max);
                frame.goes_on =
                    [0, 1].map(|axis| [low[axis] > first[axis], high[axis] < end[axis]]);
                (low, high) = (low.max(first), high.min(end));
            }

            frame.rect = Rect {
                min: Point::new(low.x as i32, low.y as i32),
                max: Point::new(high.x as i32, high.y as i32),
            };
            frame
        };

        let mut meter = Meter::begin(observer, Stage::Regions, self.levels.into())?;
        // A periodic plane shows a block several times: the frame's coordinates do not wrap.
        let repeats = domain.is_periodic();
        self.run(region, frame_of, repeats, &mut meter)?;

        // Only an unknown that reaches into the window makes it unsure.
        let reaches_in = |unknown: &super::region::UnknownDisk| {
            let reach = unknown.radius;
            (-reach..window.width() + reach).contains(&unknown.at.x)
                && (-reach..window.height() + reach).contains(&unknown.at.y)
        };

        Ok(!region.unknown.iter().any(reaches_in))
    }

    /// Computes all levels in the whole domain.
    fn compute_whole(
        &self,
        region: &mut LevelRegion,
        meter: &mut Meter<'_>,
    ) -> Result<(), SampleError> {
        let frame = self.whole_frame();
        // A frame of the whole domain wraps if the plane repeats: images of blocks are not needed.
        let repeats = false;
        self.run(region, |_| frame, repeats, meter)
    }

    /// Returns the frame that holds the whole domain.
    pub(super) fn whole_frame(&self) -> LevelFrame {
        let domain = self.domain();
        LevelFrame {
            rect: domain.rect(),
            wraps: domain.is_periodic(),
            ..LevelFrame::at(domain, I64Vec2::ZERO)
        }
    }

    /// Computes all levels, each in the frame that `frame_of` gives it. `repeats` says whether a block may lie in a frame
    /// several times.
    fn run(
        &self,
        region: &mut LevelRegion,
        frame_of: impl Fn(u32) -> LevelFrame,
        repeats: bool,
        meter: &mut Meter<'_>,
    ) -> Result<(), SampleError> {
        self.run_filled(region, frame_of, repeats, meter, LevelRegion::fill)
    }

    /// Computes all levels as [`Self::run`] does, with the gaps of each filled by `fill`.
    pub(super) fn run_filled(
        &self,
        region: &mut LevelRegion,
        frame_of: impl Fn(u32) -> LevelFrame,
        repeats: bool,
        meter: &mut Meter<'_>,
        fill: impl Fn(&mut LevelRegion, Key, &mut Meter<'_>) -> Result<(), SampleError>,
    ) -> Result<(), SampleError> {
        region.clear();

        // The coarsest level has the widest frame and the widest margins: no other level sees more blocks.
        let coarsest = self.units(0);
        let widest = frame_of(0);
        let (target, origin) = (widest.tiled(coarsest.units), widest.origin);
        self.draws
            .find(&target, origin, coarsest.units, repeats, &mut region.blocks);

        for level in 0..self.levels {
            region.begin(frame_of(level), self.units(level));
            region.claim(level as usize, &self.variants, meter)?;
            fill(region, self.level_key(level), meter)?;
            region.ends.push(region.samples.len());
            meter.tick()?;
        }

        Ok(())
    }

    /// Returns the key of a level's draws. The finest has the run's own.
    const fn level_key(&self, level: u32) -> Key {
        match self.levels - 1 - level {
            0 => self.key,
            halvings => self.key.derive(Stream::Nested, halvings),
        }
    }
}

/// Returns the domain of nested levels, or why `parameters` do not allow that many levels.
fn check(parameters: &Parameters, levels: u32) -> Result<Domain, ParameterError> {
    let domain = parameters.validate()?;
    check_levels(levels)?;

    // Nested levels are defined for the default of each choice alone (see the head of `levels`). The names
    // complete the error's message.
    let choices = [
        (
            "the method, which is KDRT",
            parameters.method != TilingMethod::default(),
        ),
        (
            "the order of elimination",
            parameters.order != Order::default(),
        ),
        (
            "the insertion",
            parameters.insertion != Insertion::default(),
        ),
        ("the search", parameters.search != Search::default()),
        ("the variant", parameters.variant != Variant::default()),
        (
            "the pattern's boundary",
            parameters.pattern.boundary != Boundary::Periodic,
        ),
    ];

    if let Some((name, _)) = choices.into_iter().find(|(_, differs)| *differs) {
        return Err(ParameterError::NestedChoice { name });
    }

    // Each side needs as many radii of the coarsest set as a run of one level needs of its own.
    let least = match parameters.boundary {
        Boundary::Periodic => MIN_SIDE_RADII_PERIODIC,
        Boundary::Bounded => MIN_SIDE_RADII_BOUNDED,
    };
    // In radii of the finest level: each coarser one has a radius larger by the root of 2, and so half of the samples.
    let coarsest_radius = f64::from(1_u32 << (levels - 1)).sqrt();

    for (name, units) in [("width", domain.width()), ("height", domain.height())] {
        let radii = f64::from(units) / f64::from(R);
        if radii < least * coarsest_radius {
            return Err(ParameterError::TooManyLevels {
                name,
                levels,
                radii,
                minimum: least * coarsest_radius,
            });
        }
    }

    Ok(domain)
}

/// Returns the samples of a region by the level that adds them: those in `shown`, a rectangle of the frame, as places
/// of the domain.
fn collect(region: &LevelRegion, shown: &Rect) -> Vec<Vec<Point>> {
    let mut first = 0;

    let level = |&end: &usize| {
        let added = &region.samples[first..end];
        first = end;

        let inside = added.iter().filter(|at| shown.contains(**at));
        inside.map(|at| region.frame.in_domain(*at)).collect()
    };

    region.ends.iter().map(level).collect()
}

/// Returns the samples of a region that is the whole domain by the level that adds them.
fn split_by_level(region: &LevelRegion) -> Vec<Vec<Point>> {
    let starts = std::iter::once(0).chain(region.ends.iter().copied());
    let levels = starts.zip(&region.ends);
    levels
        .map(|(first, &end)| region.samples[first..end].to_vec())
        .collect()
}

#[cfg(test)]
mod tests {
    use tilescope_tests::cases;

    use super::*;
    use crate::progress::Unobserved;

    /// With narrow halos windows have unknowns. Whatever a window then says that it knows is right.
    #[test]
    fn narrow_halos_are_found_out() {
        // All windows of the larger domain take forty seconds in tests.
        let has_all = cases(2) == 2;
        let [width, height] = if has_all { [160.0, 200.0] } else { [120.0; 2] };
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let parameters = Parameters {
                width,
                height,
                radius: 1.0,
                leaf: 9.0,
                boundary,
                ..Parameters::default()
            };
            let plane = NestedPlane::new(&parameters, 4, &mut Unobserved).unwrap();
            let mut region = LevelRegion::default();
            let mut unobserved = Unobserved;
            let mut meter = Meter::begin(&mut unobserved, Stage::Regions, 4).unwrap();
            plane.compute_whole(&mut region, &mut meter).unwrap();
            let domain = plane.domain().rect();
            let all = collect(&region, &domain);
            let side = 40 * R;
            for halo in [1, 2, 4, 8] {
                let (mut known, mut unknown) = (0, 0);
                for window in pieces(&domain, side) {
                    if !plane
                        .compute(&mut region, &window, halo, &mut Unobserved)
                        .unwrap()
                    {
                        unknown += 1;
                        continue;
                    }
                    known += 1;
                    let shown = Rect {
                        min: Point::default(),
                        max: Point::new(window.width(), window.height()),
                    };
                    let found = collect(&region, &shown);
                    for (mut found, all) in found.into_iter().zip(&all) {
                        let inside = |p: &&Point| window.contains(**p);
                        let mut expected: Vec<Point> = all.iter().filter(inside).copied().collect();
                        found.sort_unstable_by_key(|p| p.row_major());
                        expected.sort_unstable_by_key(|p| p.row_major());
                        assert_eq!(found, expected, "{boundary:?}, halo {halo}, {window:?}");
                    }
                }
                assert!(halo > 1 || unknown > 0, "the test shows nothing");
                assert!(halo < 8 || known > 0, "{boundary:?}: no halo suffices");
            }
        }
    }
}
