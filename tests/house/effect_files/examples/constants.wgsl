// Ink: constants in let, of which naga's pipelines once made what its writers could not write; half words.
struct Ink { @range(0.0, 1.0, 0.5) helper: f32 }
fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    let g = vec2f(0.2, 0.3);
    let size = vec2f(320.0, 240.0);
    let aspect = size.x / size.y;
    let m = mat2x2f(0.8, 0.6, -0.6, 0.8);
    let halves = unpack2x16float(pack2x16float(g * p.helper));
    s.color = vec4f(abs(s.normal), g.x + 1.0) * aspect * m[0].y + reflect(g, halves).x;
    return s;
}
