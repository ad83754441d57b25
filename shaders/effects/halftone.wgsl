// Halftone: dots of ink on paper, large where it is dark.
//@ use lib/angle
//@ use lib/color
//@ use lib/image_pass

struct Halftone {
    /// Color of the one ink, linear; its alpha is how well it covers.
    @color(0.02, 0.03, 0.06) @when(inks, one) ink: vec4f,
    /// Color of the paper, linear.
    @color(0.93, 0.89, 0.8) paper: vec4f,
    /// With which inks the picture is printed.
    @choice(four, one) inks: u32,
    /// Distance of dots.
    @range(3, 32, 5) @hard(2, 256) @unit(px) cell_px: f32,
    /// Turns all screens.
    @range(-90, 90, 0) @hard(-180, 180) @unit(°) angle_deg: f32,
    /// How much of what all colors have in common is printed black.
    @range(0, 1, 0.7) @when(inks, four) black: f32,
}

fn halftone(at: ImageAt, p: Halftone) -> vec4f {
    let color = image_color(at.x, at.y);
    let light = clamp(color.rgb, vec3f(0.0), vec3f(1.0));
    let place = image_middle(at);
    if p.inks == HALFTONE_INKS_ONE {
        let dark = 1.0 - color_luminance(light);
        let covered = halftone_screen(place, 45.0, dark, p) * p.ink.a;
        return vec4f(mix(p.paper.rgb, p.ink.rgb, covered), color.a);
    }
    let key = p.black * (1.0 - max(max(light.r, light.g), light.b));
    let rest = max(1.0 - key, 0.001);
    let tones = clamp((rest - light) / rest, vec3f(0.0), vec3f(1.0));
    let cyan = halftone_screen(place, 15.0, tones.r, p);
    let magenta = halftone_screen(place, 75.0, tones.g, p);
    let yellow = halftone_screen(place, 0.0, tones.b, p);
    let black = halftone_screen(place, 45.0, key, p);
    // What each ink leaves of the light.
    var printed = p.paper.rgb;
    printed *= 1.0 - cyan * vec3f(1.0, 0.32, 0.08);
    printed *= 1.0 - magenta * vec3f(0.12, 1.0, 0.5);
    printed *= 1.0 - yellow * vec3f(0.02, 0.1, 1.0);
    printed *= 1.0 - black * vec3f(0.98, 0.98, 0.97);
    return vec4f(printed, color.a);
}

// How much of a pixel the dots of a screen at this angle cover, given the fraction that they cover together.
fn halftone_screen(place: vec2f, degrees: f32, tone: f32, p: Halftone) -> f32 {
    let along = direction_degrees(degrees + p.angle_deg);
    let cell = vec2f(dot(place, along), dot(place, vec2f(-along.y, along.x))) / p.cell_px;
    let height = 0.5 + 0.25 * (cosine_turns(cell.x) + cosine_turns(cell.y));
    // Half of the width of an edge of one pixel, in heights.
    let edge = 0.8 / p.cell_px;
    let waterline = mix(1.0 + edge, -edge, tone);
    return clamp((height - waterline) / (2.0 * edge) + 0.5, 0.0, 1.0);
}
