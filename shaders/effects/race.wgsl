// Race: what goes wrong without atomics, live: load the depth, compare, store depth and triangle id, and hope.
//@ use common/hash

struct Race {
    delay: u32,
}

fn race_idle(key: u32) -> u32 {
    return hash(hash(hash(hash(hash(hash(hash(hash(key))))))));
}

// Idle work on a key. False for key 0 alone, which no sample has: the hash is a bijection that keeps 0, and no compiler
// knows that. Without a loop, since some CPU adapters end loops that run too often.
fn race_dawdle(key: u32, p: Race) -> bool {
    var h = key;
    if p.delay > 0u { h = race_idle(h); }
    if p.delay > 1u { h = race_idle(h); }
    if p.delay > 2u { h = race_idle(race_idle(h)); }
    if p.delay > 3u { h = race_idle(race_idle(race_idle(race_idle(h)))); }
    return h != 0u;
}
