// Totals, three8: three words for channels of 8 bits; the number of layers stands above the first channel, in 12 bits.
//@ use slot/sums

const TOTALS_CAPACITY = 4095u;

// Adds a layer; true if with it the pixel holds more than fits.
fn totals_add(pixel: u32, color: vec3f, weight: u32) -> bool {
    let sum = vec3u(round(color * 255.0));
    sums_add(pixel, 1u, sum.g);
    sums_add(pixel, 2u, sum.b);
    return (sums_add(pixel, 0u, sum.r | (1u << 20u)) >> 20u) == TOTALS_CAPACITY;
}
