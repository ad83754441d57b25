// Light, mapped: the share of a directional light that arrives at a sample, by the depths that the light sees.
//@ use common/surface
//@ use glue/surface

// What takes a place in the world to the shadow map. Mirror of `gpu::uniforms::LightUniform`.
struct ShadowMapView {
    column: vec4f, // texels to the right, of a place (x, y, z, 1)
    row: vec4f,    // texels down
    depth: vec4f,  // reversed depth: 1 near the light
    texel_m: f32,
    depth_range_m: f32,  // metres from depth 0 to depth 1
    side: u32,     // texels
    spare: u32,
}

@group(0) @binding(30) var<uniform> light: ShadowMapView;
@group(0) @binding(31) var shadow_map: texture_2d<u32>;

// Texels a side of the filter: 1, 3 or 5.
override SHADOW_TAPS_SIDE: i32 = 3;
// Largest tangent of the angle between light and normal that counts.
override MAX_SHADOW_SLOPE: f32 = 8.0;

// Is the depth at least that of what the light sees in a texel? Reversed depths are floats from 0 up, whose bits order as
// they do. Beyond the map stands nothing.
fn light_reaches(texel: vec2i, depth: f32) -> bool {
    let is_inside = all(texel >= vec2i(0)) && all(texel < vec2i(i32(light.side)));
    let key = textureLoad(shadow_map, clamp(texel, vec2i(0), vec2i(i32(light.side) - 1)), 0).x;
    return !is_inside || bitcast<u32>(max(depth, 1e-9)) >= key;
}

// Weight of a tap along one axis, of `SHADOW_TAPS_SIDE - 1` in all: the outermost fade as the sample crosses its texel, so that the
// sum is smooth.
fn light_weight(tap: i32, fraction: f32) -> f32 {
    let reach = SHADOW_TAPS_SIDE / 2;
    if reach == 0 { return 1.0; }
    return select(select(1.0, fraction, tap == reach), 1.0 - fraction, tap == -reach);
}

fn light_filled(surface: Surface) -> Surface {
    var s = surface;
    let p = vec4f(s.position, 1.0);
    let at = vec2f(dot(light.column, p), dot(light.row, p));
    let texel_depth = light.texel_m / light.depth_range_m;
    // The plane of the triangle: how deep it falls from texel to texel.
    let across = vec2f(dot(light.column.xyz, s.flat_normal), dot(light.row.xyz, s.flat_normal)) * light.texel_m;
    let along = dot(light.depth.xyz, s.flat_normal) * light.depth_range_m;
    let slant = across / select(max(along, 1e-3), min(along, -1e-3), along < 0.0);
    let tangent = length(slant);
    let held = min(tangent, MAX_SHADOW_SLOPE);
    let fall = -slant * (held / max(tangent, 1e-9)) * texel_depth;
    let depth = dot(light.depth, p) + (effects.shadow.bias + effects.shadow.slope * held) * texel_depth;

    let first = floor(at);
    let fraction = at - first;
    let reach = SHADOW_TAPS_SIDE / 2;
    var sum = 0.0;
    for (var y = -reach; y <= reach; y += 1) {
        for (var x = -reach; x <= reach; x += 1) {
            let texel = vec2i(x, y);
            let middle = vec2f(texel) + 0.5 - fraction;
            let weight = light_weight(x, fraction.x) * light_weight(y, fraction.y);
            sum += select(0.0, weight, light_reaches(vec2i(first) + texel, depth + dot(fall, middle)));
        }
    }
    let whole = f32(max(SHADOW_TAPS_SIDE - 1, 1));
    s.lit = sum / (whole * whole);
    return s;
}
