// Loads: the words that invocations gather, each at an index of its own: vertex records, and the bytes of the file.
// Chosen for the resolve on CPU adapters with 64-bit integers: wide; for scenes whose attributes are larger than a binding: split.
//
// The buffers, and their loads.
//@ declare var vertex_bytes
//@ declare var vertices
// A record of 16 bytes: a vertex, a sample setup or four ranks.
//@ declare fn load_record(index: u32) -> vec4u
// A word of the attributes.
//@ declare fn load_word(word: u32) -> u32
// Three words, one behind the other.
//@ declare fn load_words3(word: u32) -> vec3u

//@ variant default
// Word by word.
//@ binding @group(0) @binding(2) var<storage, read> vertex_bytes: array<u32>;
//@ binding @group(0) @binding(4) var<storage, read> vertices: array<vec4u>;

fn load_record(index: u32) -> vec4u {
    return vertices[index];
}

fn load_word(word: u32) -> u32 {
    return vertex_bytes[word];
}

fn load_words3(word: u32) -> vec3u {
    return vec3u(vertex_bytes[word], vertex_bytes[word + 1u], vertex_bytes[word + 2u]);
}

//@ variant wide
// Two words at a time. On lavapipe a gathered component of 64 bits costs about as much as one of 32 (docs/benchmarks.md).
// Buffers are multiples of 16 bytes long, so every word has its pair.
//@ binding @group(0) @binding(2) var<storage, read> vertex_bytes: array<u64>;
//@ binding @group(0) @binding(4) var<storage, read> vertices: array<vec2<u64>>;

fn load_record(index: u32) -> vec4u {
    let pairs = vertices[index];
    return vec4u(loads_low(pairs.x), loads_high(pairs.x), loads_low(pairs.y), loads_high(pairs.y));
}

fn load_word(word: u32) -> u32 {
    let pair = vertex_bytes[word / 2u];
    return select(loads_low(pair), loads_high(pair), (word & 1u) != 0u);
}

fn load_words3(word: u32) -> vec3u {
    let first = vertex_bytes[word / 2u];
    let second = vertex_bytes[word / 2u + 1u];
    let words = vec4u(loads_low(first), loads_high(first), loads_low(second), loads_high(second));
    return select(words.xyz, words.yzw, (word & 1u) != 0u);
}

fn loads_low(pair: u64) -> u32 {
    return u32(pair & 0xfffffffflu);
}

fn loads_high(pair: u64) -> u32 {
    return u32(pair >> 32u);
}

//@ variant split
// Word by word, from a second buffer behind the words that the first one holds.
//@ binding @group(0) @binding(2) var<storage, read> vertex_bytes: array<u32>;
//@ binding @group(0) @binding(39) var<storage, read> vertex_bytes_rest: array<u32>;
//@ binding @group(0) @binding(4) var<storage, read> vertices: array<vec4u>;

// Words in the first buffer.
override SPLIT_WORD: u32 = 0u;

fn load_record(index: u32) -> vec4u {
    return vertices[index];
}

fn load_word(word: u32) -> u32 {
    if word < SPLIT_WORD { return vertex_bytes[word]; }
    return vertex_bytes_rest[word - SPLIT_WORD];
}

fn load_words3(word: u32) -> vec3u {
    if word + 2u < SPLIT_WORD { return vec3u(vertex_bytes[word], vertex_bytes[word + 1u], vertex_bytes[word + 2u]); }
    return vec3u(load_word(word), load_word(word + 1u), load_word(word + 2u));
}
