//! Where cells of local size throw in step and no coin thins the darts, the samples show a stripe at each power of two of the
//! radius: the negative control of the density along a ramp.

use super::*;

/// How much the radius grows along x.
const SLOPE: f64 = 0.03;

/// The least radius of the ramp, in R: the ramp goes to 2.3 R, as far beyond the power of two as it begins before it.
const LEAST: f64 = 1.7;

/// The sides of the domain, in R.
const SIZE: [f64; 2] = [20.0, 6_000.0];

/// Bins of the radius, in R, to both sides of 2 R, away from the borders by 2.5 radii.
const FIRST: f64 = 1.86;
const BIN: f64 = 0.02;
const BINS: usize = 14;

/// The seeds whose samples are counted together: some 2,800 in a bin.
const SEEDS: [u64; 4] = [1, 2, 3, 4];

/// The side of the squares in which samples are looked up. No sample is near a place that is farther away than the largest
/// radius, 2.3 R, and so than two squares.
const SQUARE: i64 = 2 * R as i64;

fn ramp(seed: u64) -> Case {
    let domain = Domain::from_size(SIZE, 1.0, Boundary::Bounded).expect("a domain");
    let bits = 17;
    let [columns, rows] = RadiusField::node_counts(&domain, bits).expect("a pitch");
    // Rounded up, so that cells of 2 R begin where the ramp reaches 2 R, halfway: a unit less would put them a cell later.
    let node = |index: usize| {
        let x = ((index % columns) << bits) as f64;
        (LEAST * f64::from(R) + SLOPE * x).ceil() as i32
    };
    Case {
        domain,
        bits,
        columns,
        nodes: (0..columns * rows).map(node).collect(),
        rings: None,
        seed,
    }
}

/// The samples so far, by squares.
struct Sampled<'a> {
    case: &'a Case,
    columns: i64,
    squares: Vec<Vec<Dart>>,
    samples: Vec<Dart>,
}

impl<'a> Sampled<'a> {
    fn new(case: &'a Case) -> Self {
        let [columns, rows] =
            [case.domain.width(), case.domain.height()].map(|side| i64::from(side) / SQUARE + 1);
        Self {
            case,
            columns,
            squares: vec![Vec::new(); (columns * rows) as usize],
            samples: Vec::new(),
        }
    }

    /// Returns the samples that can be near a place.
    fn around(&self, x: i64, y: i64) -> impl Iterator<Item = &Dart> {
        let rows = self.squares.len() as i64 / self.columns;
        let span = |value: i64, count: i64| {
            let square = value / SQUARE;
            (square - 2).max(0)..(square + 3).min(count)
        };
        let across = span(x, self.columns);
        span(y, rows)
            .flat_map(move |row| {
                across
                    .clone()
                    .map(move |column| row * self.columns + column)
            })
            .flat_map(|square| &self.squares[square as usize])
    }

    fn add(&mut self, dart: Dart) {
        let square = dart.y / SQUARE * self.columns + dart.x / SQUARE;
        self.squares[square as usize].push(dart);
        self.samples.push(dart);
    }

    fn is_refused(&self, dart: &Dart) -> bool {
        let mut around = self.around(dart.x, dart.y);
        around.any(|sample| self.case.is_near(sample, dart))
    }

    /// Whether one sample is near all places of a square: its farthest corner, as if it had the least radius in the square.
    fn covers(&self, left: i64, bottom: i64, side: i64) -> bool {
        let least = self.case.least(left, bottom, side);
        let [right, top] = [left + side - 1, bottom + side - 1];
        let mut around = self.around(left, bottom);
        around.any(|sample| {
            let across = (sample.x - left).abs().max((sample.x - right).abs());
            let up = (sample.y - bottom).abs().max((sample.y - top).abs());
            let sum = sample.radius + least;
            let reach = (2 * sample.radius * least + sum - 1) / sum;
            across * across + up * up <= reach * reach
        })
    }
}

