// Shading of a point on a fiber: shared by the two resolve passes. Loops are as in visibility_fibers.wgsl.

struct Surface {
    tube: Tube,
    // Section axes of the fiber's ply.
    radial: vec3f,
    tangential: vec3f,
    // Angle by which they turn per radius along the yarn.
    winding: f32,
    position: vec3f,
    tangent: vec3f,
    normal: vec3f,
    // Where on its yarn: the segment, and the parameter along it.
    segment: u32,
    t: f32,
}

// The normal of a round fiber seen at `offset` (-1 … 1) across it; `side` points where the offset grows.
fn fiber_normal(tangent: vec3f, side: vec3f, view: vec3f, offset: f32) -> vec3f {
    let across = normalize(cross(tangent, view) + vec3f(1e-12, 0.0, 0.0));
    let right = across * select(-1.0, 1.0, dot(across, side) >= 0.0);
    let forward = normalize(view - tangent * dot(view, tangent) + vec3f(0.0, 0.0, 1e-12));
    let x = clamp(offset, -1.0, 1.0);
    return normalize(right * x + forward * sqrt(max(1.0 - x * x, 0.0)));
}

// What a fiber makes of even light: its ambient term.
fn even_light(material: Material, sin_theta_o: f32) -> EvenLight {
    if PHYSICAL {
        return physical_ambient(material, ambient_factors(material, sin_theta_o));
    }
    return EvenLight(simple_ambient(material, sin_theta_o), vec3f(0.0), vec3f(0.0));
}

// Radiance of a fiber per irradiance, by light scattered once.
fn reflected_once(material: Material, surface: Surface, direction: vec3f, view: vec3f) -> Reflected {
    let angles = fiber_angles(surface.tangent, direction, view);
    let cos_normal = dot(surface.normal, direction);
    if PHYSICAL {
        return physical_lobes(material, normalizers_at(material, angles.sin_theta_i), angles, cos_normal);
    }
    return simple_lobes(material, angles, cos_normal);
}

// Share of the light behind a fiber, as its TT lobe takes it in, that the yarn's own fibers let through: at two azimuths, one deviation off.
fn self_shadow_behind(yarn: Yarn, seen: SeenPoint, gamma: f32) -> f32 {
    let behind = -seen.section.x * seen.view.x - seen.section.y * seen.view.y;
    let beside = seen.section.y * seen.view.x - seen.section.x * seen.view.y;
    let off = beside * sin(gamma);
    return 0.5 * (self_shadow(yarn, seen, behind * cos(gamma) + off) + self_shadow(yarn, seen, behind * cos(gamma) - off));
}

// Lambert's term takes in light by the cosine to its normal, over a section's angles: their standard deviation, √(π²/4 − 2), of which two angles so far off are
// Gauss's quadrature.
const LAMBERT_ANGLE: f32 = 0.6837;

// Share of the sky that Lambert's term takes in and that the yarn's own fibers let through.
fn self_shadow_facing(yarn: Yarn, seen: SeenPoint, normal: vec3f) -> f32 {
    let n = section_direction(seen.section, normal).unit;
    let facing = (seen.section.x * n.x + seen.section.y * n.y) * cos(LAMBERT_ANGLE);
    let beside = (seen.section.y * n.x - seen.section.x * n.y) * sin(LAMBERT_ANGLE);
    return 0.5 * (self_shadows(yarn, seen, facing + beside).point + self_shadows(yarn, seen, facing - beside).point);
}

// As in native/gpu/src/frame/mod.rs.
const MOST_SKY_VIEWS: u32 = 8u;

// The directions of this sample in which a point sees sky or other yarns.
struct Around {
    // Share of them that is sky.
    open: f32,
    // Light scattered more than once, under radiance 1 from the sky.
    sky: vec3f,
    // Radiance, by all orders, under radiance 1 from the other yarns in each direction.
    yarns: array<vec3f, MOST_SKY_VIEWS>,
}

fn look_around(yarn: Yarn, surface: Surface, seen: SeenPoint, transport: TransportPoint, even: vec3f) -> Around {
    var around: Around;
    let share = 1.0 / f32(max(frame.sky_view_count, 1u));
    if frame.sky_view_count == 0u {
        return around;
    }
    var i = 0u;
    loop {
        let direction = sky_direction(frame.sky_view + i);
        let shadow = tube_shadow(frame.sky_view + i, shadow_tube(yarn, surface.tube), surface.position, direction);
        around.open += share * shadow.open;
        if MULTIPLE {
            let scattered = transport_ambient(transport, seen.section, direction);
            around.sky += (share * shadow.open) * scattered;
            let by_yarns = 1.0 - shadow.open - shadow.solid;
            around.yarns[i] = (share * by_yarns) * (scattered + even * self_shadow(yarn, seen, direction));
        }
        i++;
        if i >= frame.sky_view_count {
            break;
        }
    }
    return around;
}

