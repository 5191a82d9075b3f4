//! Helpers: states without a window, and reproducible random numbers.

use std::sync::Arc;

use emath::{Rect, pos2, vec2};
use tilescope_workbench::command::{ViewCommand, Which};
use tilescope_workbench::{Command, State};

/// A state with a canvas of its own and its default session.
pub fn state() -> State {
    let mut state = State::new(Arc::new(|| {}));
    let viewport = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(viewport)));
    state.settle();
    state
}

/// A state that has opened a link.
pub fn opened(fragment: &str) -> State {
    let mut state = state();
    state.open_link(fragment);
    settle(&mut state);
    state
}

/// Waits for all work, and for flights to arrive.
pub fn settle(state: &mut State) {
    for _ in 0..2 {
        state.settle();
        state.advance(5.0);
    }
    state.settle();
}

pub fn digest(state: &State) -> String {
    state
        .runs()
        .first
        .session
        .as_ref()
        .expect("a session")
        .digest()
        .to_owned()
}

pub fn notice_text(state: &State) -> String {
    state
        .messages()
        .notice
        .as_ref()
        .map_or_else(String::new, |notice| notice.text.clone())
}

/// A generator of numbers (xorshift).
pub struct Draws(pub u64);

impl Draws {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    pub fn below(&mut self, end: usize) -> usize {
        (self.next() >> 11) as usize % end
    }

    pub fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}
