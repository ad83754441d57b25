// Tiles: the 16x16 pixels of the picture that one workgroup owns, and the lists of the triangles that may touch them. One
// word per tile says how long its list is, then where it begins, at last where it ends; another how much of it is drawn.
// Behind those words stand the lists.
//@ use common/frame

fn tiles_width() -> u32 {
    return (frame.size.x + 15u) / 16u;
}

// Tiles of the picture.
fn tiles_count() -> u32 {
    return tiles_width() * ((frame.size.y + 15u) / 16u);
}

// Where the lists begin.
fn tiles_lists() -> u32 {
    return 2u * tiles_count();
}
