// Splits active cells in four and keeps the quarters that no single sample covers, except those in unsure cells.
// import: cover_cell

fn is_unsure_at(p: vec2<i32>) -> bool {
    if !holds(p) {
        return true;
    }
    let at = cell_of(p);
    return (grid_word(4u * cell_index(at.x, at.y) + 3u) & FLAG_UNSURE) != 0u;
}

fn is_unsure(low: vec2<i32>, last: i32) -> bool {
    return is_unsure_at(low) && is_unsure_at(low + vec2<i32>(last, 0))
        && is_unsure_at(low + vec2<i32>(0, last)) && is_unsure_at(low + last);
}

fn run(index: u32) {
    let count = atomicLoad(&counters[COUNTER_ACTIVE]);
    if index >= count || count > frame.active_capacity {
        return;
    }

    let corner = active_cells[index];
    let point = vec2<i32>(domain_point(corner));
    let half = i32(1u << job.c) / 2;

    for (var k = 0; k < 4; k++) {
        let offset = vec2<i32>(k % 2, k / 2) * half;
        let low = corner + offset;
        if any(point + offset >= domain_end()) {
            continue;
        }

        // The cell does not wrap around the domain, so its quarters do not either.
        let extent = min(vec2<i32>(half), domain_end() - point - offset) - 1;

        if !is_cell_covered(low, extent) && !is_unsure(low, half - 1) {
            let to = atomicAdd(&counters[COUNTER_NEXT_ACTIVE], 1u);
            if to < frame.active_capacity {
                next_active_cells[to] = low;
            }
        }
    }
}
