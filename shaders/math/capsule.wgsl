// Coverage of pixel centres by a round-ended line.

struct LineEnd {
    // Pixels, and distance along the view axis.
    position: vec2f,
    depth: f32,
    radius: f32,
}

// With what its pixels share: a software driver does not move it out of a loop.
struct Line {
    a: LineEnd,
    b: LineEnd,
    direction: vec2f,
    inverse_length_squared: f32,
    // 1 / depth at the ends, which is linear on the screen; orthographic: 1.
    inverse_a: f32,
    inverse_b: f32,
}

// Where a pixel centre lies relative to a line.
struct LineHit {
    covered: bool,
    // Share of the way from a to b, on the screen.
    t: f32,
    // How far the surface of a round line stands out of its centre line, pixels: less past an end, where it is a sphere.
    bulge: f32,
    radius: f32,
}

fn make_line(a: LineEnd, b: LineEnd, orthographic: bool) -> Line {
    let direction = b.position - a.position;
    return Line(
        a,
        b,
        direction,
        1.0 / max(dot(direction, direction), 1e-20),
        select(1.0 / a.depth, 1.0, orthographic),
        select(1.0 / b.depth, 1.0, orthographic),
    );
}

fn line_hit(line: Line, pixel: vec2f) -> LineHit {
    let from_a = pixel - line.a.position;
    let t = clamp(dot(from_a, line.direction) * line.inverse_length_squared, 0.0, 1.0);
    let radius = mix(line.a.radius, line.b.radius, t);
    let away = from_a - t * line.direction;
    let left = radius * radius - dot(away, away);
    return LineHit(left >= 0.0 && radius > 0.0, t, sqrt(max(left, 0.0)), radius);
}

// Share of the way from a to b in space: equal steps on the screen are not equal steps in depth.
fn line_share(line: Line, t: f32) -> f32 {
    return t * line.inverse_b / mix(line.inverse_a, line.inverse_b, t);
}

fn line_depth(line: Line, share: f32) -> f32 {
    return mix(line.a.depth, line.b.depth, share);
}

// What the depth of a curve adds to that of its chord at `share` of the way: the cubic with the curve's rates of depth at the
// ends, per whole chord and beside the chord's own. A chord that is exact on the screen may still pass through the middle of a yarn
// a pixel wide.
fn depth_beyond_chord(rate_a: f32, rate_b: f32, share: f32) -> f32 {
    let rest = 1.0 - share;
    return share * rest * (rate_a * rest - rate_b * share);
}

// Pixels to visit: columns along x if the line is flat, else rows along y, as a range and one about its centre in each.
struct LineWalk {
    flat: bool,
    first: i32,
    last: i32,
    reach: f32,
    // Along and across: a point on the centre line, and how it goes on between the two ends.
    start: vec2f,
    slope: f32,
    ends: vec2f,
    // Border across: first pixel and one past the last.
    low: f32,
    high: f32,
}

fn line_walk(line: Line, low: vec2f, high: vec2f) -> LineWalk {
    var w: LineWalk;
    w.flat = abs(line.direction.x) >= abs(line.direction.y);
    let radius = max(line.a.radius, line.b.radius);
    let a = select(line.a.position.y, line.a.position.x, w.flat);
    let b = select(line.b.position.y, line.b.position.x, w.flat);
    let major = select(line.direction.y, line.direction.x, w.flat);
    let minor = select(line.direction.x, line.direction.y, w.flat);
    let along = select(vec2f(low.y, high.y), vec2f(low.x, high.x), w.flat);
    w.low = select(low.x, low.y, w.flat);
    w.high = select(high.x, high.y, w.flat);
    w.first = i32(ceil(clamp(min(a, b) - radius - 0.5, along.x, along.y)));
    w.last = i32(floor(clamp(max(a, b) + radius - 0.5, along.x - 1.0, along.y - 1.0)));
    w.start = select(line.a.position.yx, line.a.position, w.flat);
    w.ends = vec2f(min(a, b), max(a, b));
    w.slope = select(minor / major, 0.0, abs(major) < 1e-12);
    w.reach = radius * sqrt(1.0 + w.slope * w.slope);
    return w;
}

// First and last pixel across, at the column or row `i`.
fn line_span(w: LineWalk, i: i32) -> vec2i {
    let at = clamp(f32(i) + 0.5, w.ends.x, w.ends.y);
    let center = w.start.y - 0.5 + (at - w.start.x) * w.slope;
    return vec2i(
        i32(ceil(clamp(center - w.reach, w.low, w.high))),
        i32(floor(clamp(center + w.reach, w.low - 1.0, w.high - 1.0))),
    );
}

// A pixel of a walk: the column or row, and the range across that begins with it. One loop goes over all of them: threads that run
// abreast wait for the one with most pixels in all, not in each column.
struct WalkPlace {
    i: i32,
    span: vec2i,
}

fn walk_begin(w: LineWalk, parts: Parts) -> WalkPlace {
    let i = first_turn(w.first, parts);
    return WalkPlace(i, line_span(w, i));
}

// A range may be empty, and so may the walk.
fn walk_is_on_pixel(w: LineWalk, place: WalkPlace) -> bool {
    return place.i <= w.last && place.span.x <= place.span.y;
}

fn walk_pixel(w: LineWalk, place: WalkPlace) -> vec2i {
    return select(vec2i(place.span.x, place.i), vec2i(place.i, place.span.x), w.flat);
}

fn walk_next(w: LineWalk, place: WalkPlace, parts: Parts) -> WalkPlace {
    var next = WalkPlace(place.i, vec2i(place.span.x + 1, place.span.y));
    if next.span.x > next.span.y {
        next.i += i32(parts.count);
        next.span = line_span(w, next.i);
    }
    return next;
}

// Threads that share a line: they take columns or rows in turn. `count` is a power of two.
struct Parts {
    count: u32,
    number: u32,
}

// The first column or row, from `first` on, that is this part's turn.
fn first_turn(first: i32, parts: Parts) -> i32 {
    return first + i32((parts.number - u32(first)) & (parts.count - 1u));
}
