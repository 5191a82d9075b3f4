//! The rounds of `tilescope bench`: the CPU's engines against the reference sampler, and windows of a large plane.

use std::sync::Arc;

use serde::Serialize;
use tilescope_analysis::{Region, VerifyOptions, verify_cut};
use tilescope_core::{
    ExactPlane, Key, Parameters, Pattern, PatternHistory, PatternSpec, Plane, Stream, Window,
    WindowMaker,
};

use super::{EngineRate, EngineTime, median, rows, sized, timed, times};
use crate::control::{Control, Watch};
use crate::engines::{Engine, Engines};
use crate::error::Result;

/// The settings of a bench.
#[derive(Clone, Debug)]
pub struct Bench {
    /// Samples of a set, about.
    pub samples: u64,
    /// Leaf sizes in radii.
    pub leaves: Vec<f64>,
    /// Numbers of threads of the parallel engine and of exact tiling, which is also timed on one thread.
    pub threads: Vec<usize>,
    /// Whether the sequential engine is timed, too.
    pub sequential: bool,
    /// How many rounds there are.
    pub rounds: u64,
    /// Seed of the first round; each round has its own.
    pub seed: u64,
    /// Samples of the plane from which windows are taken.
    pub plane: u64,
}

/// Rates of the CPU's engines.
#[derive(Clone, Debug)]
pub struct CpuRates {
    /// Seconds of generating KDRT's pattern.
    pub pattern_seconds: f64,
    /// Seconds of generating the pattern of exact tiling and its tables.
    pub history_seconds: f64,
    /// The engines at each leaf size, after the reference sampler, which is the baseline.
    pub rows: Vec<EngineRate>,
    /// Windows of a large plane of KDRT, one a round.
    pub windows: WindowTimes,
    /// The same windows of a plane of exact tiling.
    pub exact_windows: WindowTimes,
}

impl CpuRates {
    /// Returns the seconds of a row's set from nothing: with the pattern that it is made from.
    #[must_use]
    pub fn from_nothing(&self, row: &EngineRate) -> f64 {
        let set = median(row.times.iter().map(|one| one.seconds)).unwrap_or(f64::NAN);
        let before = match row.engine {
            Engine::Reference | Engine::Combined { .. } => 0.0,
            Engine::Sequential | Engine::Parallel { .. } | Engine::Gpu { .. } => {
                self.pattern_seconds
            }
            Engine::Exact | Engine::ExactParallel { .. } | Engine::ExactGpu { .. } => {
                self.history_seconds
            }
        };
        before + set
    }
}

/// Times of windows at random positions of a large plane.
#[derive(Clone, Debug, Serialize)]
pub struct WindowTimes {
    /// Seconds of setting up the plane.
    pub plane_seconds: f64,
    /// Seconds of each window.
    pub seconds: Vec<f64>,
    /// Samples of each window.
    pub counts: Vec<usize>,
    /// Whether all windows are valid.
    pub valid: bool,
}

impl WindowTimes {
    /// Returns the times of a plane that took so many seconds, before its first window.
    const fn new(plane_seconds: f64) -> Self {
        Self {
            plane_seconds,
            seconds: Vec::new(),
            counts: Vec::new(),
            valid: true,
        }
    }

    /// Times a window of a plane, and verifies it.
    fn add(
        &mut self,
        plane: &impl WindowMaker,
        window: &Window,
        control: &Control<'_>,
    ) -> Result<()> {
        let (points, seconds) = timed(|| plane.window(window));
        self.seconds.push(seconds);
        self.counts.push(points?.len());
        control.go_on()?;

        // The verdict also needs the samples around the window, which are not in its time.
        let cut = plane.widened(window, &mut control.observer())?;
        let is_periodic = false;
        let asked = (Region::new(cut.size, is_periodic), plane.domain().radius());
        let options = VerifyOptions::default();
        let go_on = control.analysis();
        let report = verify_cut(&cut.positions, asked, cut.window, &options, &go_on)?;
        self.valid &= report.valid();
        Ok(())
    }

    /// Returns the median number of samples of a window.
    #[must_use]
    pub fn median_count(&self) -> f64 {
        median(self.counts.iter().map(|&count| count as f64)).unwrap_or(f64::NAN)
    }

    /// Returns the median of the seconds.
    #[must_use]
    pub fn median_seconds(&self) -> f64 {
        median(self.seconds.iter().copied()).unwrap_or(f64::NAN)
    }
}

impl Bench {
    /// Samples of a window, about.
    pub const WINDOW_SAMPLES: f64 = 10_000.0;

