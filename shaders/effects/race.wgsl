// Race: stores depth and triangle id without atomics: wrong, and not twice the same.
//@ use lib/hash

struct Race {
    /// Idle work between the look at the depth and the store, each step twice the one before: the longer, the more is lost.
    @range(0, 4, 0) delay: u32,
}

fn race_idle(key: u32) -> u32 {
    return hash(hash(hash(hash(hash(hash(hash(hash(key))))))));
}

// Idle work on a key. False only for key 0, which no sample has: the hash is a bijection that maps 0 to 0, which compilers do
// not know. Without a loop, because some CPU adapters abort long loops.
fn race_delay(key: u32, p: Race) -> bool {
    var h = key;
    if p.delay > 0u { h = race_idle(h); }
    if p.delay > 1u { h = race_idle(h); }
    if p.delay > 2u { h = race_idle(race_idle(h)); }
    if p.delay > 3u { h = race_idle(race_idle(race_idle(race_idle(h)))); }
    return h != 0u;
}
