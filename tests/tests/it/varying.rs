//! Sets of varying radius, in domains of any shape, before a judge that knows the field's nodes and nothing else of the sampler.

mod evaluations;

use std::ops::ControlFlow;

use proptest::prelude::*;
use tilescope_analysis::{
    LatticeRegion, Radii, Region, Shape as JudgedShape, SquaresJudge, SquaresReport, VerifyOptions,
    verify,
};
use tilescope_core::{
    Boundary, Domain, Key, Point, R, RadiusField, Shape, Stream, Unobserved, reference_sample,
    varying_sample,
};

/// A domain, its radii, and a shape in it, for the sampler and for the judge.
#[derive(Debug)]
struct Case {
    domain: Domain,
    bits: u32,
    nodes: Vec<i32>,
    kind: ShapeKind,
    seed: u64,
}

#[derive(Clone, Copy, Debug)]
enum ShapeKind {
    Rectangle,
    Polygon,
    Mask,
}

impl Case {
    fn word(&self, index: u32) -> u32 {
        Key::from_seed(self.seed).draw(Stream::Sequence, index)[0]
    }

    /// Two rings whose corners lie anywhere around the domain.
    fn rings(&self) -> Vec<Vec<[i32; 2]>> {
        let place = |index: u32, side: i32| {
            let wide = i64::from(side) * 5 / 4;
            ((i64::from(self.word(index)) * wide) >> 32) as i32 - side / 8
        };
        let (width, height) = (self.domain.width(), self.domain.height());
        let corner = |index: u32| [place(2 * index, width), place(2 * index + 1, height)];
        [1_000..1_006, 1_006..1_010]
            .map(|ring| ring.map(corner).collect())
            .to_vec()
    }

    /// Pixels of 2^14 units, in rows.
    fn pixels(&self) -> (usize, Vec<bool>) {
        let [columns, rows] =
            [self.domain.width(), self.domain.height()].map(|side| (side >> 14) as usize + 1);
        let pixel = |index: usize| self.word(1 << 20 | index as u32) >> 31 == 0;
        (columns, (0..columns * rows).map(pixel).collect())
    }

    fn field(&self) -> RadiusField {
        RadiusField::from_nodes(self.domain, self.bits, &self.nodes).expect("a field")
    }

    fn shape(&self) -> Shape {
        match self.kind {
            ShapeKind::Rectangle => Shape::rectangle(),
            ShapeKind::Polygon => {
                let point = |&[x, y]: &[i32; 2]| Point::new(x, y);
                let rings = self.rings();
                let rings: Vec<Vec<Point>> = rings
                    .iter()
                    .map(|ring| ring.iter().map(point).collect())
                    .collect();
                Shape::polygon(&rings).expect("rings")
            }
            ShapeKind::Mask => {
                let (columns, pixels) = self.pixels();
                Shape::mask(14, columns, &pixels).expect("pixels")
            }
        }
    }

    fn samples(&self) -> Vec<[i32; 2]> {
        let samples = varying_sample(&self.field(), &self.shape(), self.seed, &mut Unobserved);
        samples
            .expect("samples")
            .iter()
            .map(|p| [p.x, p.y])
            .collect()
    }

    fn judge(&self) -> SquaresJudge {
        let [columns, _] = RadiusField::node_counts(&self.domain, self.bits).expect("a pitch");
        let radii = Radii::Nodes {
            pitch_bits: self.bits,
            columns,
            nodes: &self.nodes,
        };
        let shape = match self.kind {
            ShapeKind::Rectangle => JudgedShape::Rectangle,
            ShapeKind::Polygon => JudgedShape::Polygon {
                rings: self.rings(),
            },
            ShapeKind::Mask => {
                let (columns, pixels) = self.pixels();
                JudgedShape::Mask {
                    pitch_bits: 14,
                    columns,
                    pixels,
                }
            }
        };
        SquaresJudge::new(lattice_region(&self.domain), radii, &shape).expect("a judge")
    }
}

fn lattice_region(domain: &Domain) -> LatticeRegion {
    LatticeRegion {
        width: domain.width(),
        height: domain.height(),
        boundary: Region::new(domain.size(), domain.is_periodic()).boundary,
    }
}

fn judged(judge: &SquaresJudge, samples: &[[i32; 2]]) -> SquaresReport {
    let go_on = |_| ControlFlow::Continue(());
    judge.judge(samples, 16, &go_on).expect("a report")
}

const KINDS: [ShapeKind; 3] = [ShapeKind::Rectangle, ShapeKind::Polygon, ShapeKind::Mask];

/// What a case is made from: sides beyond the shortest, in radii, and whether it is periodic; the bits of the pitch, the form
/// of the field, and the octaves of its radii.
#[derive(Clone, Copy, Debug)]
struct Draft {
    sides: (i32, i32, bool),
    bits: u32,
    form: u8,
    octaves: u32,
    seed: u64,
    kind: ShapeKind,
}

