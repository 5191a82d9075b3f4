//! Playback: the clock, which is the unit of a step of playback and of the arrow keys, and the speed: ticks of the clock, or
//! the whole run in a given time. Nothing moves here: `state/time.rs` moves the run.

use std::ops::Range;

/// The unit of a step in time.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// A tick is one event.
    Event,
    /// Consecutive events that execute one line of pseudocode.
    Line,
    /// A stage or an iteration.
    #[default]
    Stage,
    /// A compute pass of the GPU.
    Pass,
}

impl Clock {
    /// Every clock, from the finest to that of the GPU's passes.
    pub const ALL: [Self; 4] = [Self::Event, Self::Line, Self::Stage, Self::Pass];

    /// Returns the name that the window and files show.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Event => "event",
            Self::Line => "line",
            Self::Stage => "stage",
            Self::Pass => "GPU pass",
        }
    }

    /// Returns the duration of a tick at speed 1, in seconds. All are chosen, not measured.
    pub(crate) const fn tick_secs(self) -> f32 {
        match self {
            Self::Event => 0.25,
            Self::Line => 0.5,
            Self::Stage | Self::Pass => 1.2,
        }
    }
}

/// Speeds to choose from. Chosen, not measured, like the durations below.
pub const SPEEDS: [f32; 7] = [0.25, 0.5, 1.0, 2.0, 8.0, 64.0, 512.0];
/// Durations of a whole run to choose from, in seconds.
pub const WHOLE_RUNS_SECS: [f32; 3] = [10.0, 30.0, 60.0];
/// The most ticks in one frame, so that a frame stays short. Chosen, not measured.
const MAX_TICKS: u32 = 2_000;

/// The state of playback.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// The unit of a tick.
    pub clock: Clock,
    /// The factor of the speed.
    pub speed: f32,
    /// The duration of the whole run, in seconds; if given, playback takes this time instead of going by ticks.
    pub whole_run_secs: Option<f32>,
    /// The range of cursors that play loops over.
    pub range: Option<Range<usize>>,
    /// The clock to return to when there are no passes.
    without_passes: Clock,
    /// Seconds until the next tick, while playing.
    left_secs: Option<f32>,
}

impl Default for Playback {
    fn default() -> Self {
        Self {
            clock: Clock::default(),
            speed: 1.0,
            whole_run_secs: Some(WHOLE_RUNS_SECS[1]),
            range: None,
            without_passes: Clock::default(),
            left_secs: None,
        }
    }
}

impl Playback {
    /// Returns whether it is playing.
    #[must_use]
    pub const fn is_playing(&self) -> bool {
        self.left_secs.is_some()
    }

    /// Sets the clock, and keeps the one to return to when there are no passes.
    pub const fn choose(&mut self, clock: Clock) {
        self.without_passes = self.clock_of_events();
        self.clock = clock;
    }

    /// Returns the clock, or the one before it if the clock is that of passes.
    pub(crate) const fn clock_of_events(&self) -> Clock {
        match self.clock {
            Clock::Pass => self.without_passes,
            clock => clock,
        }
    }

    /// Starts playing: the first tick is due after the time of one.
    pub fn start(&mut self) {
        self.left_secs = Some(self.tick_secs());
    }

    /// Stops playing; clock and speed stay.
    pub const fn stop(&mut self) {
        self.left_secs = None;
    }

    fn tick_secs(&self) -> f32 {
        match self.pace_secs() {
            // A run with events goes by its `Course`, and not by ticks. One without is played stage by stage, and has
            // about eight stages.
            Some(secs) => secs / 8.0,
            None => self.clock.tick_secs() / self.speed,
        }
    }

    /// Plays by ticks at this speed.
    pub(crate) const fn choose_speed(&mut self, speed: f32) {
        (self.speed, self.whole_run_secs) = (speed, None);
    }

    /// Returns the duration of the whole run, if play goes by that: the passes of the GPU are played by ticks.
    #[must_use]
    pub fn pace_secs(&self) -> Option<f32> {
        self.whole_run_secs.filter(|_| self.clock != Clock::Pass)
    }

    /// Returns whether steps follow each other so quickly that a transition between them could not be seen.
    pub(crate) fn is_fast(&self, transition_secs: f32) -> bool {
        self.is_playing() && (self.pace_secs().is_some() || self.tick_secs() < transition_secs)
    }

