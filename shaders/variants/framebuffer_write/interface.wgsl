// Framebuffer writes: what a raster pass does with every sample that is covered and passes the sample tests.
// Chosen by the raster phase. No default: every phase has a variant of its own.
//
// Before the samples of a triangle, in each invocation that draws some; false where none of them is written:
//@ declare fn framebuffer_begin(id: u32) -> bool
// For a sample, with its pixel's index, its depth key and its triangle's id:
//@ declare fn framebuffer_write(pixel: u32, key: u32, id: u32)
// Behind the last sample that the invocation draws of the triangle:
//@ declare fn framebuffer_end(id: u32)
