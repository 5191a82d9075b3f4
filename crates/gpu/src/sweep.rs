//! A whole run, computed in windows, band by band: the counterpart of core's `Sweep`, with the same result. If the
//! device has the memory, the whole domain is one window.

use std::sync::Arc;

use tilescope_core::windows::WindowCounts;
use tilescope_core::{
    Domain, Observer, Parameters, Pattern, Point, Progress, R, Rect, Run, SampleError, Sampled,
    Stage, Summary, SweepState,
};

use crate::error::GpuError;
use crate::execute::Device;
use crate::fit::{self, Allowance, HALO, MIN_SIDE, longest_side, memory_of};
use crate::opened::Gpu;
use crate::pass_report::{PassReport, Recording};
use crate::setup::Setup;
use crate::window_run::{Shortage, WindowRun, WindowSamples};

/// The widest halo, in cells: [`HALO`] doubled five times. Chosen, not measured.
const MAX_HALO: i32 = 768;

/// Options of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// The most bytes of device memory to use at once; if `None`, a default for the kind of adapter.
    pub memory: Option<u64>,
    /// Whether to return the source of each sample.
    pub sources: bool,
    /// Whether to report every pass, with times if the adapter measures them.
    pub timed: bool,
    /// Initial width of the halo in cells, from 1 to 24, the usual width; another number is taken for the nearest
    /// of these. Windows with a narrow halo are recomputed more often; the result is the same. For experiments.
    pub halo: Option<u32>,
}

/// A run in progress on a GPU, band by band.
///
/// The bands, one after the other, are the result in canonical order, equal to every other engine's,
/// bit for bit.
pub struct GpuSweep {
    gpu: Arc<Gpu>,
    setup: Arc<Setup>,
    memory: u64,
    /// Whether passes are reported.
    timed: bool,
    /// Initial width of the halo in cells.
    halo: i32,
    /// Cells along the side of a window.
    side: u32,
    /// Rows of cells that have been computed.
    done: u32,
    counts: WindowCounts,
    count: u64,
    /// Buffers of the previous window.
    idle: Option<Device>,
}

impl GpuSweep {
    /// Returns a run at its beginning.
    ///
    /// Fails when the parameters cannot be sampled, ask for Algorithm 4 as printed, or when not even a small window fits
    /// the device.
    #[allow(clippy::unused_async)] // A browser may one day have to ask the adapter.
    pub async fn new(
        gpu: Arc<Gpu>,
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        options: Options,
    ) -> Result<Self, GpuError> {
        let setup = Arc::new(Setup::new(parameters, pattern, options.sources)?);
        let memory = memory_of(gpu.report(), options.memory);
        let side = longest_side(&setup, &gpu.report().limits, memory)?;

        Ok(Self {
            gpu,
            setup,
            memory,
            timed: options.timed,
            // Windows leave room for the usual halo, doubled once; a wider one may not fit.
            halo: options
                .halo
                .map_or(HALO, |halo| halo.clamp(1, HALO as u32) as i32),
            side,
            done: 0,
            counts: WindowCounts::default(),
            count: 0,
            idle: None,
        })
    }

