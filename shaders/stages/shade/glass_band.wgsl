// glass_band: goes on to the next band of pixels whose layers of glass are drawn. The nodes of the last one are composed, and free.
//@ use lib/glass
//@ use variants/glass_buffer

@compute @workgroup_size(1)
fn glass_band() {
    let counts = glass_counts();
    let most = max(glass_buffer_load(counts + GLASS_COUNT_MOST), glass_buffer_load(counts));
    glass_buffer_store(counts + GLASS_COUNT_MOST, most);
    glass_buffer_store(counts, 0u);
    glass_buffer_add(counts + GLASS_COUNT_BAND, 1u);
}
