// Echo: a kept pass of half the size that moves and fades, read by its pixels and between them.
//@ use lib/image

struct Echo {
    /// Fraction that is left a frame later.
    @range(0.0, 0.95, 0.7) lasting: f32,
}

@kept(4, 0.04)
@pass(half)
fn keep(at: ImageAt, p: Echo) -> vec4f {
    let middle = image_middle(at);
    let now = image_color_at(middle.x, middle.y);
    let left = 0.6 * image_kept_at(0.5 * middle.x + 1.3, 0.5 * middle.y - 0.7) + 0.4 * image_kept(at.x - 2, at.y + 1);
    return mix(now, left, p.lasting);
}

@pass(quarter)
fn shrink(at: ImageAt, p: Echo) -> vec4f {
    let middle = image_middle(at);
    return image_last_at(0.5 * middle.x, 0.5 * middle.y);
}

fn lay_over(at: ImageAt, p: Echo) -> vec4f {
    let color = image_color(at.x, at.y);
    let middle = 0.25 * image_middle(at);
    return vec4f(0.5 * color.rgb + 0.5 * image_last_at(middle.x, middle.y).rgb, color.a);
}
