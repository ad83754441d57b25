// Heat haze: hot air bends what lies behind it, more towards the ground.
//@ use lib/noise

struct HeatHaze {
    /// How far the picture is bent.
    @range(0.0, 24.0, 5.0) @unit(px) reach_px: f32,
    /// Size of a swirl.
    @range(4.0, 128.0, 14.0) @unit(px) size_px: f32,
    /// The moment.
    @range(0.0, 10.0, 1.5) time: f32,
}

fn heat_haze(at: ImageAt, p: HeatHaze) -> vec4f {
    let middle = image_middle(at);
    let place = vec3f(middle.x, middle.y * 0.5 + p.time * p.size_px, p.time) / p.size_px;
    let bent = vec2f(noise_layers(place, 3u, 1u), noise_layers(place, 3u, 2u));
    let amount = p.reach_px * middle.y / f32(at.size.y);
    let source = middle + amount * bent;
    return image_color_at(source.x, source.y);
}
