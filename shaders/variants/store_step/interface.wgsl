// Store steps: idle work between the load of a depth and its store, in the race framebuffer. The sample is stored where every
// step returns true. Chosen by the effect race; without it there is no such step.
//@ steps fn store_step(key: u32) -> bool
