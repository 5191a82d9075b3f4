// Last pass of a prefix sum: adds to each element the total of the parts before its own.

fn run(index: u32) {
    if index < job.a {
        data[index] += sums[index / SCAN_PART];
    }
}
