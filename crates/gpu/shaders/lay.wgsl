// Lays down the pattern's samples of each block, cell of the pattern by cell, and marks the cells within r of a block's border,
// whose darts may lack the sample that refused them.
// import: arrival
// import: marks

// Returns the index of the piece that a mark belongs to: the last one whose marks begin at it or before.
fn piece_at(index: u32) -> u32 {
    var first = 0u;
    var end = ground.pieces;
    while end - first > 1u {
        // The sum of the two may have more than 32 bits.
        let middle = first + (end - first) / 2u;
        if pieces[middle].first_mark <= index {
            first = middle;
        } else {
            end = middle;
        }
    }
    return first;
}

// Whether some place may be at most r from the border of the piece's block, where samples of other blocks may cover it.
fn is_at_border(piece: LaidPiece, places: Span) -> bool {
    return any(places.low <= vec2<i32>(piece.block_min_x, piece.block_min_y) + R)
        || any(places.high >= vec2<i32>(piece.block_max_x, piece.block_max_y) - R);
}

fn lay(index: u32, piece: LaidPiece, sample: u32) {
    let word = ground.pattern_points + 4u * sample;
    let source = vec2<i32>(i32(pattern[word]), i32(pattern[word + 1u]));
    let all = held(piece);
    if any(source < all.low) || any(source > all.high) {
        return;
    }

    let place = place_of(piece, source);
    let to = atomicAdd(&counters[COUNTER_DARTS], 1u);
    if to < ground.dart_capacity {
        let label = (index << THROW_BITS) | pattern[word + 2u];
        darts[to] = Dart(place.x, place.y, label, pattern[word + 3u], source.x, source.y, sample, 0u);
        let is_question = is_at_border(piece, Span(place, place));
        states[to] = DART_PRESENT | select(0u, DART_QUESTION, is_question);
    }
}

fn run(index: u32) {
    if index >= ground.marks {
        return;
    }

    let number = piece_at(index);
    let piece = pieces[number];
    let all = held(piece);
    let offset = index - piece.first_mark;
    let first = all.low >> vec2<u32>(CELL_BITS);
    let cell = first + vec2<i32>(i32(offset % piece.mark_columns), i32(offset / piece.mark_columns));

    let low = cell << vec2<u32>(CELL_BITS);
    if is_at_border(piece, placed(piece, overlap(Span(low, low + R - 1), all))) {
        mark(number, piece, cell);
    }

    let column = u32(cell.y) * ground.pattern_columns + u32(cell.x);
    // No more samples than words: an injected fault may put the end anywhere.
    let end = min(pattern[column + 1u], arrayLength(&pattern));
    for (var sample = pattern[column]; sample < end; sample++) {
        lay(number, piece, sample);
    }
}
