//! Nested levels as a recording: each sample arrives by an event of its own, in the order of ranks, so that a cursor is a number of
//! samples. Lessons ask their questions of it; the window shows a session of levels in its place.

use tilescope_core::{Domain, Parameters, Point, Recorder, Run, RunEvent};

use crate::ranks::RecordedLevels;
use crate::recording::Recording;
use crate::tape::{DEFAULT_BUDGET, Tape};

impl Recording {
    /// Returns the recording of nested levels of these parameters, whose samples arrive one by one in their order. There is a
    /// rank for each point.
    #[must_use]
    pub fn of_levels(
        parameters: &Parameters,
        domain: Domain,
        points: Vec<Point>,
        levels: RecordedLevels,
    ) -> Self {
        let mut tape = Tape::new(parameters, DEFAULT_BUDGET);
        for sample in 0..points.len() as u32 {
            // An event of an insertion names its iteration. Levels are not made in iterations, and 1 stands for all.
            let iteration = 1;
            tape.record(RunEvent::Insert { sample, iteration });
        }
        tape.seal();

        let mut recording = Self::of(Run::of_points(*parameters, domain, points), tape);
        recording.levels = Some(levels);
        recording
    }

    /// Returns the data of its nested levels, if it is a recording of some.
    #[must_use]
    pub const fn levels(&self) -> Option<&RecordedLevels> {
        self.levels.as_ref()
    }

    /// Returns the recording of those samples of nested levels that are in `kept`, by their numbers, which ascend. `None` if it
    /// has no levels.
    #[must_use]
    pub fn painted(&self, kept: &[u32]) -> Option<Self> {
        let levels = self.levels()?;
        let points = &self.run().samples.points;
        let indices = || kept.iter().map(|&sample| sample as usize);

        let painted = RecordedLevels {
            request: levels.request,
            ranks: indices().map(|sample| levels.ranks[sample]).collect(),
            // Painting takes out samples by their place, of any level, so that no level counts as whole.
            ends: Vec::new(),
            is_painted: true,
        };
        let left = indices().map(|sample| points[sample]).collect();
        Some(Self::of_levels(
            &self.run().parameters,
            *self.domain(),
            left,
            painted,
        ))
    }

    /// Returns the recording of the first `count` samples of nested levels, or of all samples if there are fewer. A
    /// `count` of 0 gives the first sample. `None` if this recording has no levels.
    pub(crate) fn first_of_levels(&self, count: usize) -> Option<Self> {
        let levels = self.levels()?;
        // Of a set without samples nothing could be shown or asked, so that at least one sample is left.
        let count = count.max(1).min(levels.ranks.len());

        // `ends` lists only levels that are there whole. A level that ends behind the cut has lost some of its samples.
        let ends = levels.ends.iter().copied();
        let ends_of_whole = ends.filter(|&end| end <= count).collect();

        let cut = RecordedLevels {
            ranks: levels.ranks[..count].to_vec(),
            ends: ends_of_whole,
            ..*levels
        };
        let first = self.run().samples.points[..count].to_vec();
        Some(Self::of_levels(
            &self.run().parameters,
            *self.domain(),
            first,
            cut,
        ))
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::{NestedRequest, Unobserved, WithinLevel};

    use super::*;
    use crate::life::Status;

    /// Returns three levels, recorded.
    fn recorded() -> Recording {
        let parameters = Parameters {
            radius: 0.04,
            ..Parameters::default()
        };
        let request = NestedRequest {
            levels: 3,
            exactly: None,
            order_within: WithinLevel::Random,
        };
        let made = request.make(&parameters, &mut Unobserved).expect("levels");
        let levels = RecordedLevels::whole(request, made.ranks().expect("a whole run has ranks"));
        assert_eq!(levels.ends, made.ends());
        Recording::of_levels(&parameters, *made.domain(), made.points().to_vec(), levels)
    }

    #[test]
    fn a_cursor_is_a_number_of_samples() {
        let recording = recorded();
        let levels = recording.levels().unwrap();
        assert_eq!(recording.len(), levels.ranks.len());
        let half = levels.below(0.5);
        assert!(half > 100 && half < recording.len());
        assert_eq!(recording.status(half as u32 - 1, half), Status::Kept);
        assert_eq!(recording.status(half as u32, half), Status::Absent);
    }

    #[test]
    fn a_cut_has_the_first_samples_alone() {
        let recording = recorded();
        let half = recording.levels().unwrap().below(0.5);
        let past = recording.until(half);
        assert_eq!(
            (past.len(), past.levels().unwrap().ranks.len()),
            (half, half)
        );
        assert_eq!(
            past.run().samples.points,
            recording.run().samples.points[..half]
        );
        assert_eq!(past.run().result.len(), half);
        // Half of the samples are the levels but the last one.
        assert_eq!(
            past.levels().unwrap().ends,
            recording.levels().unwrap().ends[..2]
        );
        assert_eq!(recording.until(half - 1).levels().unwrap().ends.len(), 1);
    }

    #[test]
    fn a_painted_recording_has_the_kept_samples_with_their_ranks() {
        let recording = recorded();
        let painted = recording.painted(&[2, 5, 7]).unwrap();
        let (all, left) = (recording.levels().unwrap(), painted.levels().unwrap());
        assert_eq!(left.ranks, [all.ranks[2], all.ranks[5], all.ranks[7]]);
        assert!(left.is_painted && !all.is_painted);
        assert_eq!(painted.point(1), recording.point(5));
        // The control: a run without levels is not painted.
        let run = Recording::new(
            &Parameters {
                radius: 0.1,
                ..Parameters::default()
            },
            1000,
            &mut Unobserved,
        );
        assert!(run.unwrap().painted(&[0]).is_none());
    }
}
