// Geometry of triangles: object space to clip space, centers, and normals.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/attributes
//@ use variants/draw_records

// Positions are taken relative to the draw's origin, which lies near the eye, before the matrix is applied.
override IS_RELATIVE: bool = false;
// w is meters along the viewing direction and clip-space z the same everywhere; else depth is linear and w is 1.
override IS_PERSPECTIVE: bool = true;

// Clip-space position of an object-space position.
fn transform_clip(draw: u32, position: vec3f) -> vec4f {
    var p = position;
    if IS_RELATIVE { p -= draw_origin(draw); }
    let m = draws[draw].clip_from_object;
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}

// ---- Centers: means of a triangle's corners, in world space and on screen.

fn center_world(draw: u32, at: vec3u) -> vec3f {
    let a = floats_of_class(position_bits(draw, at.x), 0u);
    let b = floats_of_class(position_bits(draw, at.y), 0u);
    let c = floats_of_class(position_bits(draw, at.z), 0u);
    return center_of(draw, a, b, c);
}

// The same from corners in object space.
fn center_of(draw: u32, a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    return draw_point(draw, (a + b + c) / 3.0);
}

// 0 to 1 across the picture, for a triangle that is not clipped: corners are weighted by w, as the center of the plane is.
fn center_unclipped(a: vec4u, b: vec4u, c: vec4u) -> vec2f {
    let w = 1.0 / bitcast<vec3f>(vec3u(a.w, b.w, c.w));
    let sum = vec2f(vertex_at(a)) * w.x + vec2f(vertex_at(b)) * w.y + vec2f(vertex_at(c)) * w.z;
    return sum / ((w.x + w.y + w.z) * 2.0 * frame.center);
}

// The same from clip-space corners; `otherwise` where the center lies behind the eye.
fn center_clipped(a: vec4f, b: vec4f, c: vec4f, otherwise: vec2f) -> vec2f {
    let w = a.w + b.w + c.w;
    let ndc = (a.xy + b.xy + c.xy) / select(1.0, w, w > 0.0);
    return select(otherwise, vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y), w > 0.0);
}

// A shadow map is being drawn, but effects ask for positions in the picture that the light illuminates.
override IS_SHADOW_MAP: bool = false;

// Where a world-space point stands in the picture, 0 to 1, given where it stands in the view that is being drawn.
fn center_in_picture(center: vec3f, in_view: vec2f) -> vec2f {
    if !IS_SHADOW_MAP { return in_view; }
    let clip = frame.picture_from_world * vec4f(center, 1.0);
    return center_clipped(clip, clip, clip, vec2f(0.5));
}

// ---- Normals.

// False where a component is NaN or infinite. Compilers may assume floats to be finite, so the bits are tested.
fn is_finite(v: vec3f) -> bool {
    let exponents = bitcast<vec3u>(v) & vec3u(FLOAT_EXPONENT);
    return all(exponents != vec3u(FLOAT_EXPONENT));
}

// Direction of `v`, which may have any length; zero where it has none.
fn normal_direction(v: vec3f) -> vec3f {
    let scale = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if !(scale > 0.0) || !is_finite(v) { return vec3f(0.0); }
    let scaled = v / scale;
    return scaled / length(scaled);
}

// Normal of the plane through three points; zero for a sliver whose edges are parallel to within 1e-6.
fn normal_of_plane(a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let ab = b - a;
    let ac = c - a;
    let longest_ab = max(max(abs(ab.x), abs(ab.y)), abs(ab.z));
    let longest_ac = max(max(abs(ac.x), abs(ac.y)), abs(ac.z));
    if !(longest_ab > 0.0 && longest_ac > 0.0) { return vec3f(0.0); }
    let normal = cross(ab / longest_ab, ac / longest_ac);
    return select(vec3f(0.0), normal, dot(normal, normal) >= 1e-12);
}

// Interpolated normal; zero where a corner has none or the corners cancel.
fn normal_interpolated(a: vec4f, b: vec4f, c: vec4f, weights: vec3f) -> vec3f {
    let longest = max(max(abs(a.xyz), abs(b.xyz)), abs(c.xyz));
    let scale = max(max(longest.x, longest.y), longest.z);
    if a.w * b.w * c.w == 0.0 || scale == 0.0 { return vec3f(0.0); }
    let sum = (a.xyz * weights.x + b.xyz * weights.y + c.xyz * weights.z) / scale;
    return select(vec3f(0.0), sum, dot(sum, sum) >= 1e-12);
}
