// Glass: parts of the scene through which others are seen, layer behind layer. Mirrors `effects::glass`.
//@ use lib/surface
//@ use lib/glass

struct Glass {
    tint: vec4f,
    mirrored: vec4f,
    thickness: f32,
    fresnel: f32,
    frost: f32,
}

// Reflectance of glass seen face on.
const GLASS_FACE_ON = 0.04;
// Least cosine at which a line of sight grows longer: it breaks as it enters, and stays steeper.
const GLASS_STEEPEST = 0.66;

// The layer of a shaded surface.
fn glass(s: Surface, p: Glass) -> GlassLayer {
    let cosine = min(abs(dot(s.normal, s.view)), 1.0);
    let path = p.thickness / max(cosine, GLASS_STEEPEST);
    let tinted = pow(clamp(p.tint.rgb, vec3f(1e-6), vec3f(1.0)), vec3f(path));
    let slant = 1.0 - cosine;
    let squared = slant * slant;
    let mirrored = p.fresnel * (GLASS_FACE_ON + (1.0 - GLASS_FACE_ON) * squared * squared * slant);
    let clear = 1.0 - p.frost;
    return GlassLayer(
        tinted * ((1.0 - mirrored) * clear),
        clamp(p.mirrored.rgb, vec3f(0.0), vec3f(1.0)) * (mirrored * clear)
            + clamp(s.color.rgb, vec3f(0.0), vec3f(1.0)) * p.frost);
}
