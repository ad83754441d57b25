// Matcap: paints by the way a surface faces: a ball of clay, wax, jade or chrome. A ball of some material looks so under lights that move with the eye.
//@ use lib/surface

struct Matcap {
    /// What the ball is made of.
    @choice(clay, wax, jade, chrome) ball: u32,
    /// How much the surface's own color tints the ball.
    @range(0, 1, 1) tint: f32,
    /// How much of the ball is seen.
    @range(0, 1, 1) amount: f32,
}

// A ball that no surroundings are seen in.
struct MatcapPaint {
    dark: vec3f, // where the light does not reach
    bright: vec3f, // where it meets the surface straight on
    rim: vec3f, // added where the surface turns away from the eye
    gloss: f32, // strength of the highlight
    sharp: f32, // how sharp it is, 0 to 1
}

@smooth
fn matcap(surface: Surface, p: Matcap) -> Surface {
    var s = surface;
    // Where the eye looks nearly straight up or down, the directions across the view have no use, and fade out.
    var right = vec3f(s.view.z, 0.0, -s.view.x);
    right /= max(length(right), 0.4);
    let up = cross(s.view, right);
    let facing = vec3f(dot(s.normal, right), dot(s.normal, up), dot(s.normal, s.view));
    let shown = matcap_ball(p.ball, facing) * mix(vec3f(1.0), s.color.rgb, p.tint);
    s.color = vec4f(mix(s.color.rgb, shown, p.amount), s.color.a);
    s.glow = mix(s.glow, shown, p.amount);
    return s;
}

// The color of a ball where it faces this way: right, up, towards the eye.
fn matcap_ball(ball: u32, facing: vec3f) -> vec3f {
    switch ball {
        case MATCAP_BALL_CHROME: { return matcap_mirrored(facing); }
        case MATCAP_BALL_WAX: {
            return matcap_painted(facing, MatcapPaint(vec3f(0.3, 0.085, 0.025), vec3f(0.92, 0.74, 0.46), vec3f(0.4, 0.13, 0.03), 0.3, 0.25));
        }
        case MATCAP_BALL_JADE: {
            return matcap_painted(facing, MatcapPaint(vec3f(0.004, 0.04, 0.026), vec3f(0.05, 0.29, 0.16), vec3f(0.16, 0.34, 0.22), 0.75, 0.9));
        }
        default: {
            return matcap_painted(facing, MatcapPaint(vec3f(0.075, 0.03, 0.028), vec3f(0.78, 0.4, 0.26), vec3f(0.07, 0.08, 0.12), 0.05, 0.0));
        }
    }
}

fn matcap_painted(facing: vec3f, paint: MatcapPaint) -> vec3f {
    let light = clamp(0.6 * matcap_light(facing) + 0.4, 0.0, 1.0);
    let away = 1.0 - clamp(facing.z, 0.0, 1.0);
    // Half way between the light and the eye.
    let near = clamp(dot(facing, vec3f(-0.2469, 0.3292, 0.9114)), 0.0, 1.0);
    let power_4 = near * near * near * near;
    let power_16 = power_4 * power_4 * power_4 * power_4;
    let power_64 = power_16 * power_16 * power_16 * power_16;
    let highlight = mix(power_16, power_64, paint.sharp);
    return mix(paint.dark, paint.bright, light * light) + paint.rim * (away * away) + vec3f(paint.gloss * highlight);
}

// A sky above a ground, and the light.
fn matcap_mirrored(facing: vec3f) -> vec3f {
    let seen = facing * (2.0 * facing.z) - vec3f(0.0, 0.0, 1.0);
    let sky = mix(vec3f(0.86, 0.92, 1.0), vec3f(0.13, 0.24, 0.46), smoothstep(0.0, 0.9, seen.y));
    let ground = mix(vec3f(0.035, 0.028, 0.03), vec3f(0.42, 0.34, 0.27), smoothstep(0.0, 0.9, -seen.y));
    return mix(ground, sky, smoothstep(-0.08, 0.08, seen.y)) + vec3f(0.9 * smoothstep(0.86, 0.96, matcap_light(seen)));
}

// The cosine of the angle between a direction and that to the main light.
fn matcap_light(toward: vec3f) -> f32 {
    return dot(toward, vec3f(-0.45, 0.6, 0.6614));
}
