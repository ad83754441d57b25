// Particles: adds drifting discs to the scene.
// crates/model/src/effects/particles.rs defines how they move and look; they use no hook of the stack.

struct Particles {
    /// Color of what hardly moves.
    @color(0.02, 0.1, 0.65) slow: vec4f,
    /// Color of what is fast.
    @color(1, 0.5, 0.12) fast: vec4f,
    /// Center of the particles.
    @point(0, 0, 0) @hard(-1000, 1000) @soft(-3, 3) @unit(m) center: vec4f,
    /// Half axes of the ellipsoid in which particles are born.
    @point(1, 1, 1) @hard(0, 1000) @soft(0, 3) @unit(m) half_axes: vec4f,
    /// The point that attracts particles; a drag over the picture with Ctrl moves it.
    @point(0, 0, 0) @hard(-1000, 1000) @soft(-3, 3) @unit(m) attractor: vec4f,
    /// How many there are.
    @range(0, 200000, 100000) @hard(0, 4e6) count: u32,
    /// Another seed gives another flow and other lives.
    @range(0, 999, 1) @hard(0, 4294967295) seed: u32,
    /// Steps per second of the preset.
    @range(24, 120, 60) @hard(1, 240) @unit(/s) rate: u32,
    /// Half the side of the bounds; a particle that would leave them is born again.
    @range(0.5, 5, 2.5) @hard(0.01, 1000) @unit(m) room_m: f32,
    /// Longest life.
    @range(0.25, 12, 4) @hard(0.01, 200) @unit(s) lifetime_s: f32,
    /// Random fraction of it.
    @range(0, 1, 0.6) lifetime_variation: f32,
    /// Speed of the flow, about.
    @range(0, 3, 0.6) @hard(0, 100) @unit(m/s) speed_mps: f32,
    /// Size of the largest swirls.
    @range(0.1, 4, 0.9) @hard(0.05, 1000) @unit(m) swirl_m: f32,
    /// Layers of noise, each of half the size of the one before.
    @range(1, 6, 3) octaves: u32,
    /// Speed of each layer as a fraction of that of the previous one.
    @range(0, 1, 0.45) persistence: f32,
    /// How fast the flow itself changes.
    @range(0, 2, 0.25) @hard(0, 10) @unit(/s) evolve: f32,
    /// How tightly the flow holds particles.
    @range(0, 20, 5) @hard(0, 1000) @unit(/s) drag: f32,
    /// Largest acceleration towards the attractor; below 0 away from it.
    @range(-20, 20, 0) @hard(-1000, 1000) @unit(m/s²) attraction: f32,
    /// Distance from the attractor at which it draws most.
    @range(0.05, 2, 0.5) @hard(0.01, 1000) @unit(m) attractor_m: f32,
    /// How long the attraction takes to follow its point.
    @range(0, 1, 0.15) @hard(0, 60) @unit(s) attractor_lag_s: f32,
    /// Largest radius of a disc.
    @range(0.001, 0.05, 0.008) @hard(0, 10) @unit(m) radius_m: f32,
    /// Random fraction of it.
    @range(0, 1, 0.5) radius_variation: f32,
    /// Fraction of its life in which a disc grows, and in which it shrinks.
    @range(0.001, 0.5, 0.3) fade: f32,
    /// How far the rim of a disc turns from the viewer: 0 flat, 1 by 35 degrees.
    @range(0, 1, 1) roundness: f32,
    /// Speed of the fast color.
    @range(0.05, 4, 0.9) @hard(0.001, 1000) @unit(m/s) fast_mps: f32,
}
