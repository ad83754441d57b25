// Totals, packed16: two words of two halves: red and green, blue and the number of layers, with channels of 8 bits.
//@ use slot/sums

const TOTALS_CAPACITY = 257u;

// Adds a layer; true if with it the pixel holds more than fits.
fn totals_add(pixel: u32, color: vec3f, weight: u32) -> bool {
    let sum = vec3u(round(color * 255.0));
    sums_add(pixel, 0u, sum.r | (sum.g << 16u));
    return (sums_add(pixel, 1u, sum.b | (1u << 16u)) >> 16u) == TOTALS_CAPACITY;
}
