// Tile mask: a word for every tile of 8x8 pixels. A tile whose word is 0 shows the background.

// A triangle's box touches the tile in this picture.
const TILE_DRAWN: u32 = 1u;
// One did in the picture before, and none does in this one.
const TILE_DRAWN_BEFORE: u32 = 2u;
