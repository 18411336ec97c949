// Coverage of pixel centres by a round-ended line.

struct LineEnd {
    // Pixels, and distance along the view axis.
    position: vec2f,
    depth: f32,
    radius: f32,
}

struct Line {
    a: LineEnd,
    b: LineEnd,
    direction: vec2f,
    length_squared: f32,
}

// Where a pixel centre lies relative to a line.
struct LineHit {
    covered: bool,
    // Share of the way from a to b.
    t: f32,
    // How far the surface of a round line stands out of its centre line, in its radii: less past an end, where it is a sphere.
    bulge: f32,
    radius: f32,
}

fn make_line(a: LineEnd, b: LineEnd) -> Line {
    let direction = b.position - a.position;
    return Line(a, b, direction, max(dot(direction, direction), 1e-20));
}

fn line_hit(line: Line, pixel: vec2f) -> LineHit {
    let from_a = pixel - line.a.position;
    let t = clamp(dot(from_a, line.direction) / line.length_squared, 0.0, 1.0);
    let radius = mix(line.a.radius, line.b.radius, t);
    let distance = length(from_a - t * line.direction) / max(radius, 1e-20);
    return LineHit(distance <= 1.0 && radius > 0.0, t, sqrt(max(1.0 - distance * distance, 0.0)), radius);
}

// Depth along the line; 1 / depth is linear on the screen under perspective.
fn line_depth(line: Line, t: f32, orthographic: bool) -> f32 {
    if orthographic {
        return mix(line.a.depth, line.b.depth, t);
    }
    return 1.0 / mix(1.0 / line.a.depth, 1.0 / line.b.depth, t);
}

// What the depth of a curve adds to that of its chord at `share` of the way: the cubic with the curve's rates of depth at the
// ends (per whole chord). A chord that is exact on the screen may still pass through the middle of a yarn a pixel wide.
fn depth_beyond_chord(rate_a: f32, rate_b: f32, chord: f32, share: f32) -> f32 {
    let rest = 1.0 - share;
    return share * rest * ((rate_a - chord) * rest - (rate_b - chord) * share);
}

// Pixels to visit: columns along x if the line is flat, else rows along y, as a range and one about its centre in each.
struct LineWalk {
    flat: bool,
    first: i32,
    last: i32,
    slope: f32,
    reach: f32,
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
    w.slope = select(minor / major, 0.0, abs(major) < 1e-12);
    w.reach = radius * sqrt(1.0 + w.slope * w.slope);
    return w;
}

// First and last pixel across, at the column or row `i`.
fn line_span(line: Line, w: LineWalk, i: i32) -> vec2i {
    let a = select(line.a.position.yx, line.a.position, w.flat);
    let b = select(line.b.position.yx, line.b.position, w.flat);
    let at = clamp(f32(i) + 0.5, min(a.x, b.x), max(a.x, b.x));
    let center = a.y + (at - a.x) * w.slope;
    return vec2i(
        i32(ceil(clamp(center - w.reach - 0.5, w.low, w.high))),
        i32(floor(clamp(center + w.reach - 0.5, w.low - 1.0, w.high - 1.0))),
    );
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
