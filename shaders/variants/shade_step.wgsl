// Shade steps: what is added to the surface at a sample before surface effects. `at`: vertices of the triangle within its draw.
// Chosen by the scene and the stack: textures where materials are more than a base color, alpha where some of them blend, finish where an effect reads
// how they reflect, with finish_maps where textures tell it, transmission where light passes through some of them, normal_map where they turn
// normals that an effect reads, shadow_map where an effect reads how much light arrives.
//@ steps fn shade_step(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface
// Of the step textures, for those behind it.
//@ may declare fn slopes_of(t: Triangle, at: vec3u, position: SamplePosition, screen: vec2f) -> Slopes
//@ may declare fn texture_at(lookup: Lookup, at: vec3u, weights: vec3f, slopes: Slopes, is_color: bool) -> vec4f

//@ step textures
// The base color texture multiplies the color, and emitted light is added. The number of texels that a
// pixel spans follows exactly from the triangle's own plane, not from neighboring invocations.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/attributes
//@ use lib/shape
//@ use lib/surface
//@ use lib/shade
//@ use lib/material_atlas
//@ use variants/vertex_effects

fn shade_step_textures(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    let record = atlas_record(t.draw);
    let material = atlas_material(record);
    var slopes: Slopes;
    if (material.flags & (MATERIAL_BASE_TEXTURE | MATERIAL_EMISSION_TEXTURE)) != 0u { slopes = slopes_of(t, at, position, s.screen); }
    if (material.flags & MATERIAL_BASE_TEXTURE) != 0u {
        s.color = vec4f(s.color.rgb * texture_at(atlas_lookup(record + ATLAS_MATERIAL), at, position.weights, slopes, true).rgb, s.color.a);
    }
    if (material.flags & MATERIAL_UNLIT) != 0u {
        s.glow = s.color.rgb;
        return s;
    }
    var glow = vec3f(material.red, material.green, material.blue);
    if (material.flags & MATERIAL_EMISSION_TEXTURE) != 0u {
        glow *= texture_at(atlas_lookup(record + ATLAS_MATERIAL + ATLAS_LOOKUP), at, position.weights, slopes, true).rgb;
    }
    s.glow = glow;
    s.color = vec4f(s.color.rgb + glow, s.color.a);
    return s;
}

// Changes of the corners' weights from pixel to pixel.
struct Slopes {
    right: vec3f, // one pixel to the right
    down: vec3f,
}

// Weights are quotients of terms that are linear on screen, over their sum. Boxes and discs have no slopes.
fn slopes_of(t: Triangle, at: vec3u, position: SamplePosition, screen: vec2f) -> Slopes {
    if SHAPE != SHAPE_TRIANGLES { return Slopes(vec3f(0.0), vec3f(0.0)); }
    if shade_is_clipped(t) { return slopes_clipped(t, at, position.weights, screen); }
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let inv_w = select(bitcast<vec3f>(vec3u(t.a.w, t.b.w, t.c.w)), vec3f(1.0), IS_AFFINE);
    let unit = f32(grid_unit());
    let right = vec3f(vec3i(b.y - c.y, c.y - a.y, a.y - b.y)) * unit * inv_w;
    let down = vec3f(vec3i(c.x - b.x, a.x - c.x, b.x - a.x)) * unit * inv_w;
    return slopes_of_quotient(right, down, position.weights, dot(position.barycentrics, inv_w) * fixed_weight(a, b, c));
}

// The same on the plane of a triangle that was clipped, at a position in the picture from 0 to 1.
fn slopes_clipped(t: Triangle, at: vec3u, weights: vec3f, screen: vec2f) -> Slopes {
    let corners = vertex_effects_triangle(t.draw, at, t.id);
    let a = corners[0];
    let b = corners[1];
    let c = corners[2];
    let lines = transpose(mat3x3f(cross(b.xyw, c.xyw), cross(c.xyw, a.xyw), cross(a.xyw, b.xyw)));
    let terms = lines * vec3f(screen.x * 2.0 - 1.0, 1.0 - screen.y * 2.0, 1.0);
    let sum = dot(terms, vec3f(1.0));
    return slopes_of_quotient(lines[0] * (2.0 / f32(frame.size.x)), lines[1] * (-2.0 / f32(frame.size.y)), weights, sum);
}

fn slopes_of_quotient(right: vec3f, down: vec3f, weights: vec3f, sum: f32) -> Slopes {
    return Slopes((right - weights * dot(right, vec3f(1.0))) / sum, (down - weights * dot(down, vec3f(1.0))) / sum);
}

