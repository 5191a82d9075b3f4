// Threefry2x32-20 and numbers made of its words, as in core's random.rs.
// import: wide

fn rotate_left(word: u32, by: u32) -> u32 {
    return (word << by) | (word >> (32u - by));
}

fn threefry_round(x: vec2<u32>, rotation: u32) -> vec2<u32> {
    let sum = x.x + x.y;
    return vec2<u32>(sum, rotate_left(x.y, rotation) ^ sum);
}

// Rounds 0 to 3 of eight.
fn threefry_first(x: vec2<u32>) -> vec2<u32> {
    let half = threefry_round(threefry_round(x, 13u), 15u);
    return threefry_round(threefry_round(half, 26u), 6u);
}

// Rounds 4 to 7 of eight.
fn threefry_second(x: vec2<u32>) -> vec2<u32> {
    let half = threefry_round(threefry_round(x, 17u), 29u);
    return threefry_round(threefry_round(half, 16u), 24u);
}

// Unrolled, because an indexed array of keys or rotations would be kept in memory.
fn threefry(key: vec2<u32>, counter: vec2<u32>) -> vec2<u32> {
    let parity = 0x1BD11BDAu ^ key.x ^ key.y;
    var x = counter + key;
    x = threefry_first(x) + vec2<u32>(key.y, parity + 1u);
    x = threefry_second(x) + vec2<u32>(parity, key.x + 2u);
    x = threefry_first(x) + vec2<u32>(key.x, key.y + 3u);
    x = threefry_second(x) + vec2<u32>(key.y, parity + 4u);
    x = threefry_first(x) + vec2<u32>(parity, key.x + 5u);
    return x;
}

// The word mapped to [0, n).
fn below(word: u32, n: u32) -> u32 {
    return multiply_high(word, n);
}
