// Densities of directions about a fiber that random numbers turn into directions in closed form; twin of
// native/core/src/scattering/lobe.rs, where they are derived. Directions are in the axes of `fiber_frame`.

const LOBE_CONE_UNIFORM: u32 = 0u;
const LOBE_CONE_HALF_COSINE: u32 = 1u;
const LOBE_CONE_STRAIGHT: u32 = 2u;
const LOBE_LAMBERT: u32 = 3u;
const LOBE_EVEN: u32 = 4u;

struct Lobe {
    // Of the light that is scattered, about; 0 for a lobe that is not used.
    share: f32,
    kind: u32,
    // Of the Gaussian in θ that a cone's logistic density stands for.
    sigma: f32,
    // r - 1 of the wrapped Cauchy density of the azimuth, straight through.
    excess: f32,
}

struct Mixture {
    lobes: array<Lobe, 3>,
}

const LOGISTIC_SCALE: f32 = 0.65;

// A logistic density cut off at ±π/2.
struct Longitude {
    center: f32,
    scale: f32,
    below: f32,
    // 1 - the cumulative density at π/2: kept, since near 1 that has few digits.
    above: f32,
}

fn cone_longitude(center: f32, sigma: f32) -> Longitude {
    let scale = LOGISTIC_SCALE * sigma;
    let below = 1.0 / (1.0 + exp(min((0.5 * PI + center) / scale, 80.0)));
    let above = 1.0 / (1.0 + exp(min((0.5 * PI - center) / scale, 80.0)));
    return Longitude(center, scale, below, above);
}

fn longitude_sample(l: Longitude, u: f32) -> f32 {
    // p / (1 - p), both from sums of positive terms.
    let p = (1.0 - u) * l.below + u * (1.0 - l.above);
    let rest = (1.0 - u) * (1.0 - l.below) + u * l.above;
    return clamp(l.center + l.scale * log(max(p, 1e-30) / max(rest, 1e-30)), -0.5 * PI, 0.5 * PI);
}

fn longitude_density(l: Longitude, theta: f32) -> f32 {
    let e = exp(-abs((theta - l.center) / l.scale));
    return e / (l.scale * (1.0 + e) * (1.0 + e) * (1.0 - l.below - l.above));
}

// The wrapped Cauchy density for a von Mises density of width γ [BestFisher1979].
fn straight_excess(gamma: f32) -> f32 {
    let half = 0.5 * gamma * gamma;
    let square = half * half;
    return half + square / (1.0 + sqrt(1.0 + square));
}

fn azimuth_sample(lobe: Lobe, u: f32) -> f32 {
    switch lobe.kind {
        case LOBE_CONE_HALF_COSINE: { return 2.0 * asin(clamp(2.0 * u - 1.0, -1.0, 1.0)); }
        case LOBE_CONE_STRAIGHT: {
            return PI + 2.0 * atan(sqrt(lobe.excess / (lobe.excess + 2.0)) * tan(PI * (u - 0.5)));
        }
        default: { return 2.0 * PI * u; }
    }
}

fn azimuth_density(lobe: Lobe, cos_phi: f32) -> f32 {
    switch lobe.kind {
        case LOBE_CONE_HALF_COSINE: { return 0.25 * sqrt(max(0.5 + 0.5 * cos_phi, 0.0)); }
        case LOBE_CONE_STRAIGHT: {
            return AZIMUTHAL_UNIFORM * sqrt(lobe.excess * (lobe.excess + 2.0)) / (lobe.excess + (1.0 + cos_phi));
        }
        default: { return AZIMUTHAL_UNIFORM; }
    }
}

// The azimuth to a direction along the fiber is that to the normal.
fn across_of(direction: vec3f) -> vec2f {
    let size = length(direction.xy);
    return select(vec2f(1.0, 0.0), direction.xy / max(size, 1e-30), size > 0.0);
}

fn lobe_sample(lobe: Lobe, viewer: vec3f, u: vec2f) -> vec3f {
    if lobe.kind == LOBE_LAMBERT {
        let phi = 2.0 * PI * u.y;
        return vec3f(sqrt(1.0 - u.x), sqrt(u.x) * cos(phi), sqrt(u.x) * sin(phi));
    }
    var theta = PI * (u.x - 0.5);
    var across = vec2f(1.0, 0.0);
    if lobe.kind != LOBE_EVEN {
        theta = longitude_sample(cone_longitude(-longitude(viewer), lobe.sigma), u.x);
        across = across_of(viewer);
    }
    let phi = azimuth_sample(lobe, u.y);
    let turned = across * cos(phi) + vec2f(-across.y, across.x) * sin(phi);
    return vec3f(turned * sin(0.5 * PI - abs(theta)), sin(theta));
}

// 1/sr.
fn lobe_density(lobe: Lobe, viewer: vec3f, direction: vec3f) -> f32 {
    if lobe.kind == LOBE_LAMBERT {
        return max(direction.x, 0.0) / PI;
    }
    let cos_theta = length(direction.xy);
    if cos_theta <= 0.0 {
        return 0.0;
    }
    if lobe.kind == LOBE_EVEN {
        return AZIMUTHAL_UNIFORM / (PI * cos_theta);
    }
    let cos_phi = clamp(dot(direction.xy / cos_theta, across_of(viewer)), -1.0, 1.0);
    let l = cone_longitude(-longitude(viewer), lobe.sigma);
    return longitude_density(l, longitude(direction)) / cos_theta * azimuth_density(lobe, cos_phi);
}

// A direction of light for three numbers in [0, 1), the first of which chooses the lobe. Only for mixtures with a share above 0.
fn mixture_sample(mixture: Mixture, viewer: vec3f, u: vec3f) -> vec3f {
    var left = u.x * (mixture.lobes[0].share + mixture.lobes[1].share + mixture.lobes[2].share);
    var chosen = 0u;
    for (var k = 0u; k < 3u; k++) {
        let share = mixture.lobes[k].share;
        if share > 0.0 {
            chosen = k;
            if left < share {
                break;
            }
            left -= share;
        }
    }
    return lobe_sample(mixture.lobes[chosen], viewer, u.yz);
}

// Density of `mixture_sample`, 1/sr; 0 where nothing is scattered.
fn mixture_density(mixture: Mixture, viewer: vec3f, direction: vec3f) -> f32 {
    var total = 0.0;
    var density = 0.0;
    for (var k = 0u; k < 3u; k++) {
        let share = mixture.lobes[k].share;
        if share > 0.0 {
            total += share;
            density += share * lobe_density(mixture.lobes[k], viewer, direction);
        }
    }
    return density / max(total, 1e-30);
}

fn mean_of(color: vec3f) -> f32 {
    return (color.x + color.y + color.z) / 3.0;
}