    /// Advances by `dt_secs`; returns how many ticks are due.
    pub fn advance(&mut self, dt_secs: f32) -> u32 {
        let tick = self.tick_secs();
        let Some(left) = &mut self.left_secs else {
            return 0;
        };
        *left -= dt_secs;
        if *left > 0.0 {
            return 0;
        }
        // One tick was awaited, and `-left` is the time since it was due: further ticks have become due in that time.
        let due = (1 + (-*left / tick) as u32).min(MAX_TICKS);
        // Ticks beyond the limit are dropped: the next one is due at once, and playback falls behind.
        *left = (*left + due as f32 * tick).max(0.0);
        due
    }
}

/// The course of a whole run: the share of the time that each stage takes. It grows with the logarithm of the stage's
/// number of events, so that no stage is over before it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The cursor at the end of each stage, and the share of the time until then.
    ends: Vec<(usize, f64)>,
}

impl Course {
    /// Returns the course of a run whose stages end at these cursors, in order.
    #[must_use]
    pub fn of(stage_ends: impl Iterator<Item = usize>) -> Self {
        let (mut from, mut sum) = (0, 0.0);
        let mut ends: Vec<(usize, f64)> = Vec::new();
        for end in stage_ends {
            // With the logarithm, eighteen splits last long enough to be seen, and thousands of clips do not seem endless. 2 is
            // added, as a stage without events takes time, too.
            sum += ((end.saturating_sub(from) + 2) as f64).ln();
            ends.push((end, sum));
            from = end;
        }
        for (_, share) in &mut ends {
            *share /= sum;
        }
        Self { ends }
    }

    /// Returns the share of the time that has passed at a cursor, from 0 to 1; beyond the last stage it is 1.
    #[must_use]
    pub fn share(&self, cursor: usize) -> f64 {
        let index = self.ends.partition_point(|&(end, _)| end < cursor);
        let (from, before) = self.before(index);
        let Some(&(end, after)) = self.ends.get(index) else {
            return 1.0;
        };
        let part = (cursor - from) as f64 / (end - from).max(1) as f64;
        before + part * (after - before)
    }

    /// Returns the cursor at a share of the time: that of the end from share 1 on, 0 for a run without stages.
    #[must_use]
    pub fn cursor(&self, share: f64) -> usize {
        let index = self.ends.partition_point(|&(_, after)| after <= share);
        let (from, before) = self.before(index);
        let Some(&(end, after)) = self.ends.get(index) else {
            return self.ends.last().map_or(0, |&(end, _)| end);
        };
        let part = ((share - before) / (after - before)).clamp(0.0, 1.0);
        from + (part * (end - from) as f64) as usize
    }

    /// Returns the cursor and the share of the time at which the stage of an index begins.
    fn before(&self, index: usize) -> (usize, f64) {
        let last = index.checked_sub(1);
        last.map_or((0, 0.0), |last| self.ends[last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_gives_every_stage_its_time() {
        let course = Course::of([0, 18, 11_078, 28_000, 45_961, 45_961].into_iter());
        assert_eq!((course.cursor(0.0), course.cursor(1.0)), (0, 45_961));
        let mut last = 0;
        for percent in 0..=1_000 {
            let share = f64::from(percent) / 1_000.0;
            let cursor = course.cursor(share);
            assert!(cursor >= last);
            last = cursor;
            assert!(course.share(cursor) <= share + 1e-9, "{share}");
            let back = course.cursor(course.share(cursor));
            assert!(back.abs_diff(cursor) <= 1, "{share}: {cursor}, {back}");
        }
        // The blocks' eighteen events are not over in a moment.
        assert!(course.share(18) - course.share(0) > 0.05);
    }

    #[test]
    fn ticks_come_as_often_as_the_speed_says() {
        for speed in SPEEDS {
            let mut playback = Playback {
                clock: Clock::Event,
                speed,
                whole_run_secs: None,
                ..Playback::default()
            };
            assert_eq!(playback.advance(9.0), 0);
            playback.start();
            let ticks: u32 = (0..640).map(|_| playback.advance(1.0 / 64.0)).sum();
            let expected = 10.0 / 0.25 * speed;
            assert!((ticks as f32 - expected).abs() <= 1.0, "{speed}: {ticks}");
            playback.stop();
            assert_eq!(playback.advance(9.0), 0);
        }
    }
}
