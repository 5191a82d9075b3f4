//! The judge by squares against the definition: on small lattices every place and every pair is looked at.

mod windows;

use proptest::prelude::*;
use tilescope_analysis::{
    Boundary, LatticeRegion, MAX_FACTOR, Radii, Shape, SquaresError, SquaresJudge, SquaresReport,
};

use crate::support::{Random, go_on, on_threads};

/// A domain with a radius that varies, and all numbers that it is made from.
#[derive(Clone, Debug)]
pub struct Case {
    region: LatticeRegion,
    pitch_bits: u32,
    columns: usize,
    nodes: Vec<i32>,
    shape: Shape,
}

impl Case {
    pub fn judge(&self) -> SquaresJudge {
        let radii = Radii::Nodes {
            pitch_bits: self.pitch_bits,
            columns: self.columns,
            nodes: &self.nodes,
        };
        SquaresJudge::new(self.region, radii, &self.shape).expect("a domain")
    }

    fn is_periodic(&self) -> bool {
        self.region.boundary == Boundary::Periodic
    }

    /// All places of the domain.
    pub fn places(&self) -> Vec<[i32; 2]> {
        let closed = i32::from(!self.is_periodic());
        let (right, top) = (self.region.width + closed, self.region.height + closed);
        let all = (0..top).flat_map(|y| (0..right).map(move |x| [x, y]));
        all.filter(|&place| self.inside(place)).collect()
    }

    fn inside(&self, [x, y]: [i32; 2]) -> bool {
        match &self.shape {
            Shape::Rectangle => true,
            Shape::Polygon { rings } => {
                let sides = rings.iter().flat_map(|ring| {
                    (0..ring.len()).map(move |k| [ring[k], ring[(k + 1) % ring.len()]])
                });
                let mut odd = false;
                for [[ax, ay], [bx, by]] in sides {
                    let cross = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
                    let between = |v: i32, a: i32, b: i32| a.min(b) <= v && v <= a.max(b);
                    if cross == 0 && between(x, ax, bx) && between(y, ay, by) {
                        return true;
                    }
                    // The side crosses the row at a column to the right.
                    let crosses = (ay <= y) != (by <= y);
                    odd ^= crosses
                        && f64::from(y - ay) / f64::from(by - ay) * f64::from(bx - ax)
                            > f64::from(x - ax);
                }
                odd
            }
            Shape::Mask {
                pitch_bits,
                columns,
                pixels,
            } => {
                let (column, row) = ((x >> pitch_bits) as usize, (y >> pitch_bits) as usize);
                column < *columns && pixels.get(row * columns + column) == Some(&true)
            }
            Shape::Filling { columns, pixels } => {
                let rows = pixels.len() / columns;
                let column = x as usize * columns / self.region.width as usize;
                let row = y as usize * rows / self.region.height as usize;
                column < *columns && pixels.get(row * columns + column) == Some(&true)
            }
        }
    }

