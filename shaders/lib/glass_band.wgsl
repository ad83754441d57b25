// Bands: runs of pixels, of equal length, whose layers of glass are drawn one band after another, where those of all pixels at once
// would take too much memory.
//@ use lib/frame
//@ use lib/glass
//@ use variants/glass_buffer

override GLASS_BANDS: u32 = 1u;

// Pixels of a band.
fn glass_band_length() -> u32 { return (frame.size.x * frame.size.y + GLASS_BANDS - 1u) / GLASS_BANDS; }

// First pixel of the band that is drawn.
fn glass_band_first() -> u32 { return (glass_buffer_load(glass_counts() + GLASS_COUNT_BAND) - 1u) * glass_band_length(); }

// Is a pixel in the band that is drawn?
fn glass_band_has(pixel: u32) -> bool {
    return GLASS_BANDS == 1u || pixel / glass_band_length() + 1u == glass_buffer_load(glass_counts() + GLASS_COUNT_BAND);
}
