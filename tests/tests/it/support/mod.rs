//! Helpers of the tests.

pub mod inexact;
pub mod pinned;
pub mod random;

use std::collections::HashSet;
use std::ops::ControlFlow;

use tilescope_analysis::{Region, Report, VerifyOptions, verify};
use tilescope_core::{Boundary, Domain, Parameters, Point, Run, Unobserved, Window, sample};

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

/// The points of a whole run that lie in a window of its plane.
pub fn shown(domain: &Domain, window: &Window, points: &[Point]) -> Vec<Point> {
    let within = |value: i32, axis: usize, side: i32| {
        let (value, low, high) = (i64::from(value), window.min[axis], window.max[axis]);
        if domain.is_periodic() {
            (value - low).rem_euclid(side.into()) < high - low
        } else {
            (low..high).contains(&value)
        }
    };
    let inside = |p: &&Point| within(p.x, 0, domain.width()) && within(p.y, 1, domain.height());
    points.iter().filter(inside).copied().collect()
}

/// How `found` differs from `wanted`, to which it should be equal to the bit and in order.
pub fn difference(found: &[Point], wanted: &[Point]) -> Option<String> {
    if found == wanted {
        return None;
    }
    let only = |a: &[Point], b: &[Point]| {
        let b: HashSet<&Point> = b.iter().collect();
        let only: Vec<Point> = a.iter().filter(|p| !b.contains(p)).copied().collect();
        format!("{} as {:?}", only.len(), &only[..only.len().min(3)])
    };
    let (extra, missing) = (only(found, wanted), only(wanted, found));
    Some(format!(
        "{} points, not {}: too many {extra}; missing {missing}",
        found.len(),
        wanted.len()
    ))
}
