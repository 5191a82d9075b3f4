// Takes the darts that are no samples out of the lists of their cells, once a throw is decided.

fn run(index: u32) {
    if index >= ground.cells {
        return;
    }

    // The list is built anew, and so turned around.
    var next = heads[index];
    var kept = 0u;
    // A list has each dart at most once. The bound ends one that an injected fault has closed to a ring.
    for (var left = arrayLength(&darts); next != 0u && left > 0u; left--) {
        let dart = next - 1u;
        next = darts[dart].next;
        if (states[dart] & DART_PRESENT) != 0u {
            darts[dart].next = kept;
            kept = dart + 1u;
        }
    }
    heads[index] = kept;
}
