// A round of insertion: decides each proposal whose earlier conflicting proposals are all decided. Of several proposals
// at one point only the first can be kept.
// import: proposal
// import: rounds
// import: lattice

// Returns whether `a` comes before `b` in the order of insertion: by rank, then by position, row by row.
fn is_before(a: u32, p: vec2<i32>, b: u32, q: vec2<i32>) -> bool {
    let ranks = vec2<u32>(rank_of(a), rank_of(b));
    if ranks.x != ranks.y {
        return ranks.x < ranks.y;
    }
    let here = domain_point(p);
    let there = domain_point(q);
    if here.y != there.y {
        return here.y < there.y;
    }
    if here.x != there.x {
        return here.x < there.x;
    }
    return a < b;
}

fn run(index: u32) {
    let count = atomicLoad(&counters[COUNTER_PROPOSALS]);
    if is_over() || index >= count || count > frame.proposal_capacity || state_of(index) != PROPOSAL_UNDECIDED {
        return;
    }

    let p = proposed_at(index);
    let at = cell_of(p);
    var undecided = false;
    // Next to an unsure cell a sample that is unknown here may come first.
    var unknown = (grid[4u * cell_index(at.x, at.y) + 3u] & FLAG_HOT) != 0u;

    for (var row = at.y - 1; row <= at.y + 1; row++) {
        for (var column = at.x - 1; column <= at.x + 1; column++) {
            var next = atomicLoad(&heads[cell_index(column, row)]);
            // A list has each proposal at most once. The bound ends one that an injected fault has closed to a ring.
            for (var left = count; next != 0u && left > 0u; left--) {
                let other = next - 1u;
                next = next_of(other);
                let q = proposed_at(other);
                if other == index || !covers_offset(q - p) || !is_before(other, q, index, p) {
                    continue;
                }

                let state = state_of(other);
                if state == PROPOSAL_KEPT || state == PROPOSAL_INSERTED {
                    set_state(index, PROPOSAL_REJECTED);
                    return;
                }
                undecided |= state == PROPOSAL_UNDECIDED;
                unknown |= state == PROPOSAL_UNKNOWN || state == PROPOSAL_NOTED;
            }
        }
    }

    if undecided {
        leave_undecided();
    } else {
        set_state(index, select(PROPOSAL_KEPT, PROPOSAL_UNKNOWN, unknown));
    }
}
