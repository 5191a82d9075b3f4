//! Tests of pictures of sets in space.

use std::ops::ControlFlow;

use super::*;
use crate::orbit::projection::Projection;
use crate::orbit::scene::to_the_end;
use crate::palette::{DARK, LIGHT};

/// A set of these samples in a box of 8 x 8 x 8, with balls of radius 1.
fn set(points: &[[f64; 3]]) -> OrbitSet<'_> {
    OrbitSet {
        points,
        size: [8.0; 3],
        radius: 2.0,
        colors: BallColors::Arrival,
    }
}

/// A view straight from the side of x, a little from above and the right, so that the nearest corner is that of three ends.
fn view(is_cut: bool) -> OrbitView {
    OrbitView {
        azimuth: 45.0,
        elevation: 35.0,
        zoom: 1.0,
        is_cut,
    }
}

fn drawn(points: &[[f64; 3]], is_cut: bool) -> Pixels {
    let picture = OrbitPicture::new(set(points), view(is_cut), [120, 120], &LIGHT);
    picture.draw(&to_the_end).expect("drawn")
}

/// Returns how many pixels two pictures have different.
fn differing(a: &Pixels, b: &Pixels) -> usize {
    let pairs = a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4));
    pairs.filter(|(a, b)| a != b).count()
}

#[test]
fn a_ball_hides_one_behind_it_and_not_one_in_front() {
    let [_, _, eye] = view(false).axes();
    let along = |distance: f64| eye.map(|axis| 4.0 + distance * axis);
    let one = drawn(&[[4.0; 3]], false);
    // A ball behind the middle one, in the line of sight, changes nothing; one before it takes its place.
    let mut behind = drawn(&[[4.0; 3], along(-2.5)], false);
    assert_eq!(differing(&one, &behind), 0);
    behind = drawn(&[[4.0; 3], along(2.5)], false);
    assert!(differing(&one, &behind) > 50);

    // A sample so far outside of the box that its row is beyond all numbers is in no picture.
    let far = drawn(&[[4.0; 3], [1e300, 4.0, 4.0]], false);
    assert_eq!(differing(&one, &far), 0);
}

#[test]
fn the_open_corner_has_no_balls_and_those_at_its_border_have_flat_faces() {
    let empty = drawn(&[], true);
    assert_eq!(differing(&empty, &drawn(&[[6.0; 3]], true)), 0);
    // The same ball is seen where nothing is cut out.
    assert!(differing(&drawn(&[], false), &drawn(&[[6.0; 3]], false)) > 50);

    // The plane z = 4 goes through this ball: from above the face is one flat colour. A sphere has many.
    let from_above = |is_cut| {
        let view = OrbitView {
            elevation: 80.0,
            ..view(is_cut)
        };
        let ball = [[6.0, 6.0, 4.0]];
        let picture = OrbitPicture::new(set(&ball), view, [200, 200], &LIGHT);
        let pixels = picture.draw(&to_the_end).expect("drawn");
        let mut colors: Vec<_> = pixels.rgba.chunks_exact(4).map(<[u8]>::to_vec).collect();
        colors.sort();
        colors.dedup();
        colors.len()
    };
    let [cut, whole] = [true, false].map(from_above);
    assert!(2 * cut < whole, "{cut} and {whole} colours");
}

#[test]
fn a_plane_that_is_seen_edge_on_has_the_octant_on_its_own_side() {
    // The eye is straight in front of the side of x, so that the plane across y is seen edge-on. Columns grow with y.
    let view = OrbitView {
        azimuth: 0.0,
        elevation: 30.0,
        ..view(true)
    };
    let [_, _, eye] = view.axes();
    assert_eq!(eye[1].to_bits(), 0);

    let projection = Projection::new(&set(&[]), view, [100, 100], 1);
    let is_open = |y: f64, column: f32| {
        let opening = projection.opening([1.0, y, 1.0], column, 50.0);
        // The ray meets balls within the depth of the box alone.
        opening.far < opening.near.min(projection.depth)
    };
    assert_eq!(
        [25.0, 75.0].map(|column| is_open(1.0, column)),
        [false, true]
    );
    assert_eq!(
        [25.0, 75.0].map(|column| is_open(-1.0, column)),
        [true, false]
    );
}

