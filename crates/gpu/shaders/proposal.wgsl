// Access to proposals as atomic words, for passes that change their states.
// import: frame

fn proposed_at(index: u32) -> vec2<i32> {
    let first = index * PROPOSAL_WORDS;
    return bitcast<vec2<i32>>(vec2<u32>(atomicLoad(&proposals[first]), atomicLoad(&proposals[first + 1u])));
}

fn rank_of(index: u32) -> u32 {
    return atomicLoad(&proposals[index * PROPOSAL_WORDS + 2u]);
}

fn next_of(index: u32) -> u32 {
    return atomicLoad(&proposals[index * PROPOSAL_WORDS + 3u]);
}

fn state_of(index: u32) -> u32 {
    return atomicLoad(&proposals[index * PROPOSAL_WORDS + 7u]);
}

fn set_state(index: u32, state: u32) {
    atomicStore(&proposals[index * PROPOSAL_WORDS + 7u], state);
}
