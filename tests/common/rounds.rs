//! How often a test repeats what it does at random moments.

/// `few` rounds, or RASTERLAB_ROUNDS times as many.
pub fn rounds(few: u32) -> u32 {
    few * std::env::var("RASTERLAB_ROUNDS").map_or(1, |times| {
        times.parse().expect("RASTERLAB_ROUNDS is a whole number")
    })
}
