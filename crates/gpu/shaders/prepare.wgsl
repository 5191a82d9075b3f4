// Computes the workgroups of the next indirect dispatches from counters.
// import: workgroups

fn run(index: u32) {
    // One invocation computes all arguments.
    if index > 0u {
        return;
    }

    if (job.a & PREPARE_SPREAD) != 0u {
        counters[COUNTER_SPREAD] = min(counters[COUNTER_UNSURE], frame.unsure_capacity);
    }
    if (job.a & PREPARE_LEVEL) != 0u {
        counters[COUNTER_ACTIVE] = counters[COUNTER_NEXT_ACTIVE];
        counters[COUNTER_NEXT_ACTIVE] = 0u;
    }

    set_workgroups(ARGUMENT_CONTESTED, counters[COUNTER_CONTESTED]);
    let open = min(counters[COUNTER_OPEN], frame.list_capacity);
    set_workgroups(ARGUMENT_OPEN, open);
    set_workgroups(ARGUMENT_OPEN_ROWS, 8u * open);
    set_workgroups(ARGUMENT_PROPOSALS, min(counters[COUNTER_PROPOSALS], frame.proposal_capacity));
    // Unsure cells that have been spread are not spread again.
    set_workgroups(ARGUMENT_UNSURE, min(counters[COUNTER_UNSURE], frame.unsure_capacity) - counters[COUNTER_SPREAD]);
    set_workgroups(ARGUMENT_ACTIVE, min(counters[COUNTER_ACTIVE], frame.active_capacity));
}
