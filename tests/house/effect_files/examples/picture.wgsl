// Ink: a picture inside the text, and noise.
//@ use lib/noise
struct Ink {
    @color(1.0, 0.5, 0.25) tint: vec4f,
    @image("data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mOIAgAAXABbdTws1wAAAABJRU5ErkJggg==") helper: u32,
    @range(0.0, 1.0, 0.5) amount: f32,
}
fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    let found = noise_cellular(s.position, image_file_size(p.helper).x);
    let noise = noise_value(s.position, 1u) + noise_simplex(s.position, 2u) + noise_layers(s.position, 3u, 4u);
    s.color = p.tint * (image_file_at(p.helper, s.screen) + image_file_tiled(p.helper, found.xy) * noise * p.amount);
    return s;
}
