// Framebuffer, packed32: the complemented id and as much of the key as fits, in one 32-bit maximum. Keys that are equal after
// the cut tie, and the smaller id wins, be it nearer or farther.
//@ use lib/packed32

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

// Load before the atomic: faster where many samples lose.
override EARLY_LOAD: bool = false;
// The maximum is kept by compare and exchange. Each buffer has the function of its own: WGSL passes no pointers into buffers.
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
