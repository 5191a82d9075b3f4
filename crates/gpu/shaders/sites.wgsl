// Finds the samples that may make a candidate in a pixel: those about as near to it as the nearest sample.
// import: grid
// import: coverage

var<private> site_points: array<vec2<i32>, MAX_SITES>;
// Cell times four plus slot, and the mark of a detector.
var<private> site_keys: array<u32, MAX_SITES>;
var<private> sites: u32;
// Whether any of them is a detector.
var<private> has_detector: bool;

// Returns how many cells away a sample that makes a candidate may be.
fn widest() -> i32 {
    return select(4, 3, frame.periodic != 0u);
}

// Returns the squared distance of the nearest sample within some cells.
fn nearest_to(centre: vec2<i32>, at: vec2<i32>, reach: i32) -> f32 {
    var nearest = 1e30;
    for (var row = at.y - reach; row <= at.y + reach; row++) {
        for (var column = at.x - reach; column <= at.x + reach; column++) {
            let first = 4u * cell_index(column, row);
            let count = grid_word(first + 3u) & COUNT_MASK;
            for (var k = 0u; k < count; k++) {
                let d = vec2<f32>(unpack(grid_word(first + k), vec2<i32>(column, row)) - centre);
                nearest = min(nearest, dot(d, d));
            }
        }
    }
    return nearest;
}

fn gather_sites(centre: vec2<i32>, at: vec2<i32>, reach: i32, limit: f32) {
    for (var row = at.y - reach; row <= at.y + reach; row++) {
        for (var column = at.x - reach; column <= at.x + reach; column++) {
            let first = 4u * cell_index(column, row);
            let count = grid_word(first + 3u) & COUNT_MASK;
            for (var k = 0u; k < count; k++) {
                let word = grid_word(first + k);
                let point = unpack(word, vec2<i32>(column, row));
                let d = vec2<f32>(point - centre);
                if dot(d, d) <= limit * limit {
                    if sites == MAX_SITES {
                        atomicStore(&counters[COUNTER_FAULT], FAULT_SITES);
                        return;
                    }
                    site_points[sites] = point;
                    site_keys[sites] = (first + k) | ((word & DETECTOR) << 1u);
                    has_detector |= (word & DETECTOR) != 0u;
                    sites++;
                }
            }
        }
    }
}

// Fills the lists above for a pixel of the cell `at`, or leaves them empty if it can hold no candidate.
fn find_sites(centre: vec2<i32>, at: vec2<i32>) {
    sites = 0u;
    has_detector = false;

    // f32 holds offsets exactly and distances to 2^-22 of them: less than a tenth of a unit here, while a place
    // of the pixel is HALF_DIAGONAL from its centre at most and SITE_SLACK allows for the rounding of candidates.
    var reach = 2;
    var nearest = sqrt(nearest_to(centre, at, reach));
    if nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK >= f32(2 * R) {
        reach = widest();
        nearest = sqrt(nearest_to(centre, at, reach));
    }

    let farthest = f32(select(7 * R / 2, 2 * R + 16, frame.periodic != 0u));
    if nearest - HALF_DIAGONAL - 1.0 <= farthest {
        gather_sites(centre, at, reach, nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK);
    }
}
