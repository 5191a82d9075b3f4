// Writes the source of each sample of the result: block and pattern index, or 0xffffffff and the iteration.
// import: frame
// import: tiled

fn source_of(packed: u32, index: u32, at: vec2<i32>) -> vec2<u32> {
    let last = grid[4u * index + 3u];
    // Inserted samples are in the grid alone, with their iterations; tiled ones have iteration 0.
    for (var k = 0u; k < (last & COUNT_MASK); k++) {
        let iteration = (last >> (8u + 8u * k)) & 255u;
        if (grid[4u * index + k] & POSITION_MASK) == packed && iteration > 0u {
            return vec2<u32>(0xffffffffu, iteration);
        }
    }

    for (var k = starts[index]; k < end_of(index); k++) {
        if places[k] == (packed | FATE_KEPT) {
            let origin = k * frame.origin_words;
            let image = min(origins[origin], arrayLength(&images) - 1u);
            return vec2<u32>(images[image].block, origins[origin + 1u]);
        }
    }
    return vec2<u32>(0xffffffffu, 0u);
}

fn run(index: u32) {
    if index >= frame.cells {
        return;
    }
    let at = column_row(index);
    // An injected fault may put both anywhere.
    let end = min(min(heads[index + 1u], frame.result_capacity), arrayLength(&result));
    for (var to = heads[index]; to < end; to++) {
        // The result holds points of the domain, whose cells are aligned with the frame's.
        let p = result[to];
        let packed = ((p.y & LOW) << CELL_BITS) | (p.x & LOW);
        tags[to] = source_of(packed, index, at);
    }
}
