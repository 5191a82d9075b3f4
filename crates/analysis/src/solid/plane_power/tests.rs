use std::f64::consts::TAU;
use std::ops::ControlFlow;

use super::super::spectrum::Random;
use super::*;
use crate::region::Boundary;

fn region([width, height, depth]: [f64; 3], boundary: Boundary) -> SolidRegion {
    SolidRegion {
        width,
        height,
        depth,
        boundary,
    }
}

fn noise(count: usize, size: [f64; 3]) -> Vec<[f64; 3]> {
    let mut random = Random(2017);
    let point = |_| size.map(|side| side * random.unit());
    (0..count).map(point).collect()
}

fn of(points: &[[f64; 3]], region: SolidRegion, most: f64) -> [PlanePower; 3] {
    PlanePower::of(points, region, most, &|_| ControlFlow::Continue(())).unwrap()
}

/// Returns the power of a plane at some cycles along the picture's x and y, where cells have one frequency.
fn at(plane: &PlanePower, [x, y]: [i64; 2]) -> f64 {
    let CoarsePower { size, rows, .. } = plane.picture;
    let [column, row] = [(size, x), (rows, y)].map(|(cells, cycles)| cells as i64 / 2 + cycles);
    plane.picture.power[row as usize * size + column as usize]
}

/// Returns the power at a frequency by the formula of the spectrum by shells.
fn by_formula(points: &[[f64; 3]], region: SolidRegion, frequency: [i64; 3]) -> f64 {
    let size = region.size();
    let [mut re, mut im, mut squares] = [0.0; 3];
    for point in points {
        let turns = [0, 1, 2].map(|axis| point[axis] / size[axis]);
        let weight: f64 = match region.boundary {
            Boundary::Periodic => 1.0,
            Boundary::Bounded => turns
                .iter()
                .map(|along| 1.0 - (TAU * along).cos())
                .product(),
        };
        let cycles = (0..3).map(|axis| frequency[axis] as f64 * turns[axis]);
        let phase = TAU * cycles.sum::<f64>();
        re += weight * phase.cos();
        im -= weight * phase.sin();
        squares += weight * weight;
    }
    (re * re + im * im) / squares
}

#[test]
fn powers_are_those_of_the_formula() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = region([3.0, 4.0, 5.0], boundary);
        let points = noise(70, region.size());
        for plane in of(&points, region, 1.5) {
            let CoarsePower { size, rows, .. } = plane.picture;
            let [most_x, most_y] = [size, rows].map(|cells| cells as i64 / 2);
            assert!(most_x >= 4 && most_y >= 6, "{plane:?}");
            for (x, y) in (-most_x..=most_x).flat_map(|x| (-most_y..=most_y).map(move |y| (x, y))) {
                // The mean density is subtracted where the taper has power of its own.
                if x.abs() <= 1 && y.abs() <= 1 {
                    continue;
                }
                let frequency = match plane.axis {
                    0 => [0, x, y],
                    1 => [x, 0, y],
                    _ => [x, y, 0],
                };
                let (found, expected) =
                    (at(&plane, [x, y]), by_formula(&points, region, frequency));
                assert!(
                    (found - expected).abs() < 1e-7,
                    "{frequency:?} {found} {expected}"
                );
            }
        }
    }
}

/// Columns of samples along z, scattered along them, are a lattice in the plane `k_z = 0` alone; layers show in both others.
#[test]
fn columns_and_layers_show_in_the_planes_that_hold_their_frequencies() {
    let region = region([8.0; 3], Boundary::Periodic);
    let scattered = noise(512, region.size());
    let lattice = |index: usize, step: usize| (index / step % 8) as f64;
    let each = || scattered.iter().enumerate();
    let columns: Vec<[f64; 3]> = each()
        .map(|(index, point)| [lattice(index, 1), lattice(index, 8), point[2]])
        .collect();
    let layers: Vec<[f64; 3]> = each()
        .map(|(index, point)| [point[0], point[1], lattice(index, 64)])
        .collect();

    let highest = |points: &[[f64; 3]]| {
        of(points, region, 1.0).map(|plane| {
            let finite = plane.picture.power.iter().filter(|power| power.is_finite());
            finite.copied().fold(0.0, f64::max)
        })
    };
    // Columns have 8 cycles along x and along y, each of which lies in one of the other planes, too.
    let [no_x, no_y, no_z] = of(&columns, region, 1.0);
    for peak in [
        at(&no_z, [8, 8]),
        at(&no_z, [8, 0]),
        at(&no_y, [8, 0]),
        at(&no_x, [8, 0]),
    ] {
        assert!((peak - 512.0).abs() < 1e-6, "{peak}");
    }
    assert!(at(&no_z, [7, 3]) < 1e-9 && at(&no_x, [8, 3]) < 20.0);

    // Layers have 8 cycles along z, the picture's y without a cycle along x or along y. The control is the plane that has
    // none along z, in which they are noise, as scattered samples are everywhere.
    let [no_x, no_y, no_z] = highest(&layers);
    assert!((no_x - 512.0).abs() < 1e-6 && (no_y - 512.0).abs() < 1e-6);
    assert!(no_z < 20.0, "{no_z}");
    assert!(highest(&scattered).iter().all(|power| *power < 20.0));
}

