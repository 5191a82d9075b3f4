// Makes the answers the new states, and counts those that are others than before. Around a sample of the pattern that
// is lost, the cells that its disk may touch are marked: darts that it refused are thrown.
// import: arrival
// import: marks

fn mark_disk(place: vec2<i32>, first: u32, end: u32) {
    for (var number = first; number < end; number++) {
        let piece = pieces[number];
        let places = overlap(Span(place - R, place + R), placed(piece, held(piece)));
        if is_empty(places) {
            continue;
        }

        let sources = sources_of(piece, places);
        let low = sources.low >> vec2<u32>(CELL_BITS);
        let high = sources.high >> vec2<u32>(CELL_BITS);
        for (var row = low.y; row <= high.y; row++) {
            for (var column = low.x; column <= high.x; column++) {
                mark(number, piece, vec2<i32>(column, row));
            }
        }
    }
}

fn run(index: u32) {
    if index >= atomicLoad(&counters[COUNTER_JUDGED]) {
        return;
    }

    let asked = questions[index];
    let state = states[asked];
    let is_present = verdicts[index] != 0u;
    if ((state & DART_PRESENT) != 0u) == is_present {
        return;
    }

    states[asked] = state ^ DART_PRESENT;
    atomicAdd(&counters[COUNTER_CHANGED], 1u);
    let dart = darts[asked];
    if is_own(dart) && !is_present {
        // In other blocks its disk reaches only cells within r of the border, which are marked.
        let piece = pieces[piece_of(dart)];
        // An injected fault may put the end anywhere.
        mark_disk(at(dart), piece.first_piece, min(piece.end_piece, arrayLength(&pieces)));
    }
}
