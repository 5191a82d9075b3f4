// Second pass of a prefix sum: one workgroup replaces the totals of the parts by their prefix sums; the sum of all goes
// to a counter.
// import: prefix

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(local_invocation_index) local: u32) {
    let length = (job.a + SCAN_PART - 1u) / SCAN_PART;
    let each = (length + WORKGROUP - 1u) / WORKGROUP;
    let first = local * each;
    let last = min(first + each, length);

    var total = 0u;
    for (var k = first; k < last; k++) {
        total += sums[k];
    }

    var sum = sum_before(local, total);
    for (var k = first; k < last; k++) {
        let value = sums[k];
        sums[k] = sum;
        sum += value;
    }

    if local == WORKGROUP - 1u {
        counters[job.b] = totals[local];
    }
}
