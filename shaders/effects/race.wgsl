// Race: what goes wrong without atomics, live: load the depth, compare, store depth and triangle id.
//@ use lib/hash

struct Race {
    delay: u32,
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
