// Takes the darts that are no samples out of the lists of their cells, once a throw is decided.

fn run(index: u32) {
    if index >= ground.cells {
        return;
    }

    // The list is built anew, and so turned around.
    var next = heads[index];
    var kept = 0u;
    while next != 0u {
        let dart = next - 1u;
        next = darts[dart].next;
        if (states[dart] & DART_PRESENT) != 0u {
            darts[dart].next = kept;
            kept = dart + 1u;
        }
    }
    heads[index] = kept;
}
