/* Ink: the sample hook with a helper
   /* and nested comments that name frame, draws and color */
*/
struct Ink { @range(1, 64, 8) side: u32 } // one line
fn helper(at: vec2u, side: u32) -> u32 { return at.x / side + at.y / side; }
fn is_drawn(sample: Sample, p: Ink) -> bool { return (helper(sample.at, p.side) & 1u) == 0u && sample_total_area(sample) > 0u; }
fn painted(surface: Surface, p: Ink) -> Surface { var s = surface; s.color.r = f32(helper(vec2u(s.pixel), p.side)); return s; }
//@ use lib/sample
