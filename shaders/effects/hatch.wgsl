// Hatch: cross-hatching in ink, whose lines grow as the tone darkens.
//@ use lib/surface
//@ use lib/color
//@ use lib/angle

struct Hatch {
    /// Color of the lines, linear.
    @color(0.012, 0.014, 0.03) ink: vec4f,
    /// Color between the lines, linear.
    @color(0.86, 0.82, 0.72) paper: vec4f,
    /// The space in which the lines are drawn.
    @choice(screen, surface) space: u32,
    /// Distance of two lines in the picture.
    @range(3, 24, 6) @hard(0.25, 1024) @unit(px) @when(space, screen) spacing_px: f32,
    /// Distance of two planes.
    @range(0.01, 0.5, 0.06) @hard(0.001, 1000) @unit(m) @log @when(space, surface) spacing_m: f32,
    /// Direction of the first layer; the second crosses it, two more lie between.
    @range(-90, 90, 35) @hard(-360, 360) @unit(°) angle_deg: f32,
    /// Layers that appear one after the other.
    @range(1, 4, 3) layers: u32,
    /// Width of a full line, as a fraction of the spacing.
    @range(0.05, 1, 0.55) width: f32,
    /// Tone at which every layer is full, as the eye sees it.
    @range(0, 1, 0.05) dark: f32,
    /// Tone from which the paper stays bare.
    @range(0, 1, 0.9) bright: f32,
    /// How much of the surface's hue the paper takes on.
    @range(0, 1, 0) tint: f32,
}

@smooth
fn hatch(surface: Surface, p: Hatch) -> Surface {
    var s = surface;
    let base = max(s.color.rgb, vec3f(0.0));
    let tone = min(sqrt(color_luminance(base)), 1.0);
    let darkness = 1.0 - clamp((tone - p.dark) / max(p.bright - p.dark, 0.2), 0.0, 1.0);
    var bare = 1.0;
    for (var layer = 0u; layer < p.layers; layer += 1u) {
        let width = clamp(darkness * f32(p.layers) - f32(layer), 0.0, 1.0) * p.width;
        bare *= 1.0 - hatch_line(s, p, layer, width);
    }
    let brightest = max(max(base.r, base.g), base.b);
    var hue = vec3f(1.0);
    if brightest > 1e-6 { hue = base / brightest; }
    let paper = p.paper.rgb + (p.paper.rgb * hue - p.paper.rgb) * p.tint;
    // Mixed in the scale of the tone, close to perception: in linear light a trace of paper would outshine the ink.
    let mixed = mix(sqrt(p.ink.rgb), sqrt(paper), bare);
    s.color = vec4f(mixed * mixed, s.color.a);
    return s;
}

// Fraction of the pixel under the lines of a layer, whose width is a fraction of their spacing.
fn hatch_line(s: Surface, p: Hatch, layer: u32, width: f32) -> f32 {
    // Two crossed layers, then two between them.
    let along = direction_degrees(p.angle_deg + f32(layer & 1u) * 90.0 + f32(layer >> 1u) * 45.0);
    var position = (s.pixel.y * along.x - s.pixel.x * along.y) / p.spacing_px;
    var spacing_px = p.spacing_px;
    if p.space == HATCH_SPACE_SURFACE {
        let across = normalize(vec3f(-along.y, along.x, f32(layer >> 1u)));
        // Change of the distance to the planes from pixel to pixel; limited where the surface is parallel to the planes or
        // seen edge-on, and by the resolution of f32 in the world.
        let change = across - s.normal * (dot(across, s.view) / max(dot(s.normal, s.view), 0.1));
        let per_px = max(s.pixel_size_m * max(length(change), 0.4), 1.5e-4 * (length(s.position) + s.depth_m));
        position = dot(s.position, across) / p.spacing_m;
        spacing_px = p.spacing_m / per_px;
    }
    let distance = abs(position - floor(position) - 0.5) * spacing_px;
    let half = 0.5 * width * spacing_px;
    let covered = clamp(min(distance + 0.5, half) - max(distance - 0.5, -half), 0.0, 1.0);
    // Lines closer than a pixel become their mean.
    return width + (covered - width) * clamp(spacing_px - 1.0, 0.0, 1.0);
}