/// Returns all samples of the process, in the order of their arrival: with its coin those of the sampler.
fn maximal(case: &Case, coins: Coin) -> Vec<Dart> {
    let mut sampled = Sampled::new(case);
    let base = case.base_cells().into_iter();
    let mut active: Vec<Part> = base
        .map(|(left, bottom, side)| Part {
            left,
            bottom,
            side,
            base_side: side,
        })
        .collect();

    let mut level = 0;
    while !active.is_empty() {
        for throw in 0..throws(level) {
            let mut darts = Vec::new();
            for part in &active {
                case.part_darts(*part, coins, level, throw, &mut darts);
            }
            darts.sort_unstable();
            for dart in darts {
                if !sampled.is_refused(&dart) {
                    sampled.add(dart);
                }
            }
        }

        let quarters = active.iter().filter(|part| part.side > 1).flat_map(|part| {
            let side = part.side / 2;
            [(0, 0), (side, 0), (0, side), (side, side)].map(|(right, up)| Part {
                left: part.left + right,
                bottom: part.bottom + up,
                side,
                ..*part
            })
        });
        let max = case.domain.rect().max;
        let is_open = |part: &Part| {
            let begins_inside = part.left < max.x.into() && part.bottom < max.y.into();
            begins_inside && !sampled.covers(part.left, part.bottom, part.side)
        };
        active = quarters.filter(is_open).collect();
        level += 1;
    }
    sampled.samples
}

/// Returns N R^2 of each bin: 0.70 in a maximal set of one radius.
fn densities(samples: &[Dart], domains: usize) -> Vec<f64> {
    let mut sums = [0.0; BINS];
    for sample in samples {
        let radius = sample.radius as f64 / f64::from(R);
        let bin = ((radius - FIRST) / BIN).floor();
        if (0.0..BINS as f64).contains(&bin) {
            sums[bin as usize] += radius * radius;
        }
    }
    let area = BIN / SLOPE * SIZE[1] * domains as f64;
    sums.iter().map(|sum| sum / area).collect()
}

/// Whether the density does not depend on the radius, by the limits of the design (section 14).
fn is_even(densities: &[f64]) -> bool {
    densities
        .iter()
        .all(|density| (0.65..0.75).contains(density))
}

#[test]
fn the_coin_keeps_the_density_even_across_a_power_of_two() {
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for seed in SEEDS {
        let case = ramp(seed);
        let samples = maximal(&case, Coin::Thrown);
        // This process is that of the sampler, sample by sample: what follows from the coin alone is shown by leaving it out.
        let places: Vec<Point> = samples
            .iter()
            .map(|dart| Point::new(dart.x as i32, dart.y as i32))
            .collect();
        let sampler = varying_sample(&case.field(), &case.shape(), seed, &mut Unobserved);
        assert!(places == sampler.expect("samples"), "seed {seed}");
        with.extend(samples);

        let coinless = maximal(&case, Coin::LeftOut);
        let of_seed = densities(&coinless, 1);
        let extremes = |fold: fn(f64, f64) -> f64, start| of_seed.iter().copied().fold(start, fold);
        let (least, most) = (extremes(f64::min, 1.0), extremes(f64::max, 0.0));
        assert!(least < 0.6 && most > 0.8, "seed {seed}: {of_seed:?}");
        without.extend(coinless);
    }

    let even = densities(&with, SEEDS.len());
    assert!(is_even(&even), "{even:?}");
    // The control: the same process without its coin. The design saw 0.98 beside 0.45.
    let striped = densities(&without, SEEDS.len());
    assert!(!is_even(&striped), "{striped:?}");
    let count = |samples: &[Dart]| {
        let bin = |dart: &&Dart| (dart.radius as f64 / f64::from(R) - 2.0).abs() < BIN / 2.0;
        samples.iter().filter(bin).count()
    };
    assert!(count(&with) > 2_500);
    eprintln!("{} {even:.3?} {striped:.3?}", count(&with));
}
