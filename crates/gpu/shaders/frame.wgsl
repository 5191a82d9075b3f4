// Cells and points of the frame.

// Returns the index of the cell (column, row), which may lie in the padding.
fn cell_index(column: i32, row: i32) -> u32 {
    return u32((row + PAD) * i32(frame.stride) + column + PAD);
}

// Returns column and row of a cell. In the padding they are below 0 or beyond the last.
fn column_row(cell: u32) -> vec2<i32> {
    return vec2<i32>(i32(cell % frame.stride), i32(cell / frame.stride)) - PAD;
}

// Returns the point of a packed sample of the cell (column, row).
fn unpack(packed: u32, at: vec2<i32>) -> vec2<i32> {
    return (at << vec2<u32>(CELL_BITS)) | vec2<i32>(i32(packed & LOW), i32((packed >> CELL_BITS) & LOW));
}

fn pack(p: vec2<i32>) -> u32 {
    return ((u32(p.y) & LOW) << CELL_BITS) | (u32(p.x) & LOW);
}

fn cell_of(p: vec2<i32>) -> vec2<i32> {
    return p >> vec2<u32>(CELL_BITS);
}

// Returns the lattice point of the domain at a point of the frame.
fn domain_point(p: vec2<i32>) -> vec2<u32> {
    let sum = vec2<u32>(frame.origin_x, frame.origin_y) + vec2<u32>(p);
    if frame.periodic == 0u {
        return sum;
    }
    return sum % vec2<u32>(frame.side_x, frame.side_y);
}

fn in_window(p: vec2<i32>) -> bool {
    return p.x >= frame.window_min_x && p.x < frame.window_max_x
        && p.y >= frame.window_min_y && p.y < frame.window_max_y;
}

// Returns whether a point lies in the frame, and so inside a bounded domain.
fn holds(p: vec2<i32>) -> bool {
    return p.x >= 0 && p.y >= 0 && p.x < frame.end_x && p.y < frame.end_y;
}

// Returns whether the window touches a cell.
fn touches_window(at: vec2<i32>) -> bool {
    let low = at << vec2<u32>(CELL_BITS);
    return low.x + R > frame.window_min_x && low.x < frame.window_max_x
        && low.y + R > frame.window_min_y && low.y < frame.window_max_y;
}

// Returns whether a cell is an outermost one on a side beyond which the plane continues.
fn is_edge(at: vec2<i32>) -> bool {
    return (at.x == 0 && (frame.goes_on & 1u) != 0u)
        || (at.x == frame.columns - 1 && (frame.goes_on & 2u) != 0u)
        || (at.y == 0 && (frame.goes_on & 4u) != 0u)
        || (at.y == frame.rows - 1 && (frame.goes_on & 8u) != 0u);
}
