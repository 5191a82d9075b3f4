// The list of tiled samples, cell by cell.

// Returns where the samples of a cell end. The list's length bounds it: an injected fault may put it anywhere.
fn end_of(cell: u32) -> u32 {
    return min(starts[cell + 1u], arrayLength(&places));
}
