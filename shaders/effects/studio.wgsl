// Studio: materials of glTF 2.0 under a sun and an environment. The formulas and their sources are explained in `effects/studio`.
//@ use lib/surface
//@ use lib/angle

struct Studio {
    sun: vec4f,
    sun_direction: vec4f,
    environment: u32,
    turn_deg: f32,
    strength: f32,
    material: u32,
    metallic: f32,
    roughness: f32,
    lights: f32,
}

fn studio(surface: Surface, p: Studio) -> Surface {
    var s = surface;
    let m = studio_material(s, p);
    let seen = studio_albedo(m, max(dot(s.normal, s.view), STUDIO_GRAZING));

    let squared = dot(p.sun_direction.xyz, p.sun_direction.xyz);
    let toward = select(vec3f(0.0, 1.0, 0.0), p.sun_direction.xyz / sqrt(squared), squared > 0.0);
    let arrives = 1.0 - p.sun_direction.w * (1.0 - s.lit);
    let from_sun = p.sun.rgb * arrives * studio_from_sun(m, seen, s.normal, s.view, toward);

    let mirrored = s.normal * (2.0 * dot(s.normal, s.view)) - s.view;
    let spread = mirrored + (s.normal - mirrored) * (m.alpha * m.alpha);
    let turn = direction_degrees(p.turn_deg);
    let sky = studio_sky(p.environment);
    let diffuse = studio_irradiance(sky, studio_turned(s.normal, turn));
    let reflected = studio_radiance(sky, studio_turned(spread / sqrt(max(dot(spread, spread), 1e-12)), turn), m.alpha);
    let from_sky = (m.diffuse * (1.0 - seen.all) + seen.repeated) * diffuse + seen.once * reflected;

    s.color = vec4f(from_sun + from_sky * (p.strength * s.finish.occlusion) + s.glow, s.color.a);
    return s;
}

// What the material of a surface does, or that of the parameters.
fn studio_material(s: Surface, p: Studio) -> StudioReflector {
    let has_own = p.material == STUDIO_MATERIAL_OWN && s.finish.specular.a > 0.0;
    let metallic = select(s.finish.metallic, p.metallic, has_own);
    let rough = clamp(select(s.finish.roughness, p.roughness, has_own), STUDIO_SMOOTHEST, 1.0);
    let base = s.color.rgb - s.glow;
    return studio_reflector(
        base * (1.0 - metallic), mix(s.finish.specular.rgb, base, metallic), mix(s.finish.specular.a, 1.0, metallic), rough * rough);
}

// Smallest perceptual roughness, and smallest cosine between a normal and the eye.
const STUDIO_SMOOTHEST = 0.08;
const STUDIO_GRAZING = 0.001;

// What a material does with light.
struct StudioReflector {
    diffuse: vec3f, // color of the light that enters and leaves again
    straight: vec3f, // fraction of light reflected that meets it straight on
    grazing: f32, // of light that grazes it
    alpha: f32, // roughness of its microfacets
    again: vec3f, // of light that a microfacet reflects onto another: the fraction that leaves
    lost_mean: f32, // of one reflection, the mean over all directions of what meets another microfacet
    all_mean: vec3f, // mean over all directions of what is reflected
}

// Of the light that comes from a direction, the fractions that are reflected.
struct StudioAlbedo {
    cosine: f32, // of the angle between the direction and the normal
    lost: f32, // by a white metal: what meets another microfacet
    once: vec3f,
    repeated: vec3f,
    all: vec3f,
}

fn studio_reflector(diffuse: vec3f, straight: vec3f, grazing: f32, alpha: f32) -> StudioReflector {
    let lost = alpha * (0.2233 + alpha * (2.928 * alpha - 0.3193)) / (1.0 + alpha * (6.4332 * alpha - 2.5664));
    let edge = (0.0506 + 0.0513 * alpha) / (1.0 + alpha * (2.4128 + 26.4021 * alpha));
    let mean = straight + (grazing - straight) / 21.0;
    let again = mean * mean * (1.0 - lost) / (1.0 - mean * lost);
    return StudioReflector(diffuse, straight, grazing, alpha, again, lost, straight * (1.0 - lost - edge) + grazing * edge + again * lost);
}

