// How many darts a cell throws, as in core's darts.rs.
// import: random

fn poisson(word: u32) -> u32 {
    var count = 0u;
    for (var k = 0u; k < POISSON_COUNT; k++) {
        count += u32(word >= POISSON[k]);
    }
    return count;
}
