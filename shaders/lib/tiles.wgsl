// Tiles of 16x16 pixels, one per workgroup, and the lists of the triangles that may touch each tile, in `bins`. One word per
// tile holds the length of its list, then where the list begins, finally where it ends; a second word per tile tells how much
// of the list has been drawn. The lists follow.
//@ use lib/frame

fn tiles_width() -> u32 {
    return (frame.size.x + 15u) / 16u;
}

fn tiles_count() -> u32 {
    return tiles_width() * ((frame.size.y + 15u) / 16u);
}

// Word at which the lists begin.
fn tiles_lists() -> u32 {
    return 2u * tiles_count();
}
