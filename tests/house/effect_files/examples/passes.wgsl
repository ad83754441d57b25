// Ink: passes of several sizes, with a helper and a loop.
struct Ink { @range(1, 8, 3) radius: i32 }
fn helper(at: ImageAt, p: Ink, step: i32) -> vec4f { return image_last(at.x + step * p.radius, at.y); }
@pass(quarter) fn small(at: ImageAt, p: Ink) -> vec4f { return image_color_at(image_middle(at).x, image_middle(at).y); }
@pass(full)
fn ink(at: ImageAt, p: Ink) -> vec4f {
    var sum = vec4f(0.0);
    for (var i = -2; i <= 2; i++) { sum += helper(at, p, i); }
    if image_at(at.x, at.y).x == IMAGE_NO_TRIANGLE { sum.r += image_depth_m(at.x, at.y) * image_pixel_size_m(1.0); }
    return sum;
}
