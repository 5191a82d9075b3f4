//! The measures of the moment at a cursor.

use std::sync::Arc;

use tilescope_analysis::LiveSquares;
use tilescope_analysis::live::{LiveCover, LivePairs, LiveSolidPairs, LiveSpectrum};
use tilescope_analysis::measures::MeasureError;

use crate::balls::BallPairs;
use crate::course::Course;
use crate::kept::Kept;
use crate::spectra::Spectra;

/// The steps that measures have in a frame. By `tilescope bench --live` of 100,218 samples a jump takes 6 ns a step, and a frame
/// of play 5 ms in the mean, of which reading the spectrum, which is not counted, takes about 3.
pub const FRAME_STEPS: u64 = 800_000;

/// The most samples of a run whose measures move: of more, a change of the spectrum alone would take a frame.
pub const MAX_SAMPLES: usize = 200_000;

/// What visible panels, curves and players ask for. Nothing else is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is asked for by itself")]
pub struct Wanted {
    /// The spectrum, with all numbers that are read from it.
    pub spectrum: bool,
    /// Whether every second or third frequency along each axis will do while the budget of steps is too small for all.
    pub thinned: bool,
    /// Distances: g(r), the smallest one, conflicts. Of a set in space they are all that moves with the run, without g(r).
    pub pairs: bool,
    /// Open places and, of one radius in a rectangle, the covering radius; in a field or a shape, conflicts too.
    pub cover: bool,
}

/// What a move took, and whether it arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The counted steps that the move took.
    pub steps: u64,
    /// Whether all that was wanted is the moment's.
    pub arrived: bool,
}

/// The measures of the moment at a cursor.
pub struct LiveMoment {
    course: Arc<Course>,
    cursor: usize,
    /// How many changes lie before the cursor.
    changes: usize,
    spectra: Spectra,
    pairs: Kept<LivePairs>,
    cover: Kept<LiveCover>,
    /// In a field or a shape, the squares of its judge, which take the place of covered circles.
    squares: Option<Kept<LiveSquares>>,
    /// In space, the distances, which take the place of all others.
    balls: Kept<BallPairs>,
}

impl LiveMoment {
    /// Returns the moment before the first event. Nothing is measured yet. In a field or a shape conflicts and open places will be
    /// those of its judge; spectrum and g(r) are of all samples together, without regard to the radius at each place.
    #[must_use]
    pub fn new(course: Arc<Course>) -> Self {
        let squares = course.ground().map(|ground| ground.squares.clone());
        Self {
            course,
            cursor: 0,
            changes: 0,
            spectra: Spectra::default(),
            pairs: Kept::default(),
            cover: Kept::default(),
            squares: squares.map(Kept::of_nothing),
            balls: Kept::default(),
        }
    }

    /// Returns the course that it follows.
    #[must_use]
    pub const fn course(&self) -> &Arc<Course> {
        &self.course
    }

    /// Returns how many samples cover their disks at the cursor.
    #[must_use]
    pub fn count(&self) -> usize {
        self.course.count_after(self.changes)
    }