// A yarn as shadow maps have it.
fn shadow_tube(yarn: Yarn, tube: Tube) -> Tube {
    return Tube(tube.center, yarn.tube_radius * tube.radius, tube.tangent);
}

// Radiance of other yarns under a light in that direction, per irradiance.
fn neighbours_radiance(transport: u32, around: Around, direction: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if frame.sky_view_count == 0u {
        return sum;
    }
    var k = 0u;
    loop {
        sum += around.yarns[k] * yarn_radiance(transport, -dot(sky_direction(frame.sky_view + k), direction));
        k++;
        if k >= frame.sky_view_count {
            break;
        }
    }
    return sum;
}

// Share of the directions in which a yarn in a cloth sees the sky. By rays through tubes, light that has left two yarns meets another one in 0.69 of cases in a knit, in
// 0.57 in a plain weave, in 0.60 in a glove.
const CLOTH_OPEN: f32 = 0.36;

// Light on a point's neighbours by that on its own yarn: they are lit about as it is, and where a neighbour is between it and the light, that one is. By rays through tubes
// 0.62 of the light in a knit from the front, where 0.74 is on yarns that are seen; 0.46 and 0.42 from the back, 0.27 and 0.32 along it; in a plain weave 0.68 and 0.75, 0.45 and
// 0.42, 0.31 and 0.35.
const LIT_AS_ITSELF: f32 = 0.6;
const LIT_BEFORE_IT: f32 = 0.5;

// A neighbour is one up to so many diameters away, and none from so many on: by the way to its far side.
const BESIDE_BEGIN: f32 = 1.0;
const BESIDE_END: f32 = 1.5;

// Mean sine of the angle between yarns in all directions alike, for which tables have their radiance, and a light.
const ISOTROPIC_SINE: f32 = 0.25 * PI;

// Of light that fibers take, by a share of the light on the yarn's circle, in which is what goes beside them. A yarn of one fiber takes next to nothing.
fn taken_share(yarn: Yarn, share: vec3f) -> vec3f {
    return clamp((share - (1.0 - yarn.tube_radius)) / max(yarn.tube_radius, 1e-6), vec3f(0.0), vec3f(1.0));
}

// A place by which light enters a yarn that is scattered to a point more than once [Khungurn2017 §5.3.2]; `random`: a direction.
fn place_of_entry(entries: Entries, surface: Surface, toward_light: vec3f, random: vec3f) -> vec3f {
    let aside = random - toward_light * dot(random, toward_light);
    let across = cross(toward_light, surface.tube.tangent);
    let side = across / max(length(across), 1e-6);
    let here = dot(surface.position - surface.tube.center, side);
    return surface.position + aside * (entries.reach * surface.tube.radius) + side * ((entries.share - 1.0) * here);
}

// What of a light there is at a place and near it.
struct Arriving {
    // Share that comes there.
    here: f32,
    // The same of the neighbours.
    beside: f32,
}

fn arriving_light(light: Light, incident: Incident, tube: Tube, radius: f32, position: vec3f) -> Arriving {
    let shadow = light_shadow(light, incident, tube, position);
    // Meshes let nothing through.
    let blocked = 1.0 - shadow.open - shadow.solid;
    let is_beside = 1.0 - smoothstep(BESIDE_BEGIN, BESIDE_END, shadow.way / (2.0 * radius));
    return Arriving(shadow.open, LIT_AS_ITSELF * shadow.open + LIT_BEFORE_IT * blocked * is_beside);
}

// Radiance by what it comes from: light scattered once, by lobe, and more than once; and ambient light, however often it is scattered.
struct Shaded {
    once: Reflected,
    scattered: vec3f,
    ambient: vec3f,
    // Luminance of the lights as it arrives, and without shadows.
    arriving: f32,
    shining: f32,
}

fn radiance_of(shaded: Shaded) -> vec3f {
    return shaded.once.specular + shaded.once.transmission + shaded.once.diffuse + shaded.scattered + shaded.ambient;
}

// Of a colour in Rec. 709.
fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

