// Layers of glass: what one does to the linear color behind it, and where the layers of all pixels lie. They stand in words behind
// the pixels of the framebuffer, since portable adapters bind eight storage buffers to a pass, and raster_medium has no ninth:
// the head of every pixel's list, 0 or 1 + the number of its first node; counts (`gpu::records::GlassRecord`); what the layers
// of every pixel compose to; and the nodes.
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
// Words of what the layers of a pixel compose to: the complemented id of the opaque triangle behind them, 0 for none, and a layer.
const GLASS_COMPOSED = 4u;
// Words of a node: depth key, triangle id, next node as in a head, and a layer.
const GLASS_NODE = 6u;
const GLASS_NODE_ID = 1u;
const GLASS_NODE_NEXT = 2u;
const GLASS_NODE_LAYER = 3u;

// Layers of a band from which on they are not counted, so that the count does not overflow.
const GLASS_MOST = 0x80000000u;

// Words behind the last pixel, where each begins; heads begin at 0.
fn glass_counts() -> u32 { return frame.size.x * frame.size.y; }
fn glass_composed(pixel: u32) -> u32 { return glass_counts() + GLASS_COUNTS + GLASS_COMPOSED * pixel; }
fn glass_node(link: u32) -> u32 { return glass_composed(frame.size.x * frame.size.y) + GLASS_NODE * (link - 1u); }

// Nodes that so many words behind the last pixel hold.
fn glass_room(words: u32) -> u32 { return (words - glass_node(1u)) / GLASS_NODE; }

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