// Texture coordinates of a vertex.
fn texture_coordinates(lookup: Lookup, vertex: u32) -> vec2f {
    let byte = lookup.offset + vertex * lookup.stride;
    let stored = vec2f(pull_component(lookup.format, byte), pull_component(lookup.format, byte + pull_bytes(lookup.format)));
    return vec2f(
        lookup.u_per_u * stored.x + lookup.u_per_v * stored.y + lookup.u_offset,
        lookup.v_per_u * stored.x + lookup.v_per_v * stored.y + lookup.v_offset);
}

// Whole images between a coordinate and the equivalent one near 0.
fn texture_repeats(at: f32, wrap: u32) -> f32 {
    if wrap == WRAP_CLAMP { return 0.0; }
    return select(floor(at), 2.0 * floor(0.5 * at), wrap == WRAP_MIRRORED);
}

// Linear RGBA of a texture at a sample. Coordinates are measured from the first corner, which is moved near 0, so that errors
// grow with the size of the triangle and not with its distance from the image's edge.
fn texture_at(lookup: Lookup, at: vec3u, weights: vec3f, slopes: Slopes, is_color: bool) -> vec4f {
    let a = texture_coordinates(lookup, at.x);
    let ab = texture_coordinates(lookup, at.y) - a;
    let ac = texture_coordinates(lookup, at.z) - a;
    let whole = vec2f(texture_repeats(a.x, lookup.sampling & 3u), texture_repeats(a.y, (lookup.sampling >> 2u) & 3u));
    let uv = (a - whole) + ab * weights.y + ac * weights.z;
    let size = vec2f(vec2u(lookup.size & 0xffffu, lookup.size >> 16u));
    let right = (ab * slopes.right.y + ac * slopes.right.z) * size;
    let down = (ab * slopes.down.y + ac * slopes.down.z) * size;
    let squared = max(dot(right, right), dot(down, down));
    return atlas_filtered(lookup, uv, 0.5 * log2(max(squared, 1e-30)), is_color);
}

//@ step alpha
// The alpha of the base color texture of glass, filtered as its color is. Comes after textures.
//@ use lib/triangle
//@ use lib/surface
//@ use lib/shade
//@ use lib/glass
//@ use lib/material_atlas
//@ use variants/shade_step

fn shade_step_alpha(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    let record = atlas_record(t.draw);
    if (draws[t.draw].flags & DRAW_GLASS) == 0u || (atlas_material(record).flags & MATERIAL_BASE_TEXTURE) == 0u { return s; }
    let slopes = slopes_of(t, at, position, s.screen);
    s.color.a *= texture_at(atlas_lookup(record + ATLAS_MATERIAL), at, position.weights, slopes, true).a;
    return s;
}

//@ step finish
// How the material reflects.
//@ use lib/triangle
//@ use lib/surface
//@ use lib/shade
//@ use lib/finish_atlas
//@ use lib/material_atlas

fn shade_step_finish(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    s.finish = finish_of(finish_record(atlas_record(t.draw)));
    return s;
}

//@ step finish_maps
// Textures of how the material reflects: metallic and roughness, and the occlusion. Comes after textures and finish.
//@ use lib/triangle
//@ use lib/surface
//@ use lib/shade
//@ use lib/material_atlas
//@ use lib/map_atlas
//@ use variants/shade_step

fn shade_step_finish_maps(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    let first = maps_record(atlas_record(t.draw));
    let maps = maps_at(first);
    if !maps_have(maps, MAPS_FINISH) && !maps_have(maps, MAPS_OCCLUSION) { return s; }
    let slopes = slopes_of(t, at, position, s.screen);
    // A loop, because compilers inline the lookup wherever it is called.
    for (var map = MAPS_FINISH; map <= MAPS_OCCLUSION; map += 1u) {
        if !maps_have(maps, map) { continue; }
        let texel = texture_at(maps_lookup(first, map), at, position.weights, slopes, false);
        if map == MAPS_FINISH {
            s.finish.roughness *= texel.g;
            s.finish.metallic *= texel.b;
        } else {
            s.finish.occlusion = 1.0 + maps.occlusion_strength * (texel.r - 1.0);
        }
    }
    return s;
}

//@ step transmission
// What passes through the material instead of being scattered by its color. Comes after textures, alpha, finish and finish_maps.
//@ use lib/triangle
//@ use lib/surface
//@ use lib/shade
//@ use lib/glass
//@ use lib/material_atlas
//@ use lib/transmission

