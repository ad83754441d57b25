// Totals, four32: a word for each channel of the weighted colours and one for the weights.
//@ use slot/sums

// Bits per channel in the sums.
override SUM_BITS: u32 = 12u;

// Adds a layer; true if with it the pixel holds more than fits.
fn totals_add(pixel: u32, color: vec3f, weight: u32) -> bool {
    let whole = (1u << SUM_BITS) - 1u;
    let sum = vec3u(round(color * f32(whole))) * weight;
    sums_add(pixel, 0u, sum.r);
    sums_add(pixel, 1u, sum.g);
    sums_add(pixel, 2u, sum.b);
    let before = sums_add(pixel, 3u, weight);
    let capacity = 0xffffffffu / whole;
    return before <= capacity && before + weight > capacity;
}
