// Triangle id: gives every triangle its own color.
//@ use lib/surface
//@ use lib/hash

struct TriangleId {
    /// How much of the base color is replaced.
    @range(0, 1, 1) amount: f32,
    /// Another seed, other colors.
    @range(0, 999, 0) @hard(0, 4294967295) seed: u32,
}

@smooth
fn triangle_id(surface: Surface, p: TriangleId) -> Surface {
    var s = surface;
    let h = hash(s.triangle_id ^ (p.seed * HASH_GOLDEN));
    let bytes = vec3u(h & 255u, (h >> 8u) & 255u, (h >> 16u) & 255u);
    let shade = vec3f(0.08) + vec3f(bytes) / 255.0 * 0.8;
    s.glow *= 1.0 - p.amount;
    s.color = vec4f(s.color.rgb + (shade - s.color.rgb) * p.amount, s.color.a);
    return s;
}
