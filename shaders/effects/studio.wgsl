// Studio: metals, plastics and glazes under a sun and what surrounds them.
//
// A surface reflects as glTF 2.0 says: microfacets distributed after Trowbridge and Reitz (GGX), masked and shadowed after Smith
// with heights correlated (Heitz 2014), with Schlick's Fresnel. Light that meets several facets leaves matt, in the color of that
// many reflections (Kulla and Conty 2017), and what is not reflected enters a matt body, so that white stays white. The fractions
// of light that this takes are rational functions fitted to the integral over all directions, within 0.013 of it.
//@ use lib/surface
//@ use lib/angle
//@ use lib/environment
//@ use variants/surroundings

struct Studio {
    /// Color of the sun, linear.
    @color(0.5, 0.47, 0.42) sun: vec4f,
    /// Direction towards the sun, of any length.
    @point(0.55, 0.8, 0.6) @hard(-1000, 1000) @soft(-1, 1) sun_direction: vec4f,
    /// What surrounds the scene and is reflected.
    @choice(studio, overcast, low_sun, night, picture) environment: u32,
    /// Turns the environment about the vertical axis.
    @range(-180, 180, 0) @hard(-36000, 36000) @unit(°) turn_deg: f32,
    /// Strength of the environment's light.
    @range(0, 4, 1) @hard(0, 1000) strength: f32,
    /// Where metallic and roughness come from.
    @choice(scene, own) material: u32,
    /// 0: not a metal; 1: a metal, which reflects its base color.
    @range(0, 1, 0) @when(material, own) metallic: f32,
    /// Perceptual roughness: 0 a mirror, 1 matt.
    @range(0, 1, 0.4) @when(material, own) roughness: f32,
    /// Strength of the lights that come with the scene; they cast no shadows. 1: a white matt
    /// surface shows lux divided by π, as in three.js; 0: they are off.
    @range(0, 4, 1) @hard(0, 1000) lights: f32,
}

@smooth
fn studio(surface: Surface, p: Studio) -> Surface {
    var s = surface;
    let m = studio_material(s, p);
    let seen = studio_albedo(m, max(dot(s.normal, s.view), STUDIO_GRAZING));

    let squared = dot(p.sun_direction.xyz, p.sun_direction.xyz);
    let toward = select(vec3f(0.0, 1.0, 0.0), p.sun_direction.xyz / sqrt(squared), squared > 0.0);
    let arrives = 1.0 - p.sun_direction.w * (1.0 - s.lit);
    let from_sun = p.sun.rgb * arrives * studio_from_sun(m, seen, s.normal, s.view, toward);

    // The rougher a surface, the nearer to its normal is what it mirrors (Lagarde 2014).
    let mirrored = s.normal * (2.0 * dot(s.normal, s.view)) - s.view;
    let spread = mirrored + (s.normal - mirrored) * (m.alpha * m.alpha);
    let turn = direction_degrees(p.turn_deg);
    let sky = environment_of(p.environment);
    let diffuse = surroundings_irradiance(p.environment, sky, environment_turned(s.normal, turn));
    let reflected = surroundings_radiance(p.environment, sky, environment_turned(spread / sqrt(max(dot(spread, spread), 1e-12)), turn), m.alpha);
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

// Smallest perceptual roughness: a sun without width is not seen in a smoother surface. Smallest cosine between a normal and the eye,
// from which interpolated normals may face away.
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

// Light that leaves towards the eye, of light from one direction that gives a white matt surface its own strength: π times the BRDF,
// times the cosine.
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

//@ variant lights
// The same under the lights that come with the scene, which cast no shadows.
//@ use effects/studio
//@ use lib/surface
//@ use lib/punctual

@smooth
fn studio_under_lights(surface: Surface, p: Studio) -> Surface {
    let m = studio_material(surface, p);
    let seen = studio_albedo(m, max(dot(surface.normal, surface.view), STUDIO_GRAZING));
    var sum = vec3f(0.0);
    for (var i = 0u; i < punctual_count(); i += 1u) {
        let arriving = punctual_arriving(i, surface.position);
        sum += arriving.light * studio_from_sun(m, seen, surface.normal, surface.view, arriving.toward);
    }
    var s = studio(surface, p);
    s.color = vec4f(s.color.rgb + sum * p.lights, s.color.a);
    return s;
}
