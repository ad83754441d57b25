// Sine of an angle in turns, by a minimax polynomial: drivers may err by 2^-11 in their own. Mirror of `math::sin_turns`.

// Within `math::SINE_ERROR` of the sine of this very float, 0 exactly at whole and half turns.
fn sine_turns(turns: f32) -> f32 {
    let rest = turns - round(turns);
    // Folded to a quarter turn either way.
    let x = sign(rest) * (0.25 - abs(abs(rest) - 0.25));
    let y = x * x;
    return x * (6.28318516 + y * (-41.341655 + y * (81.601004 + y * (-76.5497823 + y * 39.5367061))));
}

fn cosine_turns(turns: f32) -> f32 {
    let rest = turns - round(turns);
    return sine_turns(0.25 - abs(rest));
}
