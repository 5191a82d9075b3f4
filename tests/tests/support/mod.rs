//! What the tests share.
#![allow(dead_code, reason = "no test binary uses all of it")]

use std::ops::ControlFlow;

use tilescope_analysis::{Region, Report, VerifyOptions, verify};
use tilescope_core::{Boundary, Domain, Parameters, Point, Run, Unobserved, sample};

/// The verifier's region of a domain.
pub fn region(domain: &Domain) -> Region {
    let [width, height] = domain.size();
    let boundary = match domain.boundary() {
        Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
        Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
    };
    Region {
        width,
        height,
        boundary,
    }
}

/// The independent verifier's report on positions of a domain.
pub fn judge(domain: &Domain, positions: &[[f64; 2]]) -> Report {
    let options = VerifyOptions::default();
    let go_on = |_| ControlFlow::Continue(());
    verify(positions, region(domain), domain.radius(), &options, &go_on).expect("a verdict")
}

/// The finished run of parameters.
pub fn run(parameters: &Parameters) -> Run {
    sample(parameters, &mut Unobserved).expect("valid parameters")
}

/// The digest of a result: BLAKE3 over x and y of each point, little-endian, in canonical order.
pub fn digest(points: &[Point]) -> String {
    let bytes: Vec<u8> = points
        .iter()
        .flat_map(|p| [p.x.to_le_bytes(), p.y.to_le_bytes()])
        .flatten()
        .collect();
    tilescope_formats::bytes_digest(&bytes)
}
