// Clear steps: what a frame begins with is cleared by its first pass, beside the work of that pass: the counters, and the depths,
// triangle ids and sums of all pixels, and what a draw order counts. Each of `count` invocations clears a share.
// Chosen where that is faster than clearing whole buffers before the first pass; without it, those are cleared so.
//@ steps fn clear_step(index: u32, count: u32)