    /// Returns the domain of the run.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.setup.domain
    }

    /// Returns how many cells there are along the longest side of a window.
    #[must_use]
    pub const fn window_side(&self) -> u32 {
        self.side
    }

    /// Returns the bytes of device memory that the run may use at once.
    #[must_use]
    pub const fn memory(&self) -> u64 {
        self.memory
    }

    /// Returns the most bytes of device memory that the buffers have held at once so far, readbacks apart.
    #[must_use]
    pub fn highest_bytes(&self) -> u64 {
        self.idle.as_ref().map_or(0, |device| device.highest_bytes)
    }

    /// Returns the passes so far, where they are reported.
    #[must_use]
    pub fn reports(&self) -> &[PassReport] {
        let reports = self
            .idle
            .as_ref()
            .and_then(|device| device.reports.as_deref());
        reports.unwrap_or_default()
    }

    const fn recording(&self) -> Recording {
        if self.timed {
            Recording::Passes
        } else {
            Recording::Nothing
        }
    }

    /// Returns how many rows of cells have been computed, and how many there are.
    #[must_use]
    pub fn rows(&self) -> (u32, u32) {
        (self.done, self.setup.cells()[1])
    }

    /// Returns the position of the run. Another process can continue from it, with any engine.
    #[must_use]
    pub fn state(&self) -> SweepState {
        SweepState {
            rows: self.done,
            count: self.count,
            counts: self.counts.clone(),
        }
    }

    /// Continues from the state of a run with the same parameters and pattern, as if the earlier bands had been
    /// computed here.
    pub fn restore(&mut self, state: &SweepState) {
        self.done = state.rows.min(self.setup.cells()[1]);
        self.count = state.count;
        self.counts = state.counts.clone();
    }

    /// Returns the counts of all bands so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        self.counts.summary(self.count)
    }

    /// Computes the next band and returns its samples, or `None` at the end.
    ///
    /// Fails when the device fails, or when `observer`, called before each window and during it, stops the run.
    pub async fn step(&mut self, observer: &mut dyn Observer) -> Result<Option<Sampled>, GpuError> {
        let (done, rows) = self.rows();
        ask(observer, done.into(), rows.into())?;
        if done == rows {
            return Ok(None);
        }

        let mut side = self.side;
        loop {
            match self.band(side, observer).await {
                // Other programs may hold the memory, or a wider halo may not fit; smaller windows may still fit.
                Err(GpuError::OutOfMemory) if side > MIN_SIDE => {
                    side = (side / 2).max(MIN_SIDE);
                    // The buffers are freed, and windows stay smaller for the rest of the run.
                    self.idle = None;
                    self.side = side;
                }
                Err(GpuError::TooLittleMemory { .. }) if side > MIN_SIDE => {
                    // Only this band needs more than the usual halo and room.
                    side = (side / 2).max(MIN_SIDE);
                }
                other => return other.map(Some),
            }
        }
    }

    /// Computes the next band in windows of at most `longest` cells a side.
    async fn band(
        &mut self,
        longest: u32,
        observer: &mut dyn Observer,
    ) -> Result<Sampled, GpuError> {
        let [columns, rows] = self.setup.cells();
        // There are no more windows than `longest` requires, all of about the same size.
        let side = |cells: u32| cells.div_ceil(cells.div_ceil(longest));
        let (width, height) = (side(columns), side(rows));
        let max = self.setup.domain.rect().max;
        let units = |cells: u32, end: i32| (i64::from(cells) * i64::from(R)).min(end.into()) as i32;
        let top = (self.done + height).min(rows);

        let mut windows = Vec::new();
        for left in (0..columns).step_by(width as usize) {
            ask(observer, self.done.into(), rows.into())?;
            let window = Rect {
                min: Point::new(units(left, max.x), units(self.done, max.y)),
                max: Point::new(units(left + width, max.x), units(top, max.y)),
            };
            windows.push(self.window(&window, observer).await?);
        }

        // Windows are counted when all of the band are made, so that a band that fails can be computed again.
        for window in &windows {
            self.counts.add(&window.counts);
            self.count += window.points.len() as u64;
        }

        self.done = top;
        Ok(join(windows, self.setup.sources))
    }

    /// Computes a window, again with a wider halo or more room as often as needed.
    async fn window(
        &mut self,
        window: &Rect,
        observer: &mut dyn Observer,
    ) -> Result<WindowSamples, GpuError> {
        let mut allowance = Allowance::new(self.halo);
        loop {
            match self.attempt(window, allowance, observer).await? {
                Ok(window) => return Ok(window),
                Err(shortage) => allowance.grow(shortage, MAX_HALO)?,
            }
        }
    }

    /// Computes a window once. Returns its samples, or the shortage for which it must be computed again.
    async fn attempt(
        &mut self,
        window: &Rect,
        allowance: Allowance,
        observer: &mut dyn Observer,
    ) -> Result<Result<WindowSamples, Shortage>, GpuError> {
        let plan = fit::plan(
            &self.setup,
            window,
            allowance,
            &self.gpu.report().limits,
            self.memory,
        )?;

        // In rows of cells, as progress is counted.
        let height = f64::from(plan.frame.window.height()) / f64::from(R);
        let (done, rows) = self.rows();
        // The buffers of the window before are used again where they are long enough.
        let idle = self.idle.take();
        let mut work = WindowRun::new(&self.gpu, &self.setup, plan, idle, self.recording()).await?;
        let shortage = work
            .run(|share| {
                let now = u64::from(done) + (share * height) as u64;
                Ok(ask(observer, now.min(rows.into()), rows.into())?)
            })
            .await?;

        let outcome = match shortage {
            Some(shortage) => Err(shortage),
            None => Ok(work.result().await?),
        };
        self.idle = Some(work.device);
        Ok(outcome)
    }

    /// Runs to the end and returns the samples of all remaining bands, and the summary of the whole run.
    pub async fn finish(
        mut self,
        observer: &mut dyn Observer,
    ) -> Result<(Sampled, Summary), GpuError> {
        let mut all = Sampled {
            points: Vec::new(),
            sources: self.setup.sources.then(Vec::new),
        };
        while let Some(mut band) = self.step(observer).await? {
            // The first band is moved, not copied: often it is the whole run.
            if all.points.is_empty() {
                all = band;
                continue;
            }
            all.points.append(&mut band.points);
            if let (Some(all), Some(band)) = (&mut all.sources, &mut band.sources) {
                all.append(band);
            }
        }

        Ok((all, self.summary()))
    }

    /// Returns a finished run with its blocks, its result and its counts, like core's `Sweep::run`.
    ///
    /// Fails like [`Self::new`] and [`Self::step`].
    pub async fn run(
        gpu: Arc<Gpu>,
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        observer: &mut dyn Observer,
    ) -> Result<Run, GpuError> {
        let options = Options {
            sources: true,
            ..Options::default()
        };
        let sweep = Self::new(gpu, parameters, pattern, options).await?;
        let (sampled, summary) = sweep.finish(observer).await?;
        Ok(Run::of_result(parameters, pattern, sampled, summary)?)
    }
}

