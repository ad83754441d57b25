// Framebuffer, packed32: the complemented id and as much of the key as fits, in one 32-bit maximum. Keys that are equal after
// the cut tie, and the smaller id wins, be it nearer or farther.
//@ use lib/packed32

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

fn framebuffer_begin(id: u32) -> bool { return true; }

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    atomicMax(&packed[pixel], packed32_word(key, id));
}
