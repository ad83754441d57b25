// Hardware: an ordinary render pipeline over the same vertex and index bytes, as a yardstick. The same effects shade it;
// what only a rasterizer of our own knows (flat normal, triangle id, center) it leaves at the interpolated values.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/surface
//@ use lib/color
//@ use glue/surface

struct Varyings {
    @builtin(position) at: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) depth_m: f32,
    @location(3) @interpolate(flat) draw: u32,
}

@vertex
fn hardware_vertex(@location(0) position: vec3f, @location(1) normal: vec3f, @builtin(instance_index) draw: u32) -> Varyings {
    var v: Varyings;
    v.at = draws[draw].clip_from_object * vec4f(position, 1.0);
    v.position = (draws[draw].world_from_object * vec4f(position, 1.0)).xyz;
    v.normal = (draws[draw].normal_from_object * vec4f(normal, 0.0)).xyz;
    v.depth_m = v.at.w;
    v.draw = draw;
    return v;
}

@fragment
fn hardware_fragment(v: Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    var s: Surface;
    s.color = draws[0].base_color;
    s.position = v.position;
    s.normal = select(-normalize(v.normal), normalize(v.normal), is_front);
    s.flat_normal = s.normal;
    s.view = normalize(frame.eye.xyz - v.position);
    s.center = v.position;
    s.screen = v.at.xy / vec2f(frame.size);
    s.center_screen = s.screen;
    s.depth_m = v.depth_m;
    s.flat_depth_m = v.depth_m;
    s.depth_range_m = frame.depth_range_m;
    let shaded = glue_surface(s, v.draw);
    return vec4f(color_encode(shaded.color.rgb), shaded.color.a);
}
