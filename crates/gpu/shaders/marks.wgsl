// Marks cells of the pattern in a piece: the darts of marked cells are thrown. A cell is listed once, by the invocation
// that marks it first; which one that is does not matter.
// import: laid

fn mark(index: u32, piece: LaidPiece, cell: vec2<i32>) {
    let first = vec2<i32>(piece.source_min_x, piece.source_min_y) >> vec2<u32>(CELL_BITS);
    let at = vec2<u32>(cell - first);
    let before = atomicExchange(&marks[piece.first_mark + at.y * piece.mark_columns + at.x], 1u);
    if before != 0u {
        return;
    }

    let to = atomicAdd(&counters[COUNTER_FRESH_CELLS], 1u);
    if to < ground.cell_capacity {
        fresh_cells[to] = PieceCell(index, cell.x << CELL_BITS, cell.y << CELL_BITS);
    }
}
