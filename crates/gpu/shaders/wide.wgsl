// 64-bit integers in two's complement: x holds the low word, y the high one. Results are modulo 2^64, so results that
// fit 64 bits are exact.

fn wide_from(a: i32) -> vec2<u32> {
    // The shift spreads the sign over the high word.
    return vec2<u32>(bitcast<u32>(a), bitcast<u32>(a >> 31u));
}

fn wide_add(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + u32(low < a.x));
}

fn wide_sub(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x - b.x, a.y - b.y - u32(a.x < b.x));
}

fn wide_negate(a: vec2<u32>) -> vec2<u32> {
    return wide_sub(vec2<u32>(0u, 0u), a);
}

fn wide_is_negative(a: vec2<u32>) -> bool {
    return (a.y >> 31u) != 0u;
}

// Signed.
fn wide_less(a: vec2<u32>, b: vec2<u32>) -> bool {
    return select(bitcast<i32>(a.y) < bitcast<i32>(b.y), a.x < b.x, a.y == b.y);
}

// The high word of the unsigned product.
fn multiply_high(a: u32, b: u32) -> u32 {
    let a0 = a & 0xFFFFu;
    let a1 = a >> 16u;
    let b0 = b & 0xFFFFu;
    let b1 = b >> 16u;
    // Neither sum overflows: (2^16 - 1)^2 + 2^16 - 1 < 2^32.
    let middle = a1 * b0 + ((a0 * b0) >> 16u);
    let carried = a0 * b1 + (middle & 0xFFFFu);
    return a1 * b1 + (middle >> 16u) + (carried >> 16u);
}

// Exact: at most 2^62 in magnitude.
fn wide_multiply(a: i32, b: i32) -> vec2<u32> {
    return wide_times(wide_from(a), b);
}

// Modulo 2^64, exact where the product fits.
fn wide_times(a: vec2<u32>, b: i32) -> vec2<u32> {
    let word = bitcast<u32>(b);
    // A negative b is word - 2^32: its product has 2^32 a less.
    let excess = select(0u, a.x, b < 0);
    return vec2<u32>(a.x * word, multiply_high(a.x, word) + a.y * word - excess);
}

// The squared length. If both components are -2^31 it is 2^63, which is correct only as an unsigned number; otherwise
// it is less, and never negative.
fn wide_norm_squared(d: vec2<i32>) -> vec2<u32> {
    return wide_add(wide_multiply(d.x, d.x), wide_multiply(d.y, d.y));
}

// The nearest float or one close to it, of the same sign, with a relative error below 2^-21; 0 is
// exact. Each word's conversion and the sum may be rounded either way, by less than 2^-23 of its
// magnitude; all terms have one sign, so that the errors are at most (1 + 2^-23)^2 - 1 together.
fn wide_to_f32(a: vec2<u32>) -> f32 {
    let negative = wide_is_negative(a);
    let magnitude = select(a, wide_negate(a), negative);
    let value = f32(magnitude.y) * 4294967296.0 + f32(magnitude.x);
    return select(value, -value, negative);
}
