// Sample tests: is a covered sample drawn? All steps must pass, in this order: the sample effects, the shape of particle discs,
// the alpha mask of the material, and the draw order, which counts the samples that are left.
// Chosen by the stack and the scene; without any, every covered sample is drawn.
//@ steps fn sample_test(t: Triangle, at: vec2u, pixel: u32) -> bool
