//! Compares the arithmetic of shaders, run on a device, with core's: every function, bit for bit. One software adapter
//! is enough; without an adapter the tests fail.

use crate::support::device::demand;
use crate::support::inputs::{
    Numbers, OFFSET_LIMIT, halves, joined, lines, offset, offsets, quotients, rim, triangles, words,
};
use crate::support::{Words, check, compare, source, spoilt};
use glam::{I64Vec2, IVec2};
use tilescope_core::{
    R_SQUARED, below, circumcentre, covers_offset, on_line, round_half_up, threefry2x32_20,
};
use tilescope_gpu::{Choice, Gpu};

/// The number of random inputs for each function.
const MANY: usize = 2_000_000;

/// Returns a 64-bit number as an answer.
const fn wide(value: i64) -> Words {
    let [low, high] = halves(value);
    [low, high, 0, 0]
}

/// Returns the expected answer of a shader for rounded values: all of them, or zeros if one exceeds the limit.
fn existing(values: &[i64]) -> Words {
    if values.iter().any(|value| value.abs() > OFFSET_LIMIT) {
        return [0; 4];
    }
    let word = |place: usize| values.get(place).map_or(0, |value| *value as u32);
    [1, word(0), word(1), 0]
}

fn rounded([a, b, c, d]: Words) -> Words {
    match joined(c, d) {
        0 => [0; 4],
        denominator => existing(&[round_half_up(joined(a, b), denominator)]),
    }
}

fn centre([a, b, c, d]: Words) -> Words {
    circumcentre(offset(a, b), offset(c, d)).map_or([0; 4], |c| existing(&c.to_array()))
}

fn crossing([line, _, x, y]: Words) -> Words {
    on_line((line as i32).into(), offset(x, y)).map_or([0; 4], |value| existing(&[value]))
}

fn drawn([a, b, c, d]: Words) -> Words {
    let [x, y] = threefry2x32_20([a, b], [c, d]);
    [x, y, 0, 0]
}

fn covered([x, y, ..]: Words) -> Words {
    [
        covers_offset(IVec2::new(x as i32, y as i32)).into(),
        0,
        0,
        0,
    ]
}

fn product([a, b, ..]: Words) -> Words {
    wide(i64::from(a as i32) * i64::from(b as i32))
}

const ROUND: &str = "let q = round_half_up(w.xy, w.zw);
    return vec4<u32>(u32(q.exists), bitcast<u32>(q.value), 0u, 0u);";
const CENTRE: &str = "let c = circumcentre(bitcast<vec2<i32>>(w.xy), bitcast<vec2<i32>>(w.zw));
    return vec4<u32>(u32(c.exists), bitcast<vec2<u32>>(c.offset), 0u);";
const LINE: &str = "let q = on_line(bitcast<i32>(w.x), bitcast<vec2<i32>>(w.zw));
    return vec4<u32>(u32(q.exists), bitcast<u32>(q.value), 0u, 0u);";
const DRAW: &str = "return vec4<u32>(threefry(w.xy, w.zw), 0u, 0u);";
const BELOW: &str = "return vec4<u32>(below(w.x, w.y), 0u, 0u, 0u);";
const COVERS: &str = "return vec4<u32>(u32(covers_offset(bitcast<vec2<i32>>(w.xy))), 0u, 0u, 0u);";
const MULTIPLY: &str =
    "return vec4<u32>(wide_multiply(bitcast<i32>(w.x), bitcast<i32>(w.y)), 0u, 0u);";

#[test]
fn wide_sums_and_differences_are_those_of_64_bits() {
    let inputs = words(1, MANY);
    let pairs = |[a, b, c, d]: Words| (joined(a, b), joined(c, d));
    let add = source("wide", "return vec4<u32>(wide_add(w.xy, w.zw), 0u, 0u);");
    let sub = source("wide", "return vec4<u32>(wide_sub(w.xy, w.zw), 0u, 0u);");
    let add = compare(&add, &inputs, |w| {
        let (a, b) = pairs(w);
        wide(a.wrapping_add(b))
    });
    let sub = compare(&sub, &inputs, |w| {
        let (a, b) = pairs(w);
        wide(a.wrapping_sub(b))
    });
    assert_eq!((add, sub), (Ok(inputs.len()), Ok(inputs.len())));
}

