// Particles: steps every particle to the frame that is shown, and writes the triangle of its disc among the scene's bytes, where
// all later passes pull it as if a file had it. No particle knows of another, so one invocation takes all steps of one.
//@ use common/flight
//@ use slot/bytes
//@ use slot/state

const PARTICLES_LEAN = 0.7;
const PARTICLES_SQRT_3 = 1.7320508;

@compute @workgroup_size(GROUP_SIZE)
fn particles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, GROUP_SIZE);
    if id >= particle_step.count { return; }
    var f: ParticleState;
    var first = particle_step.first_frame;
    if particle_step.is_fresh != 0u {
        f = state_kept(0u, flight_first(0u, id));
        first = 0u;
    } else {
        f = state_load(first, id);
    }
    var before = f;
    for (var step = first + 1u; step <= particle_step.last_frame; step += 1u) {
        before = f;
        f = state_kept(step, flight_step(step_params_of(step), id, f, step));
    }
    // The frame before is kept too, so that a picture that is drawn again takes its last step again.
    if particle_step.last_frame > first { state_store(particle_step.last_frame - 1u, id, before); }
    state_store(particle_step.last_frame, id, f);
    splat_store(id, f);
}

fn splat_store(id: u32, f: ParticleState) {
    let c = particle_step.steps;
    let base = flight_base(c, id, f.births);
    let share = f32(f.age) / f32(flight_life(c, base));
    let fade = step_params[c].p.fade;
    let grown = smoothstep(0.0, 1.0, share / fade) * smoothstep(0.0, 1.0, (1.0 - share) / fade);
    let radius = step_params[c].p.radius_m * (1.0 - step_params[c].p.radius_variation * hash_unit(base + 14u)) * grown;
    let heat = clamp(length(f.velocity) / step_params[c].p.fast_mps, 0.0, 1.0);
    let color = mix(step_params[c].p.slow.rgb, step_params[c].p.fast.rgb, heat);

    splat_corner(particle_step.target_word + 18u * id, f.place, radius, vec2f(-PARTICLES_SQRT_3, -1.0), color);
    splat_corner(particle_step.target_word + 18u * id + 6u, f.place, radius, vec2f(PARTICLES_SQRT_3, -1.0), color);
    splat_corner(particle_step.target_word + 18u * id + 12u, f.place, radius, vec2f(0.0, 2.0), color);
}

// A corner lies two radii from the middle.
fn splat_corner(word: u32, middle: vec3f, radius: f32, aside: vec2f, color: vec3f) {
    let offset = aside.x * particle_step.right.xyz + aside.y * particle_step.up.xyz;
    let place = bitcast<vec3u>(middle + radius * offset);
    let lean = PARTICLES_LEAN * step_params[particle_step.steps].p.roundness;
    let normal = (particle_step.toward.xyz + lean * offset) / sqrt(1.0 + 4.0 * lean * lean);
    vertex_bytes[word] = place.x;
    vertex_bytes[word + 1u] = place.y;
    vertex_bytes[word + 2u] = place.z;
    vertex_bytes[word + 3u] = pack2x16unorm(color.rg);
    vertex_bytes[word + 4u] = (pack2x16unorm(vec2f(color.b, 0.0)) & 0xffffu) | (pack2x16snorm(vec2f(normal.x, 0.0)) << 16u);
    vertex_bytes[word + 5u] = pack2x16snorm(normal.yz);
}
