// Links the darts that were added last into the lists of their cells. The sequence in a list depends on atomics, and
// matters to no pass.

fn run(index: u32) {
    let linked = atomicLoad(&counters[COUNTER_LINKED]);
    let to = linked + index;
    if to >= min(atomicLoad(&counters[COUNTER_DARTS]), ground.dart_capacity) {
        return;
    }
    let cell = vec2<u32>(vec2<i32>(darts[to].x, darts[to].y)) >> vec2<u32>(CELL_BITS);
    darts[to].next = atomicExchange(&heads[cell.y * ground.columns + cell.x], to + 1u);
}
