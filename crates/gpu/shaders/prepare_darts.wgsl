// Computes the workgroups of the next indirect dispatches of exact tiling from counters, and notes how far lists are dealt with.
// import: workgroups

fn run(index: u32) {
    // One invocation computes all arguments.
    if index > 0u {
        return;
    }

    if (job.a & PREPARE_NEXT_CELLS) != 0u {
        counters[COUNTER_OPEN_CELLS] = counters[COUNTER_NEXT_OPEN_CELLS];
        counters[COUNTER_NEXT_OPEN_CELLS] = 0u;
    }
    let open = min(counters[COUNTER_OPEN_CELLS], ground.cell_capacity);
    let all = min(counters[COUNTER_DARTS], ground.dart_capacity);
    if (job.a & PREPARE_THROWN) != 0u {
        counters[COUNTER_THROWN] = open;
    }
    if (job.a & PREPARE_LINKED) != 0u {
        counters[COUNTER_LINKED] = all;
    }

    set_workgroups(ARGUMENT_OPEN_CELLS, open);
    set_workgroups(ARGUMENT_FRESH_CELLS, min(counters[COUNTER_FRESH_CELLS], ground.cell_capacity));
    set_workgroups(ARGUMENT_THROWN, open - counters[COUNTER_THROWN]);
    set_workgroups(ARGUMENT_LINKED, all - counters[COUNTER_LINKED]);

    // Where the last answers changed nothing, they are right, and no question is asked again.
    let is_asked = (job.a & PREPARE_FIRST) != 0u || counters[COUNTER_CHANGED] != 0u;
    counters[COUNTER_JUDGED] = select(0u, counters[COUNTER_QUESTIONS], is_asked);
    set_workgroups(ARGUMENT_JUDGED, counters[COUNTER_JUDGED]);
}
