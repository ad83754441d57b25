// simulate_particles: advances every particle to the frame that is shown, and writes the triangle of its disc behind the scene's
// bytes, where all later passes pull it as if a file contained it. Particles do not interact, so one invocation takes all
// steps of one particle.
//@ use lib/frame
//@ use lib/hash
//@ use lib/particle
//@ use variants/particle_state

@group(0) @binding(2) var<storage, read_write> vertex_bytes: array<u32>;

const PARTICLE_LEAN = 0.7;
const PARTICLE_SQRT_3 = 1.7320508;

@compute @workgroup_size(GROUP_SIZE)
fn simulate_particles(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let id = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    if id >= particle_step.count { return; }
    var f: ParticleState;
    var first = particle_step.first_frame;
    if particle_step.is_fresh != 0u {
        f = state_rounded(0u, particle_first(0u, id));
        first = 0u;
    } else {
        f = state_load(first, id);
    }
    var before = f;
    for (var step = first + 1u; step <= particle_step.last_frame; step += 1u) {
        before = f;
        f = state_rounded(step, particle_stepped(step_params_of(step), id, f, step));
    }
    // The previous frame is stored too, so that a picture which is drawn again repeats its last step.
    if particle_step.last_frame > first { state_store(particle_step.last_frame - 1u, id, before); }
    state_store(particle_step.last_frame, id, f);
    disc_store(id, f);
}

fn disc_store(id: u32, f: ParticleState) {
    let c = particle_step.steps;
    let seed = particle_seed(c, id, f.births);
    let fraction = f32(f.age) / f32(particle_life(c, seed));
    let fade = step_params[c].p.fade;
    let grown = smoothstep(0.0, 1.0, fraction / fade) * smoothstep(0.0, 1.0, (1.0 - fraction) / fade);
    let radius = step_params[c].p.radius_m * (1.0 - step_params[c].p.radius_variation * hash_unit(seed + 14u)) * grown;
    let heat = clamp(length(f.velocity) / step_params[c].p.fast_mps, 0.0, 1.0);
    let color = mix(step_params[c].p.slow.rgb, step_params[c].p.fast.rgb, heat);

    disc_corner_store(particle_step.target_word + 18u * id, f.position, radius, vec2f(-PARTICLE_SQRT_3, -1.0), color);
    disc_corner_store(particle_step.target_word + 18u * id + 6u, f.position, radius, vec2f(PARTICLE_SQRT_3, -1.0), color);
    disc_corner_store(particle_step.target_word + 18u * id + 12u, f.position, radius, vec2f(0.0, 2.0), color);
}

// A corner lies two radii from the center.
fn disc_corner_store(word: u32, center: vec3f, radius: f32, aside: vec2f, color: vec3f) {
    let offset = aside.x * particle_step.right.xyz + aside.y * particle_step.up.xyz;
    let position = bitcast<vec3u>(center + radius * offset);
    let lean = PARTICLE_LEAN * step_params[particle_step.steps].p.roundness;
    let normal = (particle_step.toward.xyz + lean * offset) / sqrt(1.0 + 4.0 * lean * lean);
    vertex_bytes[word] = position.x;
    vertex_bytes[word + 1u] = position.y;
    vertex_bytes[word + 2u] = position.z;
    vertex_bytes[word + 3u] = pack2x16unorm(color.rg);
    vertex_bytes[word + 4u] = (pack2x16unorm(vec2f(color.b, 0.0)) & 0xffffu) | (pack2x16snorm(vec2f(normal.x, 0.0)) << 16u);
    vertex_bytes[word + 5u] = pack2x16snorm(normal.yz);
}
