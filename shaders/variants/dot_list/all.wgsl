// Dot lists, all: every dot, by its number.
//@ use lib/dots

fn dot_list_count() -> u32 { return dot_frame.dots; }

fn dot_list_at(id: u32) -> vec2u { return dots_find(id); }