fn studio_albedo(m: StudioReflector, cosine: f32) -> StudioAlbedo {
    let a = m.alpha;
    let c = cosine;
    let lost = a * c * (0.0963 + a * (0.6126 + 3.1906 * a) + c * (0.621 + a * (25.3101 * a - 3.1938) + c * (0.3654 - 2.4222 * a)))
        / (a * a + c * (a * (15.6251 * a - 1.0455) + c * (0.9363 + a * (34.3901 * a - 12.4282) + c * (7.4696 - 10.5106 * a))));
    let sharp = (c * c + a * (c * (9.474 * a + 16.5521 * c - 0.9144) + a * (8.1679 - 0.2622 * a))) / (1.0 + a * (17.0046 + 19.1896 * a + 7.1277 * c));
    let edge = (1.0 - lost) * studio_fifth(1.0 - sqrt(sharp));
    let once = m.straight * (1.0 - lost - edge) + m.grazing * edge;
    let repeated = m.again * lost;
    return StudioAlbedo(c, lost, once, repeated, once + repeated);
}

fn studio_fifth(x: f32) -> f32 {
    let squared = x * x;
    return squared * squared * x;
}

// Light that leaves towards the eye, of light from one direction.
fn studio_from_sun(m: StudioReflector, seen: StudioAlbedo, normal: vec3f, view: vec3f, toward: vec3f) -> vec3f {
    let facing = dot(normal, toward);
    if facing <= 0.0 { return vec3f(0.0); }
    let sum = toward + view;
    let half = sum / sqrt(max(dot(sum, sum), 1e-12));
    let along = dot(normal, half);
    let aside = cross(normal, half);
    let squared = m.alpha * m.alpha;
    let height = dot(aside, aside) + along * along * squared;
    let facets = squared / (height * height);
    let visible = 0.5 / (facing * sqrt(seen.cosine * seen.cosine * (1.0 - squared) + squared)
        + seen.cosine * sqrt(facing * facing * (1.0 - squared) + squared));
    let fresnel = m.straight + (m.grazing - m.straight) * studio_fifth(1.0 - clamp(dot(view, half), 0.0, 1.0));
    let met = studio_albedo(m, facing);
    let repeated = m.again * (seen.lost * met.lost / max(m.lost_mean, 1e-4));
    let diffuse = m.diffuse * (1.0 - seen.all) * (1.0 - met.all) / max(1.0 - m.all_mean, vec3f(1e-3));
    return (fresnel * (facets * visible) + repeated + diffuse) * facing;
}

// A light of an environment: a lobe about a direction.
struct StudioLamp {
    toward: vec3f,
    mean: f32, // mean cosine of the angle between its light and its direction
    light: vec3f,
}

struct StudioSky {
    zenith: vec3f,
    horizon: vec3f,
    ground: vec3f,
    lamps: array<StudioLamp, 3>,
}

fn studio_sky(environment: u32) -> StudioSky {
    switch environment {
        case STUDIO_ENVIRONMENT_OVERCAST: {
            return StudioSky(vec3f(0.86, 0.9, 0.95), vec3f(0.5, 0.53, 0.57), vec3f(0.16, 0.15, 0.135), array<StudioLamp, 3>(
                StudioLamp(vec3f(0.28, 0.8, 0.530660), 0.84, vec3f(0.2, 0.2, 0.195)),
                StudioLamp(vec3f(0.0, 1.0, 0.0), 0.84, vec3f(0.0)),
                StudioLamp(vec3f(0.0, 1.0, 0.0), 0.84, vec3f(0.0))));
        }
        case STUDIO_ENVIRONMENT_LOW_SUN: {
            return StudioSky(vec3f(0.13, 0.2, 0.36), vec3f(0.62, 0.4, 0.27), vec3f(0.1, 0.075, 0.06), array<StudioLamp, 3>(
                StudioLamp(vec3f(0.6, 0.14, 0.787655), 0.995, vec3f(0.42, 0.25, 0.1)),
                StudioLamp(vec3f(0.6, 0.14, 0.787655), 0.88, vec3f(0.42, 0.2, 0.07)),
                StudioLamp(vec3f(-0.6, 0.3, -0.741620), 0.84, vec3f(0.06, 0.075, 0.13))));
        }
        case STUDIO_ENVIRONMENT_NIGHT: {
            return StudioSky(vec3f(0.006, 0.01, 0.024), vec3f(0.03, 0.038, 0.06), vec3f(0.012, 0.011, 0.012), array<StudioLamp, 3>(
                StudioLamp(vec3f(-0.5, 0.62, 0.604649), 0.995, vec3f(0.12, 0.15, 0.22)),
                StudioLamp(vec3f(0.84, 0.16, 0.518459), 0.98, vec3f(0.3, 0.16, 0.05)),
                StudioLamp(vec3f(-0.86, 0.1, -0.500400), 0.96, vec3f(0.02, 0.1, 0.12))));
        }
        default: {
            return StudioSky(vec3f(0.46, 0.47, 0.5), vec3f(0.2, 0.205, 0.215), vec3f(0.09, 0.085, 0.08), array<StudioLamp, 3>(
                StudioLamp(vec3f(-0.55, 0.62, 0.559553), 0.955, vec3f(0.58, 0.56, 0.52)),
                StudioLamp(vec3f(0.86, 0.28, 0.426615), 0.95, vec3f(0.16, 0.17, 0.19)),
                StudioLamp(vec3f(0.2, 0.5, -0.842615), 0.98, vec3f(0.34, 0.35, 0.38))));
        }
    }
}

