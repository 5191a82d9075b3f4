//! Playback: the clock, which is the unit of a step of play and of the arrow keys, and the speed. It counts
//! ticks; `crate::state` moves the run.

use std::ops::Range;

/// The unit of a step in time.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// One event.
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
    /// Every clock.
    pub const ALL: [Self; 4] = [Self::Event, Self::Line, Self::Stage, Self::Pass];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Event => "event",
            Self::Line => "line",
            Self::Stage => "stage",
            Self::Pass => "GPU pass",
        }
    }

    /// Returns the duration of a tick at speed 1, in seconds.
    #[must_use]
    pub const fn tick_secs(self) -> f32 {
        match self {
            Self::Event => 0.25,
            Self::Line => 0.5,
            Self::Stage | Self::Pass => 1.2,
        }
    }
}

/// Speeds to choose from.
pub const SPEEDS: [f32; 7] = [0.25, 0.5, 1.0, 2.0, 8.0, 64.0, 512.0];
/// The most ticks in one frame, so that a frame stays short.
const MAX_TICKS: u32 = 2_000;

/// The state of playback.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// The unit of a tick.
    pub clock: Clock,
    /// The factor of the speed.
    pub speed: f32,
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

    /// Sets the clock.
    pub const fn choose(&mut self, clock: Clock) {
        self.without_passes = self.clock_of_events();
        self.clock = clock;
    }

    /// Returns the clock, or the one before it if the clock is that of passes.
    #[must_use]
    pub const fn clock_of_events(&self) -> Clock {
        match self.clock {
            Clock::Pass => self.without_passes,
            clock => clock,
        }
    }

    /// Starts playing.
    pub fn start(&mut self) {
        self.left_secs = Some(self.tick_secs());
    }

    /// Stops playing.
    pub const fn stop(&mut self) {
        self.left_secs = None;
    }

    fn tick_secs(&self) -> f32 {
        self.clock.tick_secs() / self.speed
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
        let due = (1 + (-*left / tick) as u32).min(MAX_TICKS);
        *left = (*left + due as f32 * tick).max(0.0);
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_come_as_often_as_the_speed_says() {
        for speed in SPEEDS {
            let mut playback = Playback {
                clock: Clock::Event,
                speed,
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
