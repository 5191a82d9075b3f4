// Tells each tile of 8 x 8 cells which images of blocks reach it: one workgroup a piece of an image.
// How they come in is left to chance; the next pass sorts them.

fn run(index: u32) {
    // The last row of workgroups may be longer than what is left.
    if index / WORKGROUP >= job.a {
        return;
    }
    let piece = pieces[index / WORKGROUP];
    let local = index % WORKGROUP;
    let columns = piece.w & 0xffffu;
    let rows = piece.w >> 16u;
    if local >= columns * rows {
        return;
    }
    let column = piece.y + local % columns;
    let row = piece.z + local / columns;
    let first = (row * frame.tile_columns + column) * TILE_WORDS;
    let place = atomicAdd(&tile_images[first], 1u);
    if place + 1u >= TILE_WORDS {
        atomicStore(&counters[COUNTER_FAULT], FAULT_IMAGES);
        return;
    }
    atomicStore(&tile_images[first + 1u + place], piece.x);
}
