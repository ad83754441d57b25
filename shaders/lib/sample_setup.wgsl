// Sample setups: the integers that sample tests need of a triangle. Every triangle and, behind them, every clipped triangle
// has SAMPLE_SETUPS records, which stand behind the snapped vertices.
//@ use lib/frame
//@ use variants/loads

override SAMPLE_SETUPS: u32 = 1u;

// Index in `vertices` of a setup.
fn sample_setup_index(entry: u32, index: u32) -> u32 {
    return frame.vertex_count + entry * SAMPLE_SETUPS + index;
}

fn sample_setup_load(entry: u32, index: u32) -> vec4u {
    return load_record(sample_setup_index(entry, index));
}
