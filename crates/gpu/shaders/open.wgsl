// Lists the cells that may hold uncovered places: those near lost samples with an open pixel. Of these, cells within
// reach of unsure ones become unsure instead.
// import: grid_shared
// import: coverage
// import: unsure

// Returns whether a lost sample, or a sample of an unsure cell, may have covered a place of a cell.
fn is_near_lost(at: vec2<i32>) -> bool {
    let reach = min(frame.lost_reach, PAD);
    for (var row = at.y - reach; row <= at.y + reach; row++) {
        for (var column = at.x - reach; column <= at.x + reach; column++) {
            if (grid_word(4u * cell_index(column, row) + 3u) & (FLAG_LOST | FLAG_UNSURE)) != 0u {
                return true;
            }
        }
    }
    // A pattern from a file may need a reach beyond the padding. Then every open cell counts.
    return frame.lost_reach > PAD;
}

fn run(index: u32) {
    if index >= u32(frame.columns) * u32(frame.rows) {
        return;
    }
    let at = vec2<i32>(i32(index % u32(frame.columns)), i32(index / u32(frame.columns)));
    if !is_near_lost(at) {
        return;
    }

    let pixels = open_pixels(at);
    if !is_open(pixels) {
        return;
    }

    let cell = cell_index(at.x, at.y);
    let flags = grid_word(4u * cell + 3u);

    if (flags & FLAG_REACHED) != 0u && may_be_uncovered(pixels, at) {
        make_hot(cell, at);
    } else {
        let slot = atomicAdd(&counters[COUNTER_OPEN], 1u);
        if slot < frame.list_capacity {
            list[slot] = cell;
        }
    }
}
