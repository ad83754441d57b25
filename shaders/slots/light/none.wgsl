// Light, none: nobody asks how much of it arrives.
//@ use common/surface

fn light_filled(surface: Surface) -> Surface { return surface; }
