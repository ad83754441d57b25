// X-ray buffer: sums of each pixel's layers, which stand behind the pixels of the framebuffer: portable adapters bind eight
// storage buffers to a pass, and raster_medium has no ninth.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`). Default: split32.
//
// Depth key of a pixel's front.
//@ declare fn xray_buffer_front(pixel: u32) -> u32
// Adds to a word of the sums and returns its value before.
//@ declare fn xray_buffer_add(word: u32, value: u32) -> u32
