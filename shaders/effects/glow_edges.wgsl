// Glow edges: silhouettes and steps of depth shine like neon tubes.
//@ use lib/hash
//@ use lib/image
//@ use lib/image_pass

struct GlowEdges {
    /// The one color, linear; its alpha is the strength of all tubes.
    @color(0.15, 0.75, 1) color: vec4f,
    /// What color the tubes have.
    @choice(objects, picture, one) hue: u32,
    /// How far the light reaches.
    @range(1, 64, 16) @hard(1, 256) @unit(px) radius_px: f32,
    /// Strength of the light around the tubes.
    @range(0, 8, 3) @hard(0, 32) intensity: f32,
    /// How much of the picture is seen beneath.
    @range(0, 1, 0.12) picture: f32,
    /// The least jump of depth within an object that counts, as a fraction of the distance.
    @range(0.001, 0.5, 0.02) @hard(0.0001, 1) @log depth_threshold: f32,
}

// The tubes alone.
fn glow_edges_find(at: ImageAt, p: GlowEdges) -> vec4f {
    return glow_edges_tube(p, at);
}

// At half the size from here.
@pass(half)
fn glow_edges_across(at: ImageAt, p: GlowEdges) -> vec4f {
    let middle = image_middle(at);
    let radius = 0.5 * p.radius_px;
    let reach = i32(ceil(radius));
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -reach; i <= reach; i += 1) {
        let weight = glow_edges_weight(f32(i) / (radius + 1.0));
        sum += weight * image_last_at(middle.x + f32(2 * i), middle.y);
        weights += weight;
    }
    return sum / weights;
}

@pass(half)
fn glow_edges_down(at: ImageAt, p: GlowEdges) -> vec4f {
    let radius = 0.5 * p.radius_px;
    let reach = i32(ceil(radius));
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -reach; i <= reach; i += 1) {
        let weight = glow_edges_weight(f32(i) / (radius + 1.0));
        sum += weight * image_last(at.x, at.y + i);
        weights += weight;
    }
    return sum / weights;
}

fn glow_edges_shine(at: ImageAt, p: GlowEdges) -> vec4f {
    let color = image_color(at.x, at.y);
    let tube = glow_edges_tube(p, at);
    let middle = 0.5 * image_middle(at);
    // A tube is a pixel wide, so a mean over a larger radius has less of it: the halo is as bright at any size of the picture.
    let halo = p.intensity * (p.radius_px / 16.0) * image_last_at(middle.x, middle.y).rgb;
    // A tube is white in its middle.
    let core = tube.rgb + tube.a * (0.6 - 0.6 * tube.rgb);
    let dim = p.picture * color.rgb;
    let lit = dim + halo * (1.0 - clamp(dim, vec3f(0.0), vec3f(1.0)));
    return vec4f(mix(lit, core, tube.a * p.color.a), color.a);
}

fn glow_edges_weight(t: f32) -> f32 {
    let near = max(1.0 - abs(t), 0.0);
    return near * near * near;
}

// The color of the tube at a pixel, and whether there is one.
fn glow_edges_tube(p: GlowEdges, at: ImageAt) -> vec4f {
    let here = image_at(at.x, at.y);
    let right = glow_edges_is_edge(here, vec2i(at.x, at.y), vec2i(1, 0), p);
    let down = glow_edges_is_edge(here, vec2i(at.x, at.y), vec2i(0, 1), p);
    if here.x == IMAGE_NO_TRIANGLE || !(right || down) { return vec4f(0.0); }
    if p.hue == GLOW_EDGES_HUE_ONE { return vec4f(p.color.rgb, 1.0); }
    if p.hue == GLOW_EDGES_HUE_PICTURE {
        let light = max(image_color(at.x, at.y).rgb, vec3f(0.0));
        return vec4f(light / max(max(max(light.r, light.g), light.b), 0.001), 1.0);
    }
    let turn = fract(hash_unit(here.z) + vec3f(0.0, 0.6666666666666666, 0.3333333333333333));
    return vec4f(clamp(abs(turn * 6.0 - 3.0) - 1.0, vec3f(0.0), vec3f(1.0)), 1.0);
}

// Does a pixel lie on the nearer side of an edge, along an axis? Each is triangle id, depth bits and object.
fn glow_edges_is_edge(here: vec3u, at: vec2i, step: vec2i, p: GlowEdges) -> bool {
    let there = image_at(at.x + step.x, at.y + step.y);
    let beyond = image_at(at.x - step.x, at.y - step.y);
    if (there.z != here.z && there.y < here.y) || (beyond.z != here.z && beyond.y < here.y) { return true; }
    if there.z != here.z || beyond.z != here.z { return false; }
    // A slope alone is no step. Depths end at the bits of 1.0, so the sum fits.
    let bend = i32(there.y) + i32(beyond.y) - 2 * i32(here.y);
    return bend < -i32(p.depth_threshold * 8388608.0);
}
