//! The judge of sets too large for memory: the same verdict, while the samples pass by once. It takes positions in
//! nearly row order, judges a band of rows as soon as it is complete and keeps only what later bands need. Sets that it
//! cannot judge exactly are refused.
//!
//! # Why its verdict is that of [`verify`](crate::verify)
//!
//! The grid of the whole region is fixed beforehand by the radius, and a band holds some of its rows under their
//! indices in the whole ([`Grid::of_rows`](crate::grid::Grid::of_rows)). Both searches work on it with the coordinates,
//! and so with the bits, that they see in the whole set. Each row scans its pairs once, with the row above. A tile is
//! judged by a window that is proven wide enough; a tile that needs later rows is postponed. Gaps on the sides of tiles
//! are settled at the end, all together, as for a set in memory.
//!
//! # The seams of a torus
//!
//! The first rows are kept to the end and judged with the last ones. The very first row stays open
//! all the time: a file that rounds to 32 bits moves samples of the last row across the seam, so that they
//! arrive last and lie at zero.

mod bands;
mod saved;

use serde::{Deserialize, Serialize};

use crate::agreement;
use crate::circles::CircleBands;
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::{Entry, Grid};
use crate::input::{all_are_in, check_judge, check_point, check_tolerance};
use crate::judge::JudgeChoice;
use crate::monitor::{Control, Monitor};
use crate::region::Region;
use crate::report::{JudgedSet, Report};
use crate::verify::{VerifyOptions, verify};
use bands::{Bands, StreamSearch};

/// How far, in radii, an ordinate may lie below the highest one before it. Tilescope's samplers write rows of cells of
/// one radius, up to one unit of their lattice in 2^15; the rest is room for rounding.
pub const STREAM_LAG: f64 = 1.0 + 1.0 / 16.0;

/// How much of a stream is held at a time. It decides memory and speed, never the verdict.
#[derive(Clone, Copy, Debug)]
pub struct StreamBand {
    /// Samples after which a band is judged. It takes about 60 bytes for each.
    pub samples: usize,
    /// Least rows of a band; a row is 1.3 radii high. Fewer than 30 make the overlaps costly.
    pub rows: usize,
    /// Most samples held. A set that needs more is refused with [`VerifyError::BandTooLarge`].
    pub most_samples: usize,
}

impl Default for StreamBand {
    fn default() -> Self {
        Self {
            samples: 1 << 20,
            rows: 32,
            most_samples: 1 << 22,
        }
    }
}

/// Verifies a set that arrives in pieces, in nearly row order, in bounded memory.
///
/// The report is that of [`verify`] on the whole sequence: counts, extremes and witnesses, up to the rounding
/// of circles on the very side of a tile. Exactly cocircular samples count as there.
///
/// The contract: after a sample of ordinate `y` none may follow below `y` less [`STREAM_LAG`]
/// radii, but for the lowest radius of a torus, where samples may come at any time. It is checked.
///
/// ```
/// use std::ops::ControlFlow;
/// use tilescope_analysis::{Boundary, Region, StreamVerifier, VerifyOptions};
///
/// let region = Region { width: 8.0, height: 8.0, boundary: Boundary::Periodic };
/// let go_on = |_| ControlFlow::Continue(());
/// let mut verifier = StreamVerifier::new(region, 1.0, &VerifyOptions::default())?;
/// for row in 0..8 {
///     let row: Vec<_> = (0..8).map(|column| [f64::from(column), f64::from(row)]).collect();
///     verifier.push(&row, &go_on)?;
/// }
/// assert!(verifier.finish(&go_on)?.valid());
/// # Ok::<(), tilescope_analysis::VerifyError>(())
/// ```
#[derive(Clone, Debug)]
pub struct StreamVerifier {
    search: StreamSearch,
    /// The samples and findings of the first judge, if it is asked.
    bands: Option<Bands>,
    /// The samples and findings of the second judge, if it is asked.
    circles: Option<CircleBands>,
    intake: Intake,
    /// Samples that the second judge holds when it looks for a complete band.
    next_circles: usize,
    /// Samples that the caller expects, for the progress alone.
    expected: u64,
    /// The first error; there is no verdict after it.
    fault: Option<VerifyError>,
}

