// Spans: which samples of a pixel row a triangle owns, exactly, at every size. A float guesses, integers correct it.
//@ use common/fixed
//@ use common/grid

// Is the sample of a pixel on the inner side of the directed edge of a clockwise triangle?
fn spans_is_inside(begin: vec2i, end: vec2i, pixel: vec2i) -> bool {
    return fixed_sign(fixed_edge(begin, end, grid_sample(pixel))) >= fixed_bias(end - begin);
}

// Part of the pixels first.x to first.y (inclusive) of row y on the inner side of an edge; empty where x > y.
fn spans_cut(begin: vec2i, end: vec2i, y: i32, span: vec2i) -> vec2i {
    let dy = end.y - begin.y;
    if span.x > span.y { return span; }
    if dy == 0 { return select(vec2i(1, 0), span, spans_is_inside(begin, end, vec2i(span.x, y))); }
    // Along a row the edge function changes by a unit of dy per pixel: where is it zero?
    let e = fixed_to_f32(fixed_edge(begin, end, grid_sample(vec2i(span.x, y))));
    var x = span.x + i32(clamp(e / (f32(grid_unit()) * f32(dy)), -1.0, f32(span.y - span.x) + 1.0));
    if dy < 0 {
        for (var i = 0; i < 4 && x <= span.y && !spans_is_inside(begin, end, vec2i(x, y)); i += 1) { x += 1; }
        for (var i = 0; i < 4 && x > span.x && spans_is_inside(begin, end, vec2i(x - 1, y)); i += 1) { x -= 1; }
        return vec2i(max(x, span.x), span.y);
    }
    for (var i = 0; i < 4 && x >= span.x && !spans_is_inside(begin, end, vec2i(x, y)); i += 1) { x -= 1; }
    for (var i = 0; i < 4 && x < span.y && spans_is_inside(begin, end, vec2i(x + 1, y)); i += 1) { x += 1; }
    return vec2i(span.x, min(x, span.y));
}

// Samples of row y within the box of pixels that the triangle (a, b, c), clockwise on screen, owns.
fn spans_row(a: vec2i, b: vec2i, c: vec2i, y: i32, pixels: vec4i) -> vec2i {
    return spans_cut(c, a, y, spans_cut(b, c, y, spans_cut(a, b, y, pixels.xz)));
}