    /// Times the CPU's engines and windows.
    pub fn cpu(&self, watch: &dyn Watch) -> Result<CpuRates> {
        let base = self.base()?;
        let of_plane = sized(self.plane, self.seed)?;
        let units_done = 0;
        let control = Control::new(watch, units_done, "the pattern".to_owned());

        // The time to make a pattern is reported: it is generated here and not taken from those that the program keeps.
        let generate = || Pattern::generate(&base.pattern, &mut control.observer());
        let (pattern, pattern_seconds) = timed(generate);
        let pattern = Arc::new(pattern?);

        // The pattern of exact tiling has the side that the method chooses. A bench is the first work of the program,
        // so that no such pattern is kept yet: the seconds include making the pattern and its tables.
        let of_exact = PatternSpec::for_exact(self.samples as f64, self.seed);
        let tables = || PatternHistory::of_spec(&of_exact, &mut control.observer());
        let (history, history_seconds) = timed(tables);
        let no_gpus = Vec::new();
        let open = Engines::open(&self.threads, no_gpus)?.with_history(history?);

        let parallel = |&threads: &usize| Engine::Parallel { threads };
        let mut engines: Vec<Engine> = self.threads.iter().map(parallel).collect();
        if self.sequential {
            // The first engine of a group makes the set that is verified and that the others are compared with.
            engines.insert(0, Engine::Sequential);
        }

        // One thread of exact tiling is timed in any case: it is what the others, and KDRT's one thread, are compared with.
        let several = self.threads.iter().filter(|&&threads| threads > 1);
        let exact_parallel = several.map(|&threads| Engine::ExactParallel { threads });
        let exact: Vec<Engine> = std::iter::once(Engine::Exact)
            .chain(exact_parallel)
            .collect();

        // Engines of one group make the same set; that of exact tiling is another one.
        let by_leaf = [&engines[..], &exact[..]];
        let once: &[&[Engine]] = &[&[Engine::Reference]];
        let made = self.rounds(&open, once, &by_leaf, &base, &pattern, watch)?;
        let rounds: Vec<&[EngineTime]> = made.iter().map(Vec::as_slice).collect();

        // Without a named baseline the first engine of a round is the baseline, which is the reference sampler.
        let baseline = None;
        let [windows, exact_windows] = self.windows(&of_plane, &pattern, open.history()?, watch)?;
        Ok(CpuRates {
            pattern_seconds,
            history_seconds,
            rows: rows(&rounds, baseline),
            windows,
            exact_windows,
        })
    }

    /// Returns the parameters of the first round's sets. Fails if a leaf size is not possible with them.
    pub(super) fn base(&self) -> Result<Parameters> {
        let base = sized(self.samples, self.seed)?;
        base.validate_sequential()?;
        for &leaf in &self.leaves {
            Parameters { leaf, ..base }.validate()?;
        }
        Ok(base)
    }

    /// Carries out all rounds, each with a seed of its own. The engines of `once` make one set in a round, those of
    /// `by_leaf` one of each leaf size. Engines of one group make the same set.
    pub(super) fn rounds(
        &self,
        open: &Engines,
        once: &[&[Engine]],
        by_leaf: &[&[Engine]],
        base: &Parameters,
        pattern: &Arc<Pattern>,
        watch: &dyn Watch,
    ) -> Result<Vec<Vec<EngineTime>>> {
        let round = |number: u64| {
            let what = format!("round {} of {}", number + 1, self.rounds);
            let control = Control::new(watch, number as usize, what);
            control.go_on()?;

            let mut parameters = *base;
            parameters.seed = self.seed.wrapping_add(number);

            let mut all = Vec::new();
            // Sets from scratch have no leaf size: one of them is enough for a round.
            for group in once {
                all.extend(times(open, group, &parameters, pattern, &control)?);
            }

            for &leaf in &self.leaves {
                parameters.leaf = leaf;
                for group in by_leaf {
                    all.extend(times(open, group, &parameters, pattern, &control)?);
                }
            }
            Ok(all)
        };
        (0..self.rounds).map(round).collect()
    }

    /// Times a window of the plane in each round, by KDRT and by exact tiling, and verifies both.
    fn windows(
        &self,
        parameters: &Parameters,
        pattern: &Pattern,
        history: &PatternHistory,
        watch: &dyn Watch,
    ) -> Result<[WindowTimes; 2]> {
        let control = Control::new(watch, self.rounds as usize, "windows".to_owned());
        let (kdrt, kdrt_seconds) = timed(|| Plane::new(parameters, pattern));
        let (exact, exact_seconds) = timed(|| ExactPlane::new(parameters, history));
        let (kdrt, exact) = (kdrt?, exact?);

        // A maximal set has about 0.7 samples in a squared radius.
        let side = (Self::WINDOW_SAMPLES / 0.7).sqrt() * parameters.radius;
        let key = Key::from_seed(self.seed);

        let mut times = [kdrt_seconds, exact_seconds].map(WindowTimes::new);
        for round in 0..self.rounds as u32 {
            // The lower corner of the window is drawn in the unit square, which the plane repeats without end: windows
            // at its upper borders go on beyond them. Any stream of the key will do.
            let [x, y] = key.draw(Stream::Dart, round).map(f64::from);
            let low = [x, y].map(|v| v / f64::from(u32::MAX));
            let window = kdrt.domain().window(low, low.map(|v| v + side))?;

            let [of_kdrt, of_exact] = &mut times;
            of_kdrt.add(&kdrt, &window, &control)?;
            of_exact.add(&exact, &window, &control)?;
        }

        Ok(times)
    }
}
