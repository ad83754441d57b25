// Dissolve: fills every triangle to a share of its area, exactly that share, and lets a front of it travel over the model.
//@ use common/surface
//@ use common/sample
//@ use common/front
//@ use common/spans

struct Dissolve {
    rim: vec4f,
    center: vec4f,
    fill: f32,
    mode: u32,
    corner: u32,
    rim_width: f32,
    pattern: u32,
    front: f32,
    width: f32,
    along_x: f32,
    along_y: f32,
    radius_m: f32,
    width_m: f32,
    seed: u32,
}

const DISSOLVE_ONE = 16777216u; // 2^24: all of it
const DISSOLVE_BY_HASH = 1u;

fn dissolve_fill(p: Dissolve, center: vec3f, center_screen: vec2f, triangle: u32) -> f32 {
    if p.pattern == DISSOLVE_PATTERN_UNIFORM { return p.fill; }
    let front = Front(p.pattern, p.front, p.width, vec2f(p.along_x, p.along_y), p.center.xyz, p.radius_m, p.width_m, p.seed);
    return 1.0 - (1.0 - p.fill) * front_reached(front, center, center_screen, triangle);
}

// round(sqrt(x / 2^24) * 2^16); 65,537 where x is all of 2^24.
fn dissolve_root(x: u32) -> u32 {
    if x >= DISSOLVE_ONE { return 65537u; }
    let n = x << 8u;
    let root = fixed_root(Wide(0u, n));
    return root + select(0u, 1u, n - root * root > root);
}

// x: share to fill, in 2^-24. y: threshold in 2^-16, or the first pixel that is not drawn. z: how to tell.
fn dissolve_decide(t: TriangleSetup, p: Dissolve) -> vec4u {
    let share = u32(round(clamp(dissolve_fill(p, t.center, t.center_screen, t.triangle), 0.0, 1.0) * 16777216.0));
    var b = t.b;
    var c = t.c;
    let turn = fixed_sign(fixed_edge(t.a, t.b, t.c));
    if turn < 0 { b = t.c; c = t.b; }
    let first = max((min(min(t.a, b), c) + 127) >> vec2u(8u), vec2i(0));
    let last = min((max(max(t.a, b), c) - 129) >> vec2u(8u), vec2i(t.size) - 1);
    let pixels = vec4i(first, last);
    if turn == 0 || any(last < first) { return vec4u(share, 0u, DISSOLVE_BY_HASH, 0u); }
    let is_scanline = p.mode == DISSOLVE_MODE_SCANLINE;
    // A triangle of one sample or none cannot show a share; over many of them the hash does.
    var count = 0u;
    for (var y = first.y; y <= last.y && (is_scanline || count < 2u); y += 1) {
        let span = spans_row(t.a, b, c, y, pixels);
        count += u32(max(span.y - span.x + 1, 0));
    }
    if p.mode == DISSOLVE_MODE_HASH || count < 2u { return vec4u(share, 0u, DISSOLVE_BY_HASH, 0u); }
    if !is_scanline {
        if p.mode == DISSOLVE_MODE_EDGE {
            let rest = dissolve_root(DISSOLVE_ONE - share);
            return vec4u(share, select(65536u - min(rest, 65536u), 65537u, share == DISSOLVE_ONE), 0u, 0u);
        }
        return vec4u(share, dissolve_root(share), 0u, 0u);
    }
    let wanted = fixed_add(fixed_umul(share, count), Wide(0u, 8388608u));
    var rest = (wanted.lo >> 24u) | (wanted.hi << 8u);
    if rest >= count { return vec4u(share, 0xffffffffu, 0u, 0u); }
    for (var y = first.y; y <= last.y; y += 1) {
        let span = spans_row(t.a, b, c, y, pixels);
        let length = u32(max(span.y - span.x + 1, 0));
        if rest < length { return vec4u(share, (u32(y) << 16u) | (u32(span.x) + rest), 0u, 0u); }
        rest -= length;
    }
    return vec4u(share, 0xffffffffu, 0u, 0u);
}

fn dissolve_sample(s: Sample, p: Dissolve) -> bool {
    let pixel = (s.at.y << 16u) | s.at.x;
    if s.decided.z == DISSOLVE_BY_HASH { return (hash(hash(s.triangle ^ p.seed) ^ pixel) >> 8u) < s.decided.x; }
    if p.mode == DISSOLVE_MODE_SCANLINE { return pixel < s.decided.y; }
    let whole = sample_whole(s);
    let part = select(select(s.parts.x, s.parts.y, p.corner == 1u), s.parts.z, p.corner == 2u);
    var way = part;
    if p.mode == DISSOLVE_MODE_CORNER { way = whole - part; }
    if p.mode == DISSOLVE_MODE_CENTROID { way = whole - 3u * min(min(s.parts.x, s.parts.y), s.parts.z); }
    return fixed_is_less(Wide(way >> 16u, way << 16u), fixed_umul(s.decided.y, whole));
}

// A rim that glows where the triangle is about to go.
fn dissolve_surface(surface: Surface, p: Dissolve) -> Surface {
    var s = surface;
    let fill = clamp(dissolve_fill(p, s.center, s.center_screen, s.triangle_id), 0.0, 1.0);
    let part = select(select(s.barycentrics.x, s.barycentrics.y, p.corner == 1u), s.barycentrics.z, p.corner == 2u);
    var way = 0.0;
    var end = sqrt(fill);
    switch p.mode {
        case DISSOLVE_MODE_EDGE: { way = part; end = 1.0 - sqrt(1.0 - fill); }
        case DISSOLVE_MODE_CORNER: { way = 1.0 - part; }
        case DISSOLVE_MODE_CENTROID: { way = 1.0 - 3.0 * min(min(s.barycentrics.x, s.barycentrics.y), s.barycentrics.z); }
        default: { end = fill; }
    }
    // The rim is born as the triangle starts to go, so a whole one has none.
    let near = clamp(1.0 - (end - way) / p.rim_width, 0.0, 1.0) * min(8.0 * (1.0 - fill), 1.0);
    s.color += vec4f(p.rim.rgb * (p.rim.a * near * near), 0.0);
    return s;
}
