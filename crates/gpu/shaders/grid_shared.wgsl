// The grid of valid samples, for passes that change its flags; grid.wgsl is for the others.

fn grid_word(index: u32) -> u32 {
    return atomicLoad(&grid[index]);
}
