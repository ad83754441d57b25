// Corner records: where the snapped vertices of a triangle come from.
// Chosen by the scene: projected where no pass writes the records of points.
//
//@ declare fn corner_records(draw: u32, id: u32) -> CornerRecords
// The one of a point, where no pass writes it.
//@ may declare fn point_record(draw: u32, id: u32) -> vec4u

//@ variant default
// The pass that projects has written them.
//@ use lib/triangle
//@ use variants/loads

// Vertex effects move corners triangle by triangle, so every triangle has three snapped vertices that it shares with no other.
override UNSHARES_VERTICES: bool = false;

fn corner_records(draw: u32, id: u32) -> CornerRecords {
    var at = 3u * id + vec3u(0u, 1u, 2u);
    if !UNSHARES_VERTICES { at = draws[draw].first_vertex + triangle_vertices(draw, id - draws[draw].first_triangle); }
    return CornerRecords(load_record(at.x), load_record(at.y), load_record(at.z));
}

//@ variant projected
// A point is projected wherever it is asked for: that reads 12 bytes, and a record that is stored is written and read, 16 each time.
//@ use lib/triangle
//@ use variants/loads
//@ use variants/projection
//@ use variants/draw_records

// All primitives are points.
override ONLY_POINTS: bool = false;

fn corner_records(draw: u32, id: u32) -> CornerRecords {
    if !ONLY_POINTS && draw_topology(draw) != TOPOLOGY_POINTS {
        let at = draws[draw].first_vertex + triangle_vertices(draw, id - draws[draw].first_triangle);
        return CornerRecords(load_record(at.x), load_record(at.y), load_record(at.z));
    }
    let record = point_record(draw, id);
    return CornerRecords(record, record, record);
}

fn point_record(draw: u32, id: u32) -> vec4u {
    return projection_record(draw, index_at(draw, id - draws[draw].first_triangle), id);
}
