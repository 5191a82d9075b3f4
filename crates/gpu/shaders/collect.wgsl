// Writes the samples in canonical order, with their sources: block and sample of the pattern, or the iteration of a dart.
// import: arrival

fn is_lower(a: Dart, b: Dart) -> bool {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

fn run(index: u32) {
    if index >= ground.cells {
        return;
    }

    // At most four samples fit into a cell of side r. The bounds end a list that an injected fault has closed to a ring.
    var next = heads[index];
    for (var left = MAX_FOUND; next != 0u && left > 0u; left--) {
        let dart = darts[next - 1u];
        // Its place among the few of its cell, row by row.
        var to = starts[index];
        var other = heads[index];
        for (var others = MAX_FOUND; other != 0u && others > 0u; others--) {
            to += u32(is_lower(darts[other - 1u], dart));
            other = darts[other - 1u].next;
        }

        if to < arrayLength(&result) {
            result[to] = vec2<u32>(vec2<i32>(dart.x, dart.y));
            // Darts of levels 0 and 1 count as inserted in iteration 1, those of level k in iteration k.
            let iteration = max(throw_of(dart) / 4u, 1u);
            let block = pieces[piece_of(dart)].block;
            tags[to] = select(vec2<u32>(NO_SAMPLE, iteration), vec2<u32>(block, dart.sample), is_own(dart));
        }
        next = dart.next;
    }
}