fn shade(draw: u32, surface: Surface) -> Shaded {
    let yarn = yarns[draws[draw].yarn];
    let material = materials[draws[draw].material];
    let view = direction_to_viewer(frame.viewer, surface.position);
    let section = section_point(surface.tube, surface.radial, surface.tangential, surface.winding, surface.position);
    let seen = seen_point(yarn, section, surface.tangent, view);
    let even_lobes = even_light(material, dot(surface.tangent, view));
    let even = even_lobes.around + even_lobes.through + even_lobes.facing;
    var transport: TransportPoint;
    var entries: Entries;
    // Share of the light on a yarn that it gives back.
    var albedo: vec3f;
    // Light that yarns lit alike send each other.
    var gain: vec3f;
    if MULTIPLE {
        transport = transport_point(draws[draw].transport, section, surface.tube.tangent, view);
        entries = transport_entries(draws[draw].transport);
        albedo = taken_share(yarn, transport_albedo(draws[draw].transport));
        gain = 1.0 / (1.0 - (1.0 - CLOTH_OPEN) * albedo);
    }
    let tube = shadow_tube(yarn, surface.tube);
    let around = look_around(yarn, surface, seen, transport, even);
    var shaded: Shaded;
    var i = 0u;
    loop {
        let light = lights[i + unknown_zero()];
        i++;
        let incident = incident_light(light, surface.position);
        if i > frame.light_count || all(incident.irradiance <= vec3f(0.0)) {
            if i < frame.light_count {
                continue;
            }
            break;
        }
        let own = self_shadows(yarn, seen, incident.direction);
        let open = light_shadow(light, incident, tube, surface.position).open;
        let reflected = reflected_once(material, surface, incident.direction, view);
        let straight = incident.irradiance * (own.width * open);
        shaded.once.specular += reflected.specular * straight;
        shaded.once.transmission += reflected.transmission * straight;
        shaded.once.diffuse += reflected.diffuse * incident.irradiance * (own.point * open);
        shaded.arriving += luminance(straight);
        shaded.shining += luminance(incident.irradiance);
        if MULTIPLE {
            let entry = place_of_entry(entries, surface, incident.direction, sky_direction(frame.sky_view));
            let arriving = arriving_light(light, incident, tube, surface.tube.radius, entry);
            shaded.scattered += transport_radiance(transport, section, incident.direction) * incident.irradiance * arriving.here;
            // Neighbours lie about as the yarn does. They have their radiance within their tubes alone.
            let across = length(cross(incident.direction, surface.tube.tangent)) / ISOTROPIC_SINE;
            let on_neighbours = incident.irradiance * (arriving.beside * across / max(yarn.tube_radius, 1e-6));
            shaded.scattered += neighbours_radiance(draws[draw].transport, around, incident.direction) * on_neighbours * gain;
        }
        if i >= frame.light_count {
            break;
        }
    }
    let own_behind = self_shadow_behind(yarn, seen, material.gamma_tt);
    var sky = (even_lobes.around * self_sky(yarn, seen) + even_lobes.through * own_behind) * around.open;
    if any(even_lobes.facing > vec3f(0.0)) {
        sky += even_lobes.facing * (self_shadow_facing(yarn, seen, surface.normal) * around.open);
    }
    if MULTIPLE {
        sky += around.sky;
        for (var k = 0u; k < frame.sky_view_count; k++) {
            sky += around.yarns[k] * albedo * (CLOTH_OPEN * gain);
        }
    }
    shaded.ambient = frame.ambient * sky;
    return shaded;
}

// The key of a pixel taken apart.
struct Winner {
    draw: u32,
    parts: KeyParts,
    ply: u32,
    // 0 for the core, else the fiber's rank + 1.
    slot: u32,
}

fn winner_at(index: u32) -> Winner {
    let words = keys[index];
    let parts = key_parts(Key(words.y, words.x));
    let draw = find_draw(parts.segment);
    let slots = yarns[draws[draw].yarn].fibers + 1u;
    return Winner(draw, parts, parts.slot / slots, parts.slot % slots);
}

fn add_surface(index: u32, draw: u32, surface: Surface) {
    let depth = to_pixel(frame.pixel_from_render, surface.position).w;
    var shaded: Shaded;
    var color = vec4f(0.0);
    if draws[draw].holdout == 0u {
        shaded = shade(draw, surface);
        color = vec4f(radiance_of(shaded), 1.0);
    }
    add_sample(index, color, surface.normal, surface.tangent, depth, f32(draw + 1u));
    add_aovs(index, draw, surface, shaded);
}
