// Subdivision by screen-space error: how long the lines are that a fiber is drawn with.
//
// A chord over a step dt departs from its curve c by c'' dt² / 8 at most. What follows bounds c'', per segment and in pixels: of the yarn's
// centre line, of the windings about it, and of what makes a loop or a hair leave the ply.

// Chord error bound, pixels.
const CHORD_ERROR: f32 = 0.25;

// Most steps along one segment, and most lines that a loop or a hair takes of one.
const MOST_STEPS: u32 = 128u;
const MOST_LINES: f32 = 1024.0;

// However small the yarn on the screen, a step turns by no more than this (radians): its depth is a cubic; and migrates by less than a period, so
// that it lies in two of them at most.
const MOST_TURNING: f32 = 2.0;
const MOST_MIGRATION: f32 = 6.0;

// Rates of a segment's plies, fibers and migration, radians; plies and fibers with their sign. At their largest.
struct Rates {
    ply: f32,
    fiber: f32,
    migration: f32,
    // Of the yarn's direction, and what its centre line departs from its chord.
    heading: f32,
    bend: f32,
}

fn segment_rates(yarn: Yarn, s: Segment) -> Rates {
    let ends = vec2f(s.length.y, s.length.y + 2.0 * s.length.z + 3.0 * s.length.w);
    let middle = s.length.y + s.length.z + 0.75 * s.length.w;
    let radians = TAU * max(max(ends.x, ends.y), middle) * s.turns;
    let bend = max(length(2.0 * s.position.c), length(2.0 * s.position.c + 6.0 * s.position.d));
    let end_heading = s.heading.a + s.heading.b + s.heading.c + s.heading.d;
    let speed_squared = max(min(dot(s.heading.a, s.heading.a), dot(end_heading, end_heading)), 1e-30);
    return Rates(
        select(0.0, yarn.ply_sign * radians.x, yarn.plies > 1u),
        yarn.fiber_sign * radians.y,
        radians.z,
        bend / sqrt(speed_squared),
        bend / max(s.radius.x, 1e-30),
    );
}

// Of the centre line and its parallels, which bend as much more as they lie farther out; `reach` in yarn radii, as are all that follow.
fn bend_bound(rates: Rates, reach: f32) -> f32 {
    return rates.bend + reach * rates.heading * rates.heading;
}

// An ellipse is the sum of two circles that turn with and against the ply: their radii, and rates of a fiber that turns at `fiber`.
struct Circles {
    radii: vec2f,
    rates: vec2f,
}

fn circles(yarn: Yarn, rates: Rates, fiber: f32) -> Circles {
    let radii = 0.5 * vec2f(yarn.ellipse_long + yarn.ellipse_short, yarn.ellipse_long - yarn.ellipse_short);
    return Circles(abs(radii), abs(vec2f(rates.ply + fiber, rates.ply - fiber)));
}

// Of a fiber in its ply, or in a loop, that wanders between two relative radii.
fn wander_bound(yarn: Yarn, rates: Rates, inner: f32, outer: f32) -> f32 {
    let axis = max(yarn.ellipse_long, yarn.ellipse_short);
    let around = circles(yarn, rates, rates.fiber);
    // The wander and its rate are a quarter of a period apart.
    let amplitude = 0.5 * (outer - inner) * rates.migration;
    let wander = amplitude * length(vec2f(axis * rates.migration, 2.0 * dot(around.radii, around.rates)));
    return bend_bound(rates, yarn.ply_distance + axis * outer) + yarn.ply_distance * rates.ply * rates.ply
        + outer * dot(around.radii, around.rates * around.rates) + wander;
}

// Of a hair: a parabola in radius and angle, most bent at its tip; and of its width, a quartic.
fn hair_bound(yarn: Yarn, rates: Rates, period: Period) -> f32 {
    let axis = max(yarn.ellipse_long, yarn.ellipse_short);
    let along = rates.migration / (TAU * period.width);
    let turned = TAU * period.turned * yarn.fiber_sign * along;
    let begin = circles(yarn, rates, rates.fiber);
    let tip = circles(yarn, rates, rates.fiber + 2.0 * turned * period.direction);
    let around = max(begin.rates, tip.rates);
    let rise = 2.0 * period.rise * along;
    return bend_bound(rates, yarn.ply_distance + axis * period.outer) + yarn.ply_distance * rates.ply * rates.ply
        + period.outer * (dot(begin.radii, around * around) + 2.0 * axis * abs(turned) * along)
        + 2.0 * rise * (dot(begin.radii, around) + axis * rates.heading) + rise * along * axis
        + 12.0 * yarn.fiber_radius * along * along;
}