impl StreamVerifier {
    /// Returns a verifier without samples.
    ///
    /// # Errors
    ///
    /// [`VerifyError::BadRegion`], [`VerifyError::BadRadius`], [`VerifyError::BadTolerance`] and
    /// [`VerifyError::WrongJudge`], as [`verify`].
    pub fn new(region: Region, radius: f64, options: &VerifyOptions) -> Result<Self, VerifyError> {
        let domain = Domain::new(region)?;
        let scaled_radius = domain.scale_radius(radius)?;
        check_tolerance(options.covering_tolerance)?;
        check_judge(options.judges)?;

        let mut search = StreamSearch::new(region, radius, options.clone(), domain, scaled_radius);
        let (by_delaunay, by_circles) = match options.judges {
            JudgeChoice::Delaunay => (true, false),
            JudgeChoice::Circles => (false, true),
            // A stream is never judged by subdivision, which was refused above.
            JudgeChoice::Both | JudgeChoice::Subdivision => (true, true),
            JudgeChoice::Automatic => {
                // The densest set without conflicts has 1.155 samples to a squared radius; 1.2 is a little more.
                let most_samples = 1.2 * region.area() / (radius * radius);
                // A set for both judges is held in `bands` until its end, where `verify` asks both. A larger one is judged
                // by circles alone, while it comes.
                search.whole = most_samples <= JudgeChoice::BOTH_UP_TO as f64;
                (search.whole, !search.whole)
            }
        };

        // The second judge cannot stream a region of few rows: its samples are held in `bands` as a whole, too.
        search.whole |= by_circles && !CircleBands::streams(&search.question());
        let needs_bands = by_delaunay || search.whole;

        Ok(Self {
            bands: needs_bands.then(|| Bands::new(&search)),
            circles: (by_circles && !search.whole).then(|| CircleBands::new(&search.question())),
            search,
            next_circles: StreamBand::default().samples,
            intake: Intake::default(),
            expected: 0,
            fault: None,
        })
    }

    /// The same with bands of another size.
    #[must_use]
    pub fn with_band(mut self, band: StreamBand) -> Self {
        self.search.band = band;
        self.next_circles = band.samples;
        self
    }

    /// The same with the number of samples that will come, for the progress: its total is that number, or the number
    /// that came where that is larger, for each pass of a judge.
    #[must_use]
    pub fn expecting(mut self, count: u64) -> Self {
        self.expected = count;
        self
    }

    /// Samples taken so far.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.intake.count as u64
    }

    /// Takes the next samples, and judges a band when enough rows are complete.
    ///
    /// `control` is called at least once, from any thread of the current rayon pool; `Break` cancels.
    ///
    /// # Errors
    ///
    /// As [`verify`], with the index in the whole sequence, and the errors of streams: [`VerifyError::OutOfOrder`],
    /// [`VerifyError::HoleTooWide`], [`VerifyError::BandTooLarge`], [`VerifyError::Crowded`]; for these
    /// [`VerifyError::needs_memory`] is true.
    /// The verifier then repeats its error and gives no verdict.
    pub fn push(&mut self, points: &[[f64; 2]], control: Control<'_>) -> Result<(), VerifyError> {
        self.guarded(|this| this.take(points, control))
    }

    /// Returns the verdict on all samples.
    ///
    /// # Errors
    ///
    /// As [`Self::push`], [`VerifyError::Empty`], and [`VerifyError::TooSparse`] for a set without any two samples near each
    /// other.
    pub fn finish(mut self, control: Control<'_>) -> Result<Report, VerifyError> {
        self.guarded(|this| this.report(control))
    }

    /// Does some work unless an earlier call failed, and keeps the error if it fails.
    fn guarded<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<T, VerifyError>,
    ) -> Result<T, VerifyError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let outcome = work(self);
        if let Err(fault) = &outcome {
            self.fault = Some(fault.clone());
        }
        outcome
    }

    /// Hands samples to the judges, piece by piece, and has complete bands judged.
    fn take(&mut self, points: &[[f64; 2]], control: Control<'_>) -> Result<(), VerifyError> {
        let monitor = self.monitor(control);
        // Even a call without samples asks whether to go on.
        monitor.advance(0)?;

        for piece in points.chunks(PIECE) {
            let first = self.intake.count;
            // Samples are checked before they are given to a judge, so that findings are of good samples alone. No
            // index is beyond 32 bits from here on.
            self.intake.check_all(piece, &self.search)?;

            if let Some(bands) = &mut self.bands {
                for (&point, id) in piece.iter().zip(first as u32..) {
                    let position = self.search.domain.scale_point(point);
                    bands.add(Entry { position, id });
                }
            }
            if let Some(circles) = &mut self.circles {
                let complete = self.search.complete(self.intake.highest);
                circles.add(&self.search.question(), piece, first as u32, complete)?;
            }

            self.judge_complete(&monitor)?;
        }

        self.intake.work = monitor.done();
        Ok(())
    }

    /// Judges the rows that no further sample can reach, once enough of them have come. Fails if the rows that are held
    /// have too many samples.
    fn judge_complete(&mut self, monitor: &Monitor<'_>) -> Result<(), VerifyError> {
        let (search, highest) = (&self.search, self.intake.highest);
        if let Some(bands) = &mut self.bands {
            bands.judge_complete(search, highest, monitor)?;
        }
        if let Some(circles) = &mut self.circles {
            // Complete rows are looked for each time that a band of new samples has come.
            if circles.len() >= self.next_circles {
                let complete = search.complete(highest);
                circles.judge_complete(&search.question(), complete, monitor)?;
                self.next_circles = circles.len() + search.band.samples;
            }
            let (samples, limit) = (circles.len(), search.band.most_samples);
            if samples > limit {
                return Err(VerifyError::BandTooLarge { samples, limit });
            }
        }
        Ok(())
    }

    /// Judges the remaining samples, and returns the report on all of them.
    fn report(&mut self, control: Control<'_>) -> Result<Report, VerifyError> {
        let search = &self.search;
        let (region, radius, options) = (search.region, search.radius, &search.options);

        // A stream of which no band was judged yet is verified as a whole set, which is never refused for holes or
        // crowds. Where both judges are asked, the first one has the samples for both.
        let unjudged = match (&mut self.bands, &mut self.circles) {
            (Some(bands), _) => bands.take_unjudged(search),
            (None, Some(circles)) => circles.unjudged(),
            (None, None) => None,
        };
        if let Some(all) = unjudged {
            // `all` has its own copy of the samples: those in `circles` would double the memory.
            self.circles = None;
            return verify(&all, region, radius, options, control);
        }

        let monitor = self.monitor(control);
        let count = self.intake.count;
        let set = JudgedSet {
            count,
            region,
            radius,
            covering_tolerance: options.covering_tolerance,
        };
        let report_on = |found| Report::new(set, search.domain.scale, found);

        let bands = self.bands.as_mut();
        let delaunay = bands
            .map(|bands| bands.finish(search, &monitor))
            .transpose()?;

        let circles = self
            .circles
            .take()
            .map(|circles| circles.finish(&search.question(), count, &monitor))
            .transpose()?
            .map(|found| report_on(found.findings(options.witnesses)));

        match (delaunay.map(report_on), circles) {
            (Some(delaunay), Some(circles)) => agreement::agreed(delaunay, circles),
            (Some(report), None) | (None, Some(report)) => Ok(report),
            // This does not occur, as at least one judge is always asked.
            (None, None) => Err(VerifyError::Empty),
        }
    }

    /// Returns the monitor of a call, which goes on from the work that is done.
    fn monitor<'a>(&self, control: Control<'a>) -> Monitor<'a> {
        let total = self.expected.max(self.count());
        // The first judge passes over the samples twice, the second one once, as for a set in memory.
        let passes = if self.search.whole {
            self.search.options.judges.passes(total as usize)
        } else {
            2 * u64::from(self.bands.is_some()) + u64::from(self.circles.is_some())
        };
        Monitor::resumed(control, self.intake.work, passes * total)
    }
}