    /// Moves to `cursor`, forwards or backwards, and brings the wanted measures there: change by change or anew, whichever takes
    /// fewer steps, in about `budget` steps at most. What needs more is not the moment's yet; later calls with the same
    /// cursor go on.
    ///
    /// # Errors
    ///
    /// A measure is not defined in this domain.
    pub fn seek(
        &mut self,
        cursor: usize,
        wanted: Wanted,
        budget: u64,
    ) -> Result<Moved, MeasureError> {
        let (course, changes) = (&*self.course, self.course.changes_before(cursor));
        (self.cursor, self.changes) = (cursor, changes);
        if course.is_in_space() {
            return self.seek_in_space(wanted, budget);
        }
        let plane = course.plane();
        let mut steps = 0;

        // Pairs and covered circles are quick, and come first, so that they need not wait for a spectrum that takes the whole budget.
        if wanted.pairs {
            self.pairs.begin(|| LivePairs::new(plane))?;
            steps += self.pairs.seek(course, changes, budget);
        }
        if wanted.cover {
            let left = budget.saturating_sub(steps);
            steps += if let Some(squares) = &mut self.squares {
                squares.seek(course, changes, left)
            } else {
                self.cover.begin(|| LiveCover::new(plane))?;
                self.cover.seek(course, changes, left)
            };
        }
        if wanted.spectrum {
            let left = budget.saturating_sub(steps);
            steps += self.spectra.seek(course, changes, left, wanted.thinned)?;
        }

        let has_spectrum = self.spectra.after(changes, wanted.thinned).is_some();
        let arrived = (has_spectrum || !wanted.spectrum)
            && (self.pairs().is_some() || !wanted.pairs)
            && (self.cover().is_some() || self.squares().is_some() || !wanted.cover);
        Ok(Moved { steps, arrived })
    }

    /// Brings the distances of a set in space to the cursor, as [`Self::seek`] does in the plane. Its projections have no
    /// spectrum and no circles of their own, so that asking for these takes no steps.
    fn seek_in_space(&mut self, wanted: Wanted, budget: u64) -> Result<Moved, MeasureError> {
        let (course, changes) = (&*self.course, self.changes);
        let mut steps = 0;
        if let (true, Some(solid), Some(heights)) =
            (wanted.pairs, course.solid_box(), course.heights())
        {
            self.balls
                .begin(|| BallPairs::new(solid, Arc::clone(heights)))?;
            steps = self.balls.seek(course, changes, budget);
        }
        let arrived = self.balls.after(changes).is_some() || !wanted.pairs;
        Ok(Moved { steps, arrived })
    }

    /// Returns about the steps of reading the wanted measures: the rings and the picture of a spectrum take far more than the rest.
    pub(crate) fn cost_of_reading(&self, wanted: Wanted) -> u64 {
        // In space no spectrum is followed.
        if wanted.spectrum && !self.course.is_in_space() {
            self.spectra.cost_of_reading(self.changes)
        } else {
            0
        }
    }

    /// Returns the spectrum, if it is this moment's: with all frequencies, or else with the most that there are.
    #[must_use]
    pub fn spectrum(&self) -> Option<&LiveSpectrum> {
        let may_be_thinned = true;
        self.spectra.after(self.changes, may_be_thinned)
    }

    /// Returns the spectrum that has come nearest to this moment, and the cursor of the moment whose spectrum it is. `None` before
    /// a spectrum was asked for.
    pub(crate) fn nearest_spectrum(&self) -> Option<(usize, &LiveSpectrum)> {
        let (taken, spectrum) = self.spectra.nearest(self.changes)?;
        Some((self.course.cursor_after(taken), spectrum))
    }

    /// Returns the distances, if they are this moment's.
    #[must_use]
    pub fn pairs(&self) -> Option<&LivePairs> {
        self.pairs.after(self.changes)
    }

    /// Returns the distances in space, if they are this moment's. Planar sets have none.
    #[must_use]
    pub fn balls(&self) -> Option<&LiveSolidPairs> {
        self.balls.after(self.changes).map(|balls| &balls.pairs)
    }

    /// Returns how many cells, or in space cubes, throw a dart in the throw at work; 0 where none is.
    #[must_use]
    pub fn active(&self) -> u32 {
        self.course.active(self.cursor)
    }

    /// Returns the covered circles, if they are this moment's. In a field or a shape there are none.
    #[must_use]
    pub fn cover(&self) -> Option<&LiveCover> {
        self.cover.after(self.changes)
    }

    /// Returns the squares of the judge, if they are this moment's. There are some only in a field or a shape.
    #[must_use]
    pub fn squares(&self) -> Option<&LiveSquares> {
        self.squares.as_ref()?.after(self.changes)
    }
}
