// Finds which of a cell's 8 x 8 pixels may hold a place that no sample covers: a pixel is closed when one sample covers
// all of it. The importing pass also imports `grid` or `grid_shared`.
// import: frame
// import: lattice

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
    if away >= R {
        return 255u;
    }

    // Half the chord. The root of an integer below 2^30 is exact within 1/4 of a unit; subtract one unit to be safe.
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

    // Only samples of this cell and of adjacent ones cover places in it.
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

    let inside = pixels_inside(at);
    return OpenPixels(open.lower & inside.lower, open.upper & inside.upper);
}

// Returns the pixels of a cell that hold points of the domain.
fn pixels_inside(at: vec2<i32>) -> OpenPixels {
    let room = vec2<i32>(frame.end_x, frame.end_y) - (at << vec2<u32>(CELL_BITS)) + PIXEL_SIDE - 1;
    let ends = clamp(room >> vec2<u32>(PIXEL_BITS), vec2<i32>(0), vec2<i32>(8));
    let row = ((1u << u32(ends.x)) - 1u) * 0x01010101u;

    // WGSL takes shifts modulo 32, so a shift by 32 bits needs its own case.
    let low = select((1u << u32(8 * min(ends.y, 3))) - 1u, 0xffffffffu, ends.y >= 4);
    let high = select((1u << u32(8 * clamp(ends.y - 4, 0, 3))) - 1u, 0xffffffffu, ends.y == 8);
    return OpenPixels(row & low, row & high);
}

// Returns whether the square of `side` units from `low`, near the cell `at`, holds points of the domain and no single
// sample covers all of them.
fn is_square_open(low: vec2<i32>, side: i32, at: vec2<i32>) -> bool {
    let high = min(low + side, vec2<i32>(frame.end_x, frame.end_y)) - 1;
    if any(high < low) {
        return false;
    }

    for (var row = at.y - 1; row <= at.y + 1; row++) {
        for (var column = at.x - 1; column <= at.x + 1; column++) {
            let first = 4u * cell_index(column, row);
            let count = grid_word(first + 3u) & COUNT_MASK;
            for (var k = 0u; k < count; k++) {
                let s = unpack(grid_word(first + k), vec2<i32>(column, row));
                if covers_offset(max(abs(s - low), abs(s - high))) {
                    return false;
                }
            }
        }
    }
    return true;
}

// Returns whether a cell may hold an uncovered place, more exactly: its open pixels are cut twice, down to 1/512 r.
// Nearly all that is left open then lies in a gap, so that cells without gaps seldom become unsure.
fn may_be_uncovered(pixels: OpenPixels, at: vec2<i32>) -> bool {
    let corner = at << vec2<u32>(CELL_BITS);

    for (var pixel = 0u; pixel < 64u; pixel++) {
        let word = select(pixels.upper, pixels.lower, pixel < 32u);
        if ((word >> (pixel % 32u)) & 1u) == 0u {
            continue;
        }

        let low = corner + vec2<i32>(i32(pixel % 8u), i32(pixel / 8u)) * PIXEL_SIDE;
        for (var part = 0; part < 64; part++) {
            let part_low = low + vec2<i32>(part % 8, part / 8) * (PIXEL_SIDE / 8);
            if !is_square_open(part_low, PIXEL_SIDE / 8, at) {
                continue;
            }
            for (var bit = 0; bit < 64; bit++) {
                let bit_low = part_low + vec2<i32>(bit % 8, bit / 8) * (PIXEL_SIDE / 64);
                if is_square_open(bit_low, PIXEL_SIDE / 64, at) {
                    return true;
                }
            }
        }
    }
    return false;
}