/// Samples taken between two checks for a complete band.
const PIECE: usize = 4096;

/// Number and order of the samples so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Intake {
    count: usize,
    /// The highest ordinate so far, in the domain's unit.
    highest: f64,
    /// Work done, for the progress.
    work: u64,
}

impl Intake {
    /// Checks samples and counts them.
    fn check_all(&mut self, points: &[[f64; 2]], search: &StreamSearch) -> Result<(), VerifyError> {
        // The ordinates of most pieces differ by less than a sample may lag: then none is late, whatever their order, and the
        // piece is checked as a whole. A NaN leaves `low` and `high` as they are; `all_are_in` finds it.
        let (mut low, mut high) = (f64::INFINITY, self.highest);
        for point in points {
            let y = search.domain.scale_point(*point).y;
            low = if y < low { y } else { low };
            high = if y > high { y } else { high };
        }

        let none_is_late = low >= search.complete(high);
        let fits = self.count + points.len() <= Grid::MAX_SAMPLES;
        if !(none_is_late && fits && all_are_in(points, search.region)) {
            // One by one, the samples before the first at fault are counted, and the error names that one.
            let mut each = points.iter();
            return each.try_for_each(|&point| self.check_one(point, search));
        }

        self.highest = high;
        self.count += points.len();
        Ok(())
    }

    /// Checks the next sample and counts it. Fails if it is not in the region, comes too late for its row, or is one
    /// too many.
    fn check_one(&mut self, point: [f64; 2], search: &StreamSearch) -> Result<(), VerifyError> {
        let index = self.count;
        check_point(index, point, search.region)?;

        if index >= Grid::MAX_SAMPLES {
            let (count, limit) = (index.saturating_add(1), Grid::MAX_SAMPLES);
            return Err(VerifyError::TooMany { count, limit });
        }

        let position = search.domain.scale_point(point);
        let limit = search.complete(self.highest);
        // The lowest row of a torus stays open: rounding to 32 bits may bring its samples last.
        if position.y < limit && !(search.domain.periodic && search.row(position.y) == 0) {
            return Err(VerifyError::OutOfOrder {
                index,
                value: point[1],
                limit: limit / search.domain.scale,
            });
        }

        self.highest = self.highest.max(position.y);
        self.count += 1;
        Ok(())
    }
}