#[test]
fn wide_signs_and_comparisons_are_those_of_64_bits() {
    let inputs = words(2, MANY);
    let body = "return vec4<u32>(wide_negate(w.xy),
        u32(wide_is_negative(w.xy)) + 2u * u32(wide_less(w.xy, w.zw)), wide_from(bitcast<i32>(w.z)).y);";
    let result = compare(&source("wide", body), &inputs, |[a, b, c, d]| {
        let (first, second) = (joined(a, b), joined(c, d));
        let [low, high] = halves(first.wrapping_neg());
        let flags = u32::from(first < 0) + 2 * u32::from(first < second);
        [low, high, flags, halves((c as i32).into())[1]]
    });
    assert_eq!(result, Ok(inputs.len()));
    // Equal numbers, and numbers that differ in the low word alone, which random ones rarely do.
    let near: Vec<Words> = inputs.iter().map(|w| [w[0], w[1], w[2], w[1]]).collect();
    let body = "return vec4<u32>(u32(wide_less(w.xy, w.zw)), u32(wide_less(w.xy, w.xy)),
        wide_from(bitcast<i32>(w.x)));";
    let result = compare(&source("wide", body), &near, |[a, b, c, d]| {
        let [low, high] = halves((a as i32).into());
        [u32::from(joined(a, b) < joined(c, d)), 0, low, high]
    });
    assert_eq!(result, Ok(near.len()));
}

#[test]
fn wide_products_are_those_of_64_bits() {
    let inputs = words(3, MANY);
    let result = compare(&source("wide", MULTIPLY), &inputs, product);
    assert_eq!(result, Ok(inputs.len()));
    let times =
        "return vec4<u32>(wide_times(w.xy, bitcast<i32>(w.z)), multiply_high(w.x, w.z), 0u);";
    let result = compare(&source("wide", times), &inputs, |[a, b, c, _]| {
        let [low, high] = halves(joined(a, b).wrapping_mul((c as i32).into()));
        [low, high, below(a, c), 0]
    });
    assert_eq!(result, Ok(inputs.len()));
    let norm = "return vec4<u32>(wide_norm_squared(bitcast<vec2<i32>>(w.xy)), 0u, 0u);";
    let result = compare(&source("wide", norm), &inputs, |[a, b, ..]| {
        let I64Vec2 { x, y } = offset(a, b);
        wide((x * x).wrapping_add(y * y))
    });
    assert_eq!(result, Ok(inputs.len()));
}

#[test]
fn wide_numbers_become_floats_within_the_stated_error() {
    let mut inputs = words(4, MANY);
    let mut numbers = Numbers::new(5);
    inputs.extend((0..MANY).map(|_| wide(numbers.of_bits(63))));
    let body = "return vec4<u32>(bitcast<u32>(wide_to_f32(w.xy)), 0u, 0u, 0u);";
    let result = check(&source("wide", body), &inputs, |[a, b, ..], answer| {
        let (exact, float) = (i128::from(joined(a, b)), f32::from_bits(answer[0]));
        // Whole wherever it is not below 2^24, and so exact as an integer.
        let error = float as i128 - exact;
        let holds = float.is_finite() && error.abs() << 21 <= exact.abs() && float.fract() == 0.0;
        holds
            .then_some(())
            .ok_or_else(|| format!("{exact} became {float}"))
    });
    assert_eq!(result, Ok(inputs.len()));
}

#[test]
fn quotients_are_rounded_as_core_rounds_them() {
    let inputs = quotients(6, 2 * MANY);
    let zeros = inputs.iter().filter(|w| joined(w[2], w[3]) == 0).count();
    let halves = inputs.iter().filter(|w| is_half(**w)).count();
    let existing = inputs.iter().filter(|w| rounded(**w)[0] == 1).count();
    assert!(zeros > 10_000 && halves > 100_000 && existing > 1_000_000);
    let result = compare(&source("circumcentre", ROUND), &inputs, rounded);
    assert_eq!(result, Ok(inputs.len()));
}

/// Returns whether the quotient is a whole number and a half.
fn is_half([a, b, c, d]: Words) -> bool {
    let (n, d) = (joined(a, b), joined(c, d));
    d != 0 && (2 * n) % d == 0 && n % d != 0
}

#[test]
fn circumcentres_are_those_of_core() {
    let inputs = triangles(7, 2 * MANY);
    let exact = |w: &Words| circumcentre(offset(w[0], w[1]), offset(w[2], w[3]));
    let collinear = inputs.iter().filter(|w| exact(w).is_none()).count();
    let far = inputs
        .iter()
        .filter(|w| exact(w).is_some() && centre(**w) == [0; 4]);
    let far = far.count();
    assert!(collinear > 10_000 && far > 100_000 && inputs.len() - far - collinear > MANY);
    let result = compare(&source("circumcentre", CENTRE), &inputs, centre);
    assert_eq!(result, Ok(inputs.len()));
}

#[test]
fn places_on_lines_are_those_of_core() {
    let inputs = lines(8, 2 * MANY);
    let result = compare(&source("circumcentre", LINE), &inputs, crossing);
    assert_eq!(result, Ok(inputs.len()));
}

