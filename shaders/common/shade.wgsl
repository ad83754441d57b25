// Shade: a triangle's surface at a sample, rebuilt from its id and the snapped corners alone, so that the same text serves
// the resolve, which knows the triangle id of a pixel, and passes that shade every layer.
//@ use common/triangle
//@ use common/transform
//@ use common/center
//@ use common/fixed
//@ use common/grid
//@ use common/normal
//@ use common/reach
//@ use common/points
//@ use common/surface
//@ use slot/shape
//@ use slot/ranks
//@ use slot/texels
//@ use slot/light

override HAS_COLORS: bool = false;
override HAS_CLIPPING: bool = false;
// Plane normals and centres are computed; without them every corner normal is known to be sound.
override HAS_PLANES: bool = true;
override HAS_LARGE: bool = true;
override IS_PERSPECTIVE: bool = true;
// Attributes run linearly across the screen, as if all corners were equally far.
override IS_AFFINE: bool = false;

// Where a sample lies in its triangle.
struct Place {
    weights: vec3f,       // perspective-correct, sum 1
    depth: f32,           // metres along the viewing direction
    corner_depths: vec3f, // the same, of the corners
    center_screen: vec2f,
    shares: vec3f,        // as `Surface`
    edge_distance_px: vec3f,
    is_clockwise: bool,
}

// Edge functions at the sample from the snapped corners; signs cancel in the quotient, so no corners are exchanged.
fn place_whole(t: Triangle, pixel: vec2u) -> Place {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let p = grid_sample(vec2i(pixel));
    var e = vec3f(vec3i(fixed_small_area(b, c, p), fixed_small_area(c, a, p), fixed_small_area(a, b, p)));
    if HAS_LARGE { e = vec3f(fixed_weight(b, c, p), fixed_weight(c, a, p), fixed_weight(a, b, p)); }
    e = place_held(e, t, p);
    let inv_w = bitcast<vec3f>(vec3u(t.a.w, t.b.w, t.c.w));
    let share = select(e * inv_w, e, IS_AFFINE);
    let sum = share.x + share.y + share.z;
    let w = 1.0 / inv_w;
    var depths = w;
    if !IS_PERSPECTIVE { depths = linear_depths(bitcast<vec3f>(vec3u(t.a.z, t.b.z, t.c.z))); }
    let doubled_area = e.x + e.y + e.z;
    let weights = share / sum;
    let depth = select(dot(weights, depths), doubled_area / sum, IS_PERSPECTIVE && !IS_AFFINE);
    let lengths = vec3f(length(vec2f(c - b)), length(vec2f(a - c)), length(vec2f(b - a)));
    return Place(weights, depth, depths, center_whole(t.a, t.b, t.c), e / doubled_area, abs(e) / (f32(grid_unit()) * lengths), doubled_area > 0.0);
}

// Edge functions of a sample that need not lie in its triangle: in a box none turns negative, a disc is its corner's.
fn place_held(e: vec3f, t: Triangle, p: vec2i) -> vec3f {
    if SHAPE == SHAPE_TRIANGLES { return e; }
    let turn = sign(e.x + e.y + e.z);
    if SHAPE == SHAPE_BOXES { return max(e * turn, vec3f(0.0)) * turn; }
    let corner = points_corner(t.a, t.b, t.c, p);
    return turn * vec3f(vec3<bool>(corner == 0u, corner == 1u, corner == 2u));
}

// Metres of an orthographic depth.
fn linear_depths(z: vec3f) -> vec3f {
    return z * (frame.linear_depth_m.x - frame.linear_depth_m.y) + frame.linear_depth_m.y;
}

// A clipped triangle has no snapped corners: homogeneous barycentrics (Olano and Greer 1997).
fn place_clipped(t: Triangle, at: vec3u, pixel: vec2u) -> Place {
    // A loop, since compilers copy what the effects do to a corner to wherever it is called.
    var corners: array<vec4f, 3>;
    for (var i = 0u; i < 3u; i += 1u) { corners[i] = transform_vertex(t.draw, at[i], t.id); }
    let a = corners[0];
    let b = corners[1];
    let c = corners[2];
    let sample = (vec2f(pixel) + 0.5) / vec2f(frame.size);
    let p = vec3f(sample.x * 2.0 - 1.0, 1.0 - sample.y * 2.0, 1.0);
    // Counter-clockwise in clip space, y up, is a positive determinant, which all shares inside take their sign from. A
    // snapped piece may own a sample a hair outside; there a share is held at zero, or their sum vanishes at a horizon.
    let is_clockwise = dot(a.xyw, cross(b.xyw, c.xyw)) < 0.0;
    let lines = mat3x3f(cross(b.xyw, c.xyw), cross(c.xyw, a.xyw), cross(a.xyw, b.xyw));
    let signed = p * lines;
    let share = max(select(signed, -signed, is_clockwise), vec3f(0.0));
    let sum = share.x + share.y + share.z;
    let weights = select(vec3f(1.0 / 3.0), share / select(1.0, sum, sum > 0.0), sum > 0.0);
    var depths = vec3f(a.w, b.w, c.w);
    if !IS_PERSPECTIVE { depths = linear_depths(vec3f(a.z, b.z, c.z)); }
    let steps = 2.0 / vec2f(frame.size);
    let slopes = vec3f(length(lines[0].xy * steps), length(lines[1].xy * steps), length(lines[2].xy * steps));
    let edge_distance_px = abs(signed) / max(slopes, vec3f(1e-30));
    return Place(weights, dot(weights, depths), depths, center_clipped(a, b, c, sample), weights, edge_distance_px, is_clockwise);
}

