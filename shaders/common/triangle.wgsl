// Triangles as the rasterizer meets them: three projected corners, by id or as a piece left over from clipping.
//@ use common/frame
//@ use common/draws
//@ use common/vertex
//@ use slot/fetch
//@ use slot/records

override ONLY_LISTS: bool = false;

const TOPOLOGY_STRIP = 1u;
const TOPOLOGY_FAN = 2u;

// Vertices within the draw of the corners of its triangle `t`, in glTF's order.
fn triangle_vertices(draw: u32, t: u32) -> vec3u {
    var places = vec3u(3u * t, 3u * t + 1u, 3u * t + 2u);
    if !ONLY_LISTS {
        let topology = draws[draw].topology;
        if topology == TOPOLOGY_STRIP { places = vec3u(t, t + 1u + (t & 1u), t + 2u - (t & 1u)); }
        if topology == TOPOLOGY_FAN { places = vec3u(t + 1u, t + 2u, 0u); }
    }
    return vec3u(fetch_vertex(draw, places.x), fetch_vertex(draw, places.y), fetch_vertex(draw, places.z));
}

struct Triangle {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    id: u32,
    draw: u32,
    entry: u32,    // its place among all triangles and, behind them, pieces
    outline: u32,  // bit k: the edge opposite corner k is no cut
}

fn triangle_load(id: u32) -> Triangle {
    let draw = draws_of_triangle(id);
    let first = draws[draw].first_vertex;
    let at = triangle_vertices(draw, id - draws[draw].first_triangle);
    return Triangle(vertices[first + at.x], vertices[first + at.y], vertices[first + at.z], id, draw, id, 7u);
}

// Is a triangle of this orientation drawn at all, by the flags of its draw? Clockwise on screen (area > 0) is the back of a glTF triangle.
fn triangle_is_shown(flags: u32, is_clockwise: bool) -> bool {
    let is_back = is_clockwise != ((flags & DRAW_MIRRORED) != 0u);
    return (flags & DRAW_DOUBLE_SIDED) != 0u || !is_back;
}

// First and last candidate pixel of a box in 16.8, clamped to the picture; empty where a last precedes a first.
fn triangle_pixels(low: vec2i, high: vec2i) -> vec4i {
    let first = max((low + 127) >> vec2u(8u), vec2i(0));
    let last = min((high - 129) >> vec2u(8u), vec2i(frame.size) - 1);
    return vec4i(first, last);
}
