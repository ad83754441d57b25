// X-ray buffer: sums of each pixel's layers, which stand behind the pixels of the framebuffer: portable adapters bind eight
// storage buffers to a pass, and raster_medium has no ninth.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`); packed64_pairs where words come in pairs and the adapter adds
// 64 bits at once. Default: split32.
//
// Takes a sample for the nearest of its pixel if it is; without packed64_pairs other passes find the nearest.
//@ declare fn xray_buffer_nearest(pixel: u32, key: u32, id: u32)
// Depth key of a pixel's front.
//@ declare fn xray_buffer_front(pixel: u32) -> u32
// Adds a layer's words to the sums of a pixel and returns their values before.
//@ declare fn xray_buffer_add(pixel: u32, layer: vec4u) -> vec4u
