//! The longest sides that a domain may have, with blocks as long as they: nothing overflows, and
//! the sets are conflict-free and maximal. The tests run with overflow checks, too.

use tilescope_core::stages::disks::DiskGrid;
use tilescope_core::{
    Boundary, Insertion, MAX_SIDE_RADII, Order, Parameters, Pattern, PatternError, PatternSpec,
    Point, SHORTEST_SIDE_RADII_BOUNDED, Sequential, Sweep, Unobserved, reference_sample, sample,
};
use tilescope_tests::some;

fn check(parameters: &Parameters, points: &[Point]) {
    let domain = parameters.validate().unwrap();
    let mut disks = DiskGrid::new(domain);
    for &p in points {
        assert!(!disks.covers(p), "{parameters:?}: {p:?} is in conflict");
        assert!(disks.insert(p));
    }
    // 0.71 units of rounding beyond R, as a difference of squares.
    let slack = 46_600;
    assert_eq!(disks.uncovered_point(slack), None, "{parameters:?}");
}

fn long(along_x: bool, boundary: Boundary) -> Parameters {
    let (width, height) = if along_x {
        (MAX_SIDE_RADII, 10.0)
    } else {
        (10.0, MAX_SIDE_RADII)
    };
    Parameters {
        width,
        height,
        radius: 1.0,
        boundary,
        ..Parameters::default()
    }
}

#[test]
fn the_longest_domains_are_sampled() {
    use Boundary::{Bounded, Periodic};
    use Insertion::{Circumcentre, Uniform};
    for (along_x, leaf, boundary, insertion) in some([
        (true, 1e9, Bounded, Circumcentre),
        (false, 40_000.0, Periodic, Uniform),
        (true, 30.0, Periodic, Circumcentre),
        (false, 1e9, Bounded, Uniform),
        (true, 30.0, Bounded, Uniform),
        (true, 1e9, Periodic, Uniform),
        (false, 40_000.0, Bounded, Circumcentre),
        (false, 1e9, Periodic, Circumcentre),
    ]) {
        let parameters = Parameters {
            leaf,
            insertion,
            ..long(along_x, boundary)
        };
        let run = sample(&parameters, &mut Unobserved).unwrap();
        check(&parameters, &run.points());
    }
}

#[test]
fn the_reference_sampler_serves_the_longest_domains() {
    for boundary in some([Boundary::Periodic, Boundary::Bounded]) {
        let parameters = long(true, boundary);
        let domain = parameters.validate().unwrap();
        let points = reference_sample(domain, 3, &mut Unobserved).unwrap();
        check(&parameters, &points);
    }
}

#[test]
fn the_largest_pattern_serves_a_block_as_long_as_the_domain() {
    let pattern = PatternSpec {
        side: 300.0,
        ..PatternSpec::default()
    };
    for dihedral in [false, true] {
        let parameters = Parameters {
            leaf: 1e9,
            pattern,
            dihedral,
            ..long(false, Boundary::Periodic)
        };
        check(
            &parameters,
            &sample(&parameters, &mut Unobserved).unwrap().points(),
        );
    }
}

/// A radius that is far too small is refused before memory is taken for its domain.
#[test]
fn a_pattern_of_tiny_radius_is_refused() {
    let positions = [[0.1, 0.1], [0.5, 0.5]];
    let made = Pattern::from_positions(&positions, [1.0; 2], 2e-5, Boundary::Periodic);
    assert!(
        matches!(made, Err(PatternError::TooFew { count: 2, .. })),
        "{made:?}"
    );
}

/// A rectangular pattern under all symmetries, some of which swap its sides.
#[test]
fn rectangular_patterns_serve() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let shape = Parameters {
            width: 60.0,
            height: 45.0,
            radius: 1.0,
            boundary,
            ..Parameters::default()
        };
        let domain = shape.validate().unwrap();
        let points = reference_sample(domain, 5, &mut Unobserved).unwrap();
        let positions = domain.users_from_lattice(&points);
        let pattern = Pattern::from_positions(&positions, [60.0, 45.0], 1.0, boundary).unwrap();
        let parameters = Parameters {
            radius: 0.012,
            leaf: 12.0,
            dihedral: true,
            ..Parameters::default()
        };
        let engine = tilescope_core::Sequential::new(&parameters, pattern.into()).unwrap();
        check(
            &parameters,
            &engine.finish(&mut Unobserved).unwrap().points(),
        );
    }
}

/// Bounded domains of 4 to 7 r, in one or both directions: the engines give the same points, conflict-free and maximal.
#[test]
fn the_narrowest_bounded_domains_are_sampled() {
    let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved).unwrap();
    let steps = |seed: u64, step: f64| (seed as f64 * step).fract();
    for seed in 0..200 {
        let short = SHORTEST_SIDE_RADII_BOUNDED + 3.0 * steps(seed, 0.754_877_666);
        let long = [short, 4.0 + 40.0 * steps(seed, 0.569_840_29)];
        let [width, height] = if seed % 2 == 0 {
            long
        } else {
            [long[1], long[0]]
        };
        let parameters = Parameters {
            width,
            height,
            radius: 1.0,
            boundary: Boundary::Bounded,
            seed,
            leaf: if seed % 3 == 0 { 6.0 } else { 30.0 },
            order: [
                Order::Index,
                Order::Random,
                Order::OwnBlockFirst,
                Order::PhaseGroup,
            ][seed as usize / 2 % 4],
            insertion: [Insertion::Circumcentre, Insertion::Uniform][seed as usize / 8 % 2],
            ..Parameters::default()
        };
        let engine = Sequential::new(&parameters, pattern.clone()).unwrap();
        let points = engine.finish(&mut Unobserved).unwrap().points();
        check(&parameters, &points);
        let parallel = Sweep::run(&parameters, &pattern, &mut Unobserved).unwrap();
        assert_eq!(parallel.points(), points, "{parameters:?}");
    }
}

/// The covering radius of narrower domains is not promised.
#[test]
fn narrower_domains_are_refused() {
    let narrow = Parameters {
        width: 20.0,
        height: 3.999,
        radius: 1.0,
        boundary: Boundary::Bounded,
        ..Parameters::default()
    };
    assert_eq!(
        narrow.validate().unwrap_err().to_string(),
        "the height is 3.999 r long; it must be at least 4 r: choose a smaller radius"
    );
}
