// Pixels that a convex quadrilateral may cover: rows along y, and in each a range along x; used as a line's walk is (math/capsule.wgsl).

// Its sides may bulge by a quarter of a pixel, and rounding.
const QUAD_MARGIN: f32 = 0.3;

struct QuadWalk {
    // In order around it.
    corners: array<vec2f, 4>,
    first: i32,
    last: i32,
    // Border along x: first pixel and one past the last.
    low: f32,
    high: f32,
}

fn quad_walk(corners: array<vec2f, 4>, low: vec2f, high: vec2f) -> QuadWalk {
    let top = min(min(corners[0].y, corners[1].y), min(corners[2].y, corners[3].y)) - QUAD_MARGIN;
    let bottom = max(max(corners[0].y, corners[1].y), max(corners[2].y, corners[3].y)) + QUAD_MARGIN;
    let first = i32(ceil(clamp(top - 0.5, low.y, high.y)));
    let last = i32(floor(clamp(bottom - 0.5, low.y - 1.0, high.y - 1.0)));
    return QuadWalk(corners, first, last, low.x, high.x);
}

// A range, and what of a side lies in a band of rows.
fn with_side(range: vec2f, p: vec2f, q: vec2f, top: f32, bottom: f32) -> vec2f {
    let height = q.y - p.y;
    let inverse = select(1.0, -1.0, height < 0.0) / max(abs(height), 1e-6);
    let a = mix(p.x, q.x, clamp((top - p.y) * inverse, 0.0, 1.0));
    let b = mix(p.x, q.x, clamp((bottom - p.y) * inverse, 0.0, 1.0));
    let is_in_band = min(p.y, q.y) <= bottom && max(p.y, q.y) >= top;
    return select(range, vec2f(min(range.x, min(a, b)), max(range.y, max(a, b))), is_in_band);
}

// First and last pixel in a row; empty if the last comes first.
fn quad_span(w: QuadWalk, row: i32) -> vec2i {
    let top = f32(row) + 0.5 - QUAD_MARGIN;
    let bottom = f32(row) + 0.5 + QUAD_MARGIN;
    var range = vec2f(3e38, -3e38);
    range = with_side(range, w.corners[0], w.corners[1], top, bottom);
    range = with_side(range, w.corners[1], w.corners[2], top, bottom);
    range = with_side(range, w.corners[2], w.corners[3], top, bottom);
    range = with_side(range, w.corners[3], w.corners[0], top, bottom);
    return vec2i(
        i32(ceil(clamp(range.x - QUAD_MARGIN - 0.5, w.low, w.high))),
        i32(floor(clamp(range.y + QUAD_MARGIN - 0.5, w.low - 1.0, w.high - 1.0))),
    );
}

fn quad_begin(w: QuadWalk, parts: Parts) -> WalkPlace {
    let row = first_turn(w.first, parts);
    return WalkPlace(row, quad_span(w, row));
}

// A range may be empty, and so may the walk.
fn quad_is_on_pixel(w: QuadWalk, place: WalkPlace) -> bool {
    return place.i <= w.last && place.span.x <= place.span.y;
}

fn quad_next(w: QuadWalk, place: WalkPlace, parts: Parts) -> WalkPlace {
    var next = WalkPlace(place.i, vec2i(place.span.x + 1, place.span.y));
    if next.span.x > next.span.y {
        next.i += i32(parts.count);
        next.span = quad_span(w, next.i);
    }
    return next;
}
