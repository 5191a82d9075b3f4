// Ends the detectors' turn: what is inserted next are the next ones. Changes nothing where proposals did not
// find room, so that detection can be run again.

fn run(index: u32) {
    if index >= frame.cells || counters[COUNTER_PROPOSALS] > frame.proposal_capacity {
        return;
    }
    let first = 4u * index;
    let count = grid[first + 3u] & COUNT_MASK;
    for (var k = 0u; k < count; k++) {
        if (grid[first + k] & DETECTOR) != 0u {
            grid[first + k] &= ~DETECTOR;
        }
    }
}
