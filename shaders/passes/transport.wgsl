// Light that a yarn's fibers scatter more than once, from tables of native/precompute/src/transport, where they are described.

// As TransportSize::ALL and Transport::REACH.
const TRANSPORT_LIGHT_LONGITUDES: u32 = 6u;
const TRANSPORT_LIGHT_AZIMUTHS: u32 = 16u;
const TRANSPORT_RINGS: u32 = 6u;
const TRANSPORT_CONES: u32 = 20u;
const TRANSPORT_TURNS: u32 = 24u;
const TRANSPORT_VIEW_LONGITUDES: u32 = 12u;
const TRANSPORT_VIEW_AZIMUTHS: u32 = 8u;
const TRANSPORT_ANGLES: u32 = 16u;
const TRANSPORT_REACH: f32 = 1.2;

// Words before the tables: two colours and an exponent.
const TRANSPORT_HEAD: u32 = 7u;
// Cells of a ring under a sun, of all rings and azimuths, and of a ring under an even sky.
const TRANSPORT_RING: u32 = TRANSPORT_CONES * TRANSPORT_TURNS;
const TRANSPORT_SIDES: u32 = TRANSPORT_LIGHT_AZIMUTHS * TRANSPORT_RINGS * TRANSPORT_RING;
const TRANSPORT_AMBIENT_RING: u32 = TRANSPORT_VIEW_LONGITUDES * TRANSPORT_VIEW_AZIMUTHS;

// Two cells of an axis and how far the place lies from the first's centre to the second's.
struct Between {
    first: u32,
    second: u32,
    share: f32,
}

// `place`: in cells. Beyond the outermost centres, the outermost cell.
fn between(place: f32, cells: u32) -> Between {
    let p = clamp(place - 0.5, 0.0, f32(cells - 1u));
    let first = min(u32(p), cells - 2u);
    return Between(first, first + 1u, p - f32(first));
}

fn between_around(turns: f32, cells: u32) -> Between {
    let p = fract(turns) * f32(cells) - 0.5;
    let first = floor(p);
    let index = u32(i32(first) + i32(cells)) % cells;
    return Between(index, (index + 1u) % cells, p - first);
}

// Four cells, two by two, of an axis of longitudes and one of azimuths.
struct Outgoing {
    offsets: vec4u,
    weights: vec4f,
}

// `azimuths`: cells of that axis.
fn outgoing(longitude: Between, azimuth: Between, azimuths: u32) -> Outgoing {
    return Outgoing(
        vec2u(longitude.first, longitude.second).xxyy * azimuths + vec2u(azimuth.first, azimuth.second).xyxy,
        vec2f(1.0 - longitude.share, longitude.share).xxyy * vec2f(1.0 - azimuth.share, azimuth.share).xyxy,
    );
}

// Where a point lies in its yarn, and from where it is seen, as the tables have it.
struct TransportPoint {
    table: u32,
    azimuth: f32,
    ring: Between,
    // Of the way to the viewer; in turns from the point's azimuth.
    sin_theta_o: f32,
    view_turns: f32,
    yarn_axis: vec3f,
}

// `yarn_tangent`: along the yarn, which the section's axes do not tell in a yarn that is mirrored.
fn transport_point(table: u32, section: SectionPoint, yarn_tangent: vec3f, view: vec3f) -> TransportPoint {
    let across = cross(section.x, section.y);
    let yarn_axis = across * sign(dot(across, yarn_tangent));
    let azimuth = atan2(section.position.y, section.position.x) / TAU;
    let ring = between(length(section.position) / TRANSPORT_REACH * f32(TRANSPORT_RINGS), TRANSPORT_RINGS);
    let view_turns = atan2(dot(view, section.y), dot(view, section.x)) / TAU - azimuth;
    return TransportPoint(table, azimuth, ring, dot(view, yarn_axis), view_turns, yarn_axis);
}

fn transport_cells(first: u32, directions: Outgoing) -> vec3f {
    return shared_exponent(table_word(first + directions.offsets.x)) * directions.weights.x
        + shared_exponent(table_word(first + directions.offsets.y)) * directions.weights.y
        + shared_exponent(table_word(first + directions.offsets.z)) * directions.weights.z
        + shared_exponent(table_word(first + directions.offsets.w)) * directions.weights.w;
}

