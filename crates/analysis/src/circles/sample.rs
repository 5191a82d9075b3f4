//! A sample as the second judge stores it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A sample in the domain's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub position: DVec2,
    pub id: u32,
}
