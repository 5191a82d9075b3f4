// The grid of valid samples, for passes that change its flags.

fn grid_word(index: u32) -> u32 {
    return atomicLoad(&grid[index]);
}