// A direction in a sky that is turned about the vertical axis.
fn studio_turned(d: vec3f, turn: vec2f) -> vec3f {
    return vec3f(turn.x * d.x - turn.y * d.z, d.y, turn.y * d.x + turn.x * d.z);
}

// Concentration of a lobe with this mean cosine.
fn studio_concentration(mean: f32) -> f32 {
    return mean * (3.0 - mean * mean) / (1.0 - mean * mean);
}

// Light that a white matt surface shows: the sky's spherical harmonics up to the second band.
fn studio_irradiance(sky: StudioSky, normal: vec3f) -> vec3f {
    let y = normal.y;
    let above = 0.25 + y / 3.0 + (0.1171875 * y * y - 0.0390625);
    var sum = sky.ground * (0.5 - 0.5 * y) + sky.horizon * (0.5 + 0.5 * y - above) + sky.zenith * above;
    sum += studio_lamp_irradiance(sky.lamps[0], normal);
    sum += studio_lamp_irradiance(sky.lamps[1], normal);
    sum += studio_lamp_irradiance(sky.lamps[2], normal);
    return max(sum, vec3f(0.0));
}

fn studio_lamp_irradiance(lamp: StudioLamp, normal: vec3f) -> vec3f {
    let c = dot(normal, lamp.toward);
    let second = 1.0 - 3.0 * lamp.mean / studio_concentration(lamp.mean);
    return lamp.light * (0.25 + 0.5 * lamp.mean * c + 0.3125 * second * (1.5 * c * c - 0.5));
}

// What a mirror of this roughness shows in a direction.
fn studio_radiance(sky: StudioSky, d: vec3f, alpha: f32) -> vec3f {
    let blur = alpha * alpha / (0.1272 + alpha * (0.8497 + 2.0231 * alpha));
    let mean = 1.0 - blur;
    let width = sqrt(0.0016 + 3.0 * blur);
    let y = d.y * mean;
    let t = clamp((y + width) / (2.0 * width), 0.0, 1.0);
    let upper = t * t * (3.0 - 2.0 * t);
    let above = 2.0 * width * t * t * t * (1.0 - 0.5 * t) + max(y - width, 0.0);
    var sum = sky.ground * (1.0 - upper) + sky.horizon * (upper - above) + sky.zenith * above;
    sum += studio_lamp_radiance(sky.lamps[0], d, alpha);
    sum += studio_lamp_radiance(sky.lamps[1], d, alpha);
    sum += studio_lamp_radiance(sky.lamps[2], d, alpha);
    return sum;
}

fn studio_lamp_radiance(lamp: StudioLamp, d: vec3f, alpha: f32) -> vec3f {
    let squared = alpha * alpha;
    let spread = 2.0 * squared / (1.0 + alpha * (0.6749 + 2.3251 * alpha));
    let narrow = studio_concentration(lamp.mean);
    let sharp = narrow / (1.0 + narrow * spread);
    let lobe = lamp.light * (0.5 * sharp / (1.0 - exp(-2.0 * sharp)) * exp(sharp * (dot(d, lamp.toward) - 1.0)));
    return lobe + (max(studio_lamp_irradiance(lamp, d), vec3f(0.0)) - lobe) * squared;
}

//@ variant lights
// The same under the lights that come with the scene, which cast no shadows.
//@ use effects/studio
//@ use lib/surface
//@ use lib/punctual

fn studio_under_lights(surface: Surface, p: Studio) -> Surface {
    let m = studio_material(surface, p);
    let seen = studio_albedo(m, max(dot(surface.normal, surface.view), STUDIO_GRAZING));
    var sum = vec3f(0.0);
    for (var i = 0u; i < PUNCTUAL_LIGHTS; i += 1u) {
        let arriving = punctual_arriving(i, surface.position);
        sum += arriving.light * studio_from_sun(m, seen, surface.normal, surface.view, arriving.toward);
    }
    var s = studio(surface, p);
    s.color = vec4f(s.color.rgb + sum * p.lights, s.color.a);
    return s;
}
