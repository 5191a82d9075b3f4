// Inserts the proposals that were kept, and marks the cells of those whose fate is unknown.
// import: proposal
// import: unsure

// Marks the cells in which the new sample may make candidates.
fn refresh(at: vec2<i32>) {
    // As far as a candidate may be from the samples that make it (`reach_cells` of core).
    let reach = select(4, 3, frame.periodic != 0u);
    for (var row = at.y - reach; row <= at.y + reach; row++) {
        for (var column = at.x - reach; column <= at.x + reach; column++) {
            atomicOr(&grid[4u * cell_index(column, row) + 3u], FLAG_FRESH);
        }
    }
}

fn run(index: u32) {
    let count = atomicLoad(&counters[COUNTER_PROPOSALS]);
    if index >= count || count > frame.proposal_capacity {
        return;
    }

    let state = state_of(index);
    let p = proposed_at(index);
    let at = cell_of(p);
    let cell = cell_index(at.x, at.y);

    if state == PROPOSAL_UNKNOWN {
        make_hot(cell, at);
        set_state(index, PROPOSAL_NOTED);
    }
    if state != PROPOSAL_KEPT {
        return;
    }

    set_state(index, PROPOSAL_INSERTED);
    let slot = atomicAdd(&grid[4u * cell + 3u], 1u) & COUNT_MASK;
    // Three samples fill a cell: a fourth would be in conflict, so this is a fault.
    if slot == 3u {
        atomicStore(&counters[COUNTER_FAULT], FAULT_FULL);
        return;
    }

    atomicStore(&grid[4u * cell + slot], pack(p) | DETECTOR);
    // An iteration takes a byte.
    atomicOr(&grid[4u * cell + 3u], min(job.a, 255u) << (8u + 8u * slot));
    refresh(at);

    atomicAdd(&counters[COUNTER_INSERTED], 1u);
    if in_window(p) {
        atomicAdd(&counters[COUNTER_INSERTED_IN_WINDOW], 1u);
    }
}
