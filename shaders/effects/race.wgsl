// Race: what goes wrong without atomics, live: load the depth, compare, store depth and owner, and hope.
//@ use common/hash

struct Race {
    delay: u32,
}

// Idle work on a key. False for key 0 alone, which no sample has: the hash is a bijection that keeps 0, and no compiler
// knows that.
fn race_dawdle(key: u32, p: Race) -> bool {
    var h = key;
    for (var i = 0u; i < p.delay; i += 1u) { h = hash(h); }
    return h != 0u;
}
