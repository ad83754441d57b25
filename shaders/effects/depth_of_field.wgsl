// Depth of field: what is out of focus spreads to discs of light.
//@ use lib/angle
//@ use lib/hash
//@ use lib/image
//@ use lib/image_pass

struct DepthOfField {
    /// What is in focus.
    @choice(place, distance) focus: u32,
    /// The place in focus, from the left edge at 0 to the right one at 1.
    @range(0, 1, 0.5) @when(focus, place) focus_x: f32,
    /// The same from the top to the bottom.
    @range(0, 1, 0.5) @when(focus, place) focus_y: f32,
    /// Distance in focus, along the viewing direction.
    @range(0.1, 100, 6) @hard(0.001, 1e6) @unit(m) @log @when(focus, distance) focus_m: f32,
    /// Radius of the disc to which a point infinitely far away spreads.
    @range(0, 64, 16) @hard(0, 1024) @unit(px) aperture_px: f32,
    /// The largest such radius.
    @range(1, 32, 10) @hard(1, 120) @unit(px) most_px: f32,
    /// How much more bright points weigh than dark ones.
    @range(0, 16, 3) @hard(0, 64) highlights: f32,
}

const DEPTH_OF_FIELD_TAPS = 96;
// Steps to a unit of the spiral: none of its 192 coordinates lies near half a step, so that they are the same everywhere.
const DEPTH_OF_FIELD_UNIT = 1536;
// Steps to a pixel where the unit is in 256ths of one.
const DEPTH_OF_FIELD_PIXEL = 393216;
// Rings about the place in focus on which a surface is looked for, up to the picture's height.
const DEPTH_OF_FIELD_RINGS = 16;

fn depth_of_field(at: ImageAt, p: DepthOfField) -> vec4f {
    let focus_m = depth_of_field_focus(p);
    let here_m = image_depth_m(at.x, at.y);
    let here_px = depth_of_field_radius(here_m, focus_m, p);
    let most = i32(round(p.most_px * 256.0));
    var sum = image_color(at.x, at.y);
    var weights = 1.0;
    for (var i = 0; i < DEPTH_OF_FIELD_TAPS; i += 1) {
        // A spiral that fills a disc evenly.
        let turns = f32((u32(i) * HASH_GOLDEN) >> 8u) / 16777216.0;
        let away = f32(DEPTH_OF_FIELD_UNIT) * sqrt((f32(i) + 0.5) / f32(DEPTH_OF_FIELD_TAPS));
        let unit = vec2i(round(away * vec2f(cosine_turns(turns), sine_turns(turns))));
        // To the nearest pixel, in integers; 128 pixels keep what is divided above zero.
        let step = (most * unit + 128 * DEPTH_OF_FIELD_PIXEL + DEPTH_OF_FIELD_PIXEL / 2) / DEPTH_OF_FIELD_PIXEL - 128;
        let there_m = image_depth_m(at.x + step.x, at.y + step.y);
        var there_px = depth_of_field_radius(there_m, focus_m, p);
        // Light from behind does not spread over what is sharp before it.
        if there_m > here_m { there_px = min(there_px, here_px); }
        let color = image_color(at.x + step.x, at.y + step.y);
        let brightest = clamp(max(max(color.r, color.g), color.b), 0.0, 1.0);
        let weight = clamp(there_px - length(vec2f(step)) + 1.0, 0.0, 1.0) * (1.0 + p.highlights * brightest * brightest);
        sum += weight * color;
        weights += weight;
    }
    return vec4f(sum.rgb / weights, sum.a / weights);
}

// Radius of the disc to which a point so far away spreads, pixels.
fn depth_of_field_radius(depth_m: f32, focus_m: f32, p: DepthOfField) -> f32 {
    return min(p.aperture_px * abs(1.0 - focus_m / depth_m), p.most_px);
}

// The distance in focus, meters. A little is added, so that a number that is about whole falls on its pixel everywhere.
fn depth_of_field_focus(p: DepthOfField) -> f32 {
    if p.focus == DEPTH_OF_FIELD_FOCUS_DISTANCE { return p.focus_m; }
    let size = vec2i(image_size());
    let place = vec2i(floor(vec2f(p.focus_x, p.focus_y) * vec2f(size) + 0.00390625));
    var found = place;
    for (var i = 0; i < 8 * DEPTH_OF_FIELD_RINGS && image_at(found.x, found.y).y == 0u; i += 1) {
        found = place + size.y * (i / 8 + 1) / DEPTH_OF_FIELD_RINGS * depth_of_field_compass(i % 8);
    }
    if image_at(found.x, found.y).y == 0u { found = place; }
    return image_depth_m(found.x, found.y);
}

// The places of a ring, to the right and down: first those on the axes.
fn depth_of_field_compass(i: i32) -> vec2i {
    let first = select(vec2i(1, 0), vec2i(1, 1), i > 3);
    let opposite = select(first, -first, i % 4 > 1);
    return select(opposite, vec2i(-opposite.y, opposite.x), i % 2 == 1);
}
