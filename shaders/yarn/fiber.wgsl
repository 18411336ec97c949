// Plies and fibers along a yarn [WuYuksel2018 §3.1]; twin of native/core/src/yarn/fiber.rs.

struct PlyPoint {
    position: vec3f,
    velocity: vec3f,
    acceleration: vec3f,
    radial: vec3f,
    tangential: vec3f,
    angle_rate: f32,
    radial_rate: vec3f,
    tangential_rate: vec3f,
}

fn ply_point(yarn: Yarn, s: Segment, p: YarnPoint, ply: u32) -> PlyPoint {
    var unit = vec2f(1.0, 0.0);
    var angle_rate = 0.0;
    if yarn.plies > 1u {
        unit = circle(yarn.ply_sign * (s.ply_turns + p.length * s.turns.x) + f32(ply) / f32(yarn.plies));
        angle_rate = TAU * yarn.ply_sign * p.length_rate * s.turns.x;
    }
    var q: PlyPoint;
    q.radial = p.normal * unit.x + p.binormal * unit.y;
    q.tangential = p.binormal * unit.x - p.normal * unit.y;
    q.radial_rate = q.tangential * angle_rate + p.normal_rate * unit.x + p.binormal_rate * unit.y;
    q.tangential_rate = -q.radial * angle_rate - p.normal_rate * unit.y + p.binormal_rate * unit.x;
    q.position = p.position + q.radial * (yarn.ply_distance * p.radius);
    // Of the winding alone; the frame itself turns slowly beside it.
    q.acceleration = p.acceleration - q.radial * (yarn.ply_distance * p.radius * angle_rate * angle_rate);
    q.angle_rate = angle_rate;
    q.velocity = p.velocity + yarn.ply_distance * (q.radial * p.radius_rate + q.radial_rate * p.radius);
    return q;
}

// A row of the fiber table with what the ply adds to it.
struct Fiber {
    // From the outermost on: levels of detail draw the first of them.
    rank: u32,
    radius: f32,
    angle_turns: f32,
    migration_turns: f32,
    hash: u32,
}

// What a ply adds to its fibers: an angle and a phase, so that plies are not copies of each other.
struct PlySeed {
    hash: u32,
    angle_turns: f32,
    migration_turns: f32,
}

fn ply_seed(seed: u32, ply: u32) -> PlySeed {
    let hash = hash_combine(seed, ply);
    return PlySeed(
        hash,
        unit_from_hash(hash_combine(hash, 0x0ffffff2u)),
        unit_from_hash(hash_combine(hash, 0x0ffffff1u)),
    );
}

fn make_fiber(ply: PlySeed, rank: u32, row: vec3f) -> Fiber {
    return Fiber(rank, row.x, row.y + ply.angle_turns, row.z + ply.migration_turns, hash_combine(ply.hash, rank));
}

// The parts of a hair's period: a line never joins the tip to what lies beyond it.
const PIECE_PLY: u32 = 0u;
const PIECE_HAIR: u32 = 1u;
const PIECE_BEYOND: u32 = 2u;

struct Profile {
    radius: f32,
    radius_rate: f32,
    radius_acceleration: f32,
    angle_turns: f32,
    angle_rate: f32,
    // Factor on the width: a hair thins out at its tip, and so does the end left in the ply.
    taper: f32,
    piece: u32,
}

// What a fiber is in one migration period.
const PERIOD_PLY: u32 = 0u;
const PERIOD_LOOP: u32 = 1u;
const PERIOD_HAIR: u32 = 2u;

struct Period {
    kind: u32,
    // Largest radius, and how much of it a hair rises above the ply's fiber.
    outer: f32,
    rise: f32,
    // Of a hair: 1 or -1, share of the period, and turns by which it departs from the regular twist.
    direction: f32,
    width: f32,
    turned: f32,
}

fn regular_period(fiber: Fiber) -> Period {
    return Period(PERIOD_PLY, fiber.radius, 0.0, 1.0, 1.0, 0.0);
}

