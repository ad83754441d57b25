// Delay, raced: idle work between the look at the depth and the store.
//@ use common/surface
//@ use glue/surface

fn delay_passes(key: u32) -> bool {
    return race_dawdle(key, effects.race);
}
