// Throws a level's darts: each active cell draws its own. Darts that no sample covers are proposed.
// import: cover_cell
// import: poisson
// import: propose

fn is_covered(p: vec2<i32>) -> bool {
    return is_cell_covered(p, vec2<i32>(0));
}

fn run(index: u32) {
    let active_count = atomicLoad(&counters[COUNTER_ACTIVE]);
    if index >= active_count || active_count > frame.active_capacity {
        return;
    }

    let low = active_cells[index];
    let point = domain_point(low);
    // The cell's sides are two to the power of job.c.
    let shift = 16u - job.c;

    let key = threefry(vec2<u32>(job.a, job.b), point);
    // A cell of one unit throws one dart in any case, so that the last level leaves no place open.
    let darts = select(poisson(key.x), 1u, job.c == 0u);
    for (var k = 0u; k < darts; k++) {
        let draw = threefry(key, vec2<u32>(STREAM_DART, k));
        let offset = vec2<u32>((draw.x >> 16u) >> shift, (draw.x & 0xffffu) >> shift);
        let p = low + vec2<i32>(offset);

        let inside = all(vec2<i32>(point + offset) < domain_end()) && holds(p);
        if !inside || is_covered(p) {
            continue;
        }

        let at = cell_of(p);
        if (grid_word(4u * cell_index(at.x, at.y) + 3u) & FLAG_UNSURE) == 0u {
            propose(p, draw.y, vec3<u32>(NO_SITE));
        }
    }
}
