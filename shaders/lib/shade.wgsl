// Shade: the surface of a triangle at a sample, rebuilt from the triangle's id and its snapped vertices. The resolve pass shades
// the nearest triangle of a pixel with it, and the x-ray pass every layer.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/attributes
//@ use lib/geometry
//@ use lib/shape
//@ use lib/surface
//@ use variants/draw_records
//@ use variants/loads
//@ use variants/points
//@ use variants/vertex_effects
//@ use steps/shade_step

// Plane normals and centers are computed; without them every corner normal is known to be valid.
override HAS_PLANES: bool = true;
// Some triangle may be large.
override HAS_LARGE: bool = true;
// Attributes are interpolated linearly on screen, as if all corners were equally far.
override IS_AFFINE: bool = false;
// Triangles have ranks: the draw order is shown.
override HAS_RANKS: bool = false;

// A sample's position in its triangle.
struct SamplePosition {
    weights: vec3f,       // perspective-correct barycentrics, sum 1
    depth: f32,           // meters along the viewing direction
    corner_depths: vec3f, // depths of the corners
    center_screen: vec2f,
    barycentrics: vec3f,  // on screen, as in `Surface`
    edge_distance_px: vec3f,
    is_clockwise: bool,
}

// From edge functions of the snapped corners; their signs cancel in the quotient, so corners need not be exchanged.
fn sample_unclipped(t: Triangle, pixel: vec2u) -> SamplePosition {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let p = grid_sample(vec2i(pixel));
    var e = vec3f(vec3i(fixed_small_area(b, c, p), fixed_small_area(c, a, p), fixed_small_area(a, b, p)));
    if HAS_LARGE { e = vec3f(fixed_weight(b, c, p), fixed_weight(c, a, p), fixed_weight(a, b, p)); }
    e = sample_in_shape(e, t, p);
    let inv_w = bitcast<vec3f>(vec3u(t.a.w, t.b.w, t.c.w));
    let terms = select(e * inv_w, e, IS_AFFINE);
    let sum = terms.x + terms.y + terms.z;
    let w = 1.0 / inv_w;
    var depths = w;
    if !IS_PERSPECTIVE { depths = linear_depths(bitcast<vec3f>(vec3u(t.a.z, t.b.z, t.c.z))); }
    let doubled_area = e.x + e.y + e.z;
    let weights = terms / sum;
    let depth = select(dot(weights, depths), doubled_area / sum, IS_PERSPECTIVE && !IS_AFFINE);
    let lengths = vec3f(length(vec2f(c - b)), length(vec2f(a - c)), length(vec2f(b - a)));
    return SamplePosition(
        weights, depth, depths, center_unclipped(t.a, t.b, t.c), e / doubled_area, abs(e) / (f32(grid_unit()) * lengths),
        doubled_area > 0.0);
}

// Edge functions of a sample that may lie outside its triangle: clamped in a box; in a disc, those of the disc's corner.
fn sample_in_shape(e: vec3f, t: Triangle, p: vec2i) -> vec3f {
    if SHAPE == SHAPE_TRIANGLES { return e; }
    // Not from the sum of e: its roundings may exceed the area, since the sample may lie far outside the triangle.
    let orientation = f32(triangle_orientation(t));
    if SHAPE == SHAPE_BOXES { return max(e * orientation, vec3f(0.0)) * orientation; }
    let corner = disc_corner(t.a, t.b, t.c, p);
    return orientation * vec3f(vec3<bool>(corner == 0u, corner == 1u, corner == 2u));
}

// Bound on the roundings of a determinant, relative to the magnitudes of its terms.
const SIDE_ERROR = 9.5367431640625e-7; // 2^-20

// Meters of an orthographic depth.
fn linear_depths(z: vec3f) -> vec3f {
    return z * (frame.linear_depth_m.x - frame.linear_depth_m.y) + frame.linear_depth_m.y;
}

