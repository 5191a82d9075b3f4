// Cuts cells for a throw, depth first, and keeps the parts that no single sample of earlier throws covers: in all others every
// dart is refused.
// import: laid
// import: near

var<private> cut_low: vec2<i32>;
var<private> cut_extent: vec2<i32>;

fn visit(other: u32, moved: vec2<i32>) -> bool {
    // Samples of this throw and later ones may still be lost.
    if (states[other] & DART_PRESENT) == 0u || throw_of(darts[other]) >= job.a {
        return false;
    }
    // If a sample covers the corner that is farthest from it, it covers the cell.
    let offset = at(darts[other]) + moved - cut_low;
    return covers_offset(max(abs(offset), abs(offset - cut_extent)));
}

// Whether a part of a cell holds places of its piece that no single sample is known to cover together.
fn is_open(piece: LaidPiece, low: vec2<i32>, side: i32) -> bool {
    let sources = overlap(Span(low, low + side - 1), held(piece));
    if is_empty(sources) {
        return false;
    }
    let places = placed(piece, sources);
    cut_low = places.low;
    cut_extent = places.high - places.low;
    // What covers all of it covers its lowest place.
    return !any_near(places.low - R, places.low + R);
}

fn run(index: u32) {
    let listed = atomicLoad(&counters[job.d]);
    if index == 0u && listed > ground.cell_capacity {
        // Cells that the list had no room for are cut by nobody, and its counter is cleared before the host reads it.
        // So the other list counts as too short, and the run is made again.
        atomicMax(&counters[job.d + 1u], listed);
    }
    if index >= min(listed, ground.cell_capacity) {
        return;
    }
    let cell = cells[index];
    let piece = pieces[cell.piece];
    let to_side = i32(1u << job.c);

    // The part that is looked at: its offset in the cell has a bit for each cut, so that the offset alone says which quarter
    // it is of each larger part.
    var side = i32(1u << job.b);
    let whole = side;
    var offset = vec2<i32>(0);
    loop {
        let low = vec2<i32>(cell.x, cell.y) + offset;
        if is_open(piece, low, side) {
            if side > to_side {
                // Its first quarter comes next.
                side /= 2;
                continue;
            }
            let to = atomicAdd(&counters[job.d + 1u], 1u);
            if to < ground.cell_capacity {
                cells_out[to] = PieceCell(cell.piece, low.x, low.y);
            }
        }

        // After the last quarter of a part comes what follows the part.
        while side < whole && all((offset & vec2<i32>(side)) != vec2<i32>(0)) {
            offset -= side;
            side *= 2;
        }
        if side == whole {
            return;
        }
        if (offset.x & side) == 0 {
            offset.x += side;
        } else {
            offset += vec2<i32>(-side, side);
        }
    }
}
