// Sorts the list of each tile by the order of blocks.

fn run(index: u32) {
    if index >= frame.tiles {
        return;
    }
    let first = index * TILE_WORDS + 1u;
    let count = min(tile_images[index * TILE_WORDS], TILE_WORDS - 1u);

    // By insertion, as a list has at most 19 images.
    for (var k = 1u; k < count; k++) {
        let image = tile_images[first + k];
        var slot = k;
        while slot > 0u && tile_images[first + slot - 1u] > image {
            tile_images[first + slot] = tile_images[first + slot - 1u];
            slot--;
        }
        tile_images[first + slot] = image;
    }
}