// Where a hair has left its ply, the fiber begins anew: of its width alone.
fn regrowth_bound(yarn: Yarn, rates: Rates, width: f32) -> f32 {
    let along = rates.migration / (TAU * regrowth(width));
    return 6.0 * yarn.fiber_radius * along * along;
}

// Turning of a fiber about the yarn's axis along the segment, as seen from there: about its ply and with it.
fn turning(rates: Rates) -> f32 {
    return max(abs(rates.fiber), abs(rates.ply));
}

// Steps of a segment, and the longest line in units of it, for a bound in pixels.
fn steps_for(rates: Rates, bound_pixels: f32) -> u32 {
    let least = max(turning(rates) / MOST_TURNING, rates.migration / MOST_MIGRATION);
    let steps = max(sqrt(bound_pixels / (8.0 * CHORD_ERROR)), least);
    return clamp(u32(ceil(steps)), 1u, MOST_STEPS);
}

fn longest_line(bound_pixels: f32) -> f32 {
    return max(sqrt(8.0 * CHORD_ERROR / max(bound_pixels, 1e-20)), 1.0 / MOST_LINES);
}

// Steps of the fibers that stay in their ply. Lines of loops and hairs end there too, and where they must in between.
fn fiber_steps(yarn: Yarn, rates: Rates, radius_pixels: f32) -> u32 {
    return steps_for(rates, radius_pixels * wander_bound(yarn, rates, yarn.r_min, 1.0));
}

fn core_steps(yarn: Yarn, s: Segment, radius_pixels: f32) -> u32 {
    let rates = segment_rates(yarn, s);
    return steps_for(rates, radius_pixels * wander_bound(yarn, rates, 1.0, 1.0));
}

// Lines of a fiber along a segment, about: of one that takes many, if some fly away.
fn lines_about(yarn: Yarn, rates: Rates, radius_pixels: f32) -> f32 {
    let steps = f32(fiber_steps(yarn, rates, radius_pixels));
    if yarn.flyaway_fibers == 0u {
        return steps;
    }
    let width = clamp(max(abs(yarn.width_mean), yarn.width_deviation), 0.04, 0.45);
    let tip = max(yarn.tip_min_mean + yarn.tip_span_mean + yarn.tip_span_deviation, 1.0);
    let hair = Period(PERIOD_HAIR, tip, tip - 1.0, 1.0, width, yarn.turns_mean);
    let share = min(TAU * width / max(rates.migration, 1e-6), 1.0);
    return steps + share / longest_line(radius_pixels * hair_bound(yarn, rates, hair));
}

// Bound of a fiber in one period, between two places of its migration.
fn period_bound(yarn: Yarn, rates: Rates, fiber: Fiber, at: PeriodAt, from_migrated: f32, to_migrated: f32) -> f32 {
    let period = at.period;
    let is_hair = period.kind == PERIOD_HAIR;
    let wander = wander_bound(yarn, rates, fiber.radius * yarn.r_min, select(period.outer, fiber.radius, is_hair));
    // A hair that rises forwards leaves the ply in the middle of its period and ends before the next; else all is the other way round.
    let root = at.whole + 0.5;
    let tip = hair_tip(at);
    let forwards = period.direction > 0.0;
    let has_hair = is_hair && from_migrated < max(root, tip) && to_migrated > min(root, tip);
    let has_beyond = is_hair && select((from_migrated < tip), (to_migrated > tip), forwards);
    let beyond = wander + select(0.0, regrowth_bound(yarn, rates, period.width), has_beyond);
    return max(beyond, select(0.0, hair_bound(yarn, rates, period), has_hair));
}

// Where a hair ends, in periods from that in which the segment begins.
fn hair_tip(at: PeriodAt) -> f32 {
    return at.whole + 0.5 + at.period.direction * at.period.width;
}

// Periods by which points lie clear of a tip, on either side: rounding must not put them on the other.
const CLEAR_OF_TIP: f32 = 2e-6;

