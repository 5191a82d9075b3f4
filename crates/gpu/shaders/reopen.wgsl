// Checks the open cells again: those that are within reach of newly unsure cells and still open become unsure, too.
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
    if flags == FLAG_REACHED && may_be_uncovered(open_pixels(at), at) {
        make_hot(cell, at);
    }
}
