// Outline: lines at silhouettes, between objects and at steps of depth. What changes there are the integers of the picture.
//@ use lib/image
//@ use lib/color

struct Outline {
    /// Color of the line, linear; its alpha is the strength.
    @color(0.004, 0.004, 0.008) color: vec4f,
    /// Width of the line.
    @range(1, 8, 2) @hard(1, 64) @unit(px) width_px: u32,
    /// Which side of an edge the line lies on.
    @choice(outside, inside, both) side: u32,
    /// Lines between what is drawn and the background.
    @toggle(1) silhouette: u32,
    /// Lines between objects.
    @toggle(1) objects: u32,
    /// Lines between objects only where they meet: where their depths differ by less than a jump.
    @toggle(0) intersections: u32,
    /// Lines where the depth jumps within an object.
    @toggle(1) depth: u32,
    /// The least jump that counts, as a fraction of the distance.
    @range(0.001, 0.5, 0.05) @hard(0.0001, 1) @log depth_threshold: f32,
}

@smooth
fn outline(pixel: Pixel, p: Outline) -> Pixel {
    var q = pixel;
    let at = vec2i(vec2u(q.x, q.y));
    let here = image_at(at.x, at.y);
    let reach = i32(p.width_px);
    // A wide line looks at as many neighbors as one of 8 pixels.
    let step = max((reach + 7) / 8, 1);
    let first = -(reach / step) * step;
    var is_line = false;
    for (var dy = first; dy <= reach && !is_line; dy += step) {
        for (var dx = first; dx <= reach && !is_line; dx += step) {
            let squared = dx * dx + dy * dy;
            if squared >= 1 && squared <= reach * reach { is_line = outline_is_edge(p, at, here, vec2i(dx, dy)); }
        }
    }
    if is_line { q.color += (vec4f(color_encode(p.color.rgb), 1.0) - q.color) * p.color.a; }
    return q;
}

// Is there a line at a pixel because of another? Each is triangle id, depth bits and draw.
fn outline_is_edge(p: Outline, at: vec2i, here: vec3u, step: vec2i) -> bool {
    if !image_has(at.x + step.x, at.y + step.y) { return false; }
    let there = image_at(at.x + step.x, at.y + step.y);
    let is_empty = here.x == IMAGE_NO_TRIANGLE;
    if is_empty || there.x == IMAGE_NO_TRIANGLE {
        let is_right_side = p.side == OUTLINE_SIDE_BOTH || is_empty == (p.side == OUTLINE_SIDE_OUTSIDE);
        return p.silhouette != 0u && here.x != there.x && is_right_side;
    }
    if here.z != there.z {
        // At equal depths, the later object counts as behind.
        let is_behind = here.y < there.y || (here.y == there.y && here.z > there.z);
        let is_line = p.objects != 0u || (p.intersections != 0u && abs(i32(there.y) - i32(here.y)) <= outline_jump(p));
        return is_line && (p.side == OUTLINE_SIDE_BOTH || is_behind == (p.side == OUTLINE_SIDE_OUTSIDE));
    }
    if p.depth == 0u || !image_has(at.x - step.x, at.y - step.y) { return false; }
    let beyond = image_at(at.x - step.x, at.y - step.y);
    if beyond.z != here.z || beyond.x == IMAGE_NO_TRIANGLE { return false; }
    // Deviation from a straight slope; a slope alone is no jump. Depths end at the bits of 1.0, so the sum fits.
    let curvature = i32(there.y) + i32(beyond.y) - 2 * i32(here.y);
    let jump = outline_jump(p);
    switch p.side {
        case OUTLINE_SIDE_OUTSIDE: { return curvature > jump; }
        case OUTLINE_SIDE_INSIDE: { return curvature < -jump; }
        default: { return abs(curvature) > jump; }
    }
}

// The least difference of depth bits that counts as a jump.
fn outline_jump(p: Outline) -> i32 {
    return i32(p.depth_threshold * 8388608.0);
}