fn fiber_period(yarn: Yarn, periods_per_turn: f32, fiber: Fiber, hash: u32) -> Period {
    var period = regular_period(fiber);
    if fiber.rank < yarn.flyaway_fibers {
        let choice = unit_from_hash(hash);
        if choice < yarn.loop_chance {
            let draw = yarn.loop_radius_mean + yarn.loop_radius_deviation * normal_from_hash(hash_combine(hash, 1u));
            period.kind = PERIOD_LOOP;
            period.outer = max(draw, fiber.radius);
        } else if choice < yarn.loop_chance + yarn.hair_chance {
            let span = yarn.width_mean + yarn.width_deviation * normal_from_hash(hash_combine(hash, 2u));
            let tip = yarn.tip_min_mean + yarn.tip_min_deviation * normal_from_hash(hash_combine(hash, 3u))
                + yarn.tip_span_mean + yarn.tip_span_deviation * normal_from_hash(hash_combine(hash, 4u));
            let turns = yarn.turns_mean + yarn.turns_deviation * normal_from_hash(hash_combine(hash, 5u));
            period.kind = PERIOD_HAIR;
            period.outer = max(tip, fiber.radius);
            period.rise = period.outer - fiber.radius;
            period.direction = select(-1.0, 1.0, span >= 0.0);
            period.width = clamp(abs(span), 0.04, 0.45);
            period.turned = period.direction * (turns - period.width / periods_per_turn);
        }
    }
    return period;
}

// Share of a period over which a fiber regains its width beyond a hair's tip: 0.15, or what is left of the period there.
fn regrowth(width: f32) -> f32 {
    return min(0.15, 0.5 - width);
}

fn fiber_profile(yarn: Yarn, fiber: Fiber, period: Period, phase: f32) -> Profile {
    let unit = circle(phase);
    let wave = 0.5 - 0.5 * unit.x;
    let inner = fiber.radius * yarn.r_min;
    var outer = fiber.radius;
    var profile = Profile(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, PIECE_PLY);
    if period.kind == PERIOD_LOOP {
        outer = period.outer;
    } else if period.kind == PERIOD_HAIR {
        let along = (phase - 0.5) * period.direction / period.width;
        if along >= 0.0 && along <= 1.0 {
            let along_rate = period.direction / period.width;
            let radius = fiber.radius + period.rise * along * along;
            return Profile(
                radius,
                2.0 * along * period.rise * along_rate,
                2.0 * period.rise * along_rate * along_rate,
                period.turned * along * along,
                2.0 * along * period.turned * along_rate,
                1.0 - along * along * along * along,
                PIECE_HAIR,
            );
        }
        if along > 1.0 {
            profile.piece = PIECE_BEYOND;
            profile.taper = smoothstep(0.0, regrowth(period.width), (along - 1.0) * period.width);
        }
    }
    profile.radius = inner + (outer - inner) * wave;
    profile.radius_rate = (outer - inner) * (PI * unit.y);
    profile.radius_acceleration = (outer - inner) * (0.5 * TAU * TAU) * unit.x;
    return profile;
}

// A fiber in the section of its ply: offsets along the ply's radial and tangential directions.
struct FiberSection {
    offset: vec2f,
    // Per t, beside the turning of the ply's directions.
    rate: vec2f,
    // Around the ply: direction, and its angle's rate.
    unit: vec2f,
    angle_rate: f32,
    phase_rate: f32,
    profile: Profile,
    period: u32,
}

// `period` modulo the periods of a closed curve, a few times as many at most: in floating point, since a software driver divides
// integers one by one.
fn wrapped_period(period: u32, closed_periods: u32) -> u32 {
    if closed_periods == 0u {
        return period;
    }
    let rest = i32(period - u32(f32(period) / f32(closed_periods)) * closed_periods);
    return u32(select(select(rest, rest - i32(closed_periods), rest >= i32(closed_periods)), rest + i32(closed_periods), rest < 0));
}

// Periods of a fiber from the one in which the segment begins.
fn migration(s: Segment, fiber: Fiber, length: f32) -> f32 {
    return s.phase + length * s.turns.z + fiber.migration_turns;
}

// A fiber of that shape.
fn section_of(yarn: Yarn, s: Segment, p: YarnPoint, fiber: Fiber, profile: Profile, period: u32) -> FiberSection {
    var f: FiberSection;
    f.period = period;
    f.profile = profile;
    f.phase_rate = p.length_rate * s.turns.z;
    f.unit = circle(yarn.fiber_sign * (s.fiber_turns + p.length * s.turns.y + profile.angle_turns) + fiber.angle_turns);
    f.angle_rate = TAU * yarn.fiber_sign * (p.length_rate * s.turns.y + profile.angle_rate * f.phase_rate);
    let half_axes = vec2f(yarn.ellipse_short, yarn.ellipse_long);
    let radius = profile.radius * p.radius;
    let radius_rate = profile.radius * p.radius_rate + profile.radius_rate * f.phase_rate * p.radius;
    f.offset = half_axes * f.unit * radius;
    f.rate = half_axes * (vec2f(-f.unit.y, f.unit.x) * (f.angle_rate * radius) + f.unit * radius_rate);
    return f;
}

