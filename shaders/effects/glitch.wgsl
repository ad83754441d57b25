// Glitch: a broken transmission: rows slip, colors part. Rows and blocks of the picture slip aside.
//@ use lib/hash
//@ use lib/image_pass

struct Glitch {
    /// How much of the picture is torn.
    @range(0, 1, 0.35) amount: f32,
    /// Height of a row that slips.
    @range(1, 32, 4) @hard(1, 256) @unit(px) row_px: u32,
    /// How far a row slips at most.
    @range(0, 256, 40) @hard(0, 4096) @unit(px) shift_px: u32,
    /// How far red and blue part, each way; three times as far where the picture is torn.
    @range(0, 32, 2) @hard(0, 256) @unit(px) split_px: u32,
    /// How many blocks slip beside rows.
    @range(0, 1, 0.4) blocks: f32,
    /// Strength of the snow where the picture is torn.
    @range(0, 1, 0.05) noise: f32,
    /// Another seed tears the picture elsewhere.
    @range(0, 65535, 7) seed: u32,
}

fn glitch(at: ImageAt, p: Glitch) -> vec4f {
    let seed = hash(p.seed * HASH_GOLDEN);
    let row = u32(at.y) / p.row_px;
    // Rows slip together in groups of four, and a few by themselves.
    let group = hash(seed + row / 4u);
    let alone = hash(seed ^ (row * HASH_GOLDEN));
    var shift = 0;
    if hash_unit(group) < p.amount { shift += glitch_shift(group, p.shift_px) / 3; }
    if hash_unit(alone) < p.amount * p.amount { shift += glitch_shift(alone, p.shift_px); }
    let column = u32(at.x) / (p.row_px * 6u);
    let block = hash(hash(seed + column) + row / 2u);
    let is_block = hash_unit(block) < 0.25 * p.blocks * p.amount;
    if is_block { shift += glitch_shift(hash(block), p.shift_px); }
    let split = i32(p.split_px) * select(1, 3, is_block || shift != 0);
    let x = at.x + shift;
    let middle = image_color(x, at.y);
    let colors = vec3f(image_color(x - split, at.y).r, middle.g, image_color(x + split, at.y).b);
    let snow = p.noise * (hash_unit(hash(alone + u32(at.x) / 2u) + u32(at.y)) - 0.5);
    let torn = select(0.0, snow, shift != 0);
    return vec4f(max(colors + torn, vec3f(0.0)), middle.a);
}

// By how many pixels what has this hash slips, to either side.
fn glitch_shift(seed: u32, most: u32) -> i32 {
    return i32(hash(seed) % (2u * most + 1u)) - i32(most);
}
