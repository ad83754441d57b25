// Samples, all: every covered sample is drawn.

fn samples_is_drawn(t: Triangle, at: vec2u) -> bool {
    return true;
}
