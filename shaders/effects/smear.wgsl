// Smear: where nothing is drawn the picture before stays, and fades.
//@ use lib/image

struct Smear {
    /// Fraction of the difference to the background that a trail loses from one picture to the next: 1 leaves no trail, 0 never fades.
    @range(0, 0.5, 0.12) @hard(0, 1) fade: f32,
    /// Earlier pictures that are drawn before a single one.
    @range(0, 32, 12) frames: u32,
    /// Time from one of them to the next.
    @range(0.01, 0.5, 0.04) @hard(0, 60) @unit(s) step_s: f32,
}

@smooth
fn smear(pixel: Pixel, p: Smear) -> Pixel {
    var q = pixel;
    if image_at(i32(q.x), i32(q.y)).x != IMAGE_NO_TRIANGLE { return q; }
    let background = vec4i(clamp(image_background(), vec4f(0.0), vec4f(1.0)) * 255.0 + 0.5);
    let previous = vec4i(image_previous(q));
    // In units of 2^-16. A trail that fades changes by at least one step per frame, so it ends.
    let fraction = i32(p.fade * 65536.0);
    let gap = background - previous;
    let faded = previous + sign(gap) * ((abs(gap) * fraction + 65535) >> vec4u(16u));
    q.color = vec4f(faded) / 255.0;
    return q;
}
