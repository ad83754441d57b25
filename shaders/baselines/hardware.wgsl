// Hardware: an ordinary render pipeline over the same vertex and index bytes, as a yardstick. The same effects shade it;
// what only a rasterizer of our own knows (flat normal, triangle id, center) it leaves at the interpolated values.
// Images are textures of the adapter, which its own samplers filter. Mirrors `gpu::records::HardwareMaterial`.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/surface
//@ use lib/color
//@ use variants/draw_records
//@ use glue/surface

// ---- Materials that are a base color and nothing else.

struct Varyings {
    @builtin(position) at: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) depth_m: f32,
    @location(3) @interpolate(flat) draw: u32,
}

@vertex
fn hardware_vertex(@location(0) position: vec3f, @location(1) normal: vec3f, @builtin(instance_index) draw: u32) -> Varyings {
    return hardware_projected(position, normal, draw);
}

fn hardware_projected(position: vec3f, normal: vec3f, draw: u32) -> Varyings {
    var v: Varyings;
    v.at = draws[draw].clip_from_object * vec4f(position, 1.0);
    v.position = draw_point(draw, position);
    v.normal = draw_normal(draw, normal);
    if (draws[draw].flags & DRAW_UNEVEN) != 0u { v.normal = normalize(v.normal) * length(normal); }
    v.depth_m = v.at.w;
    v.draw = draw;
    return v;
}

@fragment
fn hardware_fragment(v: Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    var s = hardware_surface(v, is_front);
    s.color = draw_base_color(v.draw);
    return hardware_encoded(glue_surface(s, v.draw));
}

// The surface without its color.
fn hardware_surface(v: Varyings, is_front: bool) -> Surface {
    var s: Surface;
    s.position = v.position;
    s.view = normalize(frame.eye.xyz - v.position);
    s.normal = select(-normalize(v.normal), normalize(v.normal), is_front);
    let plane = cross(dpdx(v.position), dpdy(v.position));
    if (draws[v.draw].flags & DRAW_FACETED) != 0u { s.normal = normalize(select(plane, -plane, dot(plane, s.view) < 0.0)); }
    s.flat_normal = s.normal;
    s.center = v.position;
    s.screen = v.at.xy / vec2f(frame.size);
    s.center_screen = s.screen;
    s.depth_m = v.depth_m;
    s.flat_depth_m = v.depth_m;
    s.depth_range_m = frame.depth_range_m;
    return s;
}

// Alpha tells where something was drawn.
fn hardware_encoded(shaded: Surface) -> vec4f {
    return vec4f(color_encode(shaded.color.rgb), 1.0);
}

// ---- Materials that look up images, shine, are unlit or have vertex colors.

struct HardwareMaterial {
    base_u: vec4f,     // u in the image of the base color: factors of the file's u and v, and an offset
    base_v: vec4f,
    emission_u: vec4f, // the same for the emission
    emission_v: vec4f,
    emission: vec4f,   // linear RGB, and the least alpha that is drawn
}

@group(1) @binding(0) var<uniform> hardware_material: HardwareMaterial;
@group(1) @binding(1) var base_image: texture_2d<f32>;
@group(1) @binding(2) var base_sampler: sampler;
@group(1) @binding(3) var emission_image: texture_2d<f32>;
@group(1) @binding(4) var emission_sampler: sampler;

override HAS_BASE_IMAGE: bool = false;
override HAS_EMISSION_IMAGE: bool = false;
override IS_UNLIT: bool = false;

struct PaintedVaryings {
    @builtin(position) at: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) depth_m: f32,
    @location(3) @interpolate(flat) draw: u32,
    @location(4) base_uv: vec2f,
    @location(5) emission_uv: vec2f,
    @location(6) color: vec4f,
}

@vertex
fn hardware_painted_vertex(
    @location(0) position: vec3f, @location(1) normal: vec3f, @location(2) base_texcoord: vec2f,
    @location(3) emission_texcoord: vec2f, @location(4) color: vec4f, @builtin(instance_index) draw: u32
) -> PaintedVaryings {
    let v = hardware_projected(position, normal, draw);
    let base = vec3f(base_texcoord, 1.0);
    let emission = vec3f(emission_texcoord, 1.0);
    let base_uv = vec2f(dot(hardware_material.base_u.xyz, base), dot(hardware_material.base_v.xyz, base));
    let emission_uv = vec2f(dot(hardware_material.emission_u.xyz, emission), dot(hardware_material.emission_v.xyz, emission));
    return PaintedVaryings(v.at, v.position, v.normal, v.depth_m, v.draw, base_uv, emission_uv, color * draw_base_color(draw));
}

// What the images say of a fragment, linear RGB.
struct SurfacePaint {
    base: vec3f,
    emission: vec3f,
}

// Must be called before a fragment is discarded, whose neighbors it gives the size of a pixel in the image.
fn hardware_paint(v: PaintedVaryings) -> SurfacePaint {
    var paint = SurfacePaint(vec3f(1.0), hardware_material.emission.rgb);
    if HAS_BASE_IMAGE { paint.base = textureSample(base_image, base_sampler, v.base_uv).rgb; }
    if HAS_EMISSION_IMAGE { paint.emission *= textureSample(emission_image, emission_sampler, v.emission_uv).rgb; }
    return paint;
}

fn hardware_shaded(v: PaintedVaryings, is_front: bool, paint: SurfacePaint) -> vec4f {
    var s = hardware_surface(Varyings(v.at, v.position, v.normal, v.depth_m, v.draw), is_front);
    s.color = v.color * vec4f(paint.base, 1.0);
    if IS_UNLIT {
        s.glow = s.color.rgb;
    } else {
        s.glow = paint.emission;
        s.color = vec4f(s.color.rgb + paint.emission, s.color.a);
    }
    return hardware_encoded(glue_surface(s, v.draw));
}

@fragment
fn hardware_painted(v: PaintedVaryings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return hardware_shaded(v, is_front, hardware_paint(v));
}

// An entry point of its own, so that only masked materials lose the depth test before the fragment.
@fragment
fn hardware_masked(v: PaintedVaryings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let paint = hardware_paint(v);
    // Of the largest level, as in our kernels.
    if textureSampleLevel(base_image, base_sampler, v.base_uv, 0.0).a < hardware_material.emission.a { discard; }
    return hardware_shaded(v, is_front, paint);
}
