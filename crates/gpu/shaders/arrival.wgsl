// The order in which darts arrive, as core's PlacedDart, and what their words hold.

// Level and throw: four times the level, plus the throw.
fn throw_of(dart: Dart) -> u32 {
    return dart.label & THROW_MASK;
}

fn piece_of(dart: Dart) -> u32 {
    return dart.label >> THROW_BITS;
}

fn at(dart: Dart) -> vec2<i32> {
    return vec2<i32>(dart.x, dart.y);
}

// Whether it is a sample of the pattern, which was laid down, and no dart thrown here.
fn is_own(dart: Dart) -> bool {
    return dart.sample != NO_SAMPLE;
}

// Nearly always the throws or the ranks differ. Then the place in the pattern decides, row by row, and then the place
// in the domain.
fn is_before(a: Dart, b: Dart) -> bool {
    if throw_of(a) != throw_of(b) {
        return throw_of(a) < throw_of(b);
    }
    if a.rank != b.rank {
        return a.rank < b.rank;
    }
    if a.source_y != b.source_y {
        return a.source_y < b.source_y;
    }
    if a.source_x != b.source_x {
        return a.source_x < b.source_x;
    }
    if a.y != b.y {
        return a.y < b.y;
    }
    return a.x < b.x;
}
