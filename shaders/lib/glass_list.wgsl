// Lists of layers of glass: the nodes of a pixel, each found by its link (lib/glass).
//@ use lib/glass
//@ use variants/glass_buffer

// What is seen of a list: the nearest layer, 0 for none, and all layers as one.
struct GlassSeen {
    first: u32,
    layer: GlassLayer,
}

fn glass_key(link: u32) -> u32 { return glass_buffer_load(glass_node(link)); }
fn glass_id(link: u32) -> u32 { return glass_buffer_load(glass_node(link) + GLASS_NODE_ID); }
fn glass_next(link: u32) -> u32 { return glass_buffer_load(glass_node(link) + GLASS_NODE_NEXT); }
fn glass_set_next(link: u32, next: u32) { glass_buffer_store(glass_node(link) + GLASS_NODE_NEXT, next); }

// The three words of a layer.
fn glass_words(link: u32) -> vec3u {
    let word = glass_node(link) + GLASS_NODE_LAYER;
    return vec3u(glass_buffer_load(word), glass_buffer_load(word + 1u), glass_buffer_load(word + 2u));
}

fn glass_layer(link: u32) -> GlassLayer { return glass_unpacked(glass_words(link)); }

// Is a layer nearer than another? The larger key is, and of equal keys the smaller id.
fn glass_is_before(a: u32, b: u32) -> bool {
    let key_a = glass_key(a);
    let key_b = glass_key(b);
    return key_a > key_b || (key_a == key_b && glass_id(a) < glass_id(b));
}