// White where a lane is NaN, infinite or beyond 2^40.
fn color_of(draw: u32, vertex: u32) -> vec4f {
    let format = draws[draw].color_format;
    if !HAS_COLORS || format == 0u { return vec4f(1.0); }
    let byte = draws[draw].color_offset + vertex * draws[draw].color_stride;
    let rgb = pull_vec3(format, byte);
    let alpha = select(1.0, pull_lane(format, byte + 3u * pull_bytes(format)), (format >> 8u) == 4u);
    let bits = bitcast<vec4u>(vec4f(rgb, alpha));
    let gate = vertex_gate(bits.rgb) | vertex_gate(bits.aaa);
    return select(vec4f(1.0), vec4f(vertex_position(bits.rgb, gate), vertex_position(bits.aaa, gate).x), gate == 0u);
}

// The triangle whose samples are asked about, and its vertices.
var<private> shaded: Triangle;
var<private> shaded_at: vec3u;

// Before samples of a triangle are asked about: what they share is fetched and told once. In the middle of a loop over samples
// drivers take minutes to compile what vertex effects do.
fn shade_begin(id: u32) {
    shaded = triangle_load(id);
    shaded_at = triangle_vertices(shaded.draw, id - draws[shaded.draw].first_triangle);
    if HAS_PLANES { shape_begin(id, shaded.draw, shaded_at); }
}

fn shade_surface(pixel: vec2u) -> Surface {
    let t = shaded;
    let at = shaded_at;
    let id = t.id;
    var place: Place;
    if HAS_CLIPPING && ((t.a.x | t.b.x | t.c.x) & VERTEX_CLIPPED) != 0u {
        place = place_clipped(t, at, pixel);
    } else {
        place = place_whole(t, pixel);
    }
    let k = place.weights;
    let normal_from_object = draws[t.draw].normal_from_object;

    var s: Surface;
    s.triangle_id = id;
    s.rank = ranks_of(id);
    s.center_screen = place.center_screen;
    s.pixel = vec2f(pixel) + 0.5;
    s.screen = s.pixel / vec2f(frame.size);
    s.barycentrics = place.shares;
    s.edge_distance_px = place.edge_distance_px;
    s.depth_m = place.depth;
    s.pixel_size_m = length(frame.ndc_y.xyz) * 2.0 / f32(frame.size.y) * select(1.0, place.depth, IS_PERSPECTIVE);
    s.flat_depth_m = dot(place.corner_depths, vec3f(1.0 / 3.0));
    s.depth_range_m = frame.depth_range_m;
    // The sample lies on the ray of its pixel, so depth alone tells where.
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
    s.color = draws[t.draw].base_color
        * (color_of(t.draw, at.x) * k.x + color_of(t.draw, at.y) * k.y + color_of(t.draw, at.z) * k.z);
    s = texels_painted(s, t, at, place);

    let na = normal_bits(t.draw, at.x);
    let nb = normal_bits(t.draw, at.y);
    let nc = normal_bits(t.draw, at.z);
    s.center = s.position;
    var has_direction = true;
    if !HAS_PLANES {
        let sum = bitcast<vec3f>(na) * k.x + bitcast<vec3f>(nb) * k.y + bitcast<vec3f>(nc) * k.z;
        s.normal = normalize((normal_from_object * vec4f(sum, 0.0)).xyz);
        s.flat_normal = s.normal;
    } else {
        s.normal = normal_direction((normal_from_object * vec4f(normal_mixed(normal_gated(na), normal_gated(nb), normal_gated(nc), k), 0.0)).xyz);
        let a = vertex_position(transform_bits(t.draw, at.x), 0u);
        let b = vertex_position(transform_bits(t.draw, at.y), 0u);
        let c = vertex_position(transform_bits(t.draw, at.z), 0u);
        s.center = center_world(t.draw, at);
        s.flat_normal = normal_direction((normal_from_object * vec4f(normal_of_plane(a, b, c), 0.0)).xyz);
        s = shape_of(s, k);
        let has_smooth = any(s.normal != vec3f(0.0));
        let has_flat = any(s.flat_normal != vec3f(0.0));
        has_direction = has_smooth || has_flat;
        if !has_flat { s.flat_normal = select(s.view, s.normal, has_smooth); }
        if !has_smooth { s.normal = s.flat_normal; }
    }
    let is_mirrored = (draws[t.draw].flags & DRAW_MIRRORED) != 0u;
    if has_direction && place.is_clockwise != is_mirrored {
        s.normal = -s.normal;
        s.flat_normal = -s.flat_normal;
    }
    return light_filled(s);
}
