// Smear: where nothing is drawn, the previous picture remains and fades towards the background.
//@ use lib/image

struct Smear {
    fade: f32,
    frames: u32,
    step_s: f32,
}

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
