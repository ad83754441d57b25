// Store step, race: the delay of the effect.
//@ use effects/race
//@ use glue/effects

fn store_step_race(key: u32) -> bool {
    return race_delay(key, effects.race);
}
