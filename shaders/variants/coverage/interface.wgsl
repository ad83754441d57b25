// Coverage: which candidate samples a small or medium triangle covers, and their depth keys.
// Chosen by the accuracy axis `coverage` and by effects that draw boxes. Default: fixed.
//
// `Coverage` has the members `row`, `step_x` and `step_y`: the edge functions at the current row's first sample, and their
// change per pixel to the right and down. Their type differs from variant to variant.
//@ declare struct Coverage
// Sets up at the sample of pixel `first`. Corners must be clockwise on screen; `area` is twice their area, above 0.
//@ declare fn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32, first: vec2i) -> Coverage
// The edge functions at an offset in pixels from the first: `coverage_at(coverage, offset)`.
//@ declare fn coverage_at
// Is a sample with these edge functions covered? `coverage_contains(coverage, edges)`.
//@ declare fn coverage_contains
// Depth key at a covered sample, at least 1: `coverage_key(coverage, edges)`.
//@ declare fn coverage_key
// May the block of 8x8 samples be touched, of whose first sample these are the edge functions? `coverage_touches(coverage, edges)`.
//@ declare fn coverage_touches
// Are all samples of that block certainly covered? `coverage_fills(coverage, edges)`.
//@ declare fn coverage_fills
// The farthest and the nearest depth key of any sample.
//@ declare fn coverage_range(coverage: Coverage) -> vec2u
