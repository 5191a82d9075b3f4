// The grid of valid samples, seen by passes that change it.

fn grid_word(index: u32) -> u32 {
    return atomicLoad(&grid[index]);
}
