// Paper: the picture printed on a rough sheet, whose grain the ink does not fill.
//@ use lib/color

struct Paper {
    /// The sheet.
    @image("grain.png") sheet: u32,
    /// Pixels for one of the sheet's.
    @range(0.25, 8.0, 1.0) size: f32,
    /// How rough.
    @range(0.0, 1.0, 0.6) rough: f32,
}

fn paper(at: ImageAt, p: Paper) -> vec4f {
    let color = image_color(at.x, at.y);
    let place = image_middle(at) / (p.size * vec2f(image_file_size(p.sheet)));
    let sheet = image_file_tiled(p.sheet, place).rgb;
    let ink = 1.0 - color.rgb;
    return vec4f(sheet * (1.0 - ink * (1.0 - p.rough * (1.0 - sheet))), color.a);
}
