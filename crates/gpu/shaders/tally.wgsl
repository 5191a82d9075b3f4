// Counts the samples of the window in each cell.
// import: frame

fn run(index: u32) {
    if index > frame.cells {
        return;
    }
    heads[index] = 0u;
    if index == frame.cells {
        return;
    }

    let at = column_row(index);
    let count = grid[4u * index + 3u] & COUNT_MASK;
    if count == 0u || !touches_window(at) {
        return;
    }

    for (var k = 0u; k < count; k++) {
        heads[index] += u32(in_window(unpack(grid[4u * index + k], at)));
    }
}