#[test]
fn noise_has_the_power_1_beside_a_border_and_without_one() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = region([2.0, 3.0, 2.0], boundary);
        for plane in of(&noise(20_000, region.size()), region, 1.0) {
            let finite = plane.picture.power.iter().filter(|power| power.is_finite());
            let count = finite.clone().count() as f64;
            let mean = finite.sum::<f64>() / count;
            // Two opposite frequencies have one power, and of a tapered set some four neighbours along each axis have common
            // parts: of 1,600 pairs of frequencies or more, 400 are independent. A fifth is then four standard errors.
            assert!((mean - 1.0).abs() < 0.2, "{boundary:?} {mean}");
        }
    }
}

/// A long box has more cycles along its length than a picture may have. Across it the picture then ends before the first
/// cycle, as it ends at one frequency along both axes.
#[test]
fn a_long_side_ends_the_picture() {
    let region = region([2_000.0, 1.0, 1.0], Boundary::Periodic);
    let [no_x, no_y, _] = of(&noise(100, region.size()), region, 3.0);
    assert_eq!((no_x.picture.size, no_x.picture.rows), (3, 3));
    assert_eq!(no_y.picture.rows, 1);
    let unit = (100.0_f64 / 2_000.0).cbrt();
    let most = PlanePower::MAX_CYCLES / 2_000.0 / unit;
    assert!(
        (no_y.reach[0] - most).abs() < 0.02 * most,
        "{:?} {most}",
        no_y.reach
    );
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let region = region([5.0, 4.0, 6.0], Boundary::Bounded);
    let points = noise(3_000, region.size());
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
        let planes = pool.unwrap().install(|| of(&points, region, 2.0));
        planes.map(|plane| {
            let bits = plane.picture.power.iter().map(|power| power.to_bits());
            bits.collect::<Vec<u64>>()
        })
    };
    assert_eq!(with_threads(1), with_threads(3));
}

#[test]
fn means_are_taken_cell_by_cell_and_only_of_one_plane() {
    let region = region([3.0; 3], Boundary::Periodic);
    let points = noise(60, region.size());
    let [one, other] = [&points[..30], &points[30..]].map(|half| of(half, region, 1.0));
    let mean = PlanePower::mean(&[&one[2], &other[2]]).unwrap();
    let expected = f64::midpoint(at(&one[2], [1, 2]), at(&other[2], [1, 2]));
    assert!((at(&mean, [1, 2]) - expected).abs() < 1e-12);
    assert!(at(&mean, [0, 0]).is_nan());
    assert_eq!(mean.reach, one[2].reach);

    let differs = |error| matches!(error, Err(MeasureError::Differs { .. }));
    assert!(differs(PlanePower::mean(&[&one[2], &one[0]])));
    let longer = of(&points[..30], region, 1.9);
    assert!(differs(PlanePower::mean(&[&one[2], &longer[2]])));
    assert!(PlanePower::mean(&[]).is_err());
}

/// A set of a few more samples has another unit. At one frequency by length it has as many rows.
#[test]
fn one_frequency_by_length_gives_pictures_of_one_size() {
    let region = region([10.0; 3], Boundary::Periodic);
    let points = noise(1_020, region.size());
    for count in 1_000..1_020 {
        let unit = (count as f64 / region.volume()).cbrt();
        // Ten cycles along a side.
        let [_, _, plane] = of(&points[..count], region, 1.0 / unit);
        assert_eq!(plane.picture.size, 21, "{count}");
    }
}

#[test]
fn what_cannot_be_measured_is_refused_as_by_shells() {
    let region = region([1.0; 3], Boundary::Periodic);
    let points = noise(8, region.size());
    let refused = |most| {
        let found = PlanePower::of(&points, region, most, &|_| ControlFlow::Continue(()));
        found.unwrap_err().to_string()
    };
    assert!(refused(0.4).starts_with("the largest frequency is 0.4, which is not between 0.5"));
    let cancelled = PlanePower::of(&points, region, 1.0, &|_| ControlFlow::Break(()));
    assert_eq!(cancelled, Err(SolidError::Cancelled));
}