    /// The radius by the definition: fractions of the pitch, squared, rounded down once.
    fn radius(&self, [x, y]: [i32; 2]) -> i64 {
        let pitch = 1 << self.pitch_bits;
        let rows = self.nodes.len() / self.columns;
        let mut sum = 0;
        for (up, right) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let weight = |v: i32, k: i32| if k == 0 { pitch - v % pitch } else { v % pitch };
            let share = i64::from(weight(x, right)) * i64::from(weight(y, up));
            // A node beyond the last one of a bounded region has the weight 0.
            let column = (x / pitch + right) as usize % self.columns;
            let row = (y / pitch + up) as usize % rows;
            sum += share * i64::from(self.nodes[row * self.columns + column]);
        }
        sum / i64::from(pitch * pitch)
    }

    fn is_near(&self, a: [i32; 2], b: [i32; 2]) -> bool {
        let (squared, reach) = self.apart(a, b);
        squared <= reach * reach
    }

    /// How far two places are apart, squared, and how far they may be to be near.
    fn apart(&self, a: [i32; 2], b: [i32; 2]) -> (i64, i64) {
        let [width, height] = [self.region.width, self.region.height];
        let across = |a: i32, b: i32, side: i32| {
            let plain = i64::from((a - b).abs());
            let around = i64::from(side) - plain;
            if self.is_periodic() {
                plain.min(around)
            } else {
                plain
            }
        };
        let (x, y) = (across(a[0], b[0], width), across(a[1], b[1], height));
        let (r, s) = (self.radius(a), self.radius(b));
        (x * x + y * y, (2 * r * s + r + s - 1) / (r + s))
    }

    /// The factor by the definition: of each place that of the best sample, and the largest of these.
    fn factor(&self, samples: &[[i32; 2]]) -> Option<f64> {
        let of_place = |place: [i32; 2]| {
            let of_sample = |&sample: &[i32; 2]| {
                let (squared, reach) = self.apart(place, sample);
                squared as f64 / (reach * reach) as f64
            };
            let all = samples.iter().map(of_sample);
            all.fold(f64::INFINITY, f64::min)
        };
        let largest = self.places().into_iter().map(of_place).fold(1.0, f64::max);
        Some(largest.sqrt()).filter(|&factor| factor <= MAX_FACTOR as f64)
    }

    /// A set that is maximal by the definition: all places in a random sequence, each taken if no earlier one is near.
    fn maximal_set(&self, random: &mut Random) -> Vec<[i32; 2]> {
        let mut places: Vec<(f64, [i32; 2])> = self
            .places()
            .into_iter()
            .map(|place| (random.uniform(), place))
            .collect();
        places.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        let mut samples: Vec<[i32; 2]> = Vec::new();
        for (_, place) in places {
            if !samples.iter().any(|&sample| self.is_near(sample, place)) {
                samples.push(place);
            }
        }
        samples
    }

    /// Compares the judge's report with all pairs and all places.
    fn check(&self, samples: &[[i32; 2]]) -> SquaresReport {
        let judge = self.judge();
        let factor = judge.covering_factor(samples, &go_on);
        assert_eq!(factor, Ok(self.factor(samples)), "{self:?} {samples:?}");
        let report = judge.judge(samples, 16, &go_on).expect("a report");
        let pairs = (0..samples.len()).flat_map(|k| (0..k).map(move |j| [samples[j], samples[k]]));
        let conflicts = pairs.filter(|&[a, b]| self.is_near(a, b)).count();
        assert_eq!(report.conflicts, conflicts as u64, "{self:?} {samples:?}");
        for pair in &report.worst_conflicts {
            assert!(self.is_near(samples[pair.first], samples[pair.second]));
        }

        let covered = |place| samples.iter().any(|&sample| self.is_near(sample, place));
        let holes = self.places().into_iter().any(|place| !covered(place));
        assert_eq!(report.uncovered > 0, holes, "{self:?} {samples:?}");
        assert_eq!(factor != Ok(Some(1.0)), holes);
        for found in &report.uncovered_places {
            assert!(
                self.inside(found.place) && !covered(found.place),
                "{self:?}"
            );
            assert_eq!(i64::from(found.radius), self.radius(found.place));
        }
        report
    }
}