// A triangle that was clipped has no snapped corners: homogeneous barycentrics (Olano and Greer 1997).
fn sample_clipped(t: Triangle, at: vec3u, pixel: vec2u) -> SamplePosition {
    let corners = vertex_effects_triangle(t.draw, at, t.id);
    let a = corners[0];
    let b = corners[1];
    let c = corners[2];
    let sample = (vec2f(pixel) + 0.5) / vec2f(frame.size);
    let p = vec3f(sample.x * 2.0 - 1.0, 1.0 - sample.y * 2.0, 1.0);
    // Counter-clockwise in clip space, y up, is a positive determinant, whose sign all terms inside have. A snapped clipped
    // triangle may own a sample slightly outside; terms are clamped to 0 there, else their sum could vanish at a horizon.
    // Of edges, since the products of corners that lie far away cancel to less than their rounding errors. Where the edges' do
    // too, as on a needle with both ends far away, the sample itself has that sign, and no length that cancels.
    let ab = b.xyw - a.xyw;
    let ac = c.xyw - a.xyw;
    let plane = cross(ab, ac);
    let determinant = dot(a.xyw, plane);
    let is_certain = abs(determinant) > SIDE_ERROR * dot(abs(a.xyw), abs(ab.yzx * ac.zxy) + abs(ab.zxy * ac.yzx));
    let is_clockwise = select(dot(p, plane), determinant, is_certain) < 0.0;
    let lines = mat3x3f(cross(b.xyw, c.xyw), cross(c.xyw, a.xyw), cross(a.xyw, b.xyw));
    let signed = p * lines;
    let terms = max(select(signed, -signed, is_clockwise), vec3f(0.0));
    let sum = terms.x + terms.y + terms.z;
    let weights = select(vec3f(1.0 / 3.0), terms / select(1.0, sum, sum > 0.0), sum > 0.0);
    var depths = vec3f(a.w, b.w, c.w);
    if !IS_PERSPECTIVE { depths = linear_depths(vec3f(a.z, b.z, c.z)); }
    let steps = 2.0 / vec2f(frame.size);
    let slopes = vec3f(length(lines[0].xy * steps), length(lines[1].xy * steps), length(lines[2].xy * steps));
    let edge_distance_px = abs(signed) / max(slopes, vec3f(1e-30));
    return SamplePosition(
        weights, dot(weights, depths), depths, center_clipped(a, b, c, sample), weights, edge_distance_px, is_clockwise);
}

// Does the triangle have no snapped corners, because it had to be clipped?
fn shade_is_clipped(t: Triangle) -> bool {
    return HAS_CLIPPING && ((t.a.x | t.b.x | t.c.x) & VERTEX_CLIPPED) != 0u;
}

// Fraction of all samples that come before a triangle; four ranks to a record.
fn shade_rank(id: u32) -> f32 {
    if !HAS_RANKS { return 0.0; }
    return bitcast<f32>(load_record(frame.first_rank + id / 4u)[id % 4u]);
}

// The triangle whose samples are shaded, and its vertices within the draw.
var<private> shaded: Triangle;
var<private> shaded_at: vec3u;

// Must be called before samples of a triangle are shaded: computes what they share. Drivers take minutes to compile vertex
// effects inside a loop over samples.
fn shade_begin(id: u32) {
    shaded = triangle_load(id);
    shaded_at = triangle_vertices(shaded.draw, id - draws[shaded.draw].first_triangle);
    if HAS_PLANES { vertex_effects_begin(id, shaded.draw, shaded_at); }
}

// The interpolated normal in world space, a unit vector; zero where a corner has none, where the corners cancel and where planes
// alone have normals.
fn draw_smooth_normal(draw: u32, a: vec4f, b: vec4f, c: vec4f, weights: vec3f) -> vec3f {
    let flags = draws[draw].flags;
    if (flags & DRAW_FACETED) != 0u { return vec3f(0.0); }
    // Equal corners, as on boxes, need one transform and not four.
    if (flags & DRAW_UNEVEN) != 0u && (any(a.xyz != b.xyz) || any(a.xyz != c.xyz)) {
        return normal_direction(normal_interpolated(draw_even_normal(draw, a), draw_even_normal(draw, b), draw_even_normal(draw, c), weights));
    }
    return normal_direction(draw_normal(draw, normal_interpolated(a, b, c, weights)));
}

