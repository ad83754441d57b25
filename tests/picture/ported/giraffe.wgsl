// Giraffe: patches of a hide, each a little different, with light seams between them.
//@ use lib/noise
//@ use lib/surface

struct Giraffe {
    /// Color of the patches.
    @color(0.35, 0.16, 0.05) patch_color: vec4f,
    /// Color of the seams.
    @color(0.8, 0.62, 0.36) seam: vec4f,
    /// Patches per meter.
    @range(0.5, 12.0, 3.0) scale: f32,
    /// Width of the seams.
    @range(0.01, 0.3, 0.1) width: f32,
}

fn giraffe(surface: Surface, p: Giraffe) -> Surface {
    var s = surface;
    let found = noise_cellular(p.scale * s.position, 5u);
    let inside = clamp((found.y - found.x - 0.5 * p.width) / p.width, 0.0, 1.0);
    let color = p.patch_color.rgb * (0.7 + 0.6 * found.z);
    s.color = vec4f(mix(p.seam.rgb, color, inside), s.color.a);
    return s;
}
