// The one predicate that decides everything, as core's lattice.rs.

fn covers_offset(offset: vec2<i32>) -> bool {
    let d = abs(offset);
    if d.x > R || d.y > R {
        return false;
    }
    // At most 2^31: exact in 32 bits.
    let u = vec2<u32>(d);
    return u.x * u.x + u.y * u.y <= u32(R) * u32(R);
}
