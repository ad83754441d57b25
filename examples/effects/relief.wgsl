// Relief: the picture as an engraved plate of metal, lit from one side.
//@ use lib/angle
//@ use lib/color

struct Relief {
    /// Color of the metal.
    @color(0.72, 0.5, 0.28) metal: vec4f,
    /// How deep the plate is cut.
    @range(0.0, 10.0, 4.0) depth: f32,
    /// Where the light comes from, degrees.
    @range(-180.0, 180.0, 135.0) angle: f32,
    /// How much of the picture's own color is left.
    @range(0.0, 1.0, 0.15) enamel: f32,
}

fn relief(at: ImageAt, p: Relief) -> vec4f {
    let across = height(at.x + 1, at.y) - height(at.x - 1, at.y);
    let down = height(at.x, at.y + 1) - height(at.x, at.y - 1);
    let normal = normalize(vec3f(-p.depth * across, p.depth * down, 1.0));
    let toward = direction_degrees(p.angle);
    let light = clamp(dot(normal, normalize(vec3f(toward, 1.0))), 0.0, 1.0);
    // A polished plate: the light again, narrower.
    let gloss = light * light * light * light;
    let color = image_color(at.x, at.y);
    let plate = p.metal.rgb * (0.15 + 0.75 * light) + 0.35 * gloss * gloss;
    return vec4f(mix(plate, color.rgb * (0.3 + light), p.enamel), color.a);
}

fn height(x: i32, y: i32) -> f32 {
    return sqrt(max(color_luminance(image_color(x, y).rgb), 0.0));
}
