// Shadow: a directional light with a shadow map, which the rasterizer itself draws from the light.
//@ use lib/surface
//@ use lib/angle

struct Shadow {
    light: vec4f,
    sky: vec4f,
    ground: vec4f,
    azimuth_deg: f32,
    elevation_deg: f32,
    shading: u32,
    strength: f32,
    bias: f32,
    slope: f32,
}

fn shadow_toward(p: Shadow) -> vec3f {
    let azimuth = direction_degrees(p.azimuth_deg);
    let elevation = direction_degrees(p.elevation_deg);
    return vec3f(elevation.x * azimuth.y, elevation.y, elevation.x * azimuth.x);
}

fn shadow(surface: Surface, p: Shadow) -> Surface {
    var s = surface;
    let facing = max(dot(s.normal, shadow_toward(p)), 0.0);
    let arrives = 1.0 - p.strength * (1.0 - s.lit);
    let up = 0.5 + 0.5 * s.normal.y;
    var shade = p.light.rgb * (facing * arrives) + p.ground.rgb + (p.sky.rgb - p.ground.rgb) * up;
    // A surface that the light only grazes is dim already.
    if p.shading == SHADOW_SHADING_DIM { shade = vec3f(1.0 - p.strength * (1.0 - s.lit * min(4.0 * facing, 1.0))); }
    s.color = vec4f((s.color.rgb - s.glow) * shade + s.glow, s.color.a);
    return s;
}
