// The predicate on which all decisions rest, as in core's lattice.rs: whether a sample covers a point at this offset,
// and so whether two samples are in conflict.

fn covers_offset(offset: vec2<i32>) -> bool {
    // Compare with both ends, because the magnitude of -2^31 does not fit an i32.
    if any(offset < vec2<i32>(-R)) || any(offset > vec2<i32>(R)) {
        return false;
    }
    // Each at most 2^30, together at most 2^31: exact in 32 bits.
    let squares = vec2<u32>(offset * offset);
    return squares.x + squares.y <= u32(R) * u32(R);
}
