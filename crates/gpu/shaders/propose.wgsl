// Adds a point to the list of proposals.

fn propose(p: vec2<i32>, rank: u32, sites: vec3<u32>) {
    let slot = atomicAdd(&counters[COUNTER_PROPOSALS], 1u);
    if slot < frame.proposal_capacity {
        proposals[slot] = Proposal(p.x, p.y, rank, 0u, sites.x, sites.y, sites.z, PROPOSAL_UNDECIDED);
    }
}
