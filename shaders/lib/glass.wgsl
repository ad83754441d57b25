// Layers of glass: what one does to the linear color behind it, and where the layers of all pixels lie. They stand in words behind
// the pixels of the framebuffer, since portable adapters bind eight storage buffers to a pass, and raster_medium has no ninth:
// the head of the list of every pixel of a band (lib/glass_band), 0 or 1 + the number of its first node; counts
// (`gpu::glass::GlassRecord`); the opaque triangle of every pixel of the picture; and the nodes.
//@ use lib/frame
//@ use lib/surface

struct GlassLayer {
    passed: vec3f, // fraction of what lies behind that passes
    added: vec3f,  // light that is added
}

// A bit of a draw's flags.
const DRAW_GLASS = 32u;

// Words of the counts: nodes of this band, the number of the band from 1 on, most nodes of a band before, pixels with more layers
// than are sorted.
const GLASS_COUNTS = 8u;
const GLASS_COUNT_BAND = 1u;
const GLASS_COUNT_MOST = 2u;
const GLASS_COUNT_DEEP = 3u;
// Words of a node: depth key, triangle id, next node as in a head, and three of a layer. Nodes stand in blocks, in which the same word
// of all nodes is a row: neighbors that write at once write whole rows.
const GLASS_NODE = 6u;
const GLASS_BLOCK = 32u;
// Words from the first word of a node to its others.
const GLASS_NODE_ID = GLASS_BLOCK;
const GLASS_NODE_NEXT = 2u * GLASS_BLOCK;
const GLASS_NODE_LAYER = 3u * GLASS_BLOCK;

// Bands of pixels that are drawn one after another.
override GLASS_BANDS: u32 = 1u;

// Layers of a band from which on they are not counted, so that the count does not overflow.
const GLASS_MOST = 0x80000000u;

// Pixels of a band.
fn glass_band_length() -> u32 { return (frame.size.x * frame.size.y + GLASS_BANDS - 1u) / GLASS_BANDS; }

// Words behind the last pixel, where each begins; heads begin at 0. That of the opaque triangle holds its complemented id, 0 for none.
fn glass_counts() -> u32 { return glass_band_length(); }
fn glass_opaque(pixel: u32) -> u32 { return glass_counts() + GLASS_COUNTS + pixel; }
fn glass_nodes() -> u32 { return glass_opaque(frame.size.x * frame.size.y); }

fn glass_node(link: u32) -> u32 {
    let node = link - 1u;
    return glass_nodes() + node / GLASS_BLOCK * (GLASS_BLOCK * GLASS_NODE) + node % GLASS_BLOCK;
}

// Nodes that so many words behind the last pixel hold.
fn glass_room(words: u32) -> u32 { return (words - glass_nodes()) / (GLASS_BLOCK * GLASS_NODE) * GLASS_BLOCK; }

// The layer of a shaded surface whose material blends.
fn glass_blended(s: Surface) -> GlassLayer {
    let alpha = clamp(s.color.a, 0.0, 1.0);
    return GlassLayer(vec3f(1.0 - alpha), clamp(s.color.rgb, vec3f(0.0), vec3f(1.0)) * alpha);
}

// Two layers as one, `front` before `back`.
fn glass_merged(front: GlassLayer, back: GlassLayer) -> GlassLayer {
    return GlassLayer(front.passed * back.passed, front.passed * back.added + front.added);
}

// A layer as three words, each of its numbers in steps of 1/65535.
fn glass_packed(layer: GlassLayer) -> vec3u {
    return vec3u(
        pack2x16unorm(layer.passed.rg), pack2x16unorm(vec2f(layer.passed.b, layer.added.r)), pack2x16unorm(layer.added.gb));
}

fn glass_unpacked(words: vec3u) -> GlassLayer {
    let middle = unpack2x16unorm(words.y);
    return GlassLayer(vec3f(unpack2x16unorm(words.x), middle.x), vec3f(middle.y, unpack2x16unorm(words.z)));
}
