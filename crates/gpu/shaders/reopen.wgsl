// Looks again at the open cells: those within reach of cells that have become unsure, and still open, become
// unsure, too.
// import: grid_shared
// import: coverage
// import: unsure

fn run(index: u32) {
    if index >= min(atomicLoad(&counters[COUNTER_OPEN]), frame.list_capacity) {
        return;
    }
    let cell = list[index];
    let flags = grid_word(4u * cell + 3u) & (FLAG_REACHED | FLAG_UNSURE);
    let at = column_row(cell);
    if flags == FLAG_REACHED && is_open(open_pixels(at)) {
        make_hot(cell, at);
    }
}