// Where the fiber has migrated so far, between two parameters.
fn parameter_at(s: Segment, fiber: Fiber, migrated: f32, low: f32, high: f32) -> f32 {
    let a = migration(s, fiber, scalar_value(s.length, low));
    let b = migration(s, fiber, scalar_value(s.length, high));
    var t = mix(low, high, clamp((migrated - a) / max(b - a, 1e-12), 0.0, 1.0));
    for (var i = 0u; i < 3u; i++) {
        let rate = scalar_slope(s.length, t) * s.turns.z;
        t = clamp(t - (migration(s, fiber, scalar_value(s.length, t)) - migrated) / max(rate, 1e-12), low, high);
    }
    return t;
}

// Least part of a segment that a line has.
const SHORTEST: f32 = 2e-7;

// Lines end on a grid; what begins this share of a line before one of its ends goes on to the next.
const ON_GRID: f32 = 1e-3;

// A fiber that may fly away along one step: the periods in which the step begins and ends, and the lines that it is drawn with, of one length.
struct StepLines {
    begin: f32,
    end: f32,
    line: f32,
    first: PeriodAt,
    second: PeriodAt,
}

fn step_lines(yarn: Yarn, s: Segment, rates: Rates, fiber: Fiber, radius_pixels: f32, begin: f32, end: f32) -> StepLines {
    let a = migration(s, fiber, scalar_value(s.length, begin));
    let b = migration(s, fiber, scalar_value(s.length, end));
    let first = period_at(yarn, s, fiber, floor(a));
    let second = period_at(yarn, s, fiber, floor(b));
    let bound = max(period_bound(yarn, rates, fiber, first, a, b), period_bound(yarn, rates, fiber, second, a, b));
    let lines = ceil((end - begin) / longest_line(radius_pixels * bound) - ON_GRID);
    return StepLines(begin, end, (end - begin) / max(lines, 1.0), first, second);
}

// The period of a place on the step, by the yarn's length there.
fn period_on(s: Segment, fiber: Fiber, lines: StepLines, length: f32) -> PeriodAt {
    if floor(migration(s, fiber, length)) <= lines.first.whole {
        return lines.first;
    }
    return lines.second;
}

// The first tip beyond a place of the migration, or none: far away.
fn tip_after(lines: StepLines, migrated: f32) -> f32 {
    var tip = 3e38;
    let first = hair_tip(lines.first);
    let second = hair_tip(lines.second);
    if lines.second.period.kind == PERIOD_HAIR && second > migrated {
        tip = second;
    }
    if lines.first.period.kind == PERIOD_HAIR && first > migrated {
        tip = first;
    }
    return tip;
}

// The end of the grid that comes after a parameter.
fn grid_end(lines: StepLines, t: f32) -> f32 {
    return min(lines.begin + lines.line * (floor((t - lines.begin) / lines.line + ON_GRID) + 1.0), lines.end);
}

// The line from a parameter on: where it ends, and where the next begins, beyond a tip that lies between.
struct LineEnds {
    end: f32,
    next: f32,
}

fn line_from(s: Segment, fiber: Fiber, lines: StepLines, begin: f32) -> LineEnds {
    let last = grid_end(lines, begin);
    let tip = tip_after(lines, migration(s, fiber, scalar_value(s.length, begin)));
    let stops = parameter_at(s, fiber, tip - CLEAR_OF_TIP, begin, last);
    let rate = scalar_slope(s.length, stops) * s.turns.z;
    let beyond = clamp(stops + 2.0 * CLEAR_OF_TIP / max(rate, 1e-12), min(begin + SHORTEST, lines.end), lines.end);
    let has_tip = tip < migration(s, fiber, scalar_value(s.length, last));
    return LineEnds(select(last, stops, has_tip), select(last, beyond, has_tip));
}

// The line that a parameter lies on: where it begins and ends.
fn line_about(yarn: Yarn, s: Segment, rates: Rates, fiber: Fiber, radius_pixels: f32, t: f32) -> vec2f {
    let steps = f32(fiber_steps(yarn, rates, radius_pixels));
    let step = min(floor(t * steps), steps - 1.0);
    let ends = vec2f(step, step + 1.0) / steps;
    if fiber.rank >= yarn.flyaway_fibers {
        return ends;
    }
    let lines = step_lines(yarn, s, rates, fiber, radius_pixels, ends.x, ends.y);
    let last = grid_end(lines, t);
    let begin = max(last - lines.line, ends.x);
    let line = line_from(s, fiber, lines, begin);
    return select(vec2f(begin, line.end), vec2f(line.next, last), t > line.end);
}
