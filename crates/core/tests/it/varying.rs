//! Sets of varying radius against the definition: all darts of the first levels, none left out in advance, taken one after another.

mod stripe;
mod windows;

use std::sync::Arc;

use proptest::prelude::*;
use tilescope_core::stages::darts::{POISSON, throws};
use tilescope_core::{
    Boundary, Domain, Key, Locality, Parameters, Point, R, RadiusField, Recorder, RunEvent, Shape,
    Stream, Unobserved, Verdict, reference_recorded, varying_recorded, varying_sample,
};

/// A field with all numbers that it is made from, and a shape.
#[derive(Debug)]
struct Case {
    domain: Domain,
    bits: u32,
    columns: usize,
    nodes: Vec<i32>,
    rings: Option<Vec<Vec<Point>>>,
    seed: u64,
}

/// A dart: when it arrives, where, and the radius there.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Dart {
    level: u32,
    throw: u32,
    rank: u32,
    y: i64,
    x: i64,
    radius: i64,
}

/// A base cell, or a part of one that cuts in four have made.
#[derive(Clone, Copy)]
struct Part {
    left: i64,
    bottom: i64,
    side: i64,
    base_side: i64,
}

/// Whether coins thin the darts where the radius is larger than the side of the base cell.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Coin {
    Thrown,
    LeftOut,
}

impl Case {
    fn field(&self) -> RadiusField {
        RadiusField::from_nodes(self.domain, self.bits, &self.nodes).expect("a field")
    }

    fn shape(&self) -> Shape {
        let rings = self.rings.as_deref();
        rings.map_or(Shape::rectangle(), |rings| {
            Shape::polygon(rings).expect("rings")
        })
    }

    fn rows(&self) -> usize {
        self.nodes.len() / self.columns
    }

    /// The cells of an axis.
    fn cells(&self, axis: usize) -> i64 {
        let nodes = [self.columns, self.rows()][axis] as i64;
        if self.domain.is_periodic() {
            nodes
        } else {
            nodes - 1
        }
    }

    fn node(&self, column: i64, row: i64) -> i64 {
        let (column, row) = (column as usize % self.columns, row as usize % self.rows());
        self.nodes[row * self.columns + column].into()
    }

    fn radius(&self, x: i64, y: i64) -> i64 {
        let pitch = 1_i64 << self.bits;
        // Beyond the last nodes the radius goes on as it is there.
        let (x, y) = (x.min(self.cells(0) * pitch), y.min(self.cells(1) * pitch));
        let (column, row) = (
            (x / pitch).min(self.cells(0) - 1),
            (y / pitch).min(self.cells(1) - 1),
        );
        let (right, up) = (x - column * pitch, y - row * pitch);
        let sum = self.node(column, row) * (pitch - right) * (pitch - up)
            + self.node(column + 1, row) * right * (pitch - up)
            + self.node(column, row + 1) * (pitch - right) * up
            + self.node(column + 1, row + 1) * right * up;
        sum / (pitch * pitch)
    }

    /// The least radius that counts for a square.
    fn least(&self, x: i64, y: i64, side: i64) -> i64 {
        let pitch = 1 << self.bits;
        if side <= pitch {
            let last = side - 1;
            let corners = [(x, y), (x + last, y), (x, y + last), (x + last, y + last)];
            return corners
                .map(|(x, y)| self.radius(x, y))
                .into_iter()
                .min()
                .unwrap();
        }
        let clamp = |cell: i64, axis: usize| cell.min(self.cells(axis) - 1);
        let columns = clamp(x / pitch, 0)..=clamp((x + side - 1) / pitch, 0) + 1;
        let rows = clamp(y / pitch, 1)..=clamp((y + side - 1) / pitch, 1) + 1;
        let nodes = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
        nodes
            .map(|(column, row)| self.node(column, row))
            .min()
            .unwrap()
    }

