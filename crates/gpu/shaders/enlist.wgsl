// Lists the pattern's samples of a throw about which is asked whether an earlier sample covers them.
// import: arrival

fn run(index: u32) {
    // Samples were laid down before any dart was thrown.
    if index >= job.b || throw_of(darts[index]) != job.a || (states[index] & DART_QUESTION) == 0u {
        return;
    }
    questions[atomicAdd(&counters[COUNTER_QUESTIONS], 1u)] = index;
}
