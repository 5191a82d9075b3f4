// Makes cells unsure: whether some samples are in them depends on what lies beyond the frame.
// import: frame

fn make_unsure(cell: u32, at: vec2<i32>) {
    let before = atomicOr(&grid[4u * cell + 3u], FLAG_UNSURE);
    if (before & FLAG_UNSURE) != 0u {
        return;
    }
    let slot = atomicAdd(&counters[COUNTER_UNSURE], 1u);
    if slot < frame.unsure_capacity {
        unsure[slot] = cell;
    }
    if touches_window(at) {
        atomicAdd(&counters[COUNTER_UNSURE_IN_WINDOW], 1u);
    }
}

// Makes a cell unsure because unknown samples may be inserted in it, and marks its neighbours as hot.
fn make_hot(cell: u32, at: vec2<i32>) {
    make_unsure(cell, at);
    for (var row = at.y - 1; row <= at.y + 1; row++) {
        for (var column = at.x - 1; column <= at.x + 1; column++) {
            atomicOr(&grid[4u * cell_index(column, row) + 3u], FLAG_HOT);
        }
    }
}
