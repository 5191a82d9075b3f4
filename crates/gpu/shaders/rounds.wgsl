// Rounds: each notes whether it left anything undecided, in one of two alternating counters, and does nothing if the
// round before left nothing.

fn is_over() -> bool {
    return job.b == 0u && atomicLoad(&counters[COUNTER_UNDECIDED + 1u - job.a]) == 0u;
}

fn leave_undecided() {
    atomicStore(&counters[COUNTER_UNDECIDED + job.a], 1u);
}
