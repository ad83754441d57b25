// Shape, still: normals and centres are those of the file.

fn shape_of(surface: Surface, draw: u32, at: vec3u, weights: vec3f) -> Surface {
    return surface;
}
