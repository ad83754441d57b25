// Ink: a pass that is kept.
struct Ink { @range(0.0, 1.0, 0.5) helper: f32 }
@kept(3, 0.5) @pass(quarter)
fn kept(at: ImageAt, p: Ink) -> vec4f { return p.helper * image_kept(at.x - 1, at.y) + image_color(4 * at.x, 4 * at.y); }
fn ink(at: ImageAt, p: Ink) -> vec4f { return image_last(at.x / 4, at.y / 4) + image_kept_at(0.5, f32(at.size.y)); }
