// First pass of a prefix sum: each workgroup replaces its part of a list by the prefix sums within the part, and stores
// the part's total.
// import: prefix

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let part = group.y * groups.x + group.x;
    let first = part * SCAN_PART + local * SCAN_EACH;
    let length = job.a;

    var total = 0u;
    for (var k = first; k < min(first + SCAN_EACH, length); k++) {
        total += data[k];
    }

    var sum = sum_before(local, total);
    for (var k = first; k < min(first + SCAN_EACH, length); k++) {
        let value = data[k];
        data[k] = sum;
        sum += value;
    }

    if local == WORKGROUP - 1u && part * SCAN_PART < length {
        sums[part] = totals[local];
    }
}
