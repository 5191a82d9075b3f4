// Exact points equally far from two or three samples, rounded half up to the lattice, as core's circumcentre.rs. Floats
// estimate a quotient; the remainder, in 64 bits, decides it.
// import: wide

// A rounded quotient; `value` is 0 if it does not exist.
struct Rounded {
    exists: bool,
    value: i32,
}

// A point, as the offset from the sample at 0; `offset` is 0 if it does not exist.
struct Centre {
    exists: bool,
    offset: vec2<i32>,
}

// The largest magnitude of a rounded quotient that exists, 8 r. Points farther from a sample are never needed.
const ROUNDED_LIMIT: i32 = 262144;

// numerator / denominator, rounded to the nearest integer, halves upwards. It exists where the
// denominator is not 0 and the rounded value q is at most 2^18 in magnitude, on every device alike.
// Both arguments must be below 2^57 in magnitude.
//
// One correction is enough. Let Q be the exact quotient, e the estimate, t the integer nearest to e.
// Numerator and denominator are converted within 2^-21 of themselves, and WGSL's division is within
// 2.5 units in the last place, 2.5 * 2^-23 of the result. Together e is within 2.7 * 2^-21 of Q,
// relative to Q.
// - Where |e| > 2^18 + 2, |Q| > 2^18 + 1, so |q| > 2^18: q does not exist.
// - Otherwise |Q| < 2^18 + 3, so |e - Q| < 0.34. With |t - e| <= 1/2 and |Q - q| <= 1/2 it follows
//   that |t - q| < 2: t is q or a neighbour of it. An error of 2^-19 would do as well.
// For a positive d, q is the integer with -d <= 2 (n - q d) < d, of which t breaks one side at most,
// that of q. |t d| <= |n| + 2 d, so nothing here leaves 64 bits.
fn round_half_up(numerator: vec2<u32>, denominator: vec2<u32>) -> Rounded {
    let flip = wide_is_negative(denominator);
    let n = select(numerator, wide_negate(numerator), flip);
    let d = select(denominator, wide_negate(denominator), flip);
    if all(d == vec2<u32>(0u, 0u)) {
        return Rounded(false, 0);
    }

    let estimate = wide_to_f32(n) / wide_to_f32(d);
    if abs(estimate) > f32(ROUNDED_LIMIT + 2) {
        return Rounded(false, 0);
    }

    let t = i32(round(estimate));
    let rest = wide_sub(n, wide_times(d, t));
    let twice = wide_add(rest, rest);
    let q = t + i32(!wide_less(twice, d)) - i32(wide_less(twice, wide_negate(d)));

    if abs(q) > ROUNDED_LIMIT {
        return Rounded(false, 0);
    }
    return Rounded(true, q);
}

// The circumcentre of the triangle (0, a, b), where the three are not collinear and both of its
// coordinates are at most 2^18 in magnitude. Components of a and b must be at most 2^18 in
// magnitude: then squares are at most 2^37, the denominator 2^38, numerators 2^56.
fn circumcentre(a: vec2<i32>, b: vec2<i32>) -> Centre {
    let cross = wide_sub(wide_multiply(a.x, b.y), wide_multiply(a.y, b.x));
    let denominator = wide_add(cross, cross);
    let a2 = wide_norm_squared(a);
    let b2 = wide_norm_squared(b);

    let x = round_half_up(wide_sub(wide_times(a2, b.y), wide_times(b2, a.y)), denominator);
    if !x.exists {
        return Centre(false, vec2<i32>(0, 0));
    }
    let y = round_half_up(wide_sub(wide_times(b2, a.x), wide_times(a2, b.x)), denominator);
    if !y.exists {
        return Centre(false, vec2<i32>(0, 0));
    }
    return Centre(true, vec2<i32>(x.value, y.value));
}

// The second coordinate of the point on the line "first coordinate = line" that is as far from 0 as from m, where m has
// an extent along the line and the coordinate is at most 2^18 in magnitude. For a horizontal line swap the coordinates
// of m. |line| and the components of m must be at most 2^18.
fn on_line(line: i32, m: vec2<i32>) -> Rounded {
    let numerator = wide_sub(wide_norm_squared(m), wide_multiply(2 * line, m.x));
    return round_half_up(numerator, wide_from(2 * m.y));
}
