// Lists the cells at which uniform insertion starts: those in the domain that the bounding box of a lost sample's disk
// touches and that no single survivor covers. The invocation whose cell holds its lowest corner lists it.
// import: cover_cell
// import: tiled

// Returns whether a lost sample's box touches the cell from `low` to `low + extent`.
fn is_touched(low: vec2<i32>, extent: vec2<i32>) -> bool {
    let first = cell_of(low - GAP_REACH);
    let last = cell_of(low + extent + GAP_REACH);

    for (var row = first.y; row <= last.y; row++) {
        for (var column = first.x; column <= last.x; column++) {
            let cell = cell_index(column, row);
            if (grid_word(4u * cell + 3u) & FLAG_LOST) == 0u {
                continue;
            }
            for (var k = starts[cell]; k < end_of(cell); k++) {
                let s = unpack(places[k], vec2<i32>(column, row));
                if (places[k] & FATE_MASK) == FATE_LOST && all(s >= low - GAP_REACH) && all(s <= low + extent + GAP_REACH) {
                    return true;
                }
            }
        }
    }
    return false;
}

// Returns the first start of a cell on an axis at or above `at`.
fn first_start(at: u32, axis: u32) -> u32 {
    let into = at % GAP_SIDE;
    let up = select(0u, GAP_SIDE - into, into != 0u);
    // The last cell ends with the domain; in a periodic plane the next one starts there.
    return min(up, u32(domain_end()[axis]) - at);
}

fn run(index: u32) {
    if index >= u32(frame.columns) * u32(frame.rows) {
        return;
    }

    let at = vec2<i32>(i32(index % u32(frame.columns)), i32(index / u32(frame.columns)));
    let corner = at << vec2<u32>(CELL_BITS);
    let end = vec2<u32>(domain_end());

    // Cells of the dart process begin at the edge of the domain and have half the sides of the grid's cells.
    var up = first_start(domain_point(corner).y, 1u);
    while up < u32(R) {
        var right = first_start(domain_point(corner).x, 0u);
        let row = domain_point(corner + vec2<i32>(0, i32(up))).y;

        while right < u32(R) {
            let low = corner + vec2<i32>(vec2<u32>(right, up));
            let point = domain_point(low);
            if !holds(low) {
                break;
            }
            list_cell(low);
            // At least one: sides that an injected fault has changed may end at the point.
            right += max(min(GAP_SIDE, end.x - point.x), 1u);
        }

        if row >= end.y {
            break;
        }
        up += min(GAP_SIDE, end.y - row);
    }
}

fn list_cell(low: vec2<i32>) {
    let extent = extent_of(low, i32(GAP_SIDE));
    if is_touched(low, extent) && !is_cell_covered(low, extent) {
        let slot = atomicAdd(&counters[COUNTER_ACTIVE], 1u);
        if slot < frame.active_capacity {
            active_cells[slot] = low;
        }
    }
}
