//! Sets of balls against the definition: all darts of the first levels, none left out in advance, taken one after another,
//! each compared with all samples.

use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use tilescope_core::{
    Boundary, Key, R, SampleError, SolidDomain, Stage, Stream, Unobserved, solid_arrivals,
    solid_arrivals_parallel, solid_sample, solid_sample_parallel,
};

/// The darts of so many levels are thrown everywhere: there are about 820 to a cubed radius.
const LEVELS: u32 = 4;

/// A dart: when it arrives, and where.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Dart {
    level: u32,
    throw: u32,
    rank: u32,
    z: i32,
    y: i32,
    x: i32,
}

impl Dart {
    const fn place(&self) -> [i32; 3] {
        [self.x, self.y, self.z]
    }
}

/// Cumulative probabilities of a Poisson count of mean 1.4, times 2^32.
fn thresholds() -> Vec<u64> {
    let (mut probability, mut sum) = ((-1.4_f64).exp(), 0.0);
    let mut found = Vec::new();
    for count in 1..14 {
        sum += probability;
        found.push((sum * 2_f64.powi(32)).round() as u64);
        probability *= 1.4 / f64::from(count);
    }
    found
}

/// All darts of a throw that land in the domain.
fn thrown(domain: &SolidDomain, seed: u64, level: u32, throw: u32, out: &mut Vec<Dart>) {
    let key = Key::from_seed(seed)
        .derive(Stream::Level, level)
        .derive(Stream::Throw, throw);
    let thresholds = thresholds();
    let closed = i32::from(domain.boundary() == Boundary::Bounded);
    let ends = domain.sides().map(|side| side + closed);
    let side = R >> level;
    let starts = |axis: usize| (0..ends[axis]).step_by(side as usize);

    for z in starts(2) {
        let plane = key.derive(Stream::Depth, z as u32);
        for (y, x) in starts(1).flat_map(|y| starts(0).map(move |x| (y, x))) {
            let cube = plane.derive_at(x, y);
            let word = u64::from(cube.words()[0]);
            let count = thresholds.iter().filter(|&&bound| word >= bound).count();
            for index in 0..count as u32 {
                let [a, b] = cube.draw(Stream::Dart, index);
                // The highest 15 bits of a word, the 15 after them and two, and the highest 15 of the other.
                let [right, up, deep] =
                    [a >> 17, (a >> 2) % (1 << 15), b >> 17].map(|bits| (bits >> level) as i32);
                let [rank, _] = cube.draw(Stream::Rank, index);
                let dart = Dart {
                    level,
                    throw,
                    rank,
                    z: z + deep,
                    y: y + up,
                    x: x + right,
                };
                if (0..3).all(|axis| dart.place()[axis] < ends[axis]) {
                    out.push(dart);
                }
            }
        }
    }
}

fn is_near(domain: &SolidDomain, a: [i32; 3], b: [i32; 3]) -> bool {
    let squared = |axis: usize| {
        let plain = i64::from((a[axis] - b[axis]).abs());
        let around = i64::from(domain.sides()[axis]) - plain;
        match domain.boundary() {
            Boundary::Periodic => plain.min(around).pow(2),
            Boundary::Bounded => plain.pow(2),
        }
    };
    squared(0) + squared(1) + squared(2) <= 1 << 30
}

/// The samples that arrive in the first levels, each with its level.
fn defined(domain: &SolidDomain, seed: u64) -> Vec<([i32; 3], u8)> {
    let mut darts = Vec::new();
    for level in 0..LEVELS {
        for throw in 0..if level == 0 { 4 } else { 1 } {
            thrown(domain, seed, level, throw, &mut darts);
        }
    }
    darts.sort_unstable();

    let mut samples: Vec<([i32; 3], u8)> = Vec::new();
    for dart in darts {
        let place = dart.place();
        if !samples
            .iter()
            .any(|&(sample, _)| is_near(domain, sample, place))
        {
            samples.push((place, dart.level as u8));
        }
    }
    samples
}

