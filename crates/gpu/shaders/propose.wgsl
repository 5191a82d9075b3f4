// Adds a place to the list of proposals.

fn propose(p: vec2<i32>, rank: u32, sites: vec3<u32>) {
    let place = atomicAdd(&counters[COUNTER_PROPOSALS], 1u);
    if place < frame.proposal_capacity {
        proposals[place] = Proposal(p.x, p.y, rank, 0u, sites.x, sites.y, sites.z, PROPOSAL_UNDECIDED);
    }
}