// `per_ring`: cells of a ring in the table that begins at `first`.
fn transport_side(point: TransportPoint, first: u32, per_ring: u32, light: Between, directions: Outgoing) -> vec3f {
    let rings = vec2u(point.ring.first, point.ring.second) * per_ring;
    let near = first + light.first * TRANSPORT_RINGS * per_ring;
    let far = first + light.second * TRANSPORT_RINGS * per_ring;
    let near_value = mix(transport_cells(near + rings.x, directions), transport_cells(near + rings.y, directions), point.ring.share);
    let far_value = mix(transport_cells(far + rings.x, directions), transport_cells(far + rings.y, directions), point.ring.share);
    return mix(near_value, far_value, light.share);
}

// Turns from the point to a direction.
fn transport_azimuth(point: TransportPoint, section: SectionPoint, direction: vec3f) -> f32 {
    return atan2(dot(direction, section.y), dot(direction, section.x)) / TAU - point.azimuth;
}

// Radiance per irradiance of a light in that direction.
fn transport_radiance(point: TransportPoint, section: SectionPoint, direction: vec3f) -> vec3f {
    let sin_theta_i = dot(direction, point.yarn_axis);
    // θ_i < 0 is the same, turned by half a turn about a line across the yarn.
    let turned = select(1.0, -1.0, sin_theta_i < 0.0);
    let turns = transport_azimuth(point, section, direction);
    let light = between_around(turned * turns + 0.5, TRANSPORT_LIGHT_AZIMUTHS);
    let cone = between((turned * (sin_theta_i + point.sin_theta_o) + 1.0) / 3.0 * f32(TRANSPORT_CONES), TRANSPORT_CONES);
    let turn = between_around(turned * (point.view_turns - turns) + 0.5, TRANSPORT_TURNS);
    let directions = outgoing(cone, turn, TRANSPORT_TURNS);
    let theta = asin(min(abs(sin_theta_i), 1.0)) / (0.5 * PI);
    let longitude = between(theta * f32(TRANSPORT_LIGHT_LONGITUDES), TRANSPORT_LIGHT_LONGITUDES);
    let suns = point.table + TRANSPORT_HEAD + TRANSPORT_ANGLES;
    return mix(
        transport_side(point, suns + longitude.first * TRANSPORT_SIDES, TRANSPORT_RING, light, directions),
        transport_side(point, suns + longitude.second * TRANSPORT_SIDES, TRANSPORT_RING, light, directions),
        longitude.share,
    );
}

// Radiance under radiance 1 from all directions, if they all had that one's azimuth.
fn transport_ambient(point: TransportPoint, section: SectionPoint, direction: vec3f) -> vec3f {
    let light = between_around(transport_azimuth(point, section, direction) + 0.5, TRANSPORT_LIGHT_AZIMUTHS);
    let longitude = between((0.5 * point.sin_theta_o + 0.5) * f32(TRANSPORT_VIEW_LONGITUDES), TRANSPORT_VIEW_LONGITUDES);
    // In (-1, 1), in half turns.
    let view_azimuth = 2.0 * (fract(point.view_turns + 0.5) - 0.5);
    let azimuth = between((view_azimuth + 0.5) * f32(TRANSPORT_VIEW_AZIMUTHS), TRANSPORT_VIEW_AZIMUTHS);
    let directions = outgoing(longitude, azimuth, TRANSPORT_VIEW_AZIMUTHS);
    let sky = point.table + TRANSPORT_HEAD + TRANSPORT_ANGLES + TRANSPORT_LIGHT_LONGITUDES * TRANSPORT_SIDES;
    return transport_side(point, sky, TRANSPORT_AMBIENT_RING, light, directions);
}

// Share of the light on a yarn that leaves it, and that on the side away from the light, with cosⁿ of the way straight on.
struct YarnAlbedo {
    albedo: vec3f,
    through: vec3f,
    exponent: f32,
}

fn yarn_albedo(table: u32) -> YarnAlbedo {
    let albedo = vec3f(table_value(table), table_value(table + 1u), table_value(table + 2u));
    let through = vec3f(table_value(table + 3u), table_value(table + 4u), table_value(table + 5u));
    return YarnAlbedo(albedo, through, table_value(table + 6u));
}

// Radiance of a yarn as a whole per irradiance, by the cosine between the ways to light and viewer.
fn yarn_radiance(table: u32, cosine: f32) -> vec3f {
    let angle = between((0.5 * cosine + 0.5) * f32(TRANSPORT_ANGLES), TRANSPORT_ANGLES);
    let first = table + TRANSPORT_HEAD;
    return mix(shared_exponent(table_word(first + angle.first)), shared_exponent(table_word(first + angle.second)), angle.share);
}
