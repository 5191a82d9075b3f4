// The position of a tiled sample in the order of elimination: rank, then id, which means block, then position in the
// clip, row by row.
// import: frame
// import: random

struct Turn {
    rank: u32,
    sequence: u32,
    y: u32,
    x: u32,
}

fn turn_of(p: vec2<i32>, image_index: u32) -> Turn {
    // Where tiled samples did not fit their list, some have the images of an earlier window.
    let image = images[min(image_index, arrayLength(&images) - 1u)];

    var rank = 0u;
    if frame.order == ORDER_RANDOM {
        rank = threefry(vec2<u32>(frame.order_key_x, frame.order_key_y), domain_point(p)).x;
    } else if frame.order == ORDER_OWN_BLOCK_FIRST {
        let own = p.x >= image.own_min_x && p.x < image.own_max_x && p.y >= image.own_min_y && p.y < image.own_max_y;
        rank = select(1u, 0u, own);
    } else if frame.order == ORDER_PHASE_GROUP {
        let count = vec2<i32>(frame.phase_count_x, frame.phase_count_y);
        let cell = min(vec2<i32>(domain_point(p)) / vec2<i32>(frame.phase_cell_x, frame.phase_cell_y), count - 1) & vec2<i32>(1);
        rank = (frame.phase_sequence >> (4u * u32(cell.y * 2 + cell.x))) & 15u;
    }

    // Exact modulo 2^32, since positions in a clip are smaller.
    return Turn(rank, image.sequence, u32(p.y) - image.corner_y, u32(p.x) - image.corner_x);
}

fn is_before(a: Turn, b: Turn) -> bool {
    if a.rank != b.rank {
        return a.rank < b.rank;
    }
    if a.sequence != b.sequence {
        return a.sequence < b.sequence;
    }
    if a.y != b.y {
        return a.y < b.y;
    }
    return a.x < b.x;
}
