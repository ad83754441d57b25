// Dot lists, listed: the dots that culling chose, in any order.

@group(0) @binding(24) var<storage, read> dot_list: array<vec2u>;
@group(0) @binding(25) var<storage, read> dot_count: u32;

fn dot_list_count() -> u32 { return dot_count; }

fn dot_list_at(id: u32) -> vec2u { return dot_list[id]; }
