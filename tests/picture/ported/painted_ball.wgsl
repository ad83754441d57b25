// Painted ball: a surface shows what a painted ball shows where it faces the same way.
//@ use lib/surface

struct PaintedBall {
    /// The ball.
    @image("ball.png") ball: u32,
    /// How much of the ball is seen.
    @range(0.0, 1.0, 1.0) amount: f32,
}

fn painted_ball(surface: Surface, p: PaintedBall) -> Surface {
    var s = surface;
    // Two directions across the view; the second points up.
    let across = normalize(cross(vec3f(0.0, 1.0, 0.0), s.view) + vec3f(1e-6, 0.0, 0.0));
    let up = cross(s.view, across);
    let place = vec2f(0.5, 0.5) + 0.49 * vec2f(dot(s.normal, across), -dot(s.normal, up));
    let ball = image_file_at(p.ball, place).rgb;
    s.color = vec4f(mix(s.color.rgb, ball, p.amount), s.color.a);
    return s;
}
