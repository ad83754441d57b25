// Delay, none: what was seen is stored at once.

fn delay_passes(key: u32) -> bool {
    return true;
}
