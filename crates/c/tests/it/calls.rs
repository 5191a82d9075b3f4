//! The functions of C, called as C calls them, compared with the library for Rust.

#![expect(unsafe_code, reason = "pointers that C must not give are given")]

use std::collections::BTreeSet;
use std::ptr::{null, null_mut};

use tilescope_c::exports::{
    TilescopePoint, TilescopeSettings, TilescopeStatus, TilescopeWindow, tilescope_plane_free,
    tilescope_plane_new, tilescope_plane_window,
};
use tilescope_core::{
    ExactPlane, Parameters, Pattern, PatternHistory, Plane, TilingMethod, Unobserved, WindowMaker,
};

use crate::support::{CPlane, buffer, sorted_bits, square};

/// A plane that repeats after 200 radii, so that windows cross its ends.
fn settings(method: i32) -> TilescopeSettings {
    TilescopeSettings {
        seed: 11,
        radius: 0.3,
        period: 60.0,
        method,
        ..TilescopeSettings::default()
    }
}

/// Returns the samples of a window by the library for Rust.
fn by_rust(method: i32, window: &TilescopeWindow) -> Vec<TilescopePoint> {
    let TilescopeSettings {
        seed,
        radius,
        period,
        ..
    } = settings(method);
    let parameters = Parameters {
        width: period,
        height: period,
        radius,
        seed,
        method: [TilingMethod::Kdrt, TilingMethod::Exact][method as usize],
        ..Parameters::default()
    };
    let parameters = Parameters {
        pattern: parameters.usual_pattern(),
        ..parameters
    };
    let (low, high) = ([window.left, window.bottom], [window.right, window.top]);

    let domain = parameters.validate().unwrap();
    let window = domain.window(low, high).unwrap();
    let points = if method == 0 {
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let plane = Plane::new(&parameters, &pattern).unwrap();
        plane.window(&window).unwrap()
    } else {
        let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let plane = ExactPlane::new(&parameters, &history).unwrap();
        plane.window(&window).unwrap()
    };
    let positions = domain.users_from_lattice(&points);
    positions
        .iter()
        .map(|&[x, y]| TilescopePoint { x, y })
        .collect()
}

#[test]
fn windows_have_the_points_of_the_library_for_rust_bit_for_bit() {
    for method in [0, 1] {
        let plane = CPlane::new(&settings(method)).unwrap();
        let window = square(7.1, 20.3, 30.0);
        let mut points = buffer(plane.capacity(&window).unwrap());
        let count = plane.fill(&window, &mut points).unwrap();
        let expected = by_rust(method, &window);
        assert!(expected.len() > 6_000);
        assert_eq!(points[..count], expected, "method {method}");

        // One period on the same samples lie one period away, up to the last bit of the sum.
        let moved = square(67.1, -39.7, 30.0);
        let count = plane.fill(&moved, &mut points).unwrap();
        assert_eq!(count, expected.len());
        for (point, expected) in points.iter().zip(&expected) {
            let (dx, dy) = (point.x - expected.x, point.y - expected.y);
            assert!((dx - 60.0).abs() < 1e-12 && (dy + 60.0).abs() < 1e-12);
        }
    }

    // The control: another seed has other points.
    let seed = 12;
    let other = CPlane::new(&TilescopeSettings {
        seed,
        ..settings(0)
    });
    let (window, mut points) = (square(7.1, 20.3, 30.0), buffer(20_000));
    let count = other.unwrap().fill(&window, &mut points).unwrap();
    assert_ne!(points[..count], by_rust(0, &window));
}

#[test]
fn what_is_kept_and_gained_is_the_next_window_and_what_is_lost_is_the_rest() {
    let plane = CPlane::new(&settings(0)).unwrap();
    let mut from = square(40.0, 40.0, 30.0);
    let mut points = buffer(20_000);
    let count = plane.fill(&from, &mut points).unwrap();
    let mut kept: BTreeSet<[u64; 2]> = sorted_bits(&points[..count]).into_iter().collect();

    // Steps along x, along both, back across the end of the period, to a window inside of the last one, and to one far away.
    let moves = [
        square(40.5, 40.0, 30.0),
        square(41.0, 40.7, 30.0),
        square(39.0, 39.0, 30.0),
        square(45.0, 45.0, 10.0),
        square(-100.0, 12.0, 20.0),
    ];
    for to in moves {
        let gained = plane.gain([&from, &to], &mut points).unwrap();
        let gained = sorted_bits(&points[..gained]);
        let lost = plane.lose([&from, &to], &mut points).unwrap();
        for point in &points[..lost] {
            assert!(plane.contains(&from, *point) && !plane.contains(&to, *point));
        }
        for bits in sorted_bits(&points[..lost]) {
            assert!(kept.remove(&bits), "a sample that was not there is lost");
        }
        for bits in gained {
            assert!(kept.insert(bits), "a sample that was there is gained");
        }

        let count = plane.fill(&to, &mut points).unwrap();
        assert!(
            points[..count]
                .iter()
                .all(|point| plane.contains(&to, *point))
        );
        let expected: BTreeSet<[u64; 2]> = sorted_bits(&points[..count]).into_iter().collect();
        assert_eq!(kept, expected);
        from = to;
    }

    let nowhere = TilescopePoint {
        x: f64::NAN,
        y: 0.0,
    };
    assert!(!plane.contains(&square(-1.0, -1.0, 2.0), nowhere));
}

