// Counts the samples of each cell, when all are decided and lists hold nothing else.

fn run(index: u32) {
    // One entry more than there are cells becomes the end of the last cell's samples.
    if index > ground.cells {
        return;
    }
    var count = 0u;
    if index < ground.cells {
        var next = heads[index];
        // A list has each sample at most once. The bound ends one that an injected fault has closed to a ring.
        while next != 0u && count < arrayLength(&darts) {
            count++;
            next = darts[next - 1u].next;
        }
    }
    starts[index] = count;
}
