// Clears the marks of the detectors and of their surroundings; the samples inserted next are the next detectors. If the
// proposals did not fit, nothing is cleared, since the window will be computed again.

fn run(index: u32) {
    if index >= frame.cells || counters[COUNTER_PROPOSALS] > frame.proposal_capacity {
        return;
    }

    let first = 4u * index;
    let last = grid[first + 3u];
    let count = last & COUNT_MASK;

    if (last & FLAG_FRESH) != 0u {
        grid[first + 3u] = last & ~FLAG_FRESH;
    }
    for (var k = 0u; k < count; k++) {
        if (grid[first + k] & DETECTOR) != 0u {
            grid[first + k] &= ~DETECTOR;
        }
    }
}
