// Framebuffer, boundary samples: one bit per pixel, for the samples of the boundary triangle alone, in which drawing stops. The two words
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
