// Sky: what surrounds the scene is seen where nothing is drawn.
//@ use lib/angle
//@ use lib/environment
//@ use lib/image
//@ use lib/image_pass
//@ use lib/image_direction
//@ use variants/surroundings

struct Sky {
    environment: u32,
    turn_deg: f32,
    strength: f32,
    blur: f32,
}

fn sky(at: ImageAt, p: Sky) -> vec4f {
    if image_at(at.x, at.y).x != IMAGE_NO_TRIANGLE { return image_color(at.x, at.y); }
    let middle = image_middle(at);
    let toward = environment_turned(image_direction(middle.x, middle.y), direction_degrees(p.turn_deg));
    let light = surroundings_radiance(p.environment, environment_of(p.environment), toward, p.blur * p.blur);
    return vec4f(light * p.strength, 1.0);
}
