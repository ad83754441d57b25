// X-ray: averages all layers of a pixel in whole numbers, so that no order shows.
//@ use lib/surface

struct Xray {
    /// Which layers count: all, or those within a window behind the front one.
    @choice(all, window) layers: u32,
    /// Depth of the window in thousandths: of the front's distance, or of the scene's depth where all rays are parallel.
    @range(0, 400, 20) @hard(0, 4000) @unit(‰) @when(layers, window) window: u32,
    /// Which layers have more weight.
    @choice(equal, facing, grazing, near) weight: u32,
    /// Fraction of the light behind it that a layer of full weight stops; at 1 the background is hidden.
    @range(0, 1, 1) opacity: f32,
    /// Bits per channel in the sums to begin with; fewer are taken where more layers must fit.
    @choice(auto, 16, 12, 10, 8) bits: u32,
}

// Weight of a layer: 1 where all count alike, else 1 to 255.
fn xray_weight(s: Surface, p: Xray) -> u32 {
    let facing = abs(dot(s.normal, s.view));
    var fraction = facing;
    switch p.weight {
        case XRAY_WEIGHT_EQUAL: { return 1u; }
        case XRAY_WEIGHT_GRAZING: { fraction = 1.0 - facing; }
        case XRAY_WEIGHT_NEAR: { fraction = (s.depth_range_m.y - s.depth_m) / (s.depth_range_m.y - s.depth_range_m.x); }
        default: {}
    }
    return u32(clamp(fraction * 255.0, 1.0, 255.0) + 0.5);
}

// Least depth key that counts behind a front; in integers, so that the oracle computes the same.
fn xray_threshold(front: u32, is_perspective: bool, p: Xray) -> u32 {
    if p.layers == XRAY_LAYERS_ALL { return 1u; }
    if !is_perspective {
        let step = u32(bitcast<f32>(front) * 1048576.0);
        let window = (p.window << 20u) / 1000u;
        return max(bitcast<u32>(f32(step - min(step, window)) * 0.00000095367431640625), 1u);
    }
    // The significand times a factor of 16 bits, in two parts, so that no product exceeds 32 bits.
    let exponent = front >> 23u;
    let significand = (front & 0x7fffffu) | 0x800000u;
    let factor = 65536000u / (1000u + p.window);
    let scaled = ((significand >> 12u) * factor + (((significand & 0xfffu) * factor) >> 12u)) >> 4u;
    let shift = countLeadingZeros(scaled) - 8u;
    if exponent <= shift { return 1u; }
    return ((exponent - shift) << 23u) | ((scaled << shift) & 0x7fffffu);
}

// Sum over count, rounded to the nearest integer, halves up.
fn xray_average(sum: u32, count: u32) -> u32 {
    let whole = max(count, 1u);
    return sum / whole + select(0u, 1u, 2u * (sum % whole) >= whole);
}

// `through` to the power of weight / unit: integer powers by squaring, because logarithms of drivers are coarse.
fn xray_clear(through: f32, weight: u32, unit: u32) -> f32 {
    let rest = weight % unit;
    var clear = select(1.0, exp2(log2(max(through, 1e-30)) * f32(rest) / f32(unit)), rest > 0u);
    var power = through;
    for (var bits = weight / unit; bits > 0u; bits >>= 1u) {
        if (bits & 1u) != 0u { clear *= power; }
        power *= power;
    }
    return select(clear, 0.0, through <= 0.0 && weight > 0u);
}

// The average over the background, with an opacity that grows with the number of layers.
fn xray_over(average: vec3f, background: vec4f, weight: u32, p: Xray) -> vec4f {
    let clear = xray_clear(1.0 - p.opacity, weight, select(255u, 1u, p.weight == XRAY_WEIGHT_EQUAL));
    return vec4f(average + (background.rgb - average) * clear, 1.0 + (background.a - 1.0) * clear);
}
