// Which of a cell's 8 x 8 pixels may hold a place that no sample covers: a pixel is closed when one
// sample covers all of it. The importing pass chooses its view of the grid.
// import: frame

struct OpenPixels {
    lower: u32,
    upper: u32,
}

fn is_open(pixels: OpenPixels) -> bool {
    return (pixels.lower | pixels.upper) != 0u;
}

// Returns the pixels of row `row` that a sample at `s` from the cell's corner does not cover.
fn open_in_row(s: vec2<i32>, row: i32) -> u32 {
    let low = row * PIXEL_SIDE;
    let away = max(abs(low - s.y), abs(low + PIXEL_SIDE - 1 - s.y));
    if away > R {
        return 255u;
    }
    // Half the chord. The root of an integer below 2^30 comes within 1/4 of a unit; one unit is given away.
    let half = i32(sqrt(f32(R * R - away * away)) - 1.0);
    let first = max((s.x - half + PIXEL_SIDE - 1) >> PIXEL_BITS, 0);
    let end = min((s.x + half + 1) >> PIXEL_BITS, 8);
    if half < 0 || first >= end {
        return 255u;
    }
    let covered = ((1u << u32(end)) - 1u) & ~((1u << u32(first)) - 1u);
    return 255u & ~covered;
}

// Returns the open pixels of a cell, rows from the lowest on, a byte each.
fn open_pixels(at: vec2<i32>) -> OpenPixels {
    var open = OpenPixels(0xffffffffu, 0xffffffffu);
    for (var row = at.y - 1; row <= at.y + 1; row++) {
        for (var column = at.x - 1; column <= at.x + 1; column++) {
            let first = 4u * cell_index(column, row);
            let count = grid_word(first + 3u) & COUNT_MASK;
            for (var k = 0u; k < count; k++) {
                let s = unpack(grid_word(first + k), vec2<i32>(column, row) - at);
                var lower = 0u;
                var upper = 0u;
                for (var line = 0; line < 4; line++) {
                    lower |= open_in_row(s, line) << u32(8 * line);
                    upper |= open_in_row(s, line + 4) << u32(8 * line);
                }
                open.lower &= lower;
                open.upper &= upper;
            }
        }
    }
    return open;
}
