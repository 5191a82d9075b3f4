// Empties the lists of proposals.
// import: frame

fn run(index: u32) {
    if index >= min(counters[COUNTER_PROPOSALS], frame.proposal_capacity) {
        return;
    }
    let at = cell_of(vec2<i32>(proposals[index].x, proposals[index].y));
    heads[cell_index(at.x, at.y)] = 0u;
}
