// Bands: runs of pixels, of equal length, whose layers of glass are drawn one band after another, where those of all pixels at once
// would take too much memory.
//@ use lib/glass
//@ use variants/glass_buffer

// First pixel of the band that is drawn.
fn glass_band_first() -> u32 {
    if GLASS_BANDS == 1u { return 0u; }
    return (glass_buffer_load(glass_counts() + GLASS_COUNT_BAND) - 1u) * glass_band_length();
}

// Is a pixel in the band that begins with `first`?
fn glass_band_has(first: u32, pixel: u32) -> bool {
    return GLASS_BANDS == 1u || pixel - first < glass_band_length();
}
