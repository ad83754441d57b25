// Framebuffer writes: what a raster pass does with every sample that is covered and passes the sample tests.
// Chosen by the raster phase. No default: every phase has a variant of its own.
//
// Once per triangle, before its samples:
//@ declare fn framebuffer_begin(id: u32)
// For a sample, with its pixel's index, its depth key and its triangle's id:
//@ declare fn framebuffer_write(pixel: u32, key: u32, id: u32)
