//! Measures that are made anew in slices of counted steps, so that no frame waits for one. The old measure stays as it is until
//! the new one takes its place.

/// The id and the place of a sample.
pub type LiveSample = (u32, [i32; 2]);

/// A measure that can be made anew in slices.
pub trait Renew: Sized {
    /// The state between two slices.
    type Work;

    /// About the steps of a sample at the beginning, when all are listed and sorted at once.
    const BEGINNING: u64;

    /// Returns the measure of no sample, and the work that makes it that of these.
    fn begin_anew(&self, samples: &[LiveSample]) -> (Self, Self::Work);

    /// Makes the next slice, a small part of a frame, and returns its counted steps; `None` once all are made.
    fn next_slice(&mut self, work: &mut Self::Work, samples: &[LiveSample]) -> Option<u64>;

    /// Returns about the steps of all slices for the given number of samples.
    fn cost_of_slices(&self, count: usize) -> u64;
}

/// A measure that is being made anew.
pub struct Renewal<M: Renew> {
    measure: M,
    work: M::Work,
    samples: Vec<LiveSample>,
    steps: u64,
    is_made: bool,
}

impl<M: Renew> Renewal<M> {
    /// Begins to make a measure anew, of these samples.
    pub fn of(measure: &M, samples: Vec<LiveSample>) -> Self {
        let (measure, work) = measure.begin_anew(&samples);
        Self {
            measure,
            work,
            steps: 0,
            samples,
            is_made: false,
        }
    }

    /// Returns about how many counted steps it takes to make a measure anew from this number of samples.
    pub fn cost(measure: &M, count: usize) -> u64 {
        M::BEGINNING * count as u64 + measure.cost_of_slices(count)
    }

    /// Makes the next slice, and returns its counted steps; those of the beginning are among the first ones.
    pub fn proceed(&mut self) -> u64 {
        let before = self.steps;
        if before == 0 {
            self.steps = M::BEGINNING * self.samples.len() as u64;
        }
        match self.measure.next_slice(&mut self.work, &self.samples) {
            Some(steps) => self.steps += steps,
            None => self.is_made = true,
        }
        self.steps - before
    }

    /// Returns about the steps that are left.
    #[must_use]
    pub fn steps_left(&self) -> u64 {
        Self::cost(&self.measure, self.samples.len()).saturating_sub(self.steps)
    }

    /// Returns whether all slices are made.
    #[must_use]
    pub const fn is_made(&self) -> bool {
        self.is_made
    }

    /// Returns the measure, which is that of the samples once all slices are made.
    #[must_use]
    pub fn finish(self) -> M {
        debug_assert!(self.is_made, "a measure of a part of the samples");
        self.measure
    }
}
