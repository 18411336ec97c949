// Light that a yarn's fibers scatter more than once, from tables of native/precompute/src/transport, where they are described.

// As Tables::add_transport, TransportSize::ALL and Transport::REACH have them.
const TRANSPORT_HEAD: u32 = 5u;
const TRANSPORT_LIGHT_LONGITUDES: u32 = 8u;
const TRANSPORT_LIGHT_AZIMUTHS: u32 = 24u;
const TRANSPORT_RINGS: u32 = 6u;
const TRANSPORT_VIEW_LONGITUDES: u32 = 12u;
const TRANSPORT_VIEW_AZIMUTHS: u32 = 8u;
const TRANSPORT_ANGLES: u32 = 16u;
const TRANSPORT_REACH: f32 = 1.2;

const TRANSPORT_OUTGOING: u32 = TRANSPORT_VIEW_LONGITUDES * TRANSPORT_VIEW_AZIMUTHS;
const TRANSPORT_SIDES: u32 = TRANSPORT_LIGHT_AZIMUTHS * TRANSPORT_RINGS * TRANSPORT_OUTGOING;

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

// Where a point lies in its yarn, and from where it is seen, as the tables have it.
struct TransportPoint {
    table: u32,
    azimuth: f32,
    ring: Between,
    // Of the tables' outgoing directions, and of those turned by half a turn about a line across the yarn.
    offsets: vec4u,
    weights: vec4f,
    turned_offsets: vec4u,
    yarn_axis: vec3f,
}

// `yarn_tangent`: along the yarn, which the section's axes do not tell in a yarn that is mirrored.
fn transport_point(table: u32, section: SectionPoint, yarn_tangent: vec3f, view: vec3f) -> TransportPoint {
    let across = cross(section.x, section.y);
    let yarn_axis = across * sign(dot(across, yarn_tangent));
    let azimuth = atan2(section.position.y, section.position.x) / TAU;
    let ring = between(length(section.position) / TRANSPORT_REACH * f32(TRANSPORT_RINGS), TRANSPORT_RINGS);
    let view_turns = atan2(dot(view, section.y), dot(view, section.x)) / TAU - azimuth;
    // In (-1, 1), in half turns.
    let view_azimuth = 2.0 * (fract(view_turns + 0.5) - 0.5);
    let a = between((view_azimuth + 0.5) * f32(TRANSPORT_VIEW_AZIMUTHS), TRANSPORT_VIEW_AZIMUTHS);
    let l = between((0.5 * dot(view, yarn_axis) + 0.5) * f32(TRANSPORT_VIEW_LONGITUDES), TRANSPORT_VIEW_LONGITUDES);
    let offsets = vec2u(l.first, l.second).xxyy * TRANSPORT_VIEW_AZIMUTHS + vec2u(a.first, a.second).xyxy;
    let weights = vec2f(1.0 - l.share, l.share).xxyy * vec2f(1.0 - a.share, a.share).xyxy;
    return TransportPoint(table + TRANSPORT_HEAD + TRANSPORT_ANGLES, azimuth, ring, offsets, weights, TRANSPORT_OUTGOING - 1u - offsets, yarn_axis);
}

fn transport_cell(first: u32, offsets: vec4u, weights: vec4f) -> vec3f {
    return shared_exponent(table_word(first + offsets.x)) * weights.x
        + shared_exponent(table_word(first + offsets.y)) * weights.y
        + shared_exponent(table_word(first + offsets.z)) * weights.z
        + shared_exponent(table_word(first + offsets.w)) * weights.w;
}

fn transport_side(point: TransportPoint, first: u32, light: Between, offsets: vec4u) -> vec3f {
    let rings = vec2u(point.ring.first, point.ring.second);
    let near = first + light.first * TRANSPORT_RINGS * TRANSPORT_OUTGOING;
    let far = first + light.second * TRANSPORT_RINGS * TRANSPORT_OUTGOING;
    let near_value = mix(
        transport_cell(near + rings.x * TRANSPORT_OUTGOING, offsets, point.weights),
        transport_cell(near + rings.y * TRANSPORT_OUTGOING, offsets, point.weights),
        point.ring.share,
    );
    let far_value = mix(
        transport_cell(far + rings.x * TRANSPORT_OUTGOING, offsets, point.weights),
        transport_cell(far + rings.y * TRANSPORT_OUTGOING, offsets, point.weights),
        point.ring.share,
    );
    return mix(near_value, far_value, light.share);
}

// Turns from the point to a direction.
fn transport_azimuth(point: TransportPoint, section: SectionPoint, direction: vec3f) -> f32 {
    return atan2(dot(direction, section.y), dot(direction, section.x)) / TAU - point.azimuth;
}

// Radiance per irradiance of a light in that direction.
fn transport_radiance(point: TransportPoint, section: SectionPoint, direction: vec3f) -> vec3f {
    let sin_theta = dot(direction, point.yarn_axis);
    let is_turned = sin_theta < 0.0;
    let turns = transport_azimuth(point, section, direction);
    let light = between_around(select(turns, -turns, is_turned) + 0.5, TRANSPORT_LIGHT_AZIMUTHS);
    let offsets = select(point.offsets, point.turned_offsets, is_turned);
    let theta = asin(min(abs(sin_theta), 1.0)) / (0.5 * PI);
    let longitude = between(theta * f32(TRANSPORT_LIGHT_LONGITUDES), TRANSPORT_LIGHT_LONGITUDES);
    return mix(
        transport_side(point, point.table + longitude.first * TRANSPORT_SIDES, light, offsets),
        transport_side(point, point.table + longitude.second * TRANSPORT_SIDES, light, offsets),
        longitude.share,
    );
}

// Radiance under radiance 1 from all directions, if they all had that one's azimuth.
fn transport_ambient(point: TransportPoint, section: SectionPoint, direction: vec3f) -> vec3f {
    let light = between_around(transport_azimuth(point, section, direction) + 0.5, TRANSPORT_LIGHT_AZIMUTHS);
    return transport_side(point, point.table + TRANSPORT_LIGHT_LONGITUDES * TRANSPORT_SIDES, light, point.offsets);
}

// Share of the light on a yarn that leaves it.
fn transport_albedo(table: u32) -> vec3f {
    return vec3f(table_value(table), table_value(table + 1u), table_value(table + 2u));
}

// Where light enters that is scattered more than once, by its distance from the plane through the yarn's axis and the light.
struct Entries {
    // Its mean over that of the place that is seen.
    share: f32,
    // As far from there, radii.
    reach: f32,
}

fn transport_entries(table: u32) -> Entries {
    return Entries(table_value(table + 3u), table_value(table + 4u));
}

// Radiance of a yarn as a whole per irradiance, by the cosine between the ways to light and viewer.
fn yarn_radiance(table: u32, cosine: f32) -> vec3f {
    let angle = between((0.5 * cosine + 0.5) * f32(TRANSPORT_ANGLES), TRANSPORT_ANGLES);
    let first = table + TRANSPORT_HEAD;
    return mix(shared_exponent(table_word(first + angle.first)), shared_exponent(table_word(first + angle.second)), angle.share);
}
