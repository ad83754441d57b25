// Shadow: a directional light whose shadows the rasterizer draws itself.
//@ use lib/surface
//@ use lib/angle

struct Shadow {
    /// Color of the light, linear.
    @color(0.92, 0.84, 0.7) @when(shading, lambert) light: vec4f,
    /// Light from straight above that nothing stops, linear.
    @color(0.16, 0.19, 0.24) @when(shading, lambert) sky: vec4f,
    /// Light from straight below that nothing stops, linear.
    @color(0.08, 0.065, 0.055) @when(shading, lambert) ground: vec4f,
    /// Where the light comes from: 0 in front of the scene, 90 from its right.
    @range(-180, 180, 40) @hard(-36000, 36000) @unit(°) azimuth_deg: f32,
    /// Elevation of the light: 90 straight above.
    @range(-90, 90, 48) @unit(°) elevation_deg: f32,
    /// What the light does.
    @choice(lambert, dim) shading: u32,
    /// Fraction of the light that a shadow removes.
    @range(0, 1, 1) strength: f32,
    /// How many texels a surface is moved towards the light before it is compared.
    @range(0, 4, 0.5) @hard(-64, 64) bias: f32,
    /// The same for every unit of the tangent of the angle between the light and the surface's normal.
    @range(0, 4, 0.25) @hard(-64, 64) slope: f32,
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
