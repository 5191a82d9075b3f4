// Gives each proposal its rank and adds it to the list of its cell. The order within a list is arbitrary, and no result
// depends on it. unlink.wgsl empties the lists.
// import: frame
// import: random

fn run(index: u32) {
    let count = atomicLoad(&counters[COUNTER_PROPOSALS]);
    if index >= count || count > frame.proposal_capacity {
        return;
    }

    let p = vec2<i32>(proposals[index].x, proposals[index].y);
    // Darts already have ranks.
    if job.c == 0u {
        proposals[index].rank = threefry(vec2<u32>(job.a, job.b), domain_point(p)).x;
    }

    let at = cell_of(p);
    proposals[index].next = atomicExchange(&heads[cell_index(at.x, at.y)], index + 1u);
}
