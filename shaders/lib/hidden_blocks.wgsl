// Hidden blocks: for every aligned block of 8x8 pixels, a depth key that no pixel of it stays behind. A triangle that covers a whole block
// raises it to the farthest key that it has there; a triangle that is farther everywhere in a block is hidden in it, before any sample is
// tested. A triangle that raises a block also draws all of it in the same dispatch, so the order in which others see that does
// not matter: what they leave out could not have won. Keys that are equal are drawn, since the smaller id wins then.
//@ use lib/frame

// Every covered sample is drawn, so that a triangle that covers a block hides what lies behind.
override HIDES_BLOCKS: bool = false;
// Of several passes over the same samples, the first raises blocks.
override RAISES_BLOCKS: bool = false;

// Side of a block, pixels.
const HIDDEN_BLOCK = 8;

fn hidden_block_of(pixel: vec2i) -> u32 {
    return u32(pixel.y / HIDDEN_BLOCK) * ((frame.size.x + 7u) / 8u) + u32(pixel.x / HIDDEN_BLOCK);
}

// Is a triangle hidden in the block of a pixel of the picture, given the farthest and the nearest key that it may have there? Unless it
// is, and if it covers the whole block, it hides others from now on.
fn hidden_block_test(pixel: vec2i, range: vec2u, is_whole: bool) -> bool {
    let block = hidden_block_of(pixel);
    let farthest = atomicLoad(&counters.farthest[block]);
    if RAISES_BLOCKS && is_whole && range.x > farthest { atomicMax(&counters.farthest[block], range.x); }
    return range.y < farthest;
}
