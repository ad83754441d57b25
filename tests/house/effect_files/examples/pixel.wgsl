//@ use lib/image
struct Ink { @range(0.0, 0.5, 0.1) @unit(m) helper: f32 }
fn helper(x: f32) -> f32 { return x * 0.5; }
fn turns(pixel: Pixel, p: Ink) -> Pixel {
    var q = pixel;
    let id = image_at(i32(q.x) + 1, i32(q.y)).x;
    if image_has(i32(q.x), -1) || id == IMAGE_NO_TRIANGLE { q.color = image_background(); }
    q.color += vec4f(image_previous(pixel)) / 255.0 * helper(p.helper);
    return q;
}
