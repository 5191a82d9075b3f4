// The grid of valid samples, for passes that do not change its flags; grid_shared.wgsl is for the others.

fn grid_word(index: u32) -> u32 {
    return grid[index];
}
