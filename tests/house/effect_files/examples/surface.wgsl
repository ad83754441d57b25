// Ink: loops, helpers and every kind of parameter.
//@ use lib/surface
//@ use lib/hash
//@ use lib/color

const STEPS = 4u;
const TABLE = array<f32, STEPS>(0.1, 0.2, 0.3, 0.4);
alias Triple = vec3f;

struct Pair {
    amount: f32,
    helper: Triple,
}

struct Ink {
    /// How.
    @choice(plain, cross-hatch) @default(cross-hatch) mode: u32,
    @range(0.0, 1.0, 0.5) @hard(-4, 4) @unit(m) @when(mode, plain) amount: f32,
    @range(-8, 8, -3) offset: i32,
    @range(1, 9, 3) count: u32,
    @toggle(1) helper: u32,
    @color(1.0, 0.5, 0.25) tint: vec4f,
    @point(1.0, -2.0, 3.5) at: vec4<f32>,
}

fn helper(pair: Pair, amount: f32) -> Triple {
    var helper = pair.helper * amount;
    for (var i = 0u; i < STEPS; i++) {
        if i == 2u { continue; }
        helper += TABLE[i];
        while helper.x > 4.0 { helper -= 1.0; }
    }
    return helper;
}

fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    let pair = Pair(p.amount, s.normal);
    if p.mode == INK_MODE_CROSS_HATCH && p.helper != 0u {
        s.color = vec4f(helper(pair, hash_unit(s.triangle_id)), 1.0);
    }
    var turns = 0;
    loop { turns += p.offset; if turns > 10 { break; } continuing { turns++; } }
    switch p.count { case 1u, 2u: { s.rank = f32(turns); } default: { s.rank = color_luminance(p.tint.rgb); } }
    return s;
}
