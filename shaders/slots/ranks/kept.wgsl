// Ranks, kept: the share of all samples that come before a triangle, four to a record behind vertices and decisions.
//@ use common/frame
//@ use slot/records

fn ranks_of(id: u32) -> f32 {
    return bitcast<f32>(vertices[frame.first_rank + id / 4u][id % 4u]);
}
