// Lists for each tile of 8 x 8 cells the images of blocks that reach it: one workgroup for each piece of an image. The
// order in a list is arbitrary; the next pass sorts it.

fn run(index: u32) {
    // The last row of workgroups may extend past the last piece.
    if index / WORKGROUP >= job.a {
        return;
    }

    let piece = pieces[index / WORKGROUP];
    let local = index % WORKGROUP;
    let columns = piece.w & 0xffffu;
    let rows = piece.w >> 16u;
    // A piece has at most one tile for each invocation, mostly fewer.
    if local >= columns * rows {
        return;
    }

    let column = piece.y + local % columns;
    let row = piece.z + local / columns;
    let first = (row * frame.tile_columns + column) * TILE_WORDS;

    let slot = atomicAdd(&tile_images[first], 1u);
    // TILE_WORDS has room for all images that can reach a tile, so this is a fault.
    if slot + 1u >= TILE_WORDS {
        atomicStore(&counters[COUNTER_FAULT], FAULT_IMAGES);
        return;
    }
    atomicStore(&tile_images[first + 1u + slot], piece.x);
}
