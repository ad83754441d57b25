// Comic: ink lines where the surface turns or ends, on a few flat tones.
//@ use lib/color

struct Comic {
    /// Color of the lines.
    @color(0.02, 0.02, 0.05) ink: vec4f,
    /// Tones from black to white.
    @range(2.0, 8.0, 4.0) tones: f32,
    /// How much a surface must turn for a line.
    @range(0.05, 1.0, 0.3) turn: f32,
    /// Width of a line.
    @range(1, 4, 1) @unit(px) width_px: i32,
}

fn comic(at: ImageAt, p: Comic) -> vec4f {
    let here = image_normal(at.x, at.y);
    var most = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = select(vec2i(p.width_px, 0), vec2i(0, p.width_px), i >= 2) * (1 - 2 * (i & 1));
        let there = image_normal(at.x + step.x, at.y + step.y);
        most = max(most, 0.5 * dot(here - there, here - there));
    }
    let color = image_color(at.x, at.y);
    let light = sqrt(clamp(color_luminance(color.rgb), 0.0, 1.0));
    let tone = floor(light * p.tones + 0.5) / p.tones;
    let flat_color = color.rgb * (tone * tone / max(light * light, 0.001));
    let line = clamp((most - p.turn) / p.turn, 0.0, 1.0);
    return vec4f(mix(flat_color, p.ink.rgb, line), color.a);
}
