// Lists of layers of glass: the nodes of a pixel, each found by its link (lib/glass).
//@ use lib/glass
//@ use variants/glass_buffer

// Most layers of a pixel that are composed, a multiple of 8: a CPU adapter ends all loops of an invocation after 65,535 iterations, and
// the driver of a card a kernel that works too long.
override GLASS_DEEPEST: u32 = 0xfffffff8u;

// What is seen of a list: the nearest layer, 0 for none, and all layers as one. Nothing is seen of a list of more than are composed.
struct GlassSeen {
    first: u32,
    layer: GlassLayer,
    is_deep: bool,
}

fn glass_key(link: u32) -> u32 { return glass_buffer_load(glass_node(link)); }
fn glass_id(link: u32) -> u32 { return glass_buffer_load(glass_node(link) + GLASS_NODE_ID); }
fn glass_next(link: u32) -> u32 { return glass_buffer_load(glass_node(link) + GLASS_NODE_NEXT); }
fn glass_set_next(link: u32, next: u32) { glass_buffer_store(glass_node(link) + GLASS_NODE_NEXT, next); }

// The three words of a layer.
fn glass_words(link: u32) -> vec3u {
    let word = glass_node(link) + GLASS_NODE_LAYER;
    return vec3u(glass_buffer_load(word), glass_buffer_load(word + GLASS_BLOCK), glass_buffer_load(word + 2u * GLASS_BLOCK));
}

fn glass_layer(link: u32) -> GlassLayer { return glass_unpacked(glass_words(link)); }

// Which of four layers are nearer than another? The larger key is, and of equal keys the smaller id.
fn glass_are_before(keys: vec4u, ids: vec4u, key: u32, id: u32) -> vec4<bool> {
    return (keys > vec4u(key)) | ((keys == vec4u(key)) & (ids < vec4u(id)));
}

fn glass_is_before(a: u32, b: u32) -> bool {
    return glass_are_before(vec4u(glass_key(a)), vec4u(glass_id(a)), glass_key(b), glass_id(b)).x;
}
