// Tile mask: which tiles of 8x8 pixels a triangle's box touches, given its first and last pixel inside the picture.
// Chosen on CPU adapters, which execute both sides of every branch, so that an empty pixel costs them as much as a full one.
// Without it, the resolve pass visits every pixel.
//@ steps fn mark_tiles(pixels: vec4i)
