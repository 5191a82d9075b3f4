use std::ops::ControlFlow;

use super::*;
use crate::lattice::Boundary;
use crate::progress::{Progress, Unobserved};
use crate::solid::{SolidDomain, solid_arrivals_parallel};

fn samples(space: &SolidSpace, low: [f64; 3], high: [f64; 3]) -> Vec<Place> {
    let window = space.window(low, high).unwrap();
    space.samples(&window, &mut Unobserved).unwrap()
}

/// Another engine: a box has the samples of the space deeper than 8 r, in the same order and of the same levels. Nothing farther than 5.9 r from a
/// side was seen to depend on it.
#[test]
fn a_window_has_the_samples_of_a_box_around_it() {
    for seed in 0..4 {
        let space = SolidSpace::new(0.1, seed).unwrap();
        let domain = SolidDomain::from_size([2.4, 2.2, 2.3], 0.1, Boundary::Bounded).unwrap();
        let whole = solid_arrivals_parallel(domain, seed, &mut Unobserved).unwrap();
        let window = space.window([0.8; 3], [1.6, 1.4, 1.5]).unwrap();
        let expected: Vec<(Place, u8)> = (whole.places.iter().copied())
            .zip(whole.levels.of_samples())
            .filter(|(place, _)| window.contains(*place))
            .collect();
        let found = space.arrivals(&window, &mut Unobserved).unwrap();
        let levels = found.levels.of_samples();
        let found: Vec<(Place, u8)> = found.places.into_iter().zip(levels).collect();
        assert!(found.len() > 150 && found == expected, "seed {seed}");
    }
}

/// Windows that lie anywhere and have any sides have the samples of a larger one that contains them.
#[test]
fn hostile_windows_have_the_samples_of_a_larger_one() {
    let space = SolidSpace::new(1.0, 11).unwrap();
    let (low, high) = ([-6.3, 39.7, -2.0], [3.1, 47.9, 9.4]);
    let whole = samples(&space, low, high);
    let positions = space.users_from_lattice(&whole);
    let mut counted = 0;
    for number in 0..12_u32 {
        // Corners from bits of a multiplied number: slices, rods and blocks, across 0 and across borders of cells and pieces.
        let bits = number.wrapping_mul(2_654_435_761);
        let span = |axis: usize| {
            let part = |shift: u32| f64::from(bits >> (8 * axis as u32 + shift) & 15) / 16.0;
            let side = high[axis] - low[axis];
            let begin = low[axis] + 0.5 * side * part(0);
            [begin, begin + (high[axis] - begin) * part(4).max(0.01)]
        };
        let [x, y, z] = [span(0), span(1), span(2)];
        let part = space
            .window([x[0], y[0], z[0]], [x[1], y[1], z[1]])
            .unwrap();
        let expected: Vec<Place> = (whole.iter().copied())
            .filter(|place| part.contains(*place))
            .collect();

        counted += expected.len();
        assert_eq!(
            space.samples(&part, &mut Unobserved).unwrap(),
            expected,
            "{number}"
        );
    }
    assert!(counted > 100 && positions.len() > 500);
}

/// Control: without asking what is in doubt, windows with narrow halos differ from the space. Those that are not in doubt do not.
#[test]
fn doubt_is_where_windows_in_space_differ() {
    let (mut differing, mut doubtful) = ([0; 6], [0; 6]);
    for number in 0..12 {
        let low = [number * 9, -number * 5, number].map(|cell| cell * R);
        let window = SolidWindow {
            min: low,
            max: low.map(|at| at + 3 * R),
        };
        let key = Key::from_seed(3);
        let expected = SpacePiece::made(key, &window).unwrap();
        for halo in 1..6 {
            let piece = SpacePiece::run(key, &window, halo);
            assert!(
                piece.is_doubtful() || piece.arrived() == expected,
                "{halo} cells"
            );
            doubtful[halo as usize] += u32::from(piece.is_doubtful());
            differing[halo as usize] += u32::from(piece.arrived() != expected);
        }
    }
    assert!(
        differing[1] > 9 && doubtful[1] == 12,
        "{differing:?} {doubtful:?}"
    );
}

/// The evidence for the width of the halo.
#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn windows_seldom_need_a_second_halo() {
    let mut doubtful = [0; 12];
    for number in 0..40 {
        let low = [number * 31, -number * 17, number].map(|cell| cell * R);
        let window = SolidWindow {
            min: low,
            max: low.map(|at| at + 5 * R),
        };
        for halo in 5..12 {
            let piece = SpacePiece::run(Key::from_seed(5), &window, halo);
            doubtful[halo as usize] += u32::from(piece.is_doubtful());
        }
    }
    println!("of 40 windows of 5 r in doubt, by cells of halo: {doubtful:?}");
    assert!(doubtful[piece::HALO as usize] < 4 && doubtful[5] > 20);
}

#[test]
fn pieces_tile_a_window_and_impossible_windows_are_refused() {
    let space = SolidSpace::new(1.0, 1).unwrap();
    let window = space
        .window([-50.5, 0.0, 47.9], [49.0, 96.0, 48.1])
        .unwrap();
    let pieces = pieces(&window);
    // Four along x, two along y, two along z.
    assert_eq!(pieces.len(), 16);
    let volume: f64 = pieces.iter().map(SolidWindow::volume_radii).sum();
    assert!((volume - window.volume_radii()).abs() < 1e-6);

    let said = |low, high| space.window(low, high).unwrap_err().to_string();
    let flat = said([0.0; 3], [1.0, 0.0, 1.0]);
    assert!(
        flat.contains("the window's height runs from 0 to 0; it must be finite, above 0"),
        "{flat}"
    );
    assert!(said([0.0; 3], [1.0, 1.0, f64::NAN]).contains("the window's depth"));
    let far = said([0.0; 3], [1.0, 1.0, 7e4]);
    assert_eq!(
        far,
        "the window's depth reaches 70,000; it must lie between -65,280 and 65,280"
    );
    assert!(SolidSpace::new(0.0, 1).is_err() && SolidSpace::new(f64::INFINITY, 1).is_err());
    // The widest window: its side has more lattice units than a 32-bit integer holds.
    let widest = space
        .window([-MAX_REACH_RADII, 0.0, 0.0], [MAX_REACH_RADII, 1.0, 2.0])
        .unwrap();
    assert!((widest.volume_radii() - 4.0 * MAX_REACH_RADII).abs() < 1e-6);
    // Nothing between two lattice planes.
    let thin = space.window([0.5, 0.5, 1e-7], [1.0, 1.0, 2e-7]).unwrap();
    assert_eq!(
        space.samples(&thin, &mut Unobserved).unwrap(),
        Vec::<Place>::new()
    );
}

/// Without a call between them, work of minutes could not be stopped.
#[test]
fn the_observer_is_called_between_the_pieces_of_a_window() {
    let space = SolidSpace::new(1.0, 1).unwrap();
    let window = space.window([47.0, 0.0, 0.0], [49.0, 1.0, 1.0]).unwrap();
    let mut calls = 0;
    let mut count = |_: Progress| {
        calls += 1;
        ControlFlow::Continue(())
    };
    space.samples(&window, &mut count).unwrap();
    // At the beginning, at the end, and at least once between.
    assert!(calls > 2, "{calls}");
}
