// A light as one point sees it.
struct Incident {
    // Unit direction towards the light, and how far it is (1e30 for the sun).
    direction: vec3f,
    distance: f32,
    // Irradiance on a plane facing it.
    irradiance: vec3f,
}

fn incident_light(light: Light, position: vec3f) -> Incident {
    if light.kind == LIGHT_SUN {
        return Incident(light.position, 1e30, light.color);
    }
    let offset = light.position - position;
    let distance = max(length(offset), 1e-6);
    let direction = offset / distance;
    var irradiance = light.color / (distance * distance);
    let cos_axis = -dot(direction, light.axis);
    if light.kind == LIGHT_AREA {
        irradiance *= max(cos_axis, 0.0);
    } else if light.cone.x > -1.5 {
        irradiance *= smoothstep(light.cone.y, light.cone.x, cos_axis);
    }
    return Incident(direction, distance, irradiance);
}
