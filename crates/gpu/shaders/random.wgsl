// Threefry2x32-20, as core's random.rs.

fn rotate_left(word: u32, by: u32) -> u32 {
    return (word << by) | (word >> (32u - by));
}

fn threefry(key: vec2<u32>, counter: vec2<u32>) -> vec2<u32> {
    var keys = array<u32, 3>(key.x, key.y, 0x1BD11BDAu ^ key.x ^ key.y);
    var rotations = array<u32, 8>(13u, 15u, 26u, 6u, 17u, 29u, 16u, 24u);
    var x = counter + key;
    for (var round = 0u; round < 20u; round++) {
        x.x += x.y;
        x.y = rotate_left(x.y, rotations[round % 8u]) ^ x.x;
        if round % 4u == 3u {
            let injection = round / 4u + 1u;
            x.x += keys[injection % 3u];
            x.y += keys[(injection + 1u) % 3u] + injection;
        }
    }
    return x;
}
