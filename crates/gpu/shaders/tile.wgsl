// Tiles: writes each cell's samples at its start in the list, and lists the cells whose samples may be in conflict:
// those with more than one image within r.
// import: clip

// Returns how many images come within r of a cell.
fn reaching(at: vec2<i32>) -> u32 {
    let low = (at << vec2<u32>(CELL_BITS)) - R;
    let high = low + 3 * R;
    let first = tile_of(at);
    let count = min(tile_images[first], TILE_WORDS - 1u);

    var reaching = 0u;
    for (var k = 0u; k < count; k++) {
        let image = images[tile_images[first + 1u + k]];
        if image.own_min_x - R < high.x && image.own_max_x + R > low.x
            && image.own_min_y - R < high.y && image.own_max_y + R > low.y {
            reaching++;
        }
    }
    return reaching;
}

fn run(index: u32) {
    if index >= frame.cells {
        return;
    }

    let at = column_row(index);
    clip_cell(at);
    if found == 0u {
        return;
    }

    let first = starts[index];
    if first + found > frame.tiled_capacity {
        atomicStore(&counters[COUNTER_FAULT], FAULT_TILED);
        return;
    }

    // Samples of one image are never in conflict. At the edge samples beyond the frame may be.
    let contested = is_edge(at) || reaching(at) > 1u;
    for (var k = 0u; k < found; k++) {
        var fate = select(FATE_KEPT, FATE_UNDECIDED, contested);
        // Samples beyond a closed border are dropped.
        if !holds(unpack(found_words[k], at)) {
            fate = FATE_LOST;
        }

        places[first + k] = found_words[k] | fate;
        let origin = (first + k) * frame.origin_words;
        origins[origin] = found_images[k];
        if frame.origin_words > 1u {
            origins[origin + 1u] = found_ids[k];
        }
    }

    if contested {
        let slot = atomicAdd(&counters[COUNTER_CONTESTED], 1u);
        if slot < frame.cells {
            list[slot] = index;
        }
    }
}
