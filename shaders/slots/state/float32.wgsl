// State, float32: eight words a particle, every number as it is.
//@ use common/flight

@group(0) @binding(19) var<storage, read_write> flights: array<vec4u>;

// Flights of even frames come first, then those of odd ones.
fn state_load(frame_number: u32, id: u32) -> Flight {
    let at = 2u * ((frame_number & 1u) * swarm.count + id);
    let place = flights[at];
    let motion = flights[at + 1u];
    return Flight(bitcast<vec3f>(place.xyz), bitcast<vec3f>(motion.xyz), place.w, motion.w);
}

fn state_store(frame_number: u32, id: u32, f: Flight) {
    let at = 2u * ((frame_number & 1u) * swarm.count + id);
    flights[at] = vec4u(bitcast<vec3u>(f.place), f.age);
    flights[at + 1u] = vec4u(bitcast<vec3u>(f.velocity), f.births);
}

// A flight as it comes back from being kept.
fn state_kept(frame_number: u32, f: Flight) -> Flight {
    return f;
}
