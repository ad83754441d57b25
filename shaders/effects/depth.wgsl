// Depth: shades by distance from the eye. It is fitted to the scene, or goes by a scale and an offset of your own.
//@ use lib/surface

struct Depth {
    /// Color at the near end, linear.
    @color(1, 0.93, 0.8) near: vec4f,
    /// Color at the far end, linear.
    @color(0.015, 0.03, 0.07) far: vec4f,
    /// Spread the two colors over the depth range of the scene.
    @toggle(1) fit: u32,
    /// Without fit: how much of the way to the far color one meter takes.
    @range(0, 2, 0.2) @hard(-1e6, 1e6) @unit(per m) @depth scale: f32,
    /// Without fit: position of the eye between the two colors, 0 near and 1 far.
    @range(-2, 2, 0) @hard(-1e6, 1e6) offset: f32,
}

@smooth
fn depth(surface: Surface, p: Depth) -> Surface {
    var s = surface;
    // A scene that is flat across the view has no depth to be spread; what f32 tells apart is spread no further.
    let room_m = max(s.depth_range_m.y - s.depth_range_m.x, 1e-4 * abs(s.depth_range_m.y) + 1e-20);
    let fitted = (s.depth_m - s.depth_range_m.x) / room_m;
    let position = select(s.depth_m * p.scale + p.offset, fitted, p.fit != 0u);
    let shade = p.near + (p.far - p.near) * clamp(position, 0.0, 1.0);
    s.glow = vec3f(0.0);
    s.color = vec4f(shade.rgb, s.color.a);
    return s;
}
