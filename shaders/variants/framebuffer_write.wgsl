// Framebuffer writes: what a raster pass does with every sample that is covered and passes the sample tests.
// Chosen by the raster phase. No default: every phase has a variant of its own.
//
// Before the samples of a triangle, in each invocation that draws some; false where none of them is written:
//@ declare fn framebuffer_begin(id: u32) -> bool
// For a sample, with its pixel's index, its depth key and its triangle's id:
//@ declare fn framebuffer_write(pixel: u32, key: u32, id: u32)
// Behind the last sample that the invocation draws of the triangle:
//@ declare fn framebuffer_end(id: u32)
//
// EARLY_LOAD: load before the atomic, which is faster where many samples lose. EXCHANGES_MAXIMUM: the maximum is kept by compare and exchange;
// each buffer has the function of its own, because WGSL passes no pointers into buffers.

//@ variant depth
// The nearest depth key of every pixel. Portable: 32-bit atomics only.

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

override EARLY_LOAD: bool = false;
override EXCHANGES_MAXIMUM: bool = false;

fn framebuffer_begin(id: u32) -> bool { return true; }
fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    if EXCHANGES_MAXIMUM {
        exchange_maximum(pixel, key);
    } else {
        let is_behind = EARLY_LOAD && atomicLoad(&depth_keys[pixel]) >= key;
        if !is_behind { atomicMax(&depth_keys[pixel], key); }
    }
}

fn exchange_maximum(pixel: u32, word: u32) {
    var there = atomicLoad(&depth_keys[pixel]);
    while there < word {
        let exchange = atomicCompareExchangeWeak(&depth_keys[pixel], there, word);
        if exchange.exchanged { return; }
        there = exchange.old_value;
    }
}

//@ variant triangle_id
// Of the triangles that reach a pixel's nearest key, the smallest id wins.

@group(0) @binding(5) var<storage, read> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> triangle_ids: array<atomic<u32>>;

override EXCHANGES_MAXIMUM: bool = false;

fn framebuffer_begin(id: u32) -> bool { return true; }
fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    if depth_keys[pixel] != key { return; }
    if EXCHANGES_MAXIMUM { exchange_maximum(pixel, ~id); } else { atomicMax(&triangle_ids[pixel], ~id); }
}

fn exchange_maximum(pixel: u32, word: u32) {
    var there = atomicLoad(&triangle_ids[pixel]);
    while there < word {
        let exchange = atomicCompareExchangeWeak(&triangle_ids[pixel], there, word);
        if exchange.exchanged { return; }
        there = exchange.old_value;
    }
}

//@ variant packed32
// The complemented id and as much of the key as fits, in one 32-bit maximum. Keys that are equal after
// the cut tie, and the smaller id wins, be it nearer or farther.
//@ use lib/packed32

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

override EARLY_LOAD: bool = false;
override EXCHANGES_MAXIMUM: bool = false;

fn framebuffer_begin(id: u32) -> bool { return true; }
fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let word = packed32_word(key, id);
    if EXCHANGES_MAXIMUM {
        exchange_maximum(pixel, word);
    } else {
        let is_behind = EARLY_LOAD && atomicLoad(&packed[pixel]) >= word;
        if !is_behind { atomicMax(&packed[pixel], word); }
    }
}

fn exchange_maximum(pixel: u32, word: u32) {
    var there = atomicLoad(&packed[pixel]);
    while there < word {
        let exchange = atomicCompareExchangeWeak(&packed[pixel], there, word);
        if exchange.exchanged { return; }
        there = exchange.old_value;
    }
}

//@ variant packed64
// Key and complemented id in one 64-bit maximum; the nearest wins, then the smallest id.

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u64>>;

override EARLY_LOAD: bool = false;

fn framebuffer_begin(id: u32) -> bool { return true; }
fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let word = (u64(key) << 32u) | u64(~id);
    let is_behind = EARLY_LOAD && atomicLoad(&depth_and_id[pixel]) >= word;
    if !is_behind { atomicMax(&depth_and_id[pixel], word); }
}

//@ variant layers
// Layers per pixel before any depth test, for the heat map and for the proof that every sample is drawn
// exactly once.

@group(0) @binding(15) var<storage, read_write> layers: array<atomic<u32>>;

fn framebuffer_begin(id: u32) -> bool { return true; }
fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    atomicAdd(&layers[pixel], 1u);
}

//@ variant xray
// Every layer adds its weighted color, in linear light and as integers, and its weight. Sums commute, so
// the order of layers does not matter. Pixels whose sums may have overflowed are counted.
//@ use lib/frame
//@ use lib/geometry
//@ use lib/shade
//@ use lib/xray_sums
//@ use effects/xray
//@ use glue/effects
//@ use glue/surface
//@ use variants/xray_buffer

// All layers count, so none waits until the nearest is known: the same pass finds it.
override FINDS_NEAREST: bool = false;

