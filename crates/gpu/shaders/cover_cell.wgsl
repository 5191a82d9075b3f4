// Tests whether one sample covers all of a cell of the dart process, and computes the extent of such cells.
// import: grid
// import: frame
// import: lattice

// Returns the first coordinates beyond the domain.
fn domain_end() -> vec2<i32> {
    return vec2<i32>(i32(frame.side_x), i32(frame.side_y)) + select(1, 0, frame.periodic != 0u);
}

// Returns the extent of the part of a cell of side `side` that lies in the domain.
fn extent_of(low: vec2<i32>, side: i32) -> vec2<i32> {
    return min(vec2<i32>(side), domain_end() - vec2<i32>(domain_point(low))) - 1;
}

// Returns whether one sample covers every point from `low` to `low + extent`.
fn is_cell_covered(low: vec2<i32>, extent: vec2<i32>) -> bool {
    let first = cell_of(low - R);
    let last = cell_of(low + extent + R);
    for (var row = first.y; row <= last.y; row++) {
        for (var column = first.x; column <= last.x; column++) {
            let cell = 4u * cell_index(column, row);
            let count = grid_word(cell + 3u) & COUNT_MASK;
            for (var k = 0u; k < count; k++) {
                // If a sample covers the corner that is farthest from it, it covers the cell.
                let s = unpack(grid_word(cell + k), vec2<i32>(column, row));
                let away = max(abs(s - low), abs(s - low - extent));
                if covers_offset(away) {
                    return true;
                }
            }
        }
    }
    return false;
}
