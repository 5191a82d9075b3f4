// The grid of valid samples, seen by passes that leave its flags alone.

fn grid_word(index: u32) -> u32 {
    return grid[index];
}
