// Depth: shades by distance from the eye, fitted to the scene or by a scale and an offset of your own.
//@ use lib/surface

struct Depth {
    near: vec4f,
    far: vec4f,
    fit: u32,
    scale: f32,
    offset: f32,
}

fn depth(surface: Surface, p: Depth) -> Surface {
    var s = surface;
    let fitted = (s.depth_m - s.depth_range_m.x) / (s.depth_range_m.y - s.depth_range_m.x);
    let position = select(s.depth_m * p.scale + p.offset, fitted, p.fit != 0u);
    let shade = p.near + (p.far - p.near) * clamp(position, 0.0, 1.0);
    s.glow = vec3f(0.0);
    s.color = vec4f(shade.rgb, s.color.a);
    return s;
}
