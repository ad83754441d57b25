// The picture of what surrounds a scene, among the words of pictures. Mirrors `scene::panorama`, which explains the formulas and the words.
//@ use lib/image_file

const PANORAMA_FORM_WORDS = 30u; // of the light on a matt surface, before the levels
const PANORAMA_LEVELS = 7u;      // blurred as mirrors are whose perceptual roughness rises evenly from 0 to 1
const PANORAMA_SIDE = 512u;      // texels along a side of the first level
const PANORAMA_LEAST_SIDE = 32u; // and least of the others

// The first word.
fn panorama_first() -> u32 {
    return image_file_word(IMAGE_FILE_RECORDS + 2u * image_file_word(IMAGE_FILE_COUNT));
}

fn panorama_form(first: u32, term: u32) -> vec3f {
    let word = first + 3u * term;
    return bitcast<vec3f>(vec3u(image_file_word(word), image_file_word(word + 1u), image_file_word(word + 2u)));
}

// Light that a white matt surface shows.
fn panorama_irradiance(n: vec3f) -> vec3f {
    let first = panorama_first();
    let linear = panorama_form(first, 0u) + panorama_form(first, 1u) * n.x + panorama_form(first, 2u) * n.y + panorama_form(first, 3u) * n.z;
    let squares = panorama_form(first, 4u) * (n.x * n.x) + panorama_form(first, 5u) * (n.y * n.y) + panorama_form(first, 6u) * (n.z * n.z);
    let products = panorama_form(first, 7u) * (n.x * n.y) + panorama_form(first, 8u) * (n.y * n.z) + panorama_form(first, 9u) * (n.z * n.x);
    return max(linear + squares + products, vec3f(0.0));
}

// What a mirror of this roughness shows in a direction.
fn panorama_radiance(d: vec3f, alpha: f32) -> vec3f {
    let place = panorama_place(d);
    let level = sqrt(clamp(alpha, 0.0, 1.0)) * f32(PANORAMA_LEVELS - 1u);
    let lower = min(u32(level), PANORAMA_LEVELS - 2u);
    var first = panorama_first() + PANORAMA_FORM_WORDS;
    for (var finer = 0u; finer < lower; finer += 1u) {
        let passed = panorama_side(finer);
        first += passed * passed;
    }
    let side = panorama_side(lower);
    let fine = panorama_between(first, side, place);
    let coarse = panorama_between(first + side * side, panorama_side(lower + 1u), place);
    return mix(fine, coarse, level - f32(lower));
}

fn panorama_side(level: u32) -> u32 {
    return max(PANORAMA_SIDE >> level, PANORAMA_LEAST_SIDE);
}

// Where a direction lies on the unfolded octahedron, from 0 to 1.
fn panorama_place(d: vec3f) -> vec2f {
    let p = d.xz / (abs(d.x) + abs(d.y) + abs(d.z));
    let signs = select(vec2f(1.0), vec2f(-1.0), p < vec2f(0.0));
    return select(p, (vec2f(1.0) - abs(p.yx)) * signs, d.y < 0.0) * 0.5 + 0.5;
}

// Between the middles of four texels of a level.
fn panorama_between(first: u32, side: u32, place: vec2f) -> vec3f {
    let at = place * f32(side) - 0.5;
    let near = vec2i(floor(at));
    let part = at - floor(at);
    let upper = mix(panorama_texel(first, side, near), panorama_texel(first, side, near + vec2i(1, 0)), part.x);
    let lower = mix(panorama_texel(first, side, near + vec2i(0, 1)), panorama_texel(first, side, near + vec2i(1, 1)), part.x);
    return mix(upper, lower, part.y);
}

// A texel of a level; beyond an edge, the one that the edge is folded onto.
fn panorama_texel(first: u32, side: u32, place: vec2i) -> vec3f {
    let end = i32(side);
    var at = place;
    if at.x < 0 || at.x >= end { at = vec2i(panorama_back(at.x, end), end - 1 - at.y); }
    if at.y < 0 || at.y >= end { at = vec2i(end - 1 - at.x, panorama_back(at.y, end)); }
    let inside = vec2u(clamp(at, vec2i(0), vec2i(end - 1)));
    let word = image_file_word(first + inside.y * side + inside.x);
    let bits = (vec3u(word) >> vec3u(0u, 9u, 18u)) & vec3u(511u);
    // 2^(exponent − 24): the exponent of an f32 has a bias of 127.
    return vec3f(bits) * bitcast<f32>(((word >> 27u) + 103u) << 23u);
}

fn panorama_back(at: i32, end: i32) -> i32 {
    return max(-1 - at, min(at, 2 * end - 1 - at));
}
