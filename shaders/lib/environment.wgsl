// Environments: a sky, a ground and three lights, which are spherical Gaussians. The light on a matt surface is the sum of their
// spherical harmonics up to the second band (Ramamoorthi and Hanrahan 2001); a rough mirror shows them blurred by lobes fitted to
// that of GGX about the normal.

// Numbers of environments; any other is the studio.
const ENVIRONMENT_OVERCAST = 1u;
const ENVIRONMENT_LOW_SUN = 2u;
const ENVIRONMENT_NIGHT = 3u;

// A light of an environment: a lobe about a direction.
struct EnvironmentLight {
    toward: vec3f,
    mean: f32, // mean cosine of the angle between its light and its direction
    color: vec3f,
}

struct Environment {
    zenith: vec3f,
    horizon: vec3f,
    ground: vec3f,
    lights: array<EnvironmentLight, 3>,
}

fn environment_of(environment: u32) -> Environment {
    switch environment {
        case ENVIRONMENT_OVERCAST: {
            return Environment(vec3f(0.86, 0.9, 0.95), vec3f(0.5, 0.53, 0.57), vec3f(0.16, 0.15, 0.135), array<EnvironmentLight, 3>(
                EnvironmentLight(vec3f(0.28, 0.8, 0.530660), 0.84, vec3f(0.2, 0.2, 0.195)),
                EnvironmentLight(vec3f(0.0, 1.0, 0.0), 0.84, vec3f(0.0)),
                EnvironmentLight(vec3f(0.0, 1.0, 0.0), 0.84, vec3f(0.0))));
        }
        case ENVIRONMENT_LOW_SUN: {
            return Environment(vec3f(0.13, 0.2, 0.36), vec3f(0.62, 0.4, 0.27), vec3f(0.1, 0.075, 0.06), array<EnvironmentLight, 3>(
                EnvironmentLight(vec3f(0.6, 0.14, 0.787655), 0.995, vec3f(0.42, 0.25, 0.1)),
                EnvironmentLight(vec3f(0.6, 0.14, 0.787655), 0.88, vec3f(0.42, 0.2, 0.07)),
                EnvironmentLight(vec3f(-0.6, 0.3, -0.741620), 0.84, vec3f(0.06, 0.075, 0.13))));
        }
        case ENVIRONMENT_NIGHT: {
            return Environment(vec3f(0.006, 0.01, 0.024), vec3f(0.03, 0.038, 0.06), vec3f(0.012, 0.011, 0.012), array<EnvironmentLight, 3>(
                EnvironmentLight(vec3f(-0.5, 0.62, 0.604649), 0.995, vec3f(0.12, 0.15, 0.22)),
                EnvironmentLight(vec3f(0.84, 0.16, 0.518459), 0.98, vec3f(0.3, 0.16, 0.05)),
                EnvironmentLight(vec3f(-0.86, 0.1, -0.500400), 0.96, vec3f(0.02, 0.1, 0.12))));
        }
        default: {
            return Environment(vec3f(0.46, 0.47, 0.5), vec3f(0.2, 0.205, 0.215), vec3f(0.09, 0.085, 0.08), array<EnvironmentLight, 3>(
                EnvironmentLight(vec3f(-0.55, 0.62, 0.559553), 0.955, vec3f(0.58, 0.56, 0.52)),
                EnvironmentLight(vec3f(0.86, 0.28, 0.426615), 0.95, vec3f(0.16, 0.17, 0.19)),
                EnvironmentLight(vec3f(0.2, 0.5, -0.842615), 0.98, vec3f(0.34, 0.35, 0.38))));
        }
    }
}

// A direction in a sky that is turned about the vertical axis.
fn environment_turned(d: vec3f, turn: vec2f) -> vec3f {
    return vec3f(turn.x * d.x - turn.y * d.z, d.y, turn.y * d.x + turn.x * d.z);
}

// Concentration of a lobe with this mean cosine (Banerjee and others 2005).
fn environment_concentration(mean: f32) -> f32 {
    return mean * (3.0 - mean * mean) / (1.0 - mean * mean);
}

// Light that a white matt surface shows: the sky's spherical harmonics up to the second band.
fn environment_irradiance(sky: Environment, normal: vec3f) -> vec3f {
    let y = normal.y;
    let above = 0.25 + y / 3.0 + (0.1171875 * y * y - 0.0390625);
    var sum = sky.ground * (0.5 - 0.5 * y) + sky.horizon * (0.5 + 0.5 * y - above) + sky.zenith * above;
    sum += environment_light_irradiance(sky.lights[0], normal);
    sum += environment_light_irradiance(sky.lights[1], normal);
    sum += environment_light_irradiance(sky.lights[2], normal);
    return max(sum, vec3f(0.0));
}

fn environment_light_irradiance(light: EnvironmentLight, normal: vec3f) -> vec3f {
    let c = dot(normal, light.toward);
    let second = 1.0 - 3.0 * light.mean / environment_concentration(light.mean);
    return light.color * (0.25 + 0.5 * light.mean * c + 0.3125 * second * (1.5 * c * c - 0.5));
}

// What a mirror of this roughness shows in a direction.
fn environment_radiance(sky: Environment, d: vec3f, alpha: f32) -> vec3f {
    // How far below 1 the mean cosine lies of what GGX mirrors about the normal; fitted within 0.004, and a third at 1.
    let blur = alpha * alpha / (0.1272 + alpha * (0.8497 + 2.0231 * alpha));
    let mean = 1.0 - blur;
    // The horizon is soft, so that f32 shows it alike.
    let width = sqrt(0.0016 + 3.0 * blur);
    let y = d.y * mean;
    let t = clamp((y + width) / (2.0 * width), 0.0, 1.0);
    let upper = t * t * (3.0 - 2.0 * t);
    // The integral of that: how high the visible sky is.
    let above = 2.0 * width * t * t * t * (1.0 - 0.5 * t) + max(y - width, 0.0);
    var sum = sky.ground * (1.0 - upper) + sky.horizon * (upper - above) + sky.zenith * above;
    sum += environment_light_radiance(sky.lights[0], d, alpha);
    sum += environment_light_radiance(sky.lights[1], d, alpha);
    sum += environment_light_radiance(sky.lights[2], d, alpha);
    return sum;
}

fn environment_light_radiance(light: EnvironmentLight, d: vec3f, alpha: f32) -> vec3f {
    // A smooth mirror blurs it by a lobe as bright in its middle as that of GGX, fitted within 2 %; a matt one is as any matt surface.
    let squared = alpha * alpha;
    let spread = 2.0 * squared / (1.0 + alpha * (0.6749 + 2.3251 * alpha));
    let narrow = environment_concentration(light.mean);
    let sharp = narrow / (1.0 + narrow * spread);
    let lobe = light.color * (0.5 * sharp / (1.0 - exp(-2.0 * sharp)) * exp(sharp * (dot(d, light.toward) - 1.0)));
    return lobe + (max(environment_light_irradiance(light, d), vec3f(0.0)) - lobe) * squared;
}
