// Framebuffer, split32, first pass: the nearest depth key of every pixel. Portable: 32-bit atomics only.

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

// Load before the atomic: faster where many samples lose.
override EARLY_LOAD: bool = false;
// The maximum is kept by compare and exchange. Each buffer has the function of its own: WGSL passes no pointers into buffers.
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
