// Storing sample setups: for the pass sample_setup, which declares `vertices` as writable, and the glue that it calls.
//@ use variants/loads
//@ use lib/sample_setup

// The setups of clipped triangles are computed, instead of those of the scene's triangles.
override IS_CLIPPED_TRIANGLES: bool = false;

fn sample_setup_store(entry: u32, index: u32, words: vec4u) {
    vertices[sample_setup_index(entry, index)] = words;
}
