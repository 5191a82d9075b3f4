// Puts the survivors into the grid, and flags cells where samples were lost and cells with unknown samples.
// import: frame
// import: tiled

fn run(index: u32) {
    if index >= frame.cells {
        return;
    }

    let at = column_row(index);
    var slots = array<u32, 3>(FREE, FREE, FREE);
    var count = 0u;
    var flags = 0u;
    var eliminated = 0u;

    for (var k = starts[index]; k < end_of(index); k++) {
        let word = places[k];
        let fate = word & FATE_MASK;
        if fate == FATE_KEPT {
            // Three samples fill a cell: a fourth would be in conflict, so this is a fault.
            if count == 3u {
                atomicStore(&counters[COUNTER_FAULT], FAULT_FULL);
            } else {
                slots[count] = word & POSITION_MASK;
                count++;
            }
        } else if fate == FATE_LOST {
            flags |= FLAG_LOST;
            let p = unpack(word, at);
            if holds(p) {
                eliminated += u32(in_window(p));
            } else {
                // Counted at the nearest point of the domain.
                let nearest = clamp(p, vec2<i32>(0), vec2<i32>(frame.end_x, frame.end_y) - 1);
                atomicAdd(&counters[COUNTER_DROPPED], u32(in_window(nearest)));
            }
        } else {
            flags |= FLAG_UNSURE;
        }
    }

    let inside = at.x >= 0 && at.y >= 0 && at.x < frame.columns && at.y < frame.rows;
    // Samples beyond the edge of the frame, which are unknown, may be in conflict with these.
    if inside && is_edge(at) {
        flags |= FLAG_UNSURE;
    }

    grid[4u * index] = slots[0];
    grid[4u * index + 1u] = slots[1];
    grid[4u * index + 2u] = slots[2];
    grid[4u * index + 3u] = count | flags;

    if eliminated > 0u {
        atomicAdd(&counters[COUNTER_ELIMINATED], eliminated);
    }

    if (flags & FLAG_UNSURE) != 0u {
        let slot = atomicAdd(&counters[COUNTER_UNSURE], 1u);
        if slot < frame.unsure_capacity {
            unsure[slot] = index;
        }
        if touches_window(at) {
            atomicAdd(&counters[COUNTER_UNSURE_IN_WINDOW], 1u);
        }
    }
}
