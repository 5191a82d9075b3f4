// Writes for each eliminated sample the first kept one that covers it, as its index in the list plus one.
// import: turn
// import: lattice
// import: tiled

fn run(index: u32) {
    if index >= frame.cells {
        return;
    }

    let at = column_row(index);
    for (var k = starts[index]; k < end_of(index); k++) {
        by[k] = 0u;
        let p = unpack(places[k], at);
        if (places[k] & FATE_MASK) == FATE_LOST && holds(p) {
            // A dropped sample lies beyond the domain; no sample eliminated it.
            by[k] = first_cover(p, at) + 1u;
        }
    }
}

fn first_cover(p: vec2<i32>, at: vec2<i32>) -> u32 {
    var first = 0xffffffffu;
    var turn = Turn(0u, 0u, 0u, 0u);

    // Cells have sides of r, so samples in conflict lie in the same cell or in adjacent ones.
    for (var row = at.y - 1; row <= at.y + 1; row++) {
        for (var column = at.x - 1; column <= at.x + 1; column++) {
            let cell = cell_index(column, row);
            for (var k = starts[cell]; k < end_of(cell); k++) {
                let q = unpack(places[k], vec2<i32>(column, row));
                if (places[k] & FATE_MASK) == FATE_KEPT && covers_offset(q - p) {
                    let other = turn_of(q, origins[k * frame.origin_words]);
                    if first == 0xffffffffu || is_before(other, turn) {
                        first = k;
                        turn = other;
                    }
                }
            }
        }
    }
    return first;
}
