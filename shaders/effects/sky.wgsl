// Sky: what surrounds the scene is seen where nothing is drawn.
//@ use lib/angle
//@ use lib/environment
//@ use lib/image
//@ use lib/image_pass
//@ use lib/image_direction
//@ use variants/surroundings

struct Sky {
    /// What surrounds the scene.
    @choice(studio, overcast, low_sun, night, picture) environment: u32,
    /// Turns it about the vertical axis.
    @range(-180, 180, 0) @hard(-36000, 36000) @unit(°) turn_deg: f32,
    /// Strength of its light.
    @range(0, 4, 1) @hard(0, 1000) strength: f32,
    /// How blurred it is: 0 not at all, 1 as a matt mirror shows it.
    @range(0, 1, 0.3) blur: f32,
}

fn sky(at: ImageAt, p: Sky) -> vec4f {
    if image_at(at.x, at.y).x != IMAGE_NO_TRIANGLE { return image_color(at.x, at.y); }
    let middle = image_middle(at);
    let toward = environment_turned(image_direction(middle.x, middle.y), direction_degrees(p.turn_deg));
    let light = surroundings_radiance(p.environment, environment_of(p.environment), toward, p.blur * p.blur);
    return vec4f(light * p.strength, 1.0);
}
