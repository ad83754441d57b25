// Framebuffer, split32, second pass: of the triangles that reach a pixel's nearest key, the smallest id wins.

@group(0) @binding(5) var<storage, read> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> triangle_ids: array<atomic<u32>>;

// The maximum is kept by compare and exchange. Each buffer has the function of its own: WGSL passes no pointers into buffers.
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