// One of a fiber's periods.
struct PeriodAt {
    period: Period,
    // Modulo those of a closed curve.
    number: u32,
    // Periods from that in which the segment begins.
    whole: f32,
}

fn period_at(yarn: Yarn, s: Segment, fiber: Fiber, whole: f32) -> PeriodAt {
    let number = wrapped_period(s.period + u32(whole), s.closed_periods);
    return PeriodAt(fiber_period(yarn, s.periods_per_turn, fiber, hash_combine(fiber.hash, number)), number, whole);
}

fn section_in(yarn: Yarn, s: Segment, p: YarnPoint, fiber: Fiber, at: PeriodAt) -> FiberSection {
    let phase = migration(s, fiber, p.length) - at.whole;
    return section_of(yarn, s, p, fiber, fiber_profile(yarn, fiber, at.period, phase), at.number);
}

fn fiber_section(yarn: Yarn, s: Segment, p: YarnPoint, fiber: Fiber) -> FiberSection {
    return section_in(yarn, s, p, fiber, period_at(yarn, s, fiber, floor(migration(s, fiber, p.length))));
}

// Of a fiber that never flies away: the same, and much less to do.
fn regular_section(yarn: Yarn, s: Segment, p: YarnPoint, fiber: Fiber) -> FiberSection {
    let phase = fract(migration(s, fiber, p.length));
    return section_of(yarn, s, p, fiber, fiber_profile(yarn, fiber, regular_period(fiber), phase), 0u);
}

struct FiberPoint {
    position: vec3f,
    velocity: vec3f,
    // How the curve bends, near enough to tell it from its chords.
    acceleration: vec3f,
    taper: f32,
}

fn fiber_point(yarn: Yarn, s: Segment, p: YarnPoint, q: PlyPoint, fiber: Fiber) -> FiberPoint {
    let at = fiber_section(yarn, s, p, fiber);
    var f: FiberPoint;
    f.position = q.position + q.radial * at.offset.x + q.tangential * at.offset.y;
    f.velocity = q.velocity + q.radial_rate * at.offset.x + q.tangential_rate * at.offset.y
        + q.radial * at.rate.x + q.tangential * at.rate.y;
    // An ellipse is the sum of two circles that turn with and against the ply.
    let with_ply = q.angle_rate + at.angle_rate;
    let against = q.angle_rate - at.angle_rate;
    let half_sum = 0.5 * (yarn.ellipse_short + yarn.ellipse_long);
    let half_difference = 0.5 * (yarn.ellipse_short - yarn.ellipse_long);
    let spoke_acceleration = -(q.radial * at.unit.x + q.tangential * at.unit.y) * (half_sum * with_ply * with_ply)
        - (q.radial * at.unit.x - q.tangential * at.unit.y) * (half_difference * against * against);
    let spoke = q.radial * (at.unit.x * yarn.ellipse_short) + q.tangential * (at.unit.y * yarn.ellipse_long);
    let spoke_rate = q.radial_rate * (at.unit.x * yarn.ellipse_short) + q.tangential_rate * (at.unit.y * yarn.ellipse_long)
        + (q.tangential * (at.unit.x * yarn.ellipse_long) - q.radial * (at.unit.y * yarn.ellipse_short)) * at.angle_rate;
    let shape = at.profile;
    f.acceleration = q.acceleration + p.radius * (spoke_acceleration * shape.radius
        + 2.0 * spoke_rate * (shape.radius_rate * at.phase_rate)
        + spoke * (shape.radius_acceleration * at.phase_rate * at.phase_rate));
    f.taper = shape.taper;
    return f;
}

// Whether a line may join two points of a fiber, by their pieces and periods: not across a hair's tip.
fn joined(piece_a: u32, period_a: u32, piece_b: u32, period_b: u32) -> bool {
    let across_tip = (piece_a == PIECE_BEYOND) != (piece_b == PIECE_BEYOND);
    return !(across_tip && period_a == period_b);
}
