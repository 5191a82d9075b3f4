// Adds to each element what comes before its part.

fn run(index: u32) {
    if index < job.a {
        data[index] += sums[index / SCAN_PART];
    }
}
