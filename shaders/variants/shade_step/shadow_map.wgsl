// Shade step, shadow map: the fraction of a directional light that reaches a sample, from the depths that the light sees.
// Mirrors `gpu::records::ShadowMapUniform`.
//@ use lib/triangle
//@ use lib/surface
//@ use lib/shade
//@ use variants/shadow_map
//@ use glue/effects

// The transform from world space to the shadow map.
struct ShadowMapView {
    column: vec4f, // texels to the right, of a point (x, y, z, 1)
    row: vec4f,    // texels down
    depth: vec4f,  // reversed depth: 1 near the light
    texel_m: f32,
    range_m: f32,  // meters from depth 0 to depth 1
    side: u32,     // texels
    spare: u32,
}

@group(0) @binding(30) var<uniform> light: ShadowMapView;

// Texels along a side of the filter: 1, 3 or 5.
override SHADOW_TAPS_SIDE: i32 = 3;
// Largest tangent of the angle between light and normal for which the bias grows.
override MAX_SHADOW_SLOPE: f32 = 8.0;

// Is the depth at least that of what the light sees in a texel? Reversed depths are floats from 0 up, which order like their
// bits. There is no shadow outside the map.
fn shadow_map_is_lit(texel: vec2i, depth: f32) -> bool {
    let is_inside = all(texel >= vec2i(0)) && all(texel < vec2i(i32(light.side)));
    let key = shadow_map_key(vec2u(clamp(texel, vec2i(0), vec2i(i32(light.side) - 1))), light.side);
    return !is_inside || bitcast<u32>(max(depth, 1e-9)) >= key;
}

// Weight of a tap along one axis; the weights sum to `SHADOW_TAPS_SIDE - 1`. The outermost taps fade as the sample crosses its
// texel, so that the sum is continuous.
fn shadow_map_weight(tap: i32, fraction: f32) -> f32 {
    let radius = SHADOW_TAPS_SIDE / 2;
    if radius == 0 { return 1.0; }
    return select(select(1.0, fraction, tap == radius), 1.0 - fraction, tap == -radius);
}

fn shade_step_shadow_map(surface: Surface, t: Triangle, vertices_at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    let p = vec4f(s.position, 1.0);
    let at = vec2f(dot(light.column, p), dot(light.row, p));
    let texel_depth = light.texel_m / light.range_m;
    // The slope of the triangle's plane: its change of depth from texel to texel.
    let across = vec2f(dot(light.column.xyz, s.flat_normal), dot(light.row.xyz, s.flat_normal)) * light.texel_m;
    let along = dot(light.depth.xyz, s.flat_normal) * light.range_m;
    let slant = across / select(max(along, 1e-3), min(along, -1e-3), along < 0.0);
    let tangent = length(slant);
    let clamped = min(tangent, MAX_SHADOW_SLOPE);
    let fall = -slant * (clamped / max(tangent, 1e-9)) * texel_depth;
    let depth = dot(light.depth, p) + (effects.shadow.bias + effects.shadow.slope * clamped) * texel_depth;

    let first = floor(at);
    let fraction = at - first;
    let radius = SHADOW_TAPS_SIDE / 2;
    var sum = 0.0;
    for (var y = -radius; y <= radius; y += 1) {
        for (var x = -radius; x <= radius; x += 1) {
            let texel = vec2i(x, y);
            let middle = vec2f(texel) + 0.5 - fraction;
            let weight = shadow_map_weight(x, fraction.x) * shadow_map_weight(y, fraction.y);
            sum += select(0.0, weight, shadow_map_is_lit(vec2i(first) + texel, depth + dot(fall, middle)));
        }
    }
    let whole = f32(max(SHADOW_TAPS_SIDE - 1, 1));
    s.lit = sum / (whole * whole);
    return s;
}