#[test]
fn random_words_are_those_of_core_and_of_the_published_answers() {
    let known = [
        ([0; 4], [0x6b20_0159, 0x99ba_4efe]),
        ([u32::MAX; 4], [0x1cb9_96fc, 0xbb00_2be7]),
        (
            [0x1319_8a2e, 0x0370_7344, 0x243f_6a88, 0x85a3_08d3],
            [0xc492_3a9c, 0x483d_f7a0],
        ),
    ];
    let draw = source("random", DRAW);
    for (input, [x, y]) in known {
        assert_eq!(compare(&draw, &[input], |_| [x, y, 0, 0]), Ok(1));
    }
    let inputs = words(9, MANY);
    assert_eq!(compare(&draw, &inputs, drawn), Ok(inputs.len()));
    let result = compare(&source("random", BELOW), &inputs, |[word, n, ..]| {
        [below(word, n), 0, 0, 0]
    });
    assert_eq!(result, Ok(inputs.len()));
}

#[test]
fn a_sample_covers_the_same_places_as_in_core() {
    let mut inputs = rim();
    let at = |squared: i64| {
        let is_at = |w: &&Words| offset(w[0], w[1]).length_squared() == squared;
        inputs.iter().filter(is_at).count()
    };
    assert!(at(R_SQUARED) >= 4 && at(R_SQUARED + 1) >= 8);
    inputs.extend(words(10, MANY));
    let mut numbers = Numbers::new(11);
    inputs.extend((0..MANY).map(|_| {
        let offset = I64Vec2::new(numbers.of_bits(16), numbers.of_bits(16));
        offsets(offset, I64Vec2::ZERO)
    }));
    let result = compare(&source("lattice", COVERS), &inputs, covered);
    assert_eq!(result, Ok(inputs.len()));
}

/// Runs a shader unchanged, which must pass, and with one part replaced, which must fail.
fn catch(
    (file, body): (&str, &str),
    inputs: &[Words],
    core: fn(Words) -> Words,
    variants: &[(&str, &str)],
) {
    let right = source(file, body);
    assert_eq!(compare(&right, inputs, core), Ok(inputs.len()));
    for (part, other) in variants {
        let result = compare(&spoilt(&right, part, other), inputs, core);
        assert!(
            result.is_err_and(|error| error.contains(", not [")),
            "{part}"
        );
    }
}

#[test]
fn wrong_exact_places_are_caught() {
    let few = MANY / 10;
    let correction = "t + i32(!wide_less(twice, d)) - i32(wide_less(twice, wide_negate(d)));";
    let rounding = [
        (correction, "t;"),
        ("!wide_less(twice, d)", "wide_less(d, twice)"),
        ("abs(q) > ROUNDED_LIMIT", "abs(q) >= ROUNDED_LIMIT"),
        ("all(d == ", "all(n == "),
    ];
    let circumcentre = "circumcentre";
    catch(
        (circumcentre, ROUND),
        &quotients(12, few),
        rounded,
        &rounding,
    );
    let swapped = [("wide_times(b2, a.y)", "wide_times(b2, a.x)")];
    catch(
        (circumcentre, CENTRE),
        &triangles(13, few),
        centre,
        &swapped,
    );
    catch(
        (circumcentre, LINE),
        &lines(14, few),
        crossing,
        &[("2 * line", "line")],
    );
}

#[test]
fn wrong_words_are_caught() {
    let inputs = words(15, MANY / 10);
    let carries = [(" - excess", ""), (" + (carried >> 16u)", "")];
    catch(("wide", MULTIPLY), &inputs, product, &carries);
    let rounds = [("16u), 24u)", "16u), 23u)"), ("key.y + 3u", "key.y + 2u")];
    catch(("random", DRAW), &inputs, drawn, &rounds);
}

#[test]
fn wrong_rims_are_caught() {
    let mut inputs = rim();
    let rims = [
        ("<= u32(R)", "< u32(R)"),
        ("<= u32(R) *", "<= 1u + u32(R) *"),
    ];
    catch(("lattice", COVERS), &inputs, covered, &rims);
    // The magnitude of -2^31 is -2^31, and its square ends in 32 zeros.
    inputs.extend(words(16, 1));
    let careless = [(
        "any(offset < vec2<i32>(-R)) || any(offset > vec2<i32>(R))",
        "any(abs(offset) > vec2<i32>(R))",
    )];
    catch(("lattice", COVERS), &inputs, covered, &careless);
}

#[test]
#[should_panic(expected = "these tests need a GPU adapter")]
fn a_missing_adapter_fails_the_tests() {
    let _ = demand(pollster::block_on(Gpu::open(&Choice {
        name: Some("no adapter has this name".to_owned()),
        ..Choice::default()
    })));
}
