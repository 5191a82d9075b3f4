// Looks at the darts around places, cell by cell. Opposite ends of a periodic domain are joined.
// import: arrival
// import: lattice

// Calls `visit`, which the pass defines, with the index of each dart in the cells that a rectangle touches, and with how far the
// dart must be moved to be beside the rectangle. Ends when `visit` returns true; returns whether it did.
fn any_near(low: vec2<i32>, high: vec2<i32>) -> bool {
    let end = vec2<i32>(ground.end_x, ground.end_y);
    let joins = vec2<bool>(ground.periodic != 0u);
    // Only where the rectangle reaches beyond an end, the cells at the other end are near it, too.
    let first_turn = select(vec2<i32>(0), vec2<i32>(-1), joins & (low < vec2<i32>(0)));
    let last_turn = select(vec2<i32>(0), vec2<i32>(1), joins & (high >= end));

    for (var up = first_turn.y; up <= last_turn.y; up++) {
        for (var right = first_turn.x; right <= last_turn.x; right++) {
            let moved = vec2<i32>(right, up) * end;
            let part_low = max(low - moved, vec2<i32>(0));
            let part_high = min(high - moved, end - 1);
            if all(part_low <= part_high) && any_in(part_low, part_high, moved) {
                return true;
            }
        }
    }
    return false;
}

fn any_in(low: vec2<i32>, high: vec2<i32>, moved: vec2<i32>) -> bool {
    let first = vec2<u32>(low) >> vec2<u32>(CELL_BITS);
    let last = vec2<u32>(high) >> vec2<u32>(CELL_BITS);
    for (var row = first.y; row <= last.y; row++) {
        for (var column = first.x; column <= last.x; column++) {
            var next = heads[row * ground.columns + column];
            // A list has each dart at most once. The bound ends one that an injected fault has closed to a ring.
            for (var left = arrayLength(&darts); next != 0u && left > 0u; left--) {
                if visit(next - 1u, moved) {
                    return true;
                }
                next = darts[next - 1u].next;
            }
        }
    }
    return false;
}
