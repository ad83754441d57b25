// Cells: what a pixel of a tile needs to know of a triangle on its list.
//@ use common/triangle

// Candidate pixels of a triangle in the tile that begins at pixel `first`: first and last, four bits each, right and down.
fn cells_box(pixels: vec4i, first: vec2i) -> u32 {
    let box = vec4u(clamp(pixels - first.xyxy, vec4i(0), vec4i(15)));
    return box.x | (box.y << 4u) | (box.z << 8u) | (box.w << 12u);
}