    fn inside(&self, x: i64, y: i64) -> bool {
        let rect = self.domain.rect();
        if x >= rect.max.x.into() || y >= rect.max.y.into() {
            return false;
        }
        let Some(rings) = &self.rings else {
            return true;
        };
        let mut odd = false;
        for ring in rings {
            for (k, a) in ring.iter().enumerate() {
                let b = ring[(k + 1) % ring.len()];
                let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(i64::from);
                let cross = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
                let between = |v: i64, a: i64, b: i64| a.min(b) <= v && v <= a.max(b);
                if cross == 0 && between(x, ax, bx) && between(y, ay, by) {
                    return true;
                }
                let crosses = (ay > y) != (by > y);
                odd ^= crosses && (cross > 0) == (by > ay);
            }
        }
        odd
    }

    fn is_near(&self, a: &Dart, b: &Dart) -> bool {
        let [width, height] = [self.domain.width(), self.domain.height()].map(i64::from);
        let across = |a: i64, b: i64, side: i64| {
            let plain = (a - b).abs();
            if self.domain.is_periodic() {
                plain.min(side - plain)
            } else {
                plain
            }
        };
        let (x, y) = (across(a.x, b.x, width), across(a.y, b.y, height));
        let sum = a.radius + b.radius;
        // The harmonic mean, rounded up.
        let reach = (2 * a.radius * b.radius + sum - 1) / sum;
        x * x + y * y <= reach * reach
    }

    /// The base cells: lowest points and sides.
    fn base_cells(&self) -> Vec<(i64, i64, i64)> {
        let rect = self.domain.rect();
        let top = 1_i64 << self.nodes.iter().max().unwrap().ilog2();
        let [right, above] = [rect.max.x, rect.max.y].map(i64::from);
        let starts = |end: i64| (0..end).step_by(top as usize);
        let mut open: Vec<_> = starts(right)
            .flat_map(|x| starts(above).map(move |y| (x, y, top)))
            .collect();
        let mut base = Vec::new();
        while let Some((x, y, side)) = open.pop() {
            if x >= right || y >= above {
                continue;
            }
            if side <= self.least(x, y, side) {
                base.push((x, y, side));
                continue;
            }
            let half = side / 2;
            open.extend([
                (x, y, half),
                (x + half, y, half),
                (x, y + half, half),
                (x + half, y + half, half),
            ]);
        }
        base
    }

    /// All darts of a throw that exist.
    fn darts(&self, level: u32, throw: u32, out: &mut Vec<Dart>) {
        for (left, bottom, base_side) in self.base_cells() {
            let side = base_side >> level;
            let parts = 0..1_i64 << level;
            for (i, j) in parts
                .clone()
                .flat_map(|i| parts.clone().map(move |j| (i, j)))
            {
                let part = Part {
                    left: left + i * side,
                    bottom: bottom + j * side,
                    side,
                    base_side,
                };
                self.part_darts(part, Coin::Thrown, level, throw, out);
            }
        }
    }

    /// The darts of a part of a base cell that exist.
    fn part_darts(&self, part: Part, coins: Coin, level: u32, throw: u32, out: &mut Vec<Dart>) {
        let Part {
            left,
            bottom,
            side,
            base_side,
        } = part;
        let key = Key::from_seed(self.seed);
        let key = key
            .derive(Stream::Level, level)
            .derive(Stream::Throw, throw);
        let cell = key.derive_at(left as i32, bottom as i32);
        let drawn = POISSON
            .iter()
            .filter(|&&bound| cell.words()[0] >= bound)
            .count();
        // A part of one unit throws its only point.
        let count = if side == 1 { 1 } else { drawn as u32 };
        for index in 0..count {
            let [x, y, rank] = if side > 1 << 16 {
                let [x, y] = cell.draw(Stream::Dart, 2 * index);
                let [rank, _] = cell.draw(Stream::Dart, 2 * index + 1);
                let scaled = |word: u32| ((u64::from(word) * side as u64) >> 32) as u32;
                [scaled(x), scaled(y), rank]
            } else {
                let [position, rank] = cell.draw(Stream::Dart, index);
                let scaled = |word: u32| word / ((1 << 16) / side as u32);
                [scaled(position >> 16), scaled(position & 0xffff), rank]
            };
            let (x, y) = (left + i64::from(x), bottom + i64::from(y));
            if !self.inside(x, y) {
                continue;
            }

            let radius = self.radius(x, y);
            let coin = i64::from(cell.draw(Stream::Thin, index)[0] >> 16);
            let is_thinned = radius > base_side
                && side > 1
                && coin * (radius * radius / 16) >= base_side * base_side * 4_096;
            if is_thinned && coins == Coin::Thrown {
                continue;
            }
            out.push(Dart {
                level,
                throw,
                rank,
                y,
                x,
                radius,
            });
        }
    }

