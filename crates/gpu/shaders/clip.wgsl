// Clips the pattern for one cell: collects the samples that each image of a block puts into it.
// import: frame

var<private> found_words: array<u32, MAX_FOUND>;
var<private> found_images: array<u32, MAX_FOUND>;
var<private> found_ids: array<u32, MAX_FOUND>;
var<private> found: u32;

fn tile_of(at: vec2<i32>) -> u32 {
    let tile = vec2<u32>(at + PAD) / TILE_SIDE;
    return (tile.y * frame.tile_columns + tile.x) * TILE_WORDS;
}

// Fills the lists above with the samples tiled in a cell: by image, then row by row.
fn clip_cell(at: vec2<i32>) {
    found = 0u;
    let first = tile_of(at);
    let count = min(tile_images[first], TILE_WORDS - 1u);
    for (var k = 0u; k < count; k++) {
        clip_image(tile_images[first + 1u + k], at);
    }
}

fn clip_image(index: u32, at: vec2<i32>) {
    let image = images[index];
    let corner = at << vec2<u32>(CELL_BITS);
    let clip_min = vec2<i32>(image.clip_min_x, image.clip_min_y);
    let low = max(corner, clip_min);
    let high = min(corner + R, vec2<i32>(image.clip_max_x, image.clip_max_y));
    if low.x >= high.x || low.y >= high.y {
        return;
    }

    // Not 0, with which the loops below would stand still, whatever an injected fault has written.
    let period = max(vec2<u32>(pattern[image.shape], pattern[image.shape + 1u]), vec2<u32>(1u));
    let start = vec2<u32>(vec2<i32>(image.start_x, image.start_y)) + vec2<u32>(low - clip_min);

    let before = found;
    var from_y = start.y % period.y;
    var y = low.y;
    // At most two periods on each axis: a pattern is longer than a cell.
    while y < high.y {
        let rows = min(u32(high.y - y), period.y - from_y);
        var from_x = start.x % period.x;
        var x = low.x;
        while x < high.x {
            let columns = min(u32(high.x - x), period.x - from_x);
            clip_piece(image.shape, vec2<u32>(from_x, from_y), vec2<u32>(columns, rows), vec2<i32>(x, y), index);
            x += i32(columns);
            from_x = 0u;
        }
        y += i32(rows);
        from_y = 0u;
    }

    // The pattern has its samples cell by cell, so those found are not yet in the order of rows.
    sort_found(before);
}

// Takes the samples in a rectangle of the pattern that does not cross its edge.
fn clip_piece(shape: u32, start: vec2<u32>, size: vec2<u32>, to: vec2<i32>, index: u32) {
    let columns = pattern[shape + 2u];
    let starts_at = pattern[shape + 3u];
    let points_at = pattern[shape + 4u];

    let first = start >> vec2<u32>(CELL_BITS);
    let last = (start + size - 1u) >> vec2<u32>(CELL_BITS);
    for (var row = first.y; row <= last.y; row++) {
        // No more samples than words: an injected fault may put the end anywhere.
        let end = min(pattern[starts_at + row * columns + last.x + 1u], arrayLength(&pattern));
        for (var k = pattern[starts_at + row * columns + first.x]; k < end; k++) {
            let at = points_at + 3u * k;
            let offset = vec2<u32>(pattern[at], pattern[at + 1u]) - start;
            // Below the start the difference wraps to a large number.
            if offset.x < size.x && offset.y < size.y && found < MAX_FOUND {
                found_words[found] = pack(to + vec2<i32>(offset));
                found_images[found] = index;
                found_ids[found] = pattern[at + 2u];
                found++;
            }
        }
    }
}

fn sort_found(first: u32) {
    for (var k = first + 1u; k < found; k++) {
        let word = found_words[k];
        let id = found_ids[k];
        var to = k;
        while to > first && found_words[to - 1u] > word {
            found_words[to] = found_words[to - 1u];
            found_ids[to] = found_ids[to - 1u];
            to--;
        }
        found_words[to] = word;
        found_ids[to] = id;
    }
}
