//! The errands that make sessions.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_core::{Pattern, PatternSpec, Run};

use super::{MakeError, Reporter, Session};
use crate::errand::{Errand, Lent};
use crate::jobs::Monitor;
use crate::recipe::Recipe;

/// What comes of making a session.
pub type Made = Result<Session, MakeError>;

/// Samples on the CPU.
#[derive(Serialize, Deserialize)]
pub struct Sampling {
    /// What is made.
    pub recipe: Recipe,
    /// What the session is known by.
    pub generation: u64,
}

impl Errand for Sampling {
    type Outcome = Made;
    const NAME: &'static str = "sample";

    fn carry_out(self, monitor: &Monitor) -> Made {
        Ok(Session::sample(&self.recipe, self.generation, monitor)?)
    }

    fn given_up(monitor: &Monitor) -> Option<Made> {
        Some(Err(MakeError::given_up(monitor)))
    }

    fn keep(made: Made) {
        Lent::keep(made);
    }
}

/// Makes the pattern that a description asks for.
#[derive(Serialize, Deserialize)]
pub struct Patterning(pub PatternSpec);

impl Errand for Patterning {
    type Outcome = Result<Arc<Pattern>, MakeError>;
    const NAME: &'static str = "pattern";

    fn carry_out(self, monitor: &Monitor) -> Self::Outcome {
        let mut observer = Reporter { monitor };
        Ok(Pattern::of_spec(&self.0, &mut observer)?)
    }

    fn given_up(monitor: &Monitor) -> Option<Self::Outcome> {
        Some(Err(MakeError::given_up(monitor)))
    }
}

/// Prepares what a GPU has made, with the events of the same run on the CPU.
#[derive(Serialize, Deserialize)]
pub struct Twin {
    /// What the GPU made.
    pub run: Run,
    /// What it was asked to make.
    pub recipe: Recipe,
    /// What the session is known by.
    pub generation: u64,
}

impl Errand for Twin {
    type Outcome = Made;
    const NAME: &'static str = "twin";

    fn carry_out(self, monitor: &Monitor) -> Made {
        let mut observer = Reporter { monitor };
        let recipe = &self.recipe;
        Ok(Session::of_gpu(
            self.run,
            recipe,
            self.generation,
            &mut observer,
        )?)
    }

    fn given_up(monitor: &Monitor) -> Option<Made> {
        Some(Err(MakeError::given_up(monitor)))
    }

    fn keep(made: Made) {
        Lent::keep(made);
    }
}
