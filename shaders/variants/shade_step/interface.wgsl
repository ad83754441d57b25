// Shade steps: what is added to the surface at a sample before surface effects. `at`: vertices of the triangle within its draw.
// Chosen by the scene and the stack: textures where materials are more than a base color, shadow_map where an effect reads
// how much light arrives.
//@ steps fn shade_step(surface: Surface, t: Triangle, at: vec3u, position: SamplePosition) -> Surface
