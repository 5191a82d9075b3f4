// Where a block has each place of the pattern, as in core's exact/pieces.rs.

// Returns an offset of the pattern as it is under a symmetry.
fn turn(symmetry: u32, at: vec2<i32>) -> vec2<i32> {
    let mirrors = vec2<bool>((symmetry & 1u) != 0u, (symmetry & 2u) != 0u);
    let mirrored = select(at, -at, mirrors);
    return select(mirrored, mirrored.yx, (symmetry & 4u) != 0u);
}

// Returns the offset of which `turn` makes this one.
fn turn_back(symmetry: u32, turned: vec2<i32>) -> vec2<i32> {
    let mirrors = vec2<bool>((symmetry & 1u) != 0u, (symmetry & 2u) != 0u);
    let mirrored = select(turned, turned.yx, (symmetry & 4u) != 0u);
    return select(mirrored, -mirrored, mirrors);
}

// Returns where the domain has a place of the pattern. The origin may lie beyond 32 bits, and sums wrap.
fn place_of(piece: LaidPiece, source: vec2<i32>) -> vec2<i32> {
    return vec2<i32>(piece.origin_x, piece.origin_y) + turn(piece.symmetry, source);
}

fn source_of(piece: LaidPiece, place: vec2<i32>) -> vec2<i32> {
    return turn_back(piece.symmetry, place - vec2<i32>(piece.origin_x, piece.origin_y));
}

// A rectangle of places, with its last ones.
struct Span {
    low: vec2<i32>,
    high: vec2<i32>,
}

// Returns where the domain has a rectangle of the pattern. A turned one has its lowest place in another corner.
fn placed(piece: LaidPiece, sources: Span) -> Span {
    let a = place_of(piece, sources.low);
    let b = place_of(piece, sources.high);
    return Span(min(a, b), max(a, b));
}

fn sources_of(piece: LaidPiece, places: Span) -> Span {
    let a = source_of(piece, places.low);
    let b = source_of(piece, places.high);
    return Span(min(a, b), max(a, b));
}

// Returns the places of the pattern that a piece has.
fn held(piece: LaidPiece) -> Span {
    return Span(
        vec2<i32>(piece.source_min_x, piece.source_min_y),
        vec2<i32>(piece.source_max_x, piece.source_max_y) - 1,
    );
}

// Returns what two rectangles have in common; `low` is beyond `high` if that is nothing.
fn overlap(a: Span, b: Span) -> Span {
    return Span(max(a.low, b.low), min(a.high, b.high));
}

fn is_empty(span: Span) -> bool {
    return any(span.low > span.high);
}
