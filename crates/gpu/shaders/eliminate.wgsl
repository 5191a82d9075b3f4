// A round of elimination: decides each sample whose earlier conflicting samples are all decided. Decisions never
// change, so a round may use decisions of the same round. Two samples are in conflict by covers_offset (lattice.wgsl),
// and is_before (turn.wgsl) gives their order.
// import: turn
// import: rounds
// import: lattice
// import: tiled

struct Before {
    kept: bool,
    undecided: bool,
    unknown: bool,
}

// Collects the fates of the samples before `turn` that are in conflict with the sample `me` at `p`.
fn look_before(me: u32, p: vec2<i32>, turn: Turn, at: vec2<i32>) -> Before {
    var before = Before(false, false, false);
    for (var row = at.y - 1; row <= at.y + 1; row++) {
        for (var column = at.x - 1; column <= at.x + 1; column++) {
            let cell = cell_index(column, row);
            let end = end_of(cell);
            for (var k = starts[cell]; k < end; k++) {
                let word = atomicLoad(&places[k]);
                let fate = word & FATE_MASK;
                // A sample that is lost eliminates no other.
                if k == me || fate == FATE_LOST {
                    continue;
                }
                let q = unpack(word, vec2<i32>(column, row));
                if covers_offset(q - p) && is_before(turn_of(q, origins[k * frame.origin_words]), turn) {
                    before.kept |= fate == FATE_KEPT;
                    before.undecided |= fate == FATE_UNDECIDED;
                    before.unknown |= fate == FATE_UNKNOWN;
                }
            }
        }
    }
    return before;
}

fn run(index: u32) {
    // If the previous round left nothing undecided, there is nothing to do.
    if index >= min(atomicLoad(&counters[COUNTER_CONTESTED]), frame.cells) || is_over() {
        return;
    }
    let cell = list[index];
    let at = column_row(cell);
    let edge = is_edge(at);

    for (var k = starts[cell]; k < end_of(cell); k++) {
        let word = atomicLoad(&places[k]);
        if (word & FATE_MASK) != FATE_UNDECIDED {
            continue;
        }

        let p = unpack(word, at);
        let before = look_before(k, p, turn_of(p, origins[k * frame.origin_words]), at);
        var fate = FATE_KEPT;
        if before.kept {
            fate = FATE_LOST;
        } else if before.undecided {
            leave_undecided();
            continue;
        } else if before.unknown || edge {
            // Samples beyond the edge of the frame are unknown.
            fate = FATE_UNKNOWN;
        }

        atomicStore(&places[k], word | fate);
    }
}
