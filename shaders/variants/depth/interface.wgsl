// Depth: keys of reversed depths, which are 1 at the near plane and 0 far away, and their interpolation over a triangle. A
// larger key is nearer; every key is at least 1.
// Chosen by the accuracy axis `depth`. Default: float.
//
// Key of a reversed depth from 0 to 1.
//@ declare fn depth_key(z: f32) -> u32
// Bits of the reversed depth that a key stands for.
//@ declare fn depth_bits(key: u32) -> u32
// The depths of a triangle, for interpolation.
//@ declare struct DepthPlane
// From the bits of the corner depths, and twice the area of the triangle.
//@ declare fn depth_plane(depths: vec3u, area: i32) -> DepthPlane
//@ declare fn depth_plane_wide(depths: vec3u, area: Wide) -> DepthPlane
// Key at a covered sample, from unbiased edge functions.
//@ declare fn depth_at(plane: DepthPlane, edges: vec3i) -> u32
// The farthest and the nearest key of any sample: those of corners.
//@ declare fn depth_range(plane: DepthPlane) -> vec2u
//
// variants/large_depth is chosen along with this, and uses more of each: `depth_weighted(plane, weights: vec3f)` of float,
// `depth_quotient` and `depth_packed` of integer.
//@ may declare fn depth_weighted
//@ may declare fn depth_quotient
//@ may declare fn depth_packed
