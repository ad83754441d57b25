// Loads: the words that invocations gather, each at an index of its own: vertex records, and the bytes of the file.
// Chosen for the resolve on CPU adapters with 64-bit integers: wide. Default: the functions below, word by word.
//@ binding @group(0) @binding(2) var<storage, read> vertex_bytes: array<u32>;
//@ binding @group(0) @binding(4) var<storage, read> vertices: array<vec4u>;

// A record of 16 bytes: a vertex, a sample setup or four ranks.
//@ declare fn load_record(index: u32) -> vec4u
fn load_record(index: u32) -> vec4u {
    return vertices[index];
}

// A word of the attributes.
//@ declare fn load_word(word: u32) -> u32
fn load_word(word: u32) -> u32 {
    return vertex_bytes[word];
}

// Three words, one behind the other.
//@ declare fn load_words3(word: u32) -> vec3u
fn load_words3(word: u32) -> vec3u {
    return vec3u(vertex_bytes[word], vertex_bytes[word + 1u], vertex_bytes[word + 2u]);
}
