// Throws the darts of a throw into the cells that have not thrown theirs. Those that no sample of earlier throws covers become
// questions.
// import: laid
// import: near
// import: poisson

var<private> thrown: Dart;

fn visit(other: u32, moved: vec2<i32>) -> bool {
    let sample = darts[other];
    // The dart that a sample of the pattern is was laid down as the sample, be it lost or not.
    if is_own(sample) && all(at(sample) == at(thrown)) && sample.rank == thrown.rank
        && throw_of(sample) == throw_of(thrown) {
        return true;
    }
    return (states[other] & DART_PRESENT) != 0u && throw_of(sample) < throw_of(thrown)
        && covers_offset(at(sample) + moved - at(thrown));
}

fn run(index: u32) {
    let number = atomicLoad(&counters[COUNTER_THROWN]) + index;
    if number >= min(atomicLoad(&counters[COUNTER_OPEN_CELLS]), ground.cell_capacity) {
        return;
    }

    let cell = cells[number];
    let piece = pieces[cell.piece];
    let all = held(piece);
    let low = vec2<i32>(cell.x, cell.y);
    // The cell's sides are two to the power of job.c, at most R; a coordinate has 16 random bits, of which it takes the highest.
    let shift = 16u - job.c;

    let key = threefry(vec2<u32>(job.a, job.b), vec2<u32>(low));
    // A cell of one unit throws one dart in any case, so that the last level leaves no place open.
    let count = select(poisson(key.x), 1u, job.c == 0u);
    for (var k = 0u; k < count; k++) {
        let draw = threefry(key, vec2<u32>(STREAM_DART, k));
        let source = low + vec2<i32>(vec2<u32>((draw.x >> 16u) >> shift, (draw.x & 0xffffu) >> shift));
        // A cell at the border of a piece reaches beyond it, to darts that the piece does not have.
        if any(source < all.low) || any(source > all.high) {
            continue;
        }

        let place = place_of(piece, source);
        let label = (cell.piece << THROW_BITS) | job.d;
        thrown = Dart(place.x, place.y, label, draw.y, source.x, source.y, NO_SAMPLE, 0u);
        if any_near(place - R, place + R) {
            continue;
        }

        let to = atomicAdd(&counters[COUNTER_DARTS], 1u);
        if to < ground.dart_capacity {
            darts[to] = thrown;
            states[to] = DART_QUESTION;
            // No dart is listed twice, so that there is as much room as for darts.
            questions[atomicAdd(&counters[COUNTER_QUESTIONS], 1u)] = to;
        }
    }
}
