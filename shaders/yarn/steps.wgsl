// Subdivision by screen-space error: how long the lines are that a fiber is drawn with.
//
// A chord over a step dt departs from its curve c by c'' dt² / 8 at most. What follows bounds c'', per segment and in pixels: of the yarn's
// centre line, of the windings about it, and of what makes a loop or a hair leave the ply.

// Chord error bound, pixels.
const CHORD_ERROR: f32 = 0.25;

// Most steps along one segment, and most lines that a loop or a hair takes of one.
const MOST_STEPS: u32 = 128u;
const MOST_LINES: f32 = 1024.0;

// However small the yarn on the screen, a step turns by no more than this (radians): its depth is a cubic.
const MOST_TURNING: f32 = 2.0;

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

// Where a hair has left its ply, the fiber begins anew.
fn beyond_bound(yarn: Yarn, rates: Rates, fiber: Fiber, width: f32) -> f32 {
    let along = rates.migration / (TAU * regrowth(width));
    return wander_bound(yarn, rates, fiber.radius * yarn.r_min, fiber.radius) + 6.0 * yarn.fiber_radius * along * along;
}

// Turning of a fiber about the yarn's axis along the segment, as seen from there: about its ply and with it.
fn turning(rates: Rates) -> f32 {
    return max(abs(rates.fiber), abs(rates.ply));
}

// Steps of a segment, and the longest line in units of it, for a bound in pixels.
fn steps_for(rates: Rates, bound_pixels: f32) -> u32 {
    let steps = max(sqrt(bound_pixels / (8.0 * CHORD_ERROR)), turning(rates) / MOST_TURNING);
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

// A part of a fiber's migration period: where it ends, in periods from that in which the segment begins, and its bound in yarn radii.
struct Stage {
    end: f32,
    at_tip: bool,
    bound: f32,
}

fn stage_after(yarn: Yarn, s: Segment, rates: Rates, fiber: Fiber, migrated: f32) -> Stage {
    let whole = floor(migrated);
    let hash = hash_combine(fiber.hash, wrapped_period(s.period + u32(whole), s.closed_periods));
    let period = fiber_period(yarn, s.periods_per_turn, fiber, hash);
    let inner = fiber.radius * yarn.r_min;
    if period.kind != PERIOD_HAIR {
        return Stage(whole + 1.0, false, wander_bound(yarn, rates, inner, period.outer));
    }
    // A hair that rises forwards leaves the ply in the middle of its period and ends before the next; else all is the other way round.
    let tip = whole + 0.5 + period.direction * period.width;
    let root = whole + 0.5;
    let forwards = period.direction > 0.0;
    if migrated < min(root, tip) {
        let bound = select(beyond_bound(yarn, rates, fiber, period.width), wander_bound(yarn, rates, inner, fiber.radius), forwards);
        return Stage(min(root, tip), !forwards, bound);
    }
    if migrated < max(root, tip) {
        return Stage(max(root, tip), forwards, hair_bound(yarn, rates, period));
    }
    let bound = select(wander_bound(yarn, rates, inner, fiber.radius), beyond_bound(yarn, rates, fiber, period.width), forwards);
    return Stage(whole + 1.0, false, bound);
}

// More stages than a line goes through: a period has three.
const MOST_STAGES: u32 = 8u;

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

// Lines may be this much longer than their bound allows: rounding must not leave a step a line of its own.
const SLACK: f32 = 1.01;

// Least part of a segment that a line has.
const SHORTEST: f32 = 2e-7;

// A line of a fiber that may fly away: where it ends, and where the next begins, beyond a tip that lies between.
struct LineEnds {
    end: f32,
    next: f32,
}

// The line that begins at `begin`, and ends at `last` at the latest. It goes on into the next stage if it can to that one's end.
fn line_from(yarn: Yarn, s: Segment, rates: Rates, fiber: Fiber, radius_pixels: f32, begin: f32, last: f32) -> LineEnds {
    let shortest = min(begin + SHORTEST, last);
    let last_migrated = migration(s, fiber, scalar_value(s.length, last));
    var migrated = migration(s, fiber, scalar_value(s.length, begin));
    var reached = begin;
    var ends = LineEnds(last, last);
    var number = 0u;
    loop {
        let stage = stage_after(yarn, s, rates, fiber, migrated);
        let is_last = stage.end >= last_migrated;
        let stops = select(parameter_at(s, fiber, stage.end - select(0.0, CLEAR_OF_TIP, stage.at_tip), begin, last), last, is_last);
        let longest = SLACK * longest_line(radius_pixels * stage.bound);
        let is_too_long = begin + longest < stops;
        if is_too_long {
            let even = begin + (stops - begin) / ceil((stops - begin) / longest);
            let end = select(even, reached, reached > shortest);
            ends = LineEnds(end, end);
        } else if !is_last && stage.at_tip {
            let migration_rate = scalar_slope(s.length, stops) * s.turns.z;
            ends = LineEnds(stops, clamp(stops + 2.0 * CLEAR_OF_TIP / max(migration_rate, 1e-12), shortest, last));
        }
        reached = stops;
        migrated = stage.end;
        number++;
        if is_too_long || is_last || stage.at_tip {
            break;
        }
        if number == MOST_STAGES {
            ends = LineEnds(max(reached, shortest), max(reached, shortest));
            break;
        }
    }
    return ends;
}

// The line that a parameter lies on: where it begins and ends.
fn line_about(yarn: Yarn, s: Segment, rates: Rates, fiber: Fiber, radius_pixels: f32, t: f32) -> vec2f {
    let steps = f32(fiber_steps(yarn, rates, radius_pixels));
    let step = min(floor(t * steps), steps - 1.0);
    var line = vec2f(step, step + 1.0) / steps;
    if fiber.rank < yarn.flyaway_fibers {
        let last = line.y;
        for (var i = 0.0; i < MOST_LINES; i += 1.0) {
            let ends = line_from(yarn, s, rates, fiber, radius_pixels, line.x, last);
            line.y = ends.end;
            if t <= ends.end || ends.next >= last {
                break;
            }
            line.x = ends.next;
        }
    }
    return line;
}
