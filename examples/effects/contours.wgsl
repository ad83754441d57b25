// Contours: lines of equal distance from the eye, over sheets of paper that lie deeper the farther they are.

struct Contours {
    /// Color of the lines.
    @color(0.12, 0.07, 0.03) ink: vec4f,
    /// Color of the nearest sheet.
    @color(0.95, 0.9, 0.76) near: vec4f,
    /// Color of the farthest sheet.
    @color(0.16, 0.36, 0.38) far: vec4f,
    /// Distance from the eye at which the sheets begin.
    @range(0.0, 50.0, 4.0) @hard(0.0, 10000.0) @unit(m) first: f32,
    /// Distance from sheet to sheet.
    @range(0.01, 5.0, 0.2) @hard(0.001, 1000.0) @unit(m) @log step: f32,
    /// Number of sheets.
    @range(2, 32, 12) sheets: u32,
    /// How far the shadow of a sheet reaches on the next one.
    @range(0, 12, 3) @unit(px) shadow_px: i32,
}

fn contours(at: ImageAt, p: Contours) -> vec4f {
    let here = sheet(at.x, at.y, p);
    let right = sheet(at.x + 1, at.y, p);
    let below = sheet(at.x, at.y + 1, p);
    let paper = mix(p.near.rgb, p.far.rgb, f32(here) / f32(p.sheets));
    // A nearer sheet up and to the left throws a shadow.
    var shade = 1.0;
    for (var i = 1; i <= p.shadow_px; i += 1) {
        if sheet(at.x - i, at.y - i, p) < here { shade = min(shade, 0.55 + 0.4 * f32(i) / f32(p.shadow_px)); }
    }
    let is_line = here != right || here != below;
    let color = select(paper * shade, p.ink.rgb, is_line);
    return vec4f(color, image_color(at.x, at.y).a);
}

// Number of the sheet that a pixel lies on, the last where nothing is drawn.
fn sheet(x: i32, y: i32, p: Contours) -> u32 {
    let depth = (image_depth_m(x, y) - p.first) / p.step;
    return u32(clamp(depth, 0.0, f32(p.sheets)));
}
