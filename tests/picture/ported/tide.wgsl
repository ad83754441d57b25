// Tide: waves run through the model.
//@ use lib/angle
//@ use lib/vertex

struct Tide {
    /// Height of the waves.
    @range(0.0, 0.5, 0.08) @unit(m) height: f32,
    /// Waves per meter.
    @range(0.1, 4.0, 0.9) waves: f32,
    /// Waves that pass in a second.
    @range(0.0, 3.0, 0.5) @unit(/s) speed: f32,
    @given(seconds) time_s: f32,
}

fn tide(v: Vertex, p: Tide) -> Vertex {
    var moved = v;
    let phase = p.waves * (v.position.x + 0.4 * v.position.z) - p.speed * p.time_s;
    moved.offset.y += 0.9 * p.height * sine_turns(phase);
    return moved;
}
