// Sines and cosines. Those built into WGSL may err by 2^-11; these polynomials are accurate to f32 rounding.
// Mirrors `math::sin_turns` and `effects::hooks::tone`.

// Sine of an angle in turns, by a minimax polynomial: within `math::SINE_ERROR` of the sine of this very float, and exactly 0
// at whole and half turns.
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

// Cosine and sine of an angle in degrees, by Taylor's series on an eighth of a turn: within 2^-24.
fn direction_degrees(degrees: f32) -> vec2f {
    let quarters = round(degrees / 90.0);
    let x = (degrees - 90.0 * quarters) * 0.017453292519943295;
    let q = x * x;
    let sin = x * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0))));
    let cos = 1.0 - q / 2.0 * (1.0 - q / 12.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0))));
    let quadrant = i32(quarters) & 3;
    let along = select(vec2f(cos, sin), vec2f(-sin, cos), (quadrant & 1) != 0);
    return select(along, -along, quadrant >= 2);
}
