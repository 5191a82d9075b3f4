//! Times moves of a window through the functions of C, on one thread: `cargo run --release -p tilescope-c --example moves`.
//!
//! A window of about 10,000 samples moves by a sixtieth of its side 1,000 times: along x, along y, and along both.

#![expect(unsafe_code, reason = "the functions are called as C calls them")]

use std::time::Instant;

use tilescope_c::exports::{
    TilescopePlane, TilescopePoint, TilescopeSettings, TilescopeStatus, TilescopeWindow,
    tilescope_plane_free, tilescope_plane_gained, tilescope_plane_new, tilescope_plane_window,
};

/// The side of the window in radii: about 10,000 samples.
const SIDE: f64 = 120.0;
const MOVES: usize = 1_000;

fn window(left: f64, bottom: f64) -> TilescopeWindow {
    TilescopeWindow {
        left,
        bottom,
        right: left + SIDE,
        top: bottom + SIDE,
    }
}

/// Returns the median and the longest time in microseconds of many moves, and the mean number of samples gained.
fn measure(
    plane: *const TilescopePlane,
    step: [f64; 2],
    points: &mut [TilescopePoint],
) -> (f64, f64, f64) {
    let mut from = window(1_000.3, 2_000.7);
    let (mut times, mut gained) = (Vec::with_capacity(MOVES), 0);

    for _ in 0..MOVES {
        let to = window(from.left + step[0], from.bottom + step[1]);
        let mut count = 0;
        let (buffer, capacity) = (points.as_mut_ptr(), points.len());
        let began = Instant::now();
        // SAFETY: the plane was made and not freed, the buffer holds `capacity` points, and all live beyond the call.
        let status = unsafe {
            tilescope_plane_gained(
                plane,
                &raw const from,
                &raw const to,
                buffer,
                capacity,
                &raw mut count,
            )
        };
        times.push(began.elapsed().as_secs_f64() * 1e6);
        assert_eq!(status, TilescopeStatus::Ok);
        gained += count;
        from = to;
    }

    times.sort_by(f64::total_cmp);
    (
        times[MOVES / 2],
        times[MOVES - 1],
        gained as f64 / MOVES as f64,
    )
}

fn main() {
    let mut points = vec![TilescopePoint { x: 0.0, y: 0.0 }; 20_000];
    for method in [0, 1] {
        let settings = TilescopeSettings {
            method,
            ..TilescopeSettings::default()
        };
        let mut plane = std::ptr::null_mut();
        // SAFETY: both pointers lead to values that live beyond the call.
        let status = unsafe { tilescope_plane_new(&raw const settings, &raw mut plane) };
        assert_eq!(status, TilescopeStatus::Ok);

        // As a program would: first the whole window.
        let (first, mut count) = (window(1_000.3, 2_000.7), 0);
        let (buffer, capacity) = (points.as_mut_ptr(), points.len());
        let began = Instant::now();
        // SAFETY: as in `measure`.
        let status = unsafe {
            tilescope_plane_window(plane, &raw const first, buffer, capacity, &raw mut count)
        };
        assert_eq!(status, TilescopeStatus::Ok);
        let whole = began.elapsed().as_secs_f64() * 1e6;
        println!(
            "{}: first window of {count} samples in {whole:.0} us",
            ["KDRT", "exact"][method as usize]
        );

        for (name, step) in [
            ("x", [2.0, 0.0]),
            ("y", [0.0, 2.0]),
            ("x and y", [2.0, 2.0]),
        ] {
            let (median, longest, gained) = measure(plane, step, &mut points);
            println!(
                "  along {name}: median {median:.0} us, longest {longest:.0} us, {gained:.0} samples gained"
            );
        }
        // SAFETY: the plane was made above, and is not used below.
        unsafe { tilescope_plane_free(plane) };
    }
}
