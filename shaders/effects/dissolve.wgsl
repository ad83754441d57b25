// Dissolve: fills every triangle to a fraction of its area.
//@ use lib/surface
//@ use lib/sample
//@ use lib/front
//@ use lib/hash
//@ use lib/fixed

struct Dissolve {
    /// Color of the glowing rim, alpha is its strength.
    @color(1, 0.45, 0.1, 0) rim: vec4f,
    /// Fraction of a triangle that stays: 0 nothing, 1 everything; behind the front where there is one.
    @range(0, 1, 0.5) fill: f32,
    /// How a triangle fills.
    @choice(edge, corner, centroid, scanline, hash) @default(corner) mode: u32,
    /// Which of the three corners the sweep is about.
    @range(0, 2, 0) @when(mode, edge, corner) corner: u32,
    /// Width of the glowing rim, as a fraction of the path.
    @range(0.01, 1, 0.25) @hard(0.001, 10) @log rim_width: f32,
    /// Center of the radial front, world space.
    @point(0, 0, 0) @soft(-3, 3) @unit(m) @when(pattern, radial) center: vec4f,
    /// How the effect is spread over the triangles.
    @choice(uniform, sweep, radial, random) pattern: u32,
    /// Progress of the front: 0 before the first triangle, 1 past the last.
    @range(0, 1, 0.5) @when(pattern, sweep, random) front: f32,
    /// Softness of the front, as a fraction of its path.
    @range(0.001, 2, 0.25) @hard(0.001, 100) @log @when(pattern, sweep, random) width: f32,
    /// Direction of the sweep in the picture: part to the right.
    @range(-1, 1, 1) @when(pattern, sweep) along_x: f32,
    /// Direction of the sweep in the picture: part downwards.
    @range(-1, 1, 0) @when(pattern, sweep) along_y: f32,
    /// Distance of the front from the center.
    @range(0, 5, 1) @hard(0, 1e6) @unit(m) @when(pattern, radial) radius_m: f32,
    /// Thickness of the front.
    @range(0.01, 5, 0.5) @hard(0.001, 1e6) @unit(m) @log @when(pattern, radial) width_m: f32,
    /// Seed of everything random in the effect.
    @range(0, 999, 0) @hard(0, 4294967295) seed: u32,
}

const DISSOLVE_ONE = 16777216u; // 2^24: the whole triangle
const DISSOLVE_NO_END = 0xffffffffu; // behind every sample of the triangle
const DISSOLVE_BY_HASH = 1u;

fn dissolve_fill(p: Dissolve, center: vec3f, center_screen: vec2f, triangle: u32) -> f32 {
    if p.pattern == DISSOLVE_PATTERN_UNIFORM { return p.fill; }
    return 1.0 - (1.0 - p.fill) * front_reached(dissolve_front(p), center, center_screen, triangle);
}

// round(sqrt(x / 2^24) * 2^16); 65,537 for x = 2^24.
fn dissolve_root(x: u32) -> u32 {
    if x >= DISSOLVE_ONE { return 65537u; }
    let n = x << 8u;
    let root = fixed_root(Wide(0u, n));
    return root + select(0u, 1u, n - root * root > root);
}

// x: fraction to fill, in 2^-24. y: threshold in 2^-16, or the first pixel that is not drawn. z: DISSOLVE_BY_HASH where the hash
// decides.
fn dissolve_sample_setup(t: TriangleSetup, p: Dissolve) -> vec4u {
    let fraction = u32(round(clamp(dissolve_fill(p, t.center, t.center_screen, t.triangle), 0.0, 1.0) * 16777216.0));
    var b = t.b;
    var c = t.c;
    let orientation = fixed_sign(fixed_edge(t.a, t.b, t.c));
    if orientation < 0 { b = t.c; c = t.b; }
    let first = max((min(min(t.a, b), c) + 127) >> vec2u(8u), vec2i(0));
    let last = min((max(max(t.a, b), c) - 129) >> vec2u(8u), vec2i(t.size) - 1);
    let pixels = vec4i(first, last);
    if orientation == 0 || any(last < first) { return vec4u(fraction, 0u, DISSOLVE_BY_HASH, 0u); }
    let is_scanline = p.mode == DISSOLVE_MODE_SCANLINE;
    // A triangle of one sample or none cannot show a fraction; over many triangles, the hash does.
    var count = 0u;
    for (var y = first.y; y <= last.y && (is_scanline || count < 2u); y += 1) {
        let span = dissolve_span(t.a, b, c, y, pixels);
        count += u32(max(span.y - span.x + 1, 0));
    }
    if p.mode == DISSOLVE_MODE_HASH || count < 2u { return vec4u(fraction, 0u, DISSOLVE_BY_HASH, 0u); }
    if !is_scanline {
        if p.mode == DISSOLVE_MODE_EDGE {
            let rest = dissolve_root(DISSOLVE_ONE - fraction);
            return vec4u(fraction, select(65536u - min(rest, 65536u), 65537u, fraction == DISSOLVE_ONE), 0u, 0u);
        }
        return vec4u(fraction, dissolve_root(fraction), 0u, 0u);
    }
    let to_fill = fixed_add(fixed_umul(fraction, count), Wide(0u, 8388608u));
    var rest = (to_fill.lo >> 24u) | (to_fill.hi << 8u);
    if rest >= count { return vec4u(fraction, DISSOLVE_NO_END, 0u, 0u); }
    for (var y = first.y; y <= last.y; y += 1) {
        let span = dissolve_span(t.a, b, c, y, pixels);
        let length = u32(max(span.y - span.x + 1, 0));
        if rest < length { return vec4u(fraction, (u32(y) << 16u) | (u32(span.x) + rest), 0u, 0u); }
        rest -= length;
    }
    return vec4u(fraction, DISSOLVE_NO_END, 0u, 0u);
}