impl Draft {
    fn case(self) -> Case {
        let Self {
            sides: (width, height, periodic),
            bits,
            form,
            octaves,
            seed,
            kind,
        } = self;
        let octaves = if periodic { octaves.min(3) } else { octaves };
        let least = if periodic { (4 << octaves) + 8 } else { 4 };
        let units = |side: i32| {
            let side = (side + least) * R;
            if periodic {
                side >> 18 << 18
            } else {
                side + (seed % 32_768) as i32
            }
        };
        // A multiple of every pitch that is still long enough.
        let units = |side: i32| units(side) + if periodic { 1 << 18 } else { 0 };
        let size = [width, height].map(|side| f64::from(units(side)) / f64::from(R));
        let domain = Domain::from_size(size, 1.0, Boundary::of(periodic)).expect("a domain");
        let [columns, rows] = RadiusField::node_counts(&domain, bits).expect("a pitch");

        let most = f64::from((R << octaves) - R);
        let key = Key::from_seed(seed);
        let node = |index: usize| {
            let (column, row) = ((index % columns) as f64, (index / columns) as f64);
            let noise = f64::from(key.draw(Stream::Order, index as u32)[0]) / 2_f64.powi(32);
            let share = match form {
                0 => noise,
                1 => f64::from(u8::from(noise < 0.03)),
                2 => f64::from(u8::from(noise > 0.03)),
                3 => column / columns as f64,
                4 => 0.5 + 0.5 * (column * 0.4).sin() * (row * 0.3).cos(),
                _ => f64::from(u8::from(
                    (column / 9.0) as i64 % 2 == (row / 7.0) as i64 % 2,
                )),
            };
            R + (share * most) as i32
        };
        let nodes = (0..columns * rows).map(node).collect();
        Case {
            domain,
            bits,
            nodes,
            kind,
            seed,
        }
    }
}

/// Steep and noisy fields whose domains are no multiples of the pitch unless they are periodic.
fn cases() -> impl Strategy<Value = Case> {
    let sides = (0_i32..40, 0_i32..40, any::<bool>());
    let numbers = (
        sides,
        12_u32..18,
        0_u8..6,
        0_u32..7,
        any::<u64>(),
        0_usize..3,
    );
    numbers.prop_map(|(sides, bits, form, octaves, seed, kind)| {
        let draft = Draft {
            sides,
            bits,
            form,
            octaves,
            seed,
            kind: KINDS[kind],
        };
        draft.case()
    })
}

/// Judges a set, and the same set with a sample less and with one more.
fn check(case: &Case) -> Result<usize, TestCaseError> {
    let (judge, samples) = (case.judge(), case.samples());
    let report = judged(&judge, &samples);
    prop_assert!(report.valid(), "{:?}", report);
    if samples.is_empty() {
        return Ok(0);
    }

    let chosen = case.word(7) as usize % samples.len();
    let mut fewer = samples.clone();
    let [x, y] = fewer.swap_remove(chosen);
    let report = judged(&judge, &fewer);
    prop_assert!(
        report.uncovered > 0 && report.conflicts == 0,
        "{:?}",
        report
    );
    // Half a radius to the left, or at the sample itself.
    let beside = [(x - judge.radius_at([x, y]) / 2).max(0), y];
    let mut more = samples;
    more.push(if judge.contains(beside) {
        beside
    } else {
        [x, y]
    });
    let report = judged(&judge, &more);
    prop_assert!(
        report.conflicts > 0 && report.uncovered == 0,
        "{:?}",
        report
    );
    Ok(more.len())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(1024), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_set_is_proven_and_every_fault_is_found(case in cases()) {
        check(&case)?;
    }
}

/// The report of both other judges on samples of one radius.
fn verified(domain: &Domain, samples: &[[i32; 2]]) -> tilescope_analysis::Report {
    let points: Vec<[f64; 2]> = samples.iter().map(|p| p.map(f64::from)).collect();
    let size = [domain.width(), domain.height()].map(f64::from);
    // Samples at most R apart conflict: their distance is below this.
    let radius = (f64::from(R) * f64::from(R) + 0.5).sqrt();
    let options = VerifyOptions::default();
    let go_on = |_| ControlFlow::Continue(());
    let region = Region::new(size, domain.is_periodic());
    verify(&points, region, radius, &options, &go_on).expect("a report")
}

#[test]
fn three_judges_agree_on_sets_of_one_radius() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let domain = Domain::from_size([40.0, 33.5], 1.0, boundary).expect("a domain");
        let points = reference_sample(domain, 9, &mut Unobserved).expect("samples");
        let whole: Vec<[i32; 2]> = points.iter().map(|p| [p.x, p.y]).collect();
        let radii = Radii::Constant(R);
        let shape = JudgedShape::Rectangle;
        let judge = SquaresJudge::new(lattice_region(&domain), radii, &shape).expect("a judge");

        let check = |samples: &[[i32; 2]]| {
            let (report, others) = (judged(&judge, samples), verified(&domain, samples));
            assert_eq!(others.judges.len(), 2);
            assert_eq!(report.conflicts, others.conflicts);
            assert_eq!(report.worst_conflicts, others.worst_conflicts);
            assert_eq!(report.uncovered == 0, others.maximal());
            report
        };
        assert!(check(&whole).valid());
        for k in tilescope_tests::some([0, 1, 2, 3, 4, 5, 6, 7]).map(|k| 97 * k) {
            let mut fewer = whole.clone();
            let [x, y] = fewer.swap_remove(k);
            assert!(check(&fewer).uncovered > 0);
            fewer.extend([[x / 2, y], [x, y / 2]]);
            assert!(check(&fewer).conflicts > 0);
        }
    }
}
