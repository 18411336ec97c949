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
    return EvenLight(simple_ambient(material, sin_theta_o), vec3f(0.0));
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

fn look_around(yarn: Yarn, surface: Surface, seen: SeenPoint, transport: TransportPoint, hidden: vec3f, even: vec3f) -> Around {
    var around: Around;
    let share = 1.0 / f32(max(frame.sky_view_count, 1u));
    if frame.sky_view_count == 0u {
        return around;
    }
    var i = 0u;
    loop {
        let direction = sky_direction(frame.sky_view + i);
        let shadow = tube_shadow(frame.sky_view + i, shadow_tube(yarn, surface.tube), surface.position, direction);
        let by_yarns = 1.0 - shadow.open - shadow.solid;
        around.open += share * shadow.open;
        if MULTIPLE {
            let scattered = transport_ambient(transport, seen.section, direction) * hidden;
            around.sky += (share * shadow.open) * scattered;
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

// Share of the directions around a point of a cloth in which it sees the sky: one of its two sides.
const CLOTH_OPEN: f32 = 0.5;

// Share of a cloth's surfaces on the side of a light from its front or back that the light reaches, others being behind them: by rays through
// tubes 0.62 in a knit, 0.68 and 0.66 in a plain weave, 0.61 in a glove.
const CLOTH_LIT: f32 = 0.63;

// Sine of the angle between such a light and the yarns, which lie across it: the mean in those three is 0.82 to 0.87; of yarns in all directions alike, for
// which tables have their radiance, π / 4.
const CLOTH_SINE: f32 = 0.85;
const ISOTROPIC_SINE: f32 = 0.25 * PI;

// Light through so many yarns' diameters, one after the other, has come through the cloth that a point is in, or along it: it starts to at the
// one, and has at the other.
const CLOTH_BEGIN: f32 = 1.5;
const CLOTH_END: f32 = 3.0;

// What other yarns leave of a light.
struct Passing {
    // Share that comes straight.
    straight: f32,
    // Share that they scatter on, over the half space of the light: each yarn some, as hairs do in [Zinke2008].
    spread: vec3f,
    // Share that comes to the cloth that the point is in.
    on_cloth: f32,
}

// Of light that fibers take, by a share of the light on the yarn's circle, in which is what goes beside them. Never 0, of which a power may be no number,
// nor by rounding, where a yarn of one fiber takes next to nothing, more than all.
fn taken_share(yarn: Yarn, share: vec3f) -> vec3f {
    return clamp((share - (1.0 - yarn.tube_radius)) / max(yarn.tube_radius, 1e-6), vec3f(1e-6), vec3f(1.0));
}

// A place about a yarn's radius beside a point, across the way to a light, in a random direction: within the yarn's width.
fn place_beside(surface: Surface, toward_light: vec3f, random: vec3f) -> vec3f {
    let aside = random - toward_light * dot(random, toward_light);
    let across = cross(toward_light, surface.tube.tangent);
    let side = across / max(length(across), 1e-6);
    let here = dot(surface.position - surface.tube.center, side) / surface.tube.radius;
    let beyond = here + dot(aside, side);
    // Reflected by the yarn's edge.
    let there = select(beyond, 2.0 * sign(beyond) - beyond, abs(beyond) > 1.0);
    return surface.position + surface.tube.radius * (aside + side * (there - beyond));
}

fn passing_light(yarn: Yarn, through: vec3f, light: Light, incident: Incident, tube: Tube, position: vec3f) -> Passing {
    let shadow = light_shadow(light, incident, shadow_tube(yarn, tube), position);
    // Meshes let nothing through.
    let blocked = 1.0 - shadow.open - shadow.solid;
    var spread = vec3f(0.0);
    var on_cloth = shadow.open;
    if MULTIPLE {
        // Through air it is spread as well, so that all of the way counts.
        let yarns_above = max(shadow.way / (2.0 * tube.radius), 1.0);
        spread = blocked * pow(taken_share(yarn, through), vec3f(yarns_above));
        on_cloth += blocked * (1.0 - smoothstep(CLOTH_BEGIN, CLOTH_END, yarns_above));
    }
    return Passing(shadow.open, spread, on_cloth);
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
    let even = even_lobes.around + even_lobes.through;
    let own_sky = self_sky(yarn, seen);
    var transport: TransportPoint;
    var albedo: YarnAlbedo;
    // Light that yarns lit alike send each other.
    var gain: vec3f;
    // Light scattered more than once comes from the directions in which fibers are. A point that is seen has fewer of them than others there,
    // but as many behind, where light comes from that goes straight on.
    var hidden: vec3f;
    if MULTIPLE {
        transport = transport_point(draws[draw].transport, section, surface.tube.tangent, view);
        albedo = yarn_albedo(draws[draw].transport);
        let around_it = (1.0 - own_sky) / max(1.0 - self_occlusion(yarn, section), 0.01);
        hidden = (even_lobes.around * around_it + even_lobes.through) / max(even, vec3f(1e-6));
        gain = 1.0 / (1.0 - (1.0 - CLOTH_OPEN) * albedo.albedo);
    }
    let around = look_around(yarn, surface, seen, transport, hidden, even);
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
        let passing = passing_light(yarn, albedo.through, light, incident, surface.tube, surface.position);
        let reflected = reflected_once(material, surface, incident.direction, view);
        let straight = incident.irradiance * (own.width * passing.straight);
        shaded.once.specular += reflected.specular * straight;
        shaded.once.transmission += reflected.transmission * straight;
        shaded.once.diffuse += reflected.diffuse * incident.irradiance * (own.point * passing.straight);
        shaded.arriving += luminance(straight);
        shaded.shining += luminance(incident.irradiance);
        if MULTIPLE {
            // TT takes in what other yarns scatter as far as that half space is behind the fiber.
            let behind = 0.5 - 0.5 * dot(section_direction(section, incident.direction).unit, seen.view);
            shaded.scattered += (0.5 * even_lobes.around + behind * even_lobes.through) * incident.irradiance * passing.spread * (own.width / PI);
            // Fibers send each other light over about a yarn's radius, which blurs the shadows in it [Khungurn2017 §5.3.2]: another place for each sample.
            let place = place_beside(surface, incident.direction, sky_direction(frame.sky_view));
            let blurred = passing_light(yarn, albedo.through, light, incident, surface.tube, place);
            let arriving = incident.irradiance * (blurred.straight + blurred.spread);
            shaded.scattered += transport_radiance(transport, section, incident.direction) * arriving * hidden;
            // Neighbours have the mean irradiance of the cloth: some are lit, and the others by what those scatter on.
            let on_lit = incident.irradiance * (blurred.on_cloth * CLOTH_SINE / ISOTROPIC_SINE);
            let on_neighbours = on_lit * mix(taken_share(yarn, albedo.through), vec3f(1.0), CLOTH_LIT);
            shaded.scattered += neighbours_radiance(draws[draw].transport, around, incident.direction) * on_neighbours * gain;
        }
        if i >= frame.light_count {
            break;
        }
    }
    let own_behind = self_shadow_behind(yarn, seen, material.gamma_tt);
    var sky = (even_lobes.around * own_sky + even_lobes.through * own_behind) * around.open;
    if MULTIPLE {
        sky += around.sky;
        for (var k = 0u; k < frame.sky_view_count; k++) {
            sky += around.yarns[k] * albedo.albedo * (CLOTH_OPEN * gain);
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
