// Writes the window's samples in canonical order: cell by cell, and row by row in a cell.
// import: frame

fn run(index: u32) {
    if index >= frame.cells {
        return;
    }

    let at = column_row(index);
    let count = grid[4u * index + 3u] & COUNT_MASK;
    if count == 0u || !touches_window(at) {
        return;
    }

    // Sorts the three slots; free ones go to the end.
    var slots = vec3<u32>(grid[4u * index], grid[4u * index + 1u], grid[4u * index + 2u]) & vec3<u32>(POSITION_MASK);
    slots = select(slots, vec3<u32>(FREE), vec3<u32>(0u, 1u, 2u) >= vec3<u32>(count));
    slots = vec3<u32>(min(slots.x, slots.y), max(slots.x, slots.y), slots.z);
    slots = vec3<u32>(slots.x, min(slots.y, slots.z), max(slots.y, slots.z));
    slots = vec3<u32>(min(slots.x, slots.y), max(slots.x, slots.y), slots.z);

    var to = heads[index];
    for (var k = 0u; k < count; k++) {
        let p = unpack(slots[k], at);
        if in_window(p) {
            if to < frame.result_capacity {
                result[to] = domain_point(p);
            }
            to++;
        }
    }
}
