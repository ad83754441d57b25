// Finish steps: what the resolve pass does to a pixel's gamma-encoded color before it is stored: first the dots, then the
// image effects of the stack.
//@ steps fn finish_step(encoded: vec4f, pixel: vec2u) -> vec4f
