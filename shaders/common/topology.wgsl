// Topology: which vertices of its draw a triangle joins.
//@ use common/draws
//@ use slot/fetch

override ONLY_TRIANGLE_LISTS: bool = false;

const TOPOLOGY_STRIP = 1u;
const TOPOLOGY_FAN = 2u;

// Vertices within the draw of the corners of its triangle `t`, in glTF's order.
fn triangle_vertices(draw: u32, t: u32) -> vec3u {
    var places = vec3u(3u * t, 3u * t + 1u, 3u * t + 2u);
    if !ONLY_TRIANGLE_LISTS {
        let topology = draws[draw].topology;
        if topology == TOPOLOGY_STRIP { places = vec3u(t, t + 1u + (t & 1u), t + 2u - (t & 1u)); }
        if topology == TOPOLOGY_FAN { places = vec3u(t + 1u, t + 2u, 0u); }
    }
    return vec3u(fetch_vertex(draw, places.x), fetch_vertex(draw, places.y), fetch_vertex(draw, places.z));
}