// A corner's normal in world space, as long as in object space.
fn draw_even_normal(draw: u32, n: vec4f) -> vec4f {
    return vec4f(normal_direction(draw_normal(draw, n.xyz)) * length(n.xyz), n.w);
}

// The surface at a pixel's sample, before surface effects.
fn shade_surface(pixel: vec2u) -> Surface {
    let t = shaded;
    let at = shaded_at;
    let id = t.id;
    var position: SamplePosition;
    if shade_is_clipped(t) {
        position = sample_clipped(t, at, pixel);
    } else {
        position = sample_unclipped(t, pixel);
    }
    let k = position.weights;

    var s: Surface;
    s.triangle_id = id;
    s.rank = shade_rank(id);
    s.center_screen = position.center_screen;
    s.pixel = vec2f(pixel) + 0.5;
    s.screen = s.pixel / vec2f(frame.size);
    s.barycentrics = position.barycentrics;
    s.edge_distance_px = position.edge_distance_px;
    s.depth_m = position.depth;
    s.pixel_size_m = length(frame.ndc_y.xyz) * 2.0 / f32(frame.size.y) * select(1.0, position.depth, IS_PERSPECTIVE);
    s.flat_depth_m = dot(position.corner_depths, vec3f(1.0 / 3.0));
    s.depth_range_m = frame.depth_range_m;
    // The sample lies on the ray of its pixel, so its depth determines its position.
    let ndc = vec2f(s.screen.x * 2.0 - 1.0, 1.0 - s.screen.y * 2.0);
    let aside = frame.ndc_x.xyz * ndc.x + frame.ndc_y.xyz * ndc.y;
    if IS_PERSPECTIVE {
        let ray = frame.forward.xyz + aside;
        s.position = frame.eye.xyz + ray * s.depth_m;
        s.view = -normalize(ray);
    } else {
        s.position = frame.eye.xyz + aside + frame.forward.xyz * s.depth_m;
        s.view = -frame.forward.xyz;
    }
    s.color = draw_base_color(t.draw)
        * (vertex_color(t.draw, at.x) * k.x + vertex_color(t.draw, at.y) * k.y + vertex_color(t.draw, at.z) * k.z);

    let na = normal_bits(t.draw, at.x);
    let nb = normal_bits(t.draw, at.y);
    let nc = normal_bits(t.draw, at.z);
    s.center = s.position;
    var has_direction = true;
    if !HAS_PLANES {
        let sum = bitcast<vec3f>(na) * k.x + bitcast<vec3f>(nb) * k.y + bitcast<vec3f>(nc) * k.z;
        s.normal = normalize(draw_normal(t.draw, sum));
        s.flat_normal = s.normal;
    } else {
        let smooth_normal = draw_smooth_normal(t.draw, normal_from_bits(na), normal_from_bits(nb), normal_from_bits(nc), k);
        let a = floats_of_class(position_bits(t.draw, at.x), 0u);
        let b = floats_of_class(position_bits(t.draw, at.y), 0u);
        let c = floats_of_class(position_bits(t.draw, at.z), 0u);
        s.center = center_world(t.draw, at);
        let normals = vertex_effects_normals(
            smooth_normal,
            normal_direction(draw_normal(t.draw, normal_of_plane(a, b, c))), k);
        s.normal = normals[0];
        s.flat_normal = normals[1];
        let has_smooth = any(s.normal != vec3f(0.0));
        let has_flat = any(s.flat_normal != vec3f(0.0));
        has_direction = has_smooth || has_flat;
        if !has_flat { s.flat_normal = select(s.view, s.normal, has_smooth); }
        if !has_smooth { s.normal = s.flat_normal; }
    }
    let is_mirrored = (draws[t.draw].flags & DRAW_MIRRORED) != 0u;
    if has_direction && position.is_clockwise != is_mirrored {
        s.normal = -s.normal;
        s.flat_normal = -s.flat_normal;
    }
    if has_direction && point_is_turned(t.draw, dot(s.normal, s.view)) {
        s.normal = -s.normal;
        s.flat_normal = -s.flat_normal;
    }
    return shade_step(s, t, at, position);
}
