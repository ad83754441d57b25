// Blur: out of focus, everywhere or away from a sharp band or disc.
//@ use lib/image
//@ use lib/image_pass

struct Blur {
    /// Where the picture is blurred.
    @choice(everywhere, band, disc) @default(band) area: u32,
    /// How far light spreads.
    @range(0, 32, 7) @hard(0, 96) @unit(px) radius_px: f32,
    /// Middle of what stays sharp, from the left edge at 0 to the right one at 1.
    @range(0, 1, 0.5) @when(area, disc) center_x: f32,
    /// The same from the top to the bottom.
    @range(0, 1, 0.55) @when(area, band, disc) center_y: f32,
    /// Half of the width of what stays sharp, in heights of the picture.
    @range(0, 1, 0.08) @hard(0, 2) @when(area, band, disc) sharp: f32,
    /// Over which distance the blur grows, in heights of the picture.
    @range(0.01, 1, 0.35) @hard(0.001, 2) @when(area, band, disc) soft: f32,
}

fn blur_across(at: ImageAt, p: Blur) -> vec4f {
    return blur_along(at, vec2i(1, 0), p);
}

fn blur_down(at: ImageAt, p: Blur) -> vec4f {
    return blur_along(at, vec2i(0, 1), p);
}

// Weighted mean of the pixels along a direction, as far as the radius here.
fn blur_along(at: ImageAt, along: vec2i, p: Blur) -> vec4f {
    let radius = p.radius_px * blur_strength(image_middle(at), p);
    let reach = i32(ceil(radius));
    let step = 1.0 / (radius + 1.0);
    var sum = image_last(at.x, at.y);
    var weights = 1.0;
    for (var i = 1; i <= reach; i += 1) {
        let t = f32(i) * step;
        let near = max(1.0 - t * t, 0.0);
        let weight = near * near * near;
        let to = i * along;
        sum += weight * (image_last(at.x + to.x, at.y + to.y) + image_last(at.x - to.x, at.y - to.y));
        weights += 2.0 * weight;
    }
    return sum / weights;
}

// Fraction of the radius at a place.
fn blur_strength(place: vec2f, p: Blur) -> f32 {
    if p.area == BLUR_AREA_EVERYWHERE { return 1.0; }
    let size = vec2f(image_size());
    let away = (place - vec2f(p.center_x, p.center_y) * size) / size.y;
    var distance = abs(away.y);
    if p.area == BLUR_AREA_DISC { distance = length(away); }
    let past = clamp((distance - p.sharp) / p.soft, 0.0, 1.0);
    return past * past * (3.0 - 2.0 * past);
}
