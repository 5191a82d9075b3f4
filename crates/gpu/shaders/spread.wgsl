// Marks the cells around newly unsure ones: those within reach, whose open places unknown samples may fill, and the
// adjacent ones, where insertions may be in conflict with unknown samples.
// import: frame

fn run(index: u32) {
    let known = min(atomicLoad(&counters[COUNTER_UNSURE]), frame.unsure_capacity);
    let k = atomicLoad(&counters[COUNTER_SPREAD]) + index;
    if k >= known {
        return;
    }

    let at = column_row(unsure[k]);
    // Adjacent cells become hot whatever the reach.
    let reach = i32(job.a);
    let low = max(at - max(reach, 1), vec2<i32>(0));
    let high = min(at + max(reach, 1), vec2<i32>(frame.columns, frame.rows) - 1);

    for (var row = low.y; row <= high.y; row++) {
        for (var column = low.x; column <= high.x; column++) {
            let away = max(abs(row - at.y), abs(column - at.x));
            let flags = select(0u, FLAG_REACHED, away <= reach) | select(0u, FLAG_HOT, away <= 1);
            atomicOr(&grid[4u * cell_index(column, row) + 3u], flags);
        }
    }
}
