// Dot lists: the dots that dots_draw draws.
// Chosen by the accuracy axis `dot_culling`: all for brute, listed for gpu and cpu. Default: listed.
//
//@ declare fn dot_list_count() -> u32
// Run and index of a dot.
//@ declare fn dot_list_at(id: u32) -> vec2u

//@ variant listed
// The dots that culling chose, in any order.

@group(0) @binding(24) var<storage, read> dot_list: array<vec2u>;
@group(0) @binding(25) var<storage, read> dot_count: u32;

fn dot_list_count() -> u32 { return dot_count; }

fn dot_list_at(id: u32) -> vec2u { return dot_list[id]; }

//@ variant all
// Every dot, by its number.
//@ use lib/dots

fn dot_list_count() -> u32 { return dot_frame.dots; }

fn dot_list_at(id: u32) -> vec2u { return dots_find(id); }
