// Lambert: diffuse light from a sun, a sky above and ground below, and a headlight.
//@ use lib/surface

struct Lambert {
    sun: vec4f,
    sky: vec4f,
    ground: vec4f,
    sun_direction: vec4f,
    headlight: f32,
}

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
