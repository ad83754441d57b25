// Store steps: idle work between the load of a depth and its store, in the race framebuffer. The sample is stored where every
// step returns true. Chosen by the effect race; without it there is no such step.
//@ steps fn store_step(key: u32) -> bool

//@ step race
// The delay of the effect.
//@ use effects/race
//@ use glue/effects

fn store_step_race(key: u32) -> bool {
    return race_delay(key, effects.race);
}
