// Sheets: a picture between its texels, repeated and texel by texel, beside the normals of what is seen.
//@ use lib/image

struct Sheets {
    /// The sheet.
    @image("sheet.png") sheet: u32,
    /// Sheets across the picture.
    @range(0.1, 8.0, 2.3) across: f32,
}

fn sheets(at: ImageAt, p: Sheets) -> vec4f {
    let color = image_color(at.x, at.y);
    let place = (image_middle(at) / vec2f(image_size()) - 0.2) * p.across;
    let size = image_file_size(p.sheet);
    let texel = image_file_texel(p.sheet, at.x / 3 - 1, at.y / 3 - 1);
    let smooth_sheet = image_file_at(p.sheet, 0.6 * place);
    let tiled = image_file_tiled(p.sheet, place);
    let mixed = 0.3 * texel.rgb + 0.3 * smooth_sheet.rgb + 0.3 * tiled.brg + 0.01 * vec3f(vec2f(size), smooth_sheet.a + tiled.a);
    let normal = 0.5 + 0.5 * image_normal(at.x, at.y);
    return vec4f(mix(mixed, normal, 0.4) * 0.8 + 0.2 * color.rgb, color.a);
}