    /// The samples that arrive in the first levels.
    fn samples(&self, levels: u32) -> Vec<Point> {
        let mut darts = Vec::new();
        for level in 0..levels {
            for throw in 0..throws(level) {
                self.darts(level, throw, &mut darts);
            }
        }
        darts.sort_unstable();
        let mut samples: Vec<Dart> = Vec::new();
        for dart in darts {
            if !samples.iter().any(|sample| self.is_near(sample, &dart)) {
                samples.push(dart);
            }
        }
        samples
            .iter()
            .map(|dart| Point::new(dart.x as i32, dart.y as i32))
            .collect()
    }
}

/// Fields that jump from node to node, with single nodes apart from all others, ramps and waves, in rectangles and polygons.
fn cases() -> impl Strategy<Value = Case> {
    let sides = (1_i32..9, 1_i32..9, any::<bool>());
    (
        sides,
        13_u32..18,
        0_u8..4,
        1_i32..17,
        any::<u64>(),
        any::<bool>(),
    )
        .prop_map(
            |((width, height, periodic), bits, kind, contrast, seed, polygon)| {
                // A periodic domain needs four of its largest radii, 10 of the smallest, and whole pitches.
                let contrast = if periodic { contrast.min(4) } else { contrast };
                let least = if periodic { 4 * contrast.max(2) + 3 } else { 4 };
                let unit = (1 << bits).max(R);
                let units = |side: i32| {
                    let side = (side + least) * R;
                    if periodic {
                        (side + unit - 1) / unit * unit
                    } else {
                        side + (seed % 30_000) as i32
                    }
                };
                let size = [width, height].map(|side| f64::from(units(side)) / f64::from(R));
                let boundary = if periodic {
                    Boundary::Periodic
                } else {
                    Boundary::Bounded
                };
                let domain = Domain::from_size(size, 1.0, boundary).expect("a domain");
                let [columns, rows] = RadiusField::node_counts(&domain, bits).expect("a pitch");

                let word = |index: u32| Key::from_seed(seed).draw(Stream::Sequence, index)[0];
                let most = f64::from((contrast - 1) * R + 1);
                let node = |index: usize| {
                    let (column, row) = ((index % columns) as f64, (index / columns) as f64);
                    let noise = f64::from(word(index as u32)) / 2_f64.powi(32);
                    let share = match kind {
                        0 => noise,
                        1 => f64::from(u8::from(noise < 0.05)),
                        2 => (column + row) / (columns + rows) as f64,
                        _ => 0.5 + 0.5 * (column * 0.9 + row * 0.7).sin(),
                    };
                    R + (share * most) as i32
                };
                let corner = |index: u32| {
                    let place =
                        |word: u32, side: i32| ((i64::from(word) * i64::from(side)) >> 32) as i32;
                    let (x, y) = (word(1 << 30 | index), word(1 << 29 | index));
                    Point::new(place(x, domain.width()), place(y, domain.height()))
                };
                let ring = |corners: std::ops::Range<u32>| corners.map(corner).collect();
                Case {
                    domain,
                    bits,
                    columns,
                    nodes: (0..columns * rows).map(node).collect(),
                    rings: polygon.then(|| vec![ring(0..5), ring(5..8)]),
                    seed,
                }
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(2048), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_first_samples_are_those_of_the_definition(case in cases()) {
        let field = case.field();
        for y in [0, 1, case.domain.height() / 3, case.domain.height() - 1] {
            let place = Point::new(case.domain.width() / 2, y);
            prop_assert_eq!(i64::from(field.radius_at(place)), case.radius(place.x.into(), y.into()));
        }
        let samples = varying_sample(&field, &case.shape(), case.seed, &mut Unobserved).expect("samples");
        let defined = case.samples(3);
        prop_assert!(defined.len() <= samples.len());
        prop_assert_eq!(&samples[..defined.len()], &defined[..]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(256), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_number_of_threads_makes_the_recorded_set(case in cases()) {
        let locality = Arc::new(Locality { field: case.field(), shape: case.shape() });
        let parameters = Parameters { seed: case.seed, ..Parameters::default() };
        let mut events = tilescope_core::Unrecorded;
        let recorded = varying_recorded(&locality, &parameters, &mut Unobserved, &mut events).unwrap();

        let sample = |seed: u64| varying_sample(&locality.field, &locality.shape, seed, &mut Unobserved).unwrap();
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            prop_assert_eq!(&pool.install(|| sample(case.seed)), &recorded.samples.points);
        }
        // Another seed gives another set, so that the comparison shows something.
        let other = sample(case.seed ^ 1);
        prop_assert!(other.is_empty() || other != recorded.samples.points);
    }
}

/// Domains of many parcels of base cells, which the cases above are too small for.
#[test]
fn a_large_domain_has_the_recorded_set() {
    for (boundary, bits) in [
        (Boundary::Bounded, 13),
        (Boundary::Bounded, 17),
        (Boundary::Periodic, 15),
    ] {
        let domain = Domain::from_size([72.0, 52.0], 1.0, boundary).unwrap();
        let [columns, rows] = RadiusField::node_counts(&domain, bits).unwrap();
        let node = |index: usize| {
            let (column, row) = ((index % columns) as f64, (index / columns) as f64);
            let wave = (9.0 * column / columns as f64).sin() * (7.0 * row / rows as f64).cos();
            R + ((0.5 + 0.5 * wave) * f64::from(3 * R)) as i32
        };
        let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
        let field = RadiusField::from_nodes(domain, bits, &nodes).unwrap();

        let pixels: Vec<bool> = (0..36 * 26).map(|pixel| pixel % 7 != 3).collect();
        for shape in [Shape::rectangle(), Shape::mask(16, 36, &pixels).unwrap()] {
            let locality = Arc::new(Locality {
                field: field.clone(),
                shape,
            });
            let mut events = tilescope_core::Unrecorded;
            let parameters = Parameters::default();
            let recorded =
                varying_recorded(&locality, &parameters, &mut Unobserved, &mut events).unwrap();
            let sample = varying_sample(
                &locality.field,
                &locality.shape,
                parameters.seed,
                &mut Unobserved,
            );
            assert_eq!(sample.unwrap(), recorded.samples.points);
        }
    }
}

/// The far border of such a domain has parcels of its own, a unit wide.
#[test]
fn a_domain_that_ends_with_a_parcel_has_the_recorded_set() {
    let domain = Domain::from_size([32.0, 16.0], 1.0, Boundary::Bounded).unwrap();
    let field = RadiusField::constant(domain, R + 9_000).unwrap();
    let locality = Arc::new(Locality {
        field,
        shape: Shape::rectangle(),
    });
    let (parameters, mut events) = (Parameters::default(), tilescope_core::Unrecorded);
    let recorded = varying_recorded(&locality, &parameters, &mut Unobserved, &mut events).unwrap();
    let Locality { field, shape } = &*locality;
    let sample = varying_sample(field, shape, parameters.seed, &mut Unobserved).unwrap();
    assert_eq!(sample, recorded.samples.points);
}

#[test]
fn with_one_radius_the_set_is_that_of_the_reference_sampler() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let domain = Domain::from_size([23.0, 31.5], 1.0, boundary).unwrap();
        for seed in [1, 7, 123_456_789_012] {
            let mut events = tilescope_core::Unrecorded;
            let reference = reference_recorded(domain, seed, &mut Unobserved, &mut events).unwrap();
            let one = RadiusField::constant(domain, R).unwrap();
            let [columns, rows] = RadiusField::node_counts(&domain, 14).unwrap();
            let nodes = RadiusField::from_nodes(domain, 14, &vec![R; columns * rows]).unwrap();
            for field in [one, nodes] {
                let shape = Shape::rectangle();
                let samples = varying_sample(&field, &shape, seed, &mut Unobserved).unwrap();
                assert_eq!(samples, reference);
            }
        }
    }
}

#[test]
fn a_mask_of_all_pixels_leaves_nothing_out() {
    let domain = Domain::from_size([16.0, 16.0], 1.0, Boundary::Periodic).unwrap();
    let field = RadiusField::constant(domain, 50_000).unwrap();
    let sample = |shape: &Shape| varying_sample(&field, shape, 3, &mut Unobserved).unwrap();
    let whole = sample(&Shape::rectangle());
    assert_eq!(sample(&Shape::mask(17, 4, &[true; 16]).unwrap()), whole);
    let mut pixels = [true; 16];
    pixels[5] = false;
    let part = sample(&Shape::mask(17, 4, &pixels).unwrap());
    assert!(part.len() < whole.len());
    assert!(part.iter().all(|p| (p.x >> 17, p.y >> 17) != (1, 1)));
    assert_eq!(sample(&Shape::mask(17, 4, &[false; 16]).unwrap()), []);
}

/// Keeps all events.
#[derive(Default)]
struct Kept(Vec<RunEvent>);

impl Recorder for Kept {
    fn record(&mut self, run_event: RunEvent) {
        self.0.push(run_event);
    }
}

/// A field that grows to the right, in a triangle with a notch.
fn ramp_in_a_triangle() -> Locality {
    let domain = Domain::from_size([24.0, 20.0], 1.0, Boundary::Bounded).unwrap();
    let [columns, rows] = RadiusField::node_counts(&domain, 15).unwrap();
    let node = |index: usize| R + (index % columns) as i32 * (R / 12);
    let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
    let corners = [(0, 0), (23, 1), (12, 8), (10, 19)].map(|(x, y)| Point::new(x * R, y * R));
    Locality {
        field: RadiusField::from_nodes(domain, 15, &nodes).unwrap(),
        shape: Shape::polygon(&[corners.to_vec()]).unwrap(),
    }
}

#[test]
fn a_recorded_run_is_the_set_with_a_verdict_on_every_dart() {
    let locality = Arc::new(ramp_in_a_triangle());
    let parameters = Parameters {
        seed: 5,
        ..Parameters::default()
    };
    let mut kept = Kept::default();
    let run = varying_recorded(&locality, &parameters, &mut Unobserved, &mut kept).unwrap();
    let Locality { field, shape } = &*locality;
    let plain = varying_sample(field, shape, 5, &mut Unobserved).unwrap();
    assert_eq!((&run.samples.points, run.points()), (&plain, plain.clone()));

    // Each verdict is compared with all samples that were there, one by one.
    let (mut there, mut counts) = (0, [0; 4]);
    for event in &kept.0 {
        match *event {
            RunEvent::Insert { sample, .. } => {
                assert_eq!(sample as usize, there);
                there += 1;
            }
            RunEvent::Dart { point, verdict, .. } => {
                let is_covered = |point| {
                    plain[..there]
                        .iter()
                        .any(|&sample| locality.is_near(sample, point))
                };
                let inside = field.domain().rect().contains(point) && locality.inside(point);
                let which = match verdict {
                    Verdict::Outside => 0,
                    Verdict::Thinned => 1,
                    Verdict::Covered { .. } => 2,
                    Verdict::Accepted => 3,
                    Verdict::TooFar | Verdict::NotNearest { .. } => unreachable!(),
                };
                assert_eq!(inside, which != 0, "{point:?}");
                assert!(which < 2 || is_covered(point) == (which == 2), "{point:?}");
                counts[which] += 1;
            }
            _ => {}
        }
    }
    assert_eq!(there, plain.len());
    assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
}
