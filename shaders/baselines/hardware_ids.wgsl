// Hardware triangle ids: which triangle the adapter's own rasterizer gives each pixel, from positions that are snapped already.
// Corners come in normalized device coordinates, three to a triangle.

struct Corner {
    @builtin(position) at: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn ids_vertex(@location(0) position: vec3f, @builtin(vertex_index) corner: u32) -> Corner {
    return Corner(vec4f(position, 1.0), corner / 3u);
}

@fragment
fn ids_fragment(corner: Corner) -> @location(0) u32 {
    return corner.triangle;
}