fn domains() -> impl Strategy<Value = SolidDomain> {
    // Whole sides, sides a few units longer, and any sides: cells of R are cut by the domain in all ways.
    let side = prop_oneof![
        (4_u32..7).prop_map(f64::from),
        (4_u32..7, 1_u32..5)
            .prop_map(|(whole, units)| f64::from(whole) + (f64::from(units) + 0.5) / f64::from(R)),
        4.0..6.5_f64,
    ];
    (prop::array::uniform3(side), any::<bool>()).prop_map(|(size, is_periodic)| {
        SolidDomain::from_size(size, 1.0, Boundary::of(is_periodic)).expect("a domain")
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(128), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_first_samples_are_those_of_the_definition(domain in domains(), seed: u64) {
        let made = solid_arrivals(domain, seed, &mut Unobserved).expect("samples");
        let defined = defined(&domain, seed);
        let samples = made.places;
        prop_assert!(defined.len() <= samples.len());
        let arrived: Vec<_> = samples.iter().copied().zip(made.levels.of_samples()).collect();
        prop_assert_eq!(&arrived[..defined.len()], &defined[..]);
        // All others arrive at later levels.
        prop_assert_eq!(arrived.len(), samples.len());
        prop_assert!(arrived[defined.len()..].iter().all(|&(_, level)| u32::from(level) >= LEVELS));

        // Later samples are in no conflict, either.
        for (k, &sample) in samples.iter().enumerate().skip(defined.len()) {
            prop_assert!(!samples[..k].iter().any(|&other| is_near(&domain, other, sample)));
        }
    }
}

/// Boxes of one and several parcels of eight radii, which end within them in all ways: at a parcel's side, a few units beside it,
/// and anywhere; thin ones and long ones.
fn hostile_domains() -> impl Strategy<Value = SolidDomain> {
    let side = prop_oneof![
        4.0..6.5_f64,
        prop::sample::select(vec![4.0, 8.0, 16.0]),
        (prop::sample::select(vec![5_u32, 8, 9, 16]), 0_u32..4)
            .prop_map(|(whole, units)| f64::from(whole) + (f64::from(units) + 0.5) / f64::from(R)),
        7.9..17.1_f64,
    ];
    // One side may be long where the others are short: larger boxes would take too long.
    (
        side,
        4.0..9.0_f64,
        prop_oneof![4.0..5.0_f64, Just(8.0)],
        0_usize..3,
        any::<bool>(),
    )
        .prop_map(|(long, middle, short, turns, is_periodic)| {
            let mut size = [long, middle, short];
            size.rotate_left(turns);
            SolidDomain::from_size(size, 1.0, Boundary::of(is_periodic)).expect("a domain")
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(400), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_engine_for_threads_makes_the_set_of_the_other_one(
        domain in hostile_domains(),
        seed: u64,
        threads in 1_usize..6,
    ) {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let made = |seed| pool.install(|| solid_arrivals_parallel(domain, seed, &mut Unobserved));
        // Places, their order and their levels.
        let expected = solid_arrivals(domain, seed, &mut Unobserved);
        prop_assert_eq!(&made(seed), &expected);
        // Another seed makes another set: the comparison can fail.
        prop_assert_ne!(&made(seed ^ 1), &expected);
    }
}

/// The longest side that a box may have: coordinates take nearly all of 32 bits. Places beyond both ends of the axis are near
/// each other, and sums of them wrap.
#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn the_longest_boxes_are_equal() {
    for (size, boundary) in [
        ([65_532.0, 4.0, 4.0], Boundary::Periodic),
        ([4.0, 4.000_06, 65_531.9], Boundary::Bounded),
    ] {
        let domain = SolidDomain::from_size(size, 1.0, boundary).expect("a domain");
        let expected = solid_sample(domain, 3, &mut Unobserved).expect("samples");
        let made = solid_sample_parallel(domain, 3, &mut Unobserved).expect("samples");
        assert!(made == expected, "{size:?} {boundary:?}");
    }
}

/// Parcels between others on every axis are only in larger sets.
#[test]
fn larger_sets_are_equal_on_any_number_of_threads() {
    let domain = SolidDomain::from_size([22.3, 19.0, 24.6], 1.0, Boundary::Periodic).unwrap();
    let samples = solid_sample(domain, 5, &mut Unobserved).unwrap();
    let density = samples.len() as f64 / domain.volume_radii();
    assert!((0.725..0.742).contains(&density), "{density}");
    for threads in tilescope_tests::some([3, 1, 2, 8]) {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads");
        let parallel = pool.install(|| solid_sample_parallel(domain, 5, &mut Unobserved));
        assert_eq!(parallel.as_ref(), Ok(&samples));
    }
}

/// The sequence is pinned: it must never change, on any machine.
#[test]
fn the_samples_of_a_seed_are_pinned() {
    let domain = SolidDomain::from_size([9.0; 3], 1.0, Boundary::Periodic).unwrap();
    let samples = solid_sample(domain, 1, &mut Unobserved).unwrap();
    let mixed = samples.iter().flatten().fold(0_u64, |hash, &value| {
        let mixed = (hash ^ value as u64).wrapping_mul(0x100_0000_01b3);
        mixed.rotate_left(17)
    });
    assert_eq!((samples.len(), mixed), (539, 0x2fba_ca0f_c2e1_08df));
}

#[test]
fn cancelling_is_an_error_that_says_where() {
    let domain = SolidDomain::from_size([5.0; 3], 1.0, Boundary::Bounded).unwrap();
    for sample in [solid_sample, solid_sample_parallel] {
        let mut stop = |_| std::ops::ControlFlow::Break(());
        let stage = Stage::Iterate(1);
        assert_eq!(
            sample(domain, 0, &mut stop),
            Err(SampleError::Cancelled { stage })
        );
    }
}