/// Reports progress to the observer. Fails if it stops the run.
fn ask(observer: &mut dyn Observer, done: u64, total: u64) -> Result<(), SampleError> {
    let stage = Stage::Regions;
    if observer.observe(Progress { stage, done, total }).is_break() {
        return Err(SampleError::Cancelled { stage });
    }
    Ok(())
}

/// Joins windows that lie side by side, row of cells by row of cells.
fn join(mut windows: Vec<WindowSamples>, with_sources: bool) -> Sampled {
    if windows.len() == 1 {
        let window = windows.remove(0);
        return Sampled {
            points: window.points,
            sources: with_sources.then_some(window.sources),
        };
    }

    let mut joined = Sampled {
        points: Vec::new(),
        sources: with_sources.then(Vec::new),
    };

    // The samples of a window are sorted by rows of cells.
    let row_of = |p: &Point| p.y / R;
    let highest_row = windows
        .iter()
        .filter_map(|w| w.points.last())
        .map(row_of)
        .max();
    let lowest_row = windows
        .iter()
        .filter_map(|w| w.points.first())
        .map(row_of)
        .min();

    // How many samples of each window are joined. If no window has any, there are no rows.
    let mut taken = vec![0; windows.len()];
    for row in lowest_row.unwrap_or(0)..=highest_row.unwrap_or(-1) {
        for (window, taken) in windows.iter().zip(&mut taken) {
            let rest = &window.points[*taken..];
            let count = rest.partition_point(|p| row_of(p) <= row);
            joined.points.extend_from_slice(&rest[..count]);

            if let Some(sources) = &mut joined.sources {
                sources.extend_from_slice(&window.sources[*taken..*taken + count]);
            }
            *taken += count;
        }
    }
    joined
}

#[cfg(test)]
mod device;
