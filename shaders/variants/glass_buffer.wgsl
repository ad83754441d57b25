// Glass buffer: the buffer of the framebuffer whose words behind the last pixel hold the layers of glass (lib/glass), and its pixels.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`). Default: split32.
//
// A word behind the last pixel; the value before it was changed.
//@ declare fn glass_buffer_load(word: u32) -> u32
//@ declare fn glass_buffer_store(word: u32, value: u32)
//@ declare fn glass_buffer_add(word: u32, value: u32) -> u32
//@ declare fn glass_buffer_exchange(word: u32, value: u32) -> u32
// Number of these words.
//@ declare fn glass_buffer_words() -> u32
// Is a sample with this key farther than the nearest opaque one of its pixel?
//@ declare fn glass_buffer_hides(pixel: u32, key: u32) -> bool

//@ variant split32
// Behind the depth keys.
//@ use lib/frame
//@ binding @group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

fn glass_buffer_first() -> u32 { return frame.size.x * frame.size.y; }
fn glass_buffer_load(word: u32) -> u32 { return atomicLoad(&depth_keys[glass_buffer_first() + word]); }
fn glass_buffer_store(word: u32, value: u32) { atomicStore(&depth_keys[glass_buffer_first() + word], value); }
fn glass_buffer_add(word: u32, value: u32) -> u32 { return atomicAdd(&depth_keys[glass_buffer_first() + word], value); }
fn glass_buffer_exchange(word: u32, value: u32) -> u32 { return atomicExchange(&depth_keys[glass_buffer_first() + word], value); }
fn glass_buffer_words() -> u32 { return arrayLength(&depth_keys) - glass_buffer_first(); }

fn glass_buffer_hides(pixel: u32, key: u32) -> bool {
    return key < atomicLoad(&depth_keys[pixel]);
}

//@ variant packed32
// Behind the packed words, which keep only a part of a key.
//@ use lib/frame
//@ use lib/packed32
//@ binding @group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

fn glass_buffer_first() -> u32 { return frame.size.x * frame.size.y; }
fn glass_buffer_load(word: u32) -> u32 { return atomicLoad(&packed[glass_buffer_first() + word]); }
fn glass_buffer_store(word: u32, value: u32) { atomicStore(&packed[glass_buffer_first() + word], value); }
fn glass_buffer_add(word: u32, value: u32) -> u32 { return atomicAdd(&packed[glass_buffer_first() + word], value); }
fn glass_buffer_exchange(word: u32, value: u32) -> u32 { return atomicExchange(&packed[glass_buffer_first() + word], value); }
fn glass_buffer_words() -> u32 { return arrayLength(&packed) - glass_buffer_first(); }

fn glass_buffer_hides(pixel: u32, key: u32) -> bool {
    return packed32_word(key, 0u) < atomicLoad(&packed[pixel]);
}

//@ variant packed64
// Behind the 64-bit words, which are read as halves.
//@ use lib/frame
//@ binding @group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u32>>;

fn glass_buffer_first() -> u32 { return 2u * frame.size.x * frame.size.y; }
fn glass_buffer_load(word: u32) -> u32 { return atomicLoad(&depth_and_id[glass_buffer_first() + word]); }
fn glass_buffer_store(word: u32, value: u32) { atomicStore(&depth_and_id[glass_buffer_first() + word], value); }
fn glass_buffer_add(word: u32, value: u32) -> u32 { return atomicAdd(&depth_and_id[glass_buffer_first() + word], value); }
fn glass_buffer_exchange(word: u32, value: u32) -> u32 { return atomicExchange(&depth_and_id[glass_buffer_first() + word], value); }
fn glass_buffer_words() -> u32 { return arrayLength(&depth_and_id) - glass_buffer_first(); }

fn glass_buffer_hides(pixel: u32, key: u32) -> bool {
    return key < atomicLoad(&depth_and_id[2u * pixel + 1u]);
}
