// Framebuffer reads: triangle id and depth key of a pixel, once all raster passes have run.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`). Default: split32.
//
// x: complemented triangle id, 0 for an empty pixel. y: depth key, as far as it is kept.
//@ declare fn framebuffer_load(pixel: u32) -> vec2u
// A word behind the last pixel.
//@ declare fn framebuffer_load_behind(word: u32) -> u32