#[test]
fn pictures_do_not_depend_on_threads_and_can_be_cancelled() {
    let points: Vec<[f64; 3]> = (0..300)
        .map(|index| [1.0, 0.37, 0.59].map(|step| (f64::from(index) * step * 2.3) % 8.0))
        .collect();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let three = rayon::ThreadPoolBuilder::new().num_threads(3).build();
    let [one, many] =
        [alone, three].map(|pool| pool.expect("a pool").install(|| drawn(&points, true)));
    assert_eq!(one, many);

    let picture = OrbitPicture::new(set(&points), view(true), [120, 120], &DARK);
    let stopped = picture.draw(&|| ControlFlow::Break(()));
    assert_eq!(stopped, Err(OrbitError::Cancelled));
}

#[test]
fn what_cannot_be_drawn_is_refused_by_name() {
    let refused = |set: OrbitSet<'_>, size| {
        let picture = OrbitPicture::new(set, view(true), size, &LIGHT);
        picture.draw(&to_the_end).expect_err("refused").to_string()
    };
    let points = [[1.0, f64::NAN, 2.0]];
    let no_radius = OrbitSet {
        radius: 0.0,
        ..set(&[])
    };
    let flat = OrbitSet {
        size: [8.0, 8.0, f64::INFINITY],
        ..set(&[])
    };
    for (said, named) in [
        (refused(set(&points), [9, 9]), "ball 0 lies at NaN"),
        (refused(no_radius, [9, 9]), "the radius is 0"),
        (refused(flat, [9, 9]), "the box along z is inf"),
        (refused(set(&[]), [0, 9]), "0 x 9"),
        (refused(set(&[]), [9, 4097]), "1 to 4096"),
    ] {
        assert!(said.contains(named), "{said}");
    }
}

#[test]
fn colours_halve_the_balls_that_are_left() {
    let points = vec![[1.0; 3]; 1024];
    let set = set(&points);
    let mut counts = [0; COLOR_BANDS as usize];
    for index in 0..points.len() {
        counts[set.color_band(index) as usize] += 1;
    }
    assert_eq!(counts, [512, 256, 128, 64, 32, 16, 8, 8]);
    let unordered = OrbitSet {
        colors: BallColors::One,
        ..set
    };
    assert_eq!(unordered.color_band(1023), 0);
}

#[test]
fn colours_are_levels_where_these_are_known() {
    let points = vec![[1.0; 3]; 4];
    let leveled = OrbitSet {
        colors: BallColors::Levels(&[3, 0, 7, 15]),
        ..set(&points)
    };
    let bands: Vec<u32> = (0..4).map(|index| leveled.color_band(index)).collect();
    assert_eq!(bands, [3, 0, 7, 7]);

    // The legend says what the colours are; balls of one colour have none.
    let texts = |colors| {
        let picture = OrbitPicture::new(
            OrbitSet { colors, ..leveled },
            view(false),
            [90, 90],
            &LIGHT,
        );
        let drawn = scene(&picture, "", true, &to_the_end).expect("a scene");
        tilescope_figures::to_svg(&drawn).expect("a picture")
    };
    let by_level = texts(leveled.colors);
    assert!(by_level.contains("by the level") && by_level.contains("7 and later"));
    let by_arrival = texts(BallColors::Arrival);
    assert!(by_arrival.contains("by arrival") && by_arrival.contains("rest"));
    assert!(!texts(BallColors::One).contains("balls by"));
}

#[test]
fn views_are_read_as_they_are_written_and_keep_their_limits() {
    let view = OrbitView::default();
    assert_eq!(OrbitView::read(&view.to_string()), Some(view));
    let whole = OrbitView {
        is_cut: false,
        zoom: 2.5,
        azimuth: 12.5,
        elevation: -7.0,
    };
    assert_eq!(whole.to_string(), "12.5,-7,2.5,whole");
    assert_eq!(OrbitView::read("12.5,-7,2.5,whole"), Some(whole));
    let far = OrbitView::read("725,120").expect("a view");
    assert!((far.azimuth - 5.0).abs() < 1e-9 && (far.elevation - MAX_ELEVATION).abs() < 1e-9);
    for text in ["", "30", "30,NaN", "30,20,1,cut", "30,20,1,whole,1", "a,b"] {
        assert_eq!(OrbitView::read(text), None, "{text}");
    }

    let heights = [-1.2, 0.3, 30.0].map(|elevation| OrbitView { elevation, ..view }.height_text());
    assert_eq!(heights, ["1 degree below", "the side", "30 degrees above"]);

    // A turn comes back to where it began.
    let turn: Vec<_> = view.turn().collect();
    assert_eq!((turn.len(), turn[0]), (TURN_FRAMES, view));
    assert!((turn[1].azimuth - (view.azimuth + 5.0)).abs() < 1e-9);
}
