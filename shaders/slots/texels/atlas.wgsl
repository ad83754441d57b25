// Texels, atlas: textures multiply the base colour, and what a material emits is added; all of it comes from the words of one
// texture. How much of an image a pixel spans is told by the triangle's own plane, exactly, not by neighbouring invocations.
//@ use common/texels
//@ use common/slopes

fn texels_painted(surface: Surface, t: Triangle, at: vec3u, place: Place) -> Surface {
    var s = surface;
    let record = texels_record(t.draw);
    let paint = texels_paint(record);
    var slopes: Slopes;
    if (paint.flags & (PAINT_BASE_TEXTURE | PAINT_EMISSION_TEXTURE)) != 0u { slopes = slopes_of(t, at, place, s.screen); }
    if (paint.flags & PAINT_BASE_TEXTURE) != 0u {
        s.color = vec4f(s.color.rgb * texels_at(texels_lookup(record + TEXELS_PAINT), at, place.weights, slopes), s.color.a);
    }
    if (paint.flags & PAINT_UNLIT) != 0u {
        s.glow = s.color.rgb;
        return s;
    }
    var glow = vec3f(paint.red, paint.green, paint.blue);
    if (paint.flags & PAINT_EMISSION_TEXTURE) != 0u {
        glow *= texels_at(texels_lookup(record + TEXELS_PAINT + TEXELS_LOOKUP), at, place.weights, slopes);
    }
    s.glow = glow;
    s.color = vec4f(s.color.rgb + glow, s.color.a);
    return s;
}

// A corner's place in the image.
fn texels_corner(look: Lookup, vertex: u32) -> vec2f {
    let byte = look.offset + vertex * look.stride;
    let stored = vec2f(pull_lane(look.format, byte), pull_lane(look.format, byte + pull_bytes(look.format)));
    return vec2f(
        look.u_per_u * stored.x + look.u_per_v * stored.y + look.u_offset, look.v_per_u * stored.x + look.v_per_v * stored.y + look.v_offset);
}

// Whole images between a coordinate and the one near 0 that shows the same.
fn texels_whole(at: f32, wrap: u32) -> f32 {
    if wrap == WRAP_CLAMP { return 0.0; }
    return select(floor(at), 2.0 * floor(0.5 * at), wrap == WRAP_MIRRORED);
}

// What a texture shows at a sample. Measured from the first corner, which is brought near 0, so that errors grow with the
// triangle and not with its distance from the image's own edge.
fn texels_at(look: Lookup, at: vec3u, weights: vec3f, slopes: Slopes) -> vec3f {
    let a = texels_corner(look, at.x);
    let ab = texels_corner(look, at.y) - a;
    let ac = texels_corner(look, at.z) - a;
    let whole = vec2f(texels_whole(a.x, look.sampling & 3u), texels_whole(a.y, (look.sampling >> 2u) & 3u));
    let place = (a - whole) + ab * weights.y + ac * weights.z;
    let size = vec2f(vec2u(look.size & 0xffffu, look.size >> 16u));
    let right = (ab * slopes.right.y + ac * slopes.right.z) * size;
    let down = (ab * slopes.down.y + ac * slopes.down.z) * size;
    let squared = max(dot(right, right), dot(down, down));
    return texels_seen(look, place, 0.5 * log2(max(squared, 1e-30)));
}
