// Finds candidates, by core's definition (stages/detect.rs): one invocation for each row of pixels of an open cell.
// import: sites
// import: circumcentre
// import: propose

fn within(d: vec2<i32>, reach: i32) -> bool {
    return !wide_less(wide_multiply(reach, reach), wide_norm_squared(d));
}

// Returns whether a detector is so near a closed border that it searches a wider radius.
fn is_near_border(p: vec2<i32>) -> bool {
    if frame.periodic != 0u {
        return false;
    }
    let at = vec2<i32>(domain_point(p));
    let away = min(at, vec2<i32>(i32(frame.side_x), i32(frame.side_y)) + 1 - at);
    // Deeper than 4.42 r all candidates of a detector are within 2 r of it, as proved at core's `Reach::new`.
    return min(away.x, away.y) <= 9 * R / 2;
}

// Returns whether the site `k` is a detector that finds the point `c` with the sites `a` and `b`.
fn finds(k: u32, c: vec2<i32>, a: u32, b: u32) -> bool {
    if (site_keys[k] & SITE_DETECTOR) == 0u {
        return false;
    }
    let p = site_points[k];
    let near = is_near_border(p);

    // The same as core's `Reach`.
    let radius = select(2 * R + 16, 7 * R / 2, near);
    let search = select(frame.search, frame.search_border, near);
    return within(c - p, radius) && within(site_points[a] - p, search) && within(site_points[b] - p, search);
}

// Returns whether no sample covers `c`, and none is much nearer to it than the nearest of its sites.
fn is_clear(c: vec2<i32>, at: vec2<i32>, nearest: vec2<u32>) -> bool {
    // Covered means a squared distance of at most R^2.
    let covering = wide_from(R * R + 1);
    var limit = wide_sub(nearest, wide_from(NEARER_SLACK));
    if wide_less(limit, covering) {
        limit = covering;
    }

    // Only samples nearer than the limit count. Those within 2 r are at most two cells away.
    let reach = select(widest(), 2, !wide_less(wide_multiply(2 * R, 2 * R), nearest));

    for (var row = at.y - reach; row <= at.y + reach; row++) {
        for (var column = at.x - reach; column <= at.x + reach; column++) {
            let first = 4u * cell_index(column, row);
            let count = grid_word(first + 3u) & COUNT_MASK;
            for (var k = 0u; k < count; k++) {
                let d = unpack(grid_word(first + k), vec2<i32>(column, row)) - c;
                if wide_less(wide_norm_squared(d), limit) {
                    return false;
                }
            }
        }
    }
    return true;
}

// Proposes the point `c` made by the sites `a`, `b` and `n`, which need not differ, if it is a candidate.
fn try_point(c: vec2<i32>, low: vec2<i32>, a: u32, b: u32, n: u32) {
    // Points in another pixel are handled there.
    if any((c >> vec2<u32>(PIXEL_BITS)) != (low >> vec2<u32>(PIXEL_BITS))) || !holds(c) {
        return;
    }
    if !(finds(a, c, b, n) || finds(b, c, a, n) || finds(n, c, a, b)) {
        return;
    }

    var nearest = wide_norm_squared(site_points[a] - c);
    let second = wide_norm_squared(site_points[b] - c);
    let third = wide_norm_squared(site_points[n] - c);
    if wide_less(second, nearest) {
        nearest = second;
    }
    if wide_less(third, nearest) {
        nearest = third;
    }

    if is_clear(c, cell_of(c), nearest) {
        let key = vec3<u32>(site_keys[a], site_keys[b], site_keys[n]) & vec3<u32>(~SITE_DETECTOR);
        propose(c, 0u, vec3<u32>(key.x, select(key.y, NO_SITE, b == a), select(key.z, NO_SITE, n == a)));
    }
}