fn framebuffer_begin(id: u32) -> bool {
    shade_begin(id);
    return true;
}

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    if FINDS_NEAREST {
        xray_buffer_nearest(pixel, key, id);
    } else if key < xray_threshold(xray_buffer_front(pixel), IS_PERSPECTIVE, effects.xray) {
        return;
    }
    let surface = glue_surface(shade_surface(vec2u(pixel % frame.size.x, pixel / frame.size.x)), shaded.draw);
    let weight = xray_weight(surface, effects.xray);
    let layer = xray_sums_layer(clamp(surface.color.rgb, vec3f(0.0), vec3f(1.0)), weight);
    let before = xray_buffer_add(pixel, layer);
    if xray_sums_overflow(before, weight) { atomicAdd(&counters.full_pixels, 1u); }
}

//@ variant glass
// Every layer of glass that may lie before the nearest opaque triangle is shaded and joins the list of its pixel. Lists are sorted
// later (stages/shade/glass_compose), so the order in which layers join does not matter. Of many bands of pixels one is drawn.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/shade
//@ use lib/glass
//@ use lib/glass_band
//@ use glue/surface
//@ use glue/glass
//@ use variants/glass_buffer

var<private> first_of_band: u32;

fn framebuffer_begin(id: u32) -> bool {
    shade_begin(id);
    first_of_band = glass_band_first();
    return (draws[shaded.draw].flags & DRAW_GLASS) != 0u;
}

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    if !glass_band_has(first_of_band, pixel) || glass_buffer_hides(pixel, key) { return; }
    let link = glass_buffer_add(glass_counts(), 1u) + 1u;
    // The count keeps the true demand: what does not fit is drawn again with more room.
    if link > glass_room(glass_buffer_words()) {
        if link > GLASS_MOST { glass_buffer_add(glass_counts(), 0xffffffffu); }
        return;
    }
    let surface = glue_surface(shade_surface(vec2u(pixel % frame.size.x, pixel / frame.size.x)), shaded.draw);
    let layer = glass_packed(glue_glass(surface, shaded.draw));
    let node = glass_node(link);
    glass_buffer_store(node, key);
    glass_buffer_store(node + GLASS_NODE_ID, id);
    glass_buffer_store(node + GLASS_NODE_LAYER, layer.x);
    glass_buffer_store(node + GLASS_NODE_LAYER + GLASS_BLOCK, layer.y);
    glass_buffer_store(node + GLASS_NODE_LAYER + 2u * GLASS_BLOCK, layer.z);
    glass_buffer_store(node + GLASS_NODE_NEXT, glass_buffer_exchange(pixel - first_of_band, link));
}

//@ variant sample_counts
// Samples per triangle, exactly, before any depth test. Each invocation counts for itself and adds once.

@group(0) @binding(5) var<storage, read_write> sample_counts: array<atomic<u32>>;

var<private> found_samples: u32;

fn framebuffer_begin(id: u32) -> bool {
    found_samples = 0u;
    return true;
}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    found_samples += 1u;
}

fn framebuffer_end(id: u32) {
    if found_samples > 0u { atomicAdd(&sample_counts[id], found_samples); }
}

//@ variant boundary_samples
// One bit per pixel, for the samples of the boundary triangle alone, in which drawing stops. The two words
// behind the bits bound the words that have any, so that few are searched: the complement of the first, and one more than the last.
//@ use lib/frame
//@ use lib/order

@group(0) @binding(5) var<storage, read_write> boundary_samples: array<atomic<u32>>;
@group(0) @binding(14) var<uniform> order: Order;

var<private> first_word: u32;
var<private> end_word: u32;

fn framebuffer_begin(id: u32) -> bool {
    first_word = 0xffffffffu;
    end_word = 0u;
    return id == order.boundary_triangle;
}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let word = pixel / 32u;
    atomicOr(&boundary_samples[word], 1u << (pixel % 32u));
    first_word = min(first_word, word);
    end_word = max(end_word, word + 1u);
}

fn framebuffer_end(id: u32) {
    let words = order_bit_words();
    // Most invocations of a large triangle find bounds that hold already.
    if end_word > atomicLoad(&boundary_samples[words + 1u]) { atomicMax(&boundary_samples[words + 1u], end_word); }
    if ~first_word > atomicLoad(&boundary_samples[words]) { atomicMax(&boundary_samples[words], ~first_word); }
}

//@ variant race
// Load, compare, store, without atomics. The last store wins, not the nearest sample.
//@ use steps/store_step

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<u32>;

fn framebuffer_begin(id: u32) -> bool { return true; }
fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let is_nearer = depth_and_id[2u * pixel + 1u] < key;
    if is_nearer && store_step(key) {
        depth_and_id[2u * pixel + 1u] = key;
        depth_and_id[2u * pixel] = ~id;
    }
}
