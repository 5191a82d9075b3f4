//! Made-up numbers of methods, for this and other tests.

use super::*;

/// Numbers of a good tiling.
pub fn one() -> Against {
    Against {
        radius: 0.005,
        method: Method::kdrt(40.0),
        difference: 0.03,
        chance: 0.02,
        left: 0.02,
        excess: 0.3,
        apart: 0.03,
        reach: 0.05,
        peak: 0.9,
    }
}
