// Hatch: cross-hatching in ink, whose lines grow as the tone darkens.
//@ use common/surface
//@ use common/tone

struct Hatch {
    ink: vec4f,
    paper: vec4f,
    space: u32,
    spacing_px: f32,
    spacing_m: f32,
    angle_deg: f32,
    layers: u32,
    width: f32,
    dark: f32,
    bright: f32,
    tint: f32,
}

fn hatch(surface: Surface, p: Hatch) -> Surface {
    var s = surface;
    let base = max(s.color.rgb, vec3f(0.0));
    let tone = min(sqrt(tone_luminance(base)), 1.0);
    let darkness = 1.0 - clamp((tone - p.dark) / max(p.bright - p.dark, 0.2), 0.0, 1.0);
    var bare = 1.0;
    for (var layer = 0u; layer < p.layers; layer += 1u) {
        let share = clamp(darkness * f32(p.layers) - f32(layer), 0.0, 1.0) * p.width;
        bare *= 1.0 - hatch_line(s, p, layer, share);
    }
    let brightest = max(max(base.r, base.g), base.b);
    var hue = vec3f(1.0);
    if brightest > 1e-6 { hue = base / brightest; }
    let paper = p.paper.rgb + (p.paper.rgb * hue - p.paper.rgb) * p.tint;
    // Mixed as the eye sees it, as the tone was taken: in linear light a trace of paper would outshine the ink.
    let mixed = mix(sqrt(p.ink.rgb), sqrt(paper), bare);
    s.color = vec4f(mixed * mixed, s.color.a);
    return s;
}

// How much of the pixel the lines of a layer take that are `share` of their spacing wide.
fn hatch_line(s: Surface, p: Hatch, layer: u32, share: f32) -> f32 {
    // Crossed, then between.
    let along = tone_turned(p.angle_deg + f32(layer & 1u) * 90.0 + f32(layer >> 1u) * 45.0);
    var place = (s.pixel.y * along.x - s.pixel.x * along.y) / p.spacing_px;
    var spacing_px = p.spacing_px;
    if p.space == HATCH_SPACE_SURFACE {
        let across = normalize(vec3f(-along.y, along.x, f32(layer >> 1u)));
        // How far the planes' distance changes from pixel to pixel; held where the surface lies along the planes or is
        // seen edge-on, and where f32 has no finer places in the world.
        let change = across - s.normal * (dot(across, s.view) / max(dot(s.normal, s.view), 0.1));
        let per_px = max(s.pixel_size_m * max(length(change), 0.4), 1.5e-4 * (length(s.position) + s.depth_m));
        place = dot(s.position, across) / p.spacing_m;
        spacing_px = p.spacing_m / per_px;
    }
    let distance = abs(place - floor(place) - 0.5) * spacing_px;
    let half = 0.5 * share * spacing_px;
    let covered = clamp(min(distance + 0.5, half) - max(distance - 0.5, -half), 0.0, 1.0);
    // Lines that no pixel can tell apart become their mean.
    return share + (covered - share) * clamp(spacing_px - 1.0, 0.0, 1.0);
}
