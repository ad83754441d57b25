// Decisions: what was settled about triangles and pieces, so many records each, behind the projected vertices.
//@ use common/frame
//@ use slot/records

override SAMPLE_SETUPS: u32 = 0u;

fn decisions_load(entry: u32, place: u32) -> vec4u {
    return vertices[frame.vertex_count + entry * SAMPLE_SETUPS + place];
}
