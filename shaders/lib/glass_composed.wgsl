// What the layers of glass of a pixel compose to: three words of a layer, which stand in the picture's buffer behind the list of tiles.
//@ use lib/frame
//@ use lib/glass
//@ use lib/picture

fn glass_composed_first(pixel: u32) -> u32 {
    let tiles = (frame.size + 7u) / 8u;
    return tile_list() + tiles.x * tiles.y + 3u * pixel;
}

fn glass_composed_store(pixel: u32, layer: GlassLayer) {
    let first = glass_composed_first(pixel);
    let words = glass_packed(layer);
    color[first] = words.x;
    color[first + 1u] = words.y;
    color[first + 2u] = words.z;
}

fn glass_composed_load(pixel: u32) -> GlassLayer {
    let first = glass_composed_first(pixel);
    return glass_unpacked(vec3u(color[first], color[first + 1u], color[first + 2u]));
}
