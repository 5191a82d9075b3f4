// Marks the detectors of iteration 1: survivors near a sample that was eliminated or dropped.
// import: frame
// import: wide
// import: tiled

fn run(index: u32) {
    if index >= frame.cells {
        return;
    }
    let count = grid[4u * index + 3u] & COUNT_MASK;
    let at = column_row(index);
    // The padding holds no survivors.
    if count == 0u || at.x < 0 || at.y < 0 || at.x >= frame.columns || at.y >= frame.rows {
        return;
    }

    // DETECTOR_REACH is 2 r and 4 units, so lost samples are at most three cells away.
    for (var row = at.y - 3; row <= at.y + 3; row++) {
        for (var column = at.x - 3; column <= at.x + 3; column++) {
            let cell = cell_index(column, row);
            if (grid[4u * cell + 3u] & FLAG_LOST) != 0u {
                mark(index, at, cell, vec2<i32>(column, row));
            }
        }
    }
}

// Marks the survivors of a cell that are near a lost sample of another one.
fn mark(index: u32, at: vec2<i32>, cell: u32, there: vec2<i32>) {
    let limit = wide_multiply(DETECTOR_REACH, DETECTOR_REACH);
    let count = grid[4u * index + 3u] & COUNT_MASK;

    for (var k = starts[cell]; k < end_of(cell); k++) {
        if (places[k] & FATE_MASK) != FATE_LOST {
            continue;
        }
        let lost = unpack(places[k], there);

        for (var slot = 0u; slot < count; slot++) {
            let s = unpack(grid[4u * index + slot], at);
            if !wide_less(limit, wide_norm_squared(lost - s)) {
                grid[4u * index + slot] |= DETECTOR;
            }
        }
    }
}
