// Dot list, every: all dots there are, by their numbers.

fn dot_list_count() -> u32 { return dot_frame.dots; }

// DotRun and place.
fn dot_list_at(id: u32) -> vec2u { return dots_find(id); }
