// Splats, discs: of a splat's triangle only the ellipse that touches its sides in their middles is drawn, and nothing at all of
// one that had to be clipped. With parts a, b, c of the whole, as sample effects have them: (a + b - c)^2 <= 4 a b.
//@ use common/fixed
//@ use common/parts

fn splats_is_drawn(t: Triangle, at: vec2u) -> bool {
    if (draws[t.draw].flags & DRAW_PARTICLES) == 0u { return true; }
    let parts = parts_of(t, at);
    let d = u32(abs(i32(parts.x + parts.y) - i32(parts.z)));
    let is_inside = !fixed_is_less(fixed_umul(2u * parts.x, 2u * parts.y), fixed_umul(d, d));
    return t.entry < frame.triangle_count && is_inside;
}
