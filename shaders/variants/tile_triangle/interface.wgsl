// Tile triangles: what one pixel of a tile needs to know about a triangle of the tile's list.
// Chosen by the sizes of triangles and by effects that draw points. Default: all, triangles of every size.
//
// Triangles that are set up at a time, at most the invocations of a tile: `TILE_BATCH`.
//@ declare const TILE_BATCH
//@ declare struct TileTriangle
// First and last candidate pixel in the tile that begins at pixel `first`, packed by `tile_box`.
//@ declare fn tile_triangle_box(t: Triangle, first: vec2i) -> u32
//@ declare fn tile_triangle(t: Triangle, first: vec2i) -> TileTriangle
// Depth key at a pixel, `offset` from the tile's first; 0 where the triangle does not cover it.
//@ declare fn tile_triangle_key(triangle: TileTriangle, at: vec2i, offset: vec2i) -> u32
