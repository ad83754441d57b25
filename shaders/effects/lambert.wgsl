// Lambert: diffuse light from sun, sky, ground and a headlight.
//@ use lib/surface

struct Lambert {
    /// Color of the sun, linear.
    @color(0.82, 0.76, 0.66) sun: vec4f,
    /// Light from straight above, linear.
    @color(0.16, 0.19, 0.24) sky: vec4f,
    /// Light from straight below, linear.
    @color(0.07, 0.055, 0.045) ground: vec4f,
    /// Direction towards the sun, of any length.
    @point(0.55, 0.8, 0.6) @hard(-1000, 1000) @soft(-1, 1) sun_direction: vec4f,
    /// Strength of a white light at the eye.
    @range(0, 1, 0.08) @hard(0, 10) headlight: f32,
}

@smooth
fn lambert(surface: Surface, p: Lambert) -> Surface {
    var s = surface;
    let squared = dot(p.sun_direction.xyz, p.sun_direction.xyz);
    let toward = select(vec3f(0.0, 1.0, 0.0), p.sun_direction.xyz / sqrt(squared), squared > 0.0);
    let sun = max(dot(s.normal, toward), 0.0);
    let headlight = max(dot(s.normal, s.view), 0.0) * p.headlight;
    let up = 0.5 + 0.5 * s.normal.y;
    let light = p.sun.rgb * sun + p.ground.rgb + (p.sky.rgb - p.ground.rgb) * up + vec3f(headlight);
    s.color = vec4f((s.color.rgb - s.glow) * light + s.glow, s.color.a);
    return s;
}
