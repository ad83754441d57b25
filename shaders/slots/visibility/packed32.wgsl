// Visibility packed32: as much of the key as fits and the complemented id in one 32-bit maximum. Keys that are cut alike tie,
// and the smaller id wins, near or far.
//@ use common/packed

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

fn visibility_begin(id: u32) {}

fn visibility_write(pixel: u32, key: u32, id: u32) {
    atomicMax(&packed[pixel], packed_word(key, id));
}
