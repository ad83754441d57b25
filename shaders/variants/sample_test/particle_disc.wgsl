// Sample test, particle disc: a particle is a triangle of which only the ellipse that touches its sides in their midpoints is
// drawn, and nothing if it had to be clipped. With areas a, b, c: (a + b - c)^2 <= 4 a b.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/areas

fn sample_test_particle_disc(t: Triangle, at: vec2u, pixel: u32) -> bool {
    if (draws[t.draw].flags & DRAW_PARTICLES) == 0u { return true; }
    let areas = areas_at(t, at);
    let d = u32(abs(i32(areas.x + areas.y) - i32(areas.z)));
    let is_inside = !fixed_is_less(fixed_umul(2u * areas.x, 2u * areas.y), fixed_umul(d, d));
    return t.entry < frame.triangle_count && is_inside;
}
