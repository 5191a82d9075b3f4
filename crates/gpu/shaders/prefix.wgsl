// Prefix sums within a workgroup.

// The sum up to each invocation, inclusive.
var<workgroup> totals: array<u32, WORKGROUP>;

// Returns the sum of the totals of the invocations before this one. All invocations of the workgroup must call it.
fn sum_before(local: u32, total: u32) -> u32 {
    totals[local] = total;
    workgroupBarrier();
    // After each step a total is the sum of twice as many invocations as before.
    for (var step = 1u; step < WORKGROUP; step *= 2u) {
        var before = 0u;
        if local >= step {
            before = totals[local - step];
        }
        workgroupBarrier();
        totals[local] += before;
        workgroupBarrier();
    }
    return totals[local] - total;
}
