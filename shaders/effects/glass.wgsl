// Glass: tinted panes that mirror at a slant, composed in the order of depth.
//@ use lib/surface
//@ use lib/glass

struct Glass {
    /// Fraction of each channel that passes a pane of thickness 1 seen face on, linear.
    @color(0.62, 0.86, 0.8) tint: vec4f,
    /// Color of the surroundings that are mirrored, linear.
    @color(0.75, 0.83, 0.9) mirrored: vec4f,
    /// Thickness in panes; a slanted line of sight is longer inside the glass.
    @range(0, 5, 1) @hard(0, 100) thickness: f32,
    /// How strongly the surroundings are mirrored, by Fresnel's law of glass (Schlick 1994): 0 not at all.
    @range(0, 1, 1) fresnel: f32,
    /// Fraction that the surface's own color covers, like dust or frost.
    @range(0, 1, 0.06) frost: f32,
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
