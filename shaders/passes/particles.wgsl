// Particles: steps every particle to the frame that is shown, and writes the triangle of its disc among the scene's bytes, where
// all later passes pull it as if a file had it. No particle knows of another, so one invocation takes all steps of one.
//@ use common/flight
//@ use slot/bytes
//@ use slot/state

const PARTICLES_LEAN = 0.7;
const PARTICLES_SQRT_3 = 1.7320508;

@compute @workgroup_size(LIST_GROUP)
fn particles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, LIST_GROUP);
    if id >= swarm.count { return; }
    var f: Flight;
    var first = swarm.first_frame;
    if swarm.is_fresh != 0u {
        f = state_kept(0u, flight_first(0u, id));
        first = 0u;
    } else {
        f = state_load(first, id);
    }
    var before = f;
    for (var step = first + 1u; step <= swarm.last_frame; step += 1u) {
        before = f;
        f = state_kept(step, flight_step(course_of(step), id, f, step));
    }
    // The frame before is kept too, so that a picture that is drawn again takes its last step again.
    if swarm.last_frame > first { state_store(swarm.last_frame - 1u, id, before); }
    state_store(swarm.last_frame, id, f);
    splat_store(id, f);
}

fn splat_store(id: u32, f: Flight) {
    let c = swarm.steps;
    let base = flight_base(c, id, f.births);
    let share = f32(f.age) / f32(flight_life(c, base));
    let fade = course[c].p.fade;
    let grown = smoothstep(0.0, 1.0, share / fade) * smoothstep(0.0, 1.0, (1.0 - share) / fade);
    let radius = course[c].p.size_m * (1.0 - course[c].p.size_spread * hash_unit(base + 14u)) * grown;
    let heat = clamp(length(f.velocity) / course[c].p.bright_mps, 0.0, 1.0);
    let color = mix(course[c].p.slow.rgb, course[c].p.fast.rgb, heat);

    splat_corner(swarm.target_word + 18u * id, f.place, radius, vec2f(-PARTICLES_SQRT_3, -1.0), color);
    splat_corner(swarm.target_word + 18u * id + 6u, f.place, radius, vec2f(PARTICLES_SQRT_3, -1.0), color);
    splat_corner(swarm.target_word + 18u * id + 12u, f.place, radius, vec2f(0.0, 2.0), color);
}

// A corner lies two radii from the middle.
fn splat_corner(word: u32, middle: vec3f, radius: f32, aside: vec2f, color: vec3f) {
    let offset = aside.x * swarm.right.xyz + aside.y * swarm.up.xyz;
    let place = bitcast<vec3u>(middle + radius * offset);
    let lean = PARTICLES_LEAN * course[swarm.steps].p.roundness;
    let normal = (swarm.toward.xyz + lean * offset) / sqrt(1.0 + 4.0 * lean * lean);
    vertex_bytes[word] = place.x;
    vertex_bytes[word + 1u] = place.y;
    vertex_bytes[word + 2u] = place.z;
    vertex_bytes[word + 3u] = pack2x16unorm(color.rg);
    vertex_bytes[word + 4u] = (pack2x16unorm(vec2f(color.b, 0.0)) & 0xffffu) | (pack2x16snorm(vec2f(normal.x, 0.0)) << 16u);
    vertex_bytes[word + 5u] = pack2x16snorm(normal.yz);
}
