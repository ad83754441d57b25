// Dot lists: the dots that dots_draw draws.
// Chosen by the accuracy axis `dot_culling`: all for brute, listed for gpu and cpu. Default: listed.
//
//@ declare fn dot_list_count() -> u32
// Run and index of a dot.
//@ declare fn dot_list_at(id: u32) -> vec2u