/// Regions of up to 48 x 48 places with fields that jump from node to node.
pub fn cases() -> impl Strategy<Value = Case> {
    let sides = (1_i32..7, 1_i32..7, 0_i32..8, 0_i32..8, any::<bool>());
    (sides, any::<u64>(), 1_i32..6, 0_u8..4).prop_map(|(sides, seed, contrast, kind)| {
        let (columns, rows, right, top, periodic) = sides;
        let mut random = Random::new(seed);
        let mut below = |count: i32| (random.uniform() * f64::from(count)) as i32;
        // A periodic region needs more than two of the largest radius.
        // Most sides are no multiples of the tiles'.
        let pitch_bits = 1 + below(3) as u32;
        let (parts, extra) = (8 >> pitch_bits, below(8 >> pitch_bits));
        let [columns, rows] =
            [columns, rows].map(|count| (count + 3 * i32::from(periodic)) * parts + extra);
        let (boundary, cut) = if periodic {
            (Boundary::Periodic, [0, 0])
        } else {
            (
                Boundary::Bounded,
                [right, top].map(|cut| cut >> (4 - pitch_bits)),
            )
        };
        let region = LatticeRegion {
            width: (columns << pitch_bits) - cut[0],
            height: (rows << pitch_bits) - cut[1],
            boundary,
        };
        let shape = match kind {
            0 | 1 => Shape::Rectangle,
            2 => {
                let mut ring = |corners: usize| {
                    (0..corners)
                        .map(|_| [below(60) - 6, below(60) - 6])
                        .collect::<Vec<_>>()
                };
                Shape::Polygon {
                    rings: vec![ring(5), ring(3)],
                }
            }
            _ => Shape::Mask {
                pitch_bits: 2,
                columns: 9,
                pixels: (0..81).map(|_| below(2) > 0).collect(),
            },
        };
        let [columns, rows] = [columns, rows].map(|count| (count + i32::from(!periodic)) as usize);
        let nodes = (0..columns * rows)
            .map(|_| 2 + below(contrast) * below(4))
            .collect();
        Case {
            region,
            pitch_bits,
            columns,
            nodes,
            shape,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(512), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reports_are_those_of_the_definition(case in cases(), seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let whole = case.maximal_set(&mut random);
        prop_assert!(case.check(&whole).valid());
        if whole.is_empty() {
            return Ok(());
        }

        // One sample left out leaves its own place uncovered, and one added anywhere is near another.
        let mut spoilt = whole.clone();
        spoilt.swap_remove((random.uniform() * whole.len() as f64) as usize);
        prop_assert!(case.check(&spoilt).uncovered > 0);
        let places = case.places();
        let mut any = || places[(random.uniform() * places.len() as f64) as usize];
        spoilt.push(any());
        case.check(&spoilt);
        let mut crowded = whole;
        crowded.push(any());
        prop_assert!(case.check(&crowded).conflicts > 0);
        crowded.extend((0..30).map(|_| any()));
        case.check(&crowded);
        case.check(&[]);
    }
}

/// A set of one radius that is maximal, made from random darts and from what the judge finds uncovered, and its judge.
pub fn filled(region: LatticeRegion, radius: i32) -> (SquaresJudge, Vec<[i32; 2]>) {
    let judge = SquaresJudge::new(region, Radii::Constant(radius), &Shape::Rectangle).unwrap();
    let mut samples: Vec<[i32; 2]> = Vec::new();
    loop {
        let report = judge.judge(&samples, usize::MAX >> 8, &go_on).unwrap();
        assert_eq!(report.conflicts, 0);
        if report.valid() {
            return (judge, samples);
        }
        for found in report.uncovered_places {
            let near = |sample: &&[i32; 2]| {
                let offset = |axis: usize| {
                    let plain = (sample[axis] - found.place[axis]).abs();
                    let side = [region.width, region.height][axis];
                    let wraps = region.boundary == Boundary::Periodic;
                    i64::from(if wraps {
                        plain.min(side - plain)
                    } else {
                        plain
                    })
                };
                offset(0).pow(2) + offset(1).pow(2) <= i64::from(radius).pow(2)
            };
            if !samples.iter().any(|sample| near(&sample)) {
                samples.push(found.place);
            }
        }
    }
}

#[test]
fn tiles_and_threads_make_no_difference() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let (width, height) = (1 << 20, 3 << 18);
        let region = LatticeRegion {
            width,
            height,
            boundary,
        };
        let (judge, mut samples) = filled(region, 20_000);
        assert!(samples.len() > 1_000);
        // Most are neither proven at once nor cut to the end.
        let whole = judge.judge(&samples, 16, &go_on).unwrap();
        assert!(
            whole.squares < 20 * samples.len() as u64,
            "{}",
            whole.squares
        );

        samples.swap_remove(700);
        samples.push([samples[3][0] ^ 1, samples[3][1]]);
        let report = judge.judge(&samples, 16, &go_on).unwrap();
        assert_eq!(report.conflicts, 1);
        assert_eq!(report.worst_conflicts[0].first, 3);
        assert!((1..20).contains(&report.uncovered));
        let factor = judge.covering_factor(&samples, &go_on);
        assert!(factor.clone().unwrap().unwrap() > 1.0);
        for threads in [1, 3] {
            let again = on_threads(threads, || judge.covering_factor(&samples, &go_on));
            assert_eq!(again, factor);
            let again = on_threads(threads, || judge.judge(&samples, 16, &go_on));
            assert_eq!(again.as_ref(), Ok(&report));
        }
    }
}

#[test]
fn the_largest_numbers_do_not_overflow() {
    let region = LatticeRegion {
        width: i32::MAX,
        height: i32::MAX,
        boundary: Boundary::Bounded,
    };
    let radii = Radii::Constant(1 << 21);
    let judge = SquaresJudge::new(region, radii, &Shape::Rectangle).unwrap();
    let report = judge
        .judge(&[[0, 0], [i32::MAX, i32::MAX]], 4, &go_on)
        .unwrap();
    assert_eq!(report.conflicts, 0);
    assert!(report.uncovered > 4 && report.uncovered_places.len() == 4);
    assert!(report.squares < 10_000, "{}", report.squares);
    assert_eq!(judge.covering_factor(&[[0, 0]], &go_on), Ok(None));
}

#[test]
fn a_set_of_one_place_counts_its_conflicts_up_to_the_limit() {
    let region = LatticeRegion {
        width: 50,
        height: 50,
        boundary: Boundary::Bounded,
    };
    let judge = SquaresJudge::new(region, Radii::Constant(80), &Shape::Rectangle).unwrap();
    let report = judge.judge(&vec![[25, 25]; 3_000], 2, &go_on).unwrap();
    assert!(report.more_conflicts() && report.uncovered == 0);
    assert_eq!(report.worst_conflicts.len(), 2);
}

#[test]
fn what_cannot_be_judged_is_refused_in_words() {
    let region = LatticeRegion {
        width: 24,
        height: 16,
        boundary: Boundary::Periodic,
    };
    let new = |region, radii| SquaresJudge::new(region, radii, &Shape::Rectangle).err();
    let words = |error: Option<SquaresError>| error.expect("an error").to_string();
    let constant = |radius| words(new(region, Radii::Constant(radius)));
    assert_eq!(constant(0), "a radius of 0 units is not from 1 to 2097152");
    assert_eq!(
        constant(8),
        "the shorter side of the periodic region has 16 units; more than twice the largest radius, 8, are needed"
    );
    assert_eq!(new(region, Radii::Constant(7)), None);

    let nodes = [5; 6];
    let field = |pitch_bits, columns| Radii::Nodes {
        pitch_bits,
        columns,
        nodes: &nodes,
    };
    assert_eq!(new(region, field(3, 3)), None);
    assert_eq!(
        words(new(region, field(3, 2))),
        "6 nodes in rows of 2 are given; 3 x 2 are needed"
    );
    let uneven = LatticeRegion {
        width: 25,
        ..region
    };
    assert!(words(new(uneven, field(3, 3))).contains("a side of 25 units"));
    assert!(words(new(region, field(21, 3))).starts_with("the pitch is 2^21 units"));
    let flat = LatticeRegion {
        height: 0,
        ..region
    };
    assert!(words(new(flat, field(3, 3))).starts_with("the region has a side of 0 units"));

    let judge = SquaresJudge::new(region, Radii::Constant(7), &Shape::Rectangle).unwrap();
    let refused = judge.judge(&[[3, 3], [24, 0]], 1, &go_on);
    assert_eq!(
        refused.unwrap_err().to_string(),
        "sample 1 at (24, 0) lies outside the domain"
    );
    let stop = |_| std::ops::ControlFlow::Break(());
    assert_eq!(judge.judge(&[], 1, &stop), Err(SquaresError::Cancelled));
}