fn shade_step_transmission(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    if (draws[t.draw].flags & DRAW_GLASS) == 0u { return s; }
    let transmission = transmission_record(atlas_record(t.draw));
    let through = (1.0 - s.finish.metallic) * select(1.0, s.color.a, transmission.is_opaque > 1u);
    let base = s.color.rgb - s.glow;
    s.passed = base * vec3f(transmission.red, transmission.green, transmission.blue) * through;
    s.color = vec4f(base * (1.0 - transmission.amount * through) + s.glow, select(s.color.a, 1.0, transmission.is_opaque != 0u));
    return s;
}

//@ step normal_map
// A texture turns the normal: its components count along the tangent of the surface, across it and outward. Comes after textures.
//@ use lib/triangle
//@ use lib/attributes
//@ use lib/surface
//@ use lib/shade
//@ use lib/material_atlas
//@ use lib/map_atlas
//@ use variants/draw_records
//@ use variants/shade_step

// Shortest part of a tangent, of the whole, that makes a direction on the surface. Shorter ones fade.
const SHORTEST_TANGENT = 0.0009765625;
// Squared length of a texture's normal below which the surface keeps its own.
const SHORTEST_NORMAL = 1e-6;

fn shade_step_normal_map(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface {
    var s = surface;
    let first = maps_record(atlas_record(t.draw));
    let maps = maps_at(first);
    if !maps_have(maps, MAPS_NORMAL) { return s; }
    let slopes = slopes_of(t, at, position, s.screen);
    let texel = texture_at(maps_lookup(first, MAPS_NORMAL), at, position.weights, slopes, false).rgb;
    let bump = (texel * 2.0 - 1.0) * vec3f(maps.normal_scale, maps.normal_scale, 1.0);

    let is_mirrored = (draws[t.draw].flags & DRAW_MIRRORED) != 0u;
    let outward = select(s.normal, -s.normal, position.is_clockwise != is_mirrored);
    let tangent = tangent_at(t, at, position.weights, maps.tangents);
    let aside = tangent.xyz - outward * dot(outward, tangent.xyz);
    let along = aside / max(max(length(aside), SHORTEST_TANGENT * length(tangent.xyz)), 1e-30);
    let across = cross(outward, along) * select(tangent.w, -tangent.w, is_mirrored);
    let turned = along * bump.x + across * bump.y + outward * bump.z;
    let squared = dot(turned, turned);
    if squared > SHORTEST_NORMAL {
        let normal = turned / sqrt(squared);
        s.normal = select(normal, -normal, position.is_clockwise != is_mirrored);
    }
    return s;
}

// The tangent of a triangle in world space, of any length, and the side to which its image rises. The tangents of its draw begin
// at byte `tangents`.
fn tangent_at(t: Triangle, at: vec3u, weights: vec3f, tangents: u32) -> vec4f {
    let first = tangents + 36u * (t.id - draws[t.draw].first_triangle);
    let factors = pull_vec3(PULL_F32, first) * weights.x + pull_vec3(PULL_F32, first + 12u) * weights.y + pull_vec3(PULL_F32, first + 24u) * weights.z;
    let a = floats_of_class(position_bits(t.draw, at.x), 0u);
    let ab = floats_of_class(position_bits(t.draw, at.y), 0u) - a;
    let ac = floats_of_class(position_bits(t.draw, at.z), 0u) - a;
    let tangent = draw_vector(t.draw, ab * factors.x + ac * factors.y);
    return vec4f(tangent, select(1.0, -1.0, factors.z < 0.0));
}

//@ step shadow_map
// The fraction of a directional light that reaches a sample, from the depths that the light sees.
// Mirrors `gpu::records::ShadowMapUniform`.
//@ use lib/frame
//@ use lib/geometry
//@ use lib/triangle
//@ use lib/surface
//@ use lib/shade
//@ use variants/shadow_map
//@ use glue/effects

// The transform to the shadow map from the axes of the world, at the eye of the picture.
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
    // From the eye, not from the origin: far from it positions are coarse.
    let ndc = vec2f(s.screen.x * 2.0 - 1.0, 1.0 - s.screen.y * 2.0);
    let aside = frame.ndc_x.xyz * ndc.x + frame.ndc_y.xyz * ndc.y;
    let from_eye = select(aside + frame.forward.xyz * s.depth_m, (frame.forward.xyz + aside) * s.depth_m, IS_PERSPECTIVE);
    let p = vec4f(from_eye, 1.0);
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
