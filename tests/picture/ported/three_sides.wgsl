// Three sides: a tile is laid on a model from three sides, without texture coordinates.
//@ use lib/surface

struct ThreeSides {
    /// The tile.
    @image("grain.png") tile: u32,
    /// Tiles per meter.
    @range(0.1, 8.0, 1.0) scale: f32,
    /// How soft the sides meet.
    @range(1.0, 8.0, 3.0) soft: f32,
}

fn three_sides(surface: Surface, p: ThreeSides) -> Surface {
    var s = surface;
    let at = p.scale * s.position;
    let facing = abs(s.normal) + 0.001;
    let power = facing * facing * mix(facing, vec3f(1.0), 1.0 / p.soft);
    let weights = power / (power.x + power.y + power.z);
    let x = image_file_tiled(p.tile, at.zy);
    let y = image_file_tiled(p.tile, at.xz);
    let z = image_file_tiled(p.tile, at.xy);
    s.color = vec4f(s.color.rgb * (weights.x * x + weights.y * y + weights.z * z).rgb, s.color.a);
    return s;
}