// Returns whether the circumcentre of 0, a and b may lie in a pixel from `low` on. A filter in floating point:
// components are exact, below 2^18; twice the area is known to 2^14 and the numerators to 2^34, so that with an area of
// 2^27 or more a centre that is 2^17 away at most is known to 64 + 16 units; the pixel is taken to be 128 larger.
fn may_lie_in(a: vec2<i32>, b: vec2<i32>, low: vec2<i32>) -> bool {
    let p = vec2<f32>(a);
    let q = vec2<f32>(b);
    let area = p.x * q.y - p.y * q.x;

    // 2^27, and twice the error of the area.
    if abs(area) < 134250496.0 {
        return true;
    }

    let squares = vec2<f32>(dot(p, p), dot(q, q));
    let centre = vec2<f32>(squares.x * q.y - squares.y * p.y, squares.y * p.x - squares.x * q.x) / (2.0 * area);
    let least = vec2<f32>(low - 128);
    return all(centre >= least) && all(centre <= least + f32(PIXEL_SIDE + 256));
}

// Tries the circumcentres of all triples with a detector.
fn try_triples(low: vec2<i32>) {
    for (var a = 0u; a + 2u < sites; a++) {
        for (var b = a + 1u; b + 1u < sites; b++) {
            for (var n = b + 1u; n < sites; n++) {
                // Candidates have a detector, by definition.
                if ((site_keys[a] | site_keys[b] | site_keys[n]) & SITE_DETECTOR) == 0u {
                    continue;
                }

                let origin = site_points[a];
                let second = site_points[b] - origin;
                let third = site_points[n] - origin;
                if !may_lie_in(second, third, low - origin) {
                    continue;
                }

                let centre = circumcentre(second, third);
                if centre.exists {
                    try_point(origin + centre.offset, low, a, b, n);
                }
            }
        }
    }
}

// Tries the points on a border line, given by its axis, that are equally far from two samples.
fn try_line(low: vec2<i32>, axis: u32, line: i32) {
    let other = 1u - axis;
    if line < low[axis] || line >= low[axis] + PIXEL_SIDE {
        return;
    }

    for (var a = 0u; a + 1u < sites; a++) {
        for (var b = a + 1u; b < sites; b++) {
            let origin = site_points[a];
            let m = site_points[b] - origin;
            let found = on_line(line - origin[axis], vec2<i32>(m[axis], m[other]));
            if found.exists {
                var c = vec2<i32>(line, line);
                c[other] = origin[other] + found.value;
                try_point(c, low, a, b, a);
            }
        }
    }
}

fn try_borders(low: vec2<i32>) {
    let first = -vec2<i32>(i32(frame.origin_x), i32(frame.origin_y));
    let last = first + vec2<i32>(i32(frame.side_x), i32(frame.side_y));
    try_line(low, 0u, first.x);
    try_line(low, 0u, last.x);
    try_line(low, 1u, first.y);
    try_line(low, 1u, last.y);

    for (var a = 0u; a < sites; a++) {
        try_point(vec2<i32>(first.x, first.y), low, a, a, a);
        try_point(vec2<i32>(last.x, first.y), low, a, a, a);
        try_point(vec2<i32>(first.x, last.y), low, a, a, a);
        try_point(vec2<i32>(last.x, last.y), low, a, a, a);
    }
}

fn run(index: u32) {
    let entry = index / 8u;
    if entry >= min(atomicLoad(&counters[COUNTER_OPEN]), frame.list_capacity) {
        return;
    }
    let cell = list[entry];
    let flags = grid_word(4u * cell + 3u);
    // From the second iteration on only cells near samples of the previous iteration matter.
    if (flags & FLAG_UNSURE) != 0u || (job.a > 1u && (flags & FLAG_FRESH) == 0u) {
        return;
    }

    let at = column_row(cell);
    let row = index % 8u;
    let pixels = open_pixels(at);
    var open = (select(pixels.upper, pixels.lower, row < 4u) >> (8u * (row % 4u))) & 255u;

    while open != 0u {
        let column = countTrailingZeros(open);
        open &= open - 1u;
        let low = (at << vec2<u32>(CELL_BITS)) + vec2<i32>(i32(column), i32(row)) * PIXEL_SIDE;
        find_sites(low + PIXEL_SIDE / 2, at);
        // A pixel without a detector among its sites holds no candidate.
        if !has_detector {
            continue;
        }

        try_triples(low);
        if frame.periodic == 0u {
            try_borders(low);
        }
    }
}