fn dissolve_sample(s: Sample, p: Dissolve) -> bool {
    let pixel = (s.at.y << 16u) | s.at.x;
    if s.setup.z == DISSOLVE_BY_HASH { return (hash(hash(s.triangle ^ p.seed) ^ pixel) >> 8u) < s.setup.x; }
    if p.mode == DISSOLVE_MODE_SCANLINE { return pixel < s.setup.y; }
    let whole = sample_total_area(s);
    let part = select(select(s.areas.x, s.areas.y, p.corner == 1u), s.areas.z, p.corner == 2u);
    var distance = part;
    if p.mode == DISSOLVE_MODE_CORNER { distance = whole - part; }
    if p.mode == DISSOLVE_MODE_CENTROID { distance = whole - 3u * min(min(s.areas.x, s.areas.y), s.areas.z); }
    return fixed_is_less(Wide(distance >> 16u, distance << 16u), fixed_umul(s.setup.y, whole));
}

// A rim that glows where the triangle is about to disappear.
@smooth
fn dissolve_surface(surface: Surface, p: Dissolve) -> Surface {
    var s = surface;
    let fill = clamp(dissolve_fill(p, s.center, s.center_screen, s.triangle_id), 0.0, 1.0);
    let part = select(select(s.barycentrics.x, s.barycentrics.y, p.corner == 1u), s.barycentrics.z, p.corner == 2u);
    var distance = 0.0;
    var end = sqrt(fill);
    switch p.mode {
        case DISSOLVE_MODE_EDGE: { distance = part; end = 1.0 - sqrt(1.0 - fill); }
        case DISSOLVE_MODE_CORNER: { distance = 1.0 - part; }
        case DISSOLVE_MODE_CENTROID: { distance = 1.0 - 3.0 * min(min(s.barycentrics.x, s.barycentrics.y), s.barycentrics.z); }
        default: { end = fill; }
    }
    // The rim appears as the triangle starts to disappear, so a whole triangle has none.
    let near = clamp(1.0 - (end - distance) / p.rim_width, 0.0, 1.0) * min(8.0 * (1.0 - fill), 1.0);
    s.color += vec4f(p.rim.rgb * (p.rim.a * near * near), 0.0);
    return s;
}

// Is the sample of a pixel on the inner side of a directed edge of a clockwise triangle?
fn dissolve_is_inside(begin: vec2i, end: vec2i, pixel: vec2i) -> bool {
    return fixed_sign(fixed_edge(begin, end, grid_sample(pixel))) >= fixed_bias(end - begin);
}

// The pixels of row y, within a span of first and last pixel, on the inner side of an edge; empty where the first is behind the
// last. Estimated in f32, corrected in integers.
fn dissolve_span_cut(begin: vec2i, end: vec2i, y: i32, span: vec2i) -> vec2i {
    let dy = end.y - begin.y;
    if span.x > span.y { return span; }
    if dy == 0 { return select(vec2i(1, 0), span, dissolve_is_inside(begin, end, vec2i(span.x, y))); }
    // Along a row the edge function changes by one unit times dy per pixel; find its zero.
    let e = fixed_to_f32(fixed_edge(begin, end, grid_sample(vec2i(span.x, y))));
    var x = span.x + i32(clamp(e / (f32(grid_unit()) * f32(dy)), -1.0, f32(span.y - span.x) + 1.0));
    if dy < 0 {
        for (var i = 0; i < 4 && x <= span.y && !dissolve_is_inside(begin, end, vec2i(x, y)); i += 1) { x += 1; }
        for (var i = 0; i < 4 && x > span.x && dissolve_is_inside(begin, end, vec2i(x - 1, y)); i += 1) { x -= 1; }
        return vec2i(max(x, span.x), span.y);
    }
    for (var i = 0; i < 4 && x >= span.x && !dissolve_is_inside(begin, end, vec2i(x, y)); i += 1) { x -= 1; }
    for (var i = 0; i < 4 && x < span.y && dissolve_is_inside(begin, end, vec2i(x + 1, y)); i += 1) { x += 1; }
    return vec2i(span.x, min(x, span.y));
}

// The samples of row y in a box of pixels that the triangle (a, b, c), clockwise on screen, covers; exact at every size.
fn dissolve_span(a: vec2i, b: vec2i, c: vec2i, y: i32, pixels: vec4i) -> vec2i {
    return dissolve_span_cut(c, a, y, dissolve_span_cut(b, c, y, dissolve_span_cut(a, b, y, pixels.xz)));
}

fn dissolve_front(p: Dissolve) -> Front {
    return Front(p.center, p.pattern, p.front, p.width, p.along_x, p.along_y, p.radius_m, p.width_m, p.seed);
}
