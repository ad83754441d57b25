// Setup steps: what sample_setup computes for a triangle, or a clipped triangle, besides the setups of sample effects. `at`:
// vertices of the triangle, or of the parent of a clipped triangle, within the draw.
// Chosen where a material has an alpha mask: alpha_mask.
//@ steps fn setup_step(t: Triangle, at: vec3u)
