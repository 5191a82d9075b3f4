// Last pass of a prefix sum: adds to each element the total of the parts before its own, up to a limit. Where the list that the sums
// are indices of is too short, they end with it, so that no pass reads beyond it before the window is computed again.

fn run(index: u32) {
    if index < job.a {
        data[index] = min(data[index] + sums[index / SCAN_PART], job.c);
    }
}