#[test]
fn threads_share_a_plane() {
    /// A plane may be used by several threads at once, which a pointer does not say by itself.
    struct Shared(CPlane);
    // SAFETY: `tilescope.h` promises it: the plane's buffers are behind a lock.
    unsafe impl Sync for Shared {}

    let plane = Shared(CPlane::new(&settings(0)).unwrap());
    let shared = &plane;
    let found: Vec<usize> = std::thread::scope(|scope| {
        let fill = move |k: u32| {
            let mut points = buffer(5_000);
            let counts = (0..20).map(|step| {
                let window = square(f64::from(step % 4 * 5), 3.0, 10.0);
                shared.0.fill(&window, &mut points).unwrap()
            });
            let sum: usize = counts.sum();
            (k, sum)
        };
        let threads = [0, 1, 2].map(|k| scope.spawn(move || fill(k).1));
        threads.map(|thread| thread.join().unwrap()).to_vec()
    });
    assert!(found[0] > 10_000 && found.iter().all(|sum| *sum == found[0]));
}

#[test]
fn wrong_arguments_are_refused_in_words() {
    let plane = CPlane::new(&settings(0)).unwrap();
    let window = square(0.0, 0.0, 10.0);
    let mut points = buffer(10);
    let (status, text) = plane.fill(&window, &mut points).unwrap_err();
    assert_eq!(status, TilescopeStatus::TooSmall);
    assert!(
        text.ends_with("samples were found, and the buffer holds 10"),
        "{text}"
    );
    assert_eq!(points, buffer(10), "nothing was written");

    for (window, said) in [
        (square(0.0, 0.0, 61.0), "60"),
        (square(0.0, 0.0, f64::NAN), "NaN"),
        (square(1e9, 0.0, 1.0), "60,000"),
    ] {
        let (status, text) = plane.fill(&window, &mut points).unwrap_err();
        assert_eq!(status, TilescopeStatus::BadValue);
        assert!(text.contains(said), "{text}");
    }
    let radius = 0.0;
    let bad = TilescopeSettings {
        radius,
        ..TilescopeSettings::default()
    };
    let refused = CPlane::new(&bad).err().expect("a bad radius");
    assert_eq!(refused.0, TilescopeStatus::BadValue);

    // The whole of the longest plane would have three thousand million samples.
    let long = CPlane::new(&TilescopeSettings::default()).unwrap();
    let (status, text) = long.fill(&square(0.0, 0.0, 60_000.0), &mut []).unwrap_err();
    assert_eq!(status, TilescopeStatus::BadValue);
    assert!(text.contains("choose a smaller one"), "{text}");
}

#[test]
fn null_and_unaligned_pointers_are_refused() {
    let settings = settings(0);
    let mut plane = null_mut();
    let new = |settings, plane| {
        // SAFETY: null and what is not aligned are refused, and the others lead to values that live beyond the call.
        unsafe { tilescope_plane_new(settings, plane) }
    };
    let unaligned = (&raw const settings).wrapping_byte_add(1);
    let statuses = [
        new(null(), &raw mut plane),
        new(&raw const settings, null_mut()),
        new(unaligned, &raw mut plane),
    ];
    assert_eq!(statuses, [TilescopeStatus::BadPointer; 3]);
    assert!(plane.is_null());

    let (window, mut count) = (square(0.0, 0.0, 1.0), 1);
    // SAFETY: as above.
    let status =
        unsafe { tilescope_plane_window(null(), &raw const window, null_mut(), 0, &raw mut count) };
    assert_eq!((status, count), (TilescopeStatus::BadPointer, 0));
    // SAFETY: null is allowed.
    unsafe { tilescope_plane_free(null_mut()) };
}

#[test]
fn no_window_has_more_samples_than_its_capacity() {
    let plane = CPlane::new(&settings(0)).unwrap();
    let mut points = buffer(1_000);
    for side in [0.001, 0.1, 0.31, 0.7, 1.3, 3.0] {
        for k in 0..40 {
            let window = square(f64::from(k) * 0.7, 5.0, side);
            let capacity = plane.capacity(&window).unwrap();
            assert!(plane.fill(&window, &mut points).unwrap() <= capacity);
        }
    }
    // The bound is no guess: 10 x 10 radii have room for at most 137 samples.
    assert_eq!(plane.capacity(&square(0.0, 0.0, 3.0)).unwrap(), 137);
}
