// Counts the samples tiled in each cell.
// import: clip

fn run(index: u32) {
    if index > frame.cells {
        return;
    }
    if index == frame.cells {
        // One more entry, so that the end of every cell's samples can be read.
        starts[index] = 0u;
        return;
    }
    clip_cell(column_row(index));
    if found >= MAX_FOUND {
        atomicStore(&counters[COUNTER_FAULT], FAULT_CROWDED);
    }
    starts[index] = found;
}
