//! Clocks: what one tick of the play button and the arrow keys is, and how fast it ticks.
//! They count; the state moves.

use std::ops::Range;

/// What a tick of time is.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// One event.
    Event,
    /// A run of events that execute one line of pseudocode.
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

    /// Returns how long a tick is shown at speed 1, in seconds.
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
/// Most ticks in one frame, so that a frame stays short.
const MAX_TICKS: u32 = 2_000;

/// How time runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// What a tick is.
    pub clock: Clock,
    /// How many times faster than at first.
    pub speed: f32,
    /// The cursors between which play goes round.
    pub range: Option<Range<usize>>,
    /// The clock to which time returns where there are no passes.
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

    /// Chooses what a tick is.
    pub const fn choose(&mut self, clock: Clock) {
        self.without_passes = self.clock_of_events();
        self.clock = clock;
    }

    /// Returns the clock, or the one before it if time runs by passes.
    #[must_use]
    pub const fn clock_of_events(&self) -> Clock {
        match self.clock {
            Clock::Pass => self.without_passes,
            clock => clock,
        }
    }

    /// Starts.
    pub fn start(&mut self) {
        self.left_secs = Some(self.tick_secs());
    }

    /// Stops.
    pub const fn stop(&mut self) {
        self.left_secs = None;
    }

    fn tick_secs(&self) -> f32 {
        self.clock.tick_secs() / self.speed
    }

    /// Goes on by `dt_secs`; returns how many ticks are due.
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
