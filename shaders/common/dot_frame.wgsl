// The dot frame: what of a picture concerns its dots alone. Mirror of `gpu::dots::DotFrame`.

struct DotFrame {
    clip_from_scene: mat4x4f, // for lines that no mesh carries
    ink: vec4f,               // gamma-encoded, alpha is the strength
    center: vec2f,            // half the picture in units of 1/256 px
    dots: u32,                // of all lines
    dot_runs: u32,
    segments: u32,
    fade_from: u32,           // bits of the 1/w at which dots of level 0 begin to fade
    fade_rate: u32,
    levels: u32,
    radius: u32,              // units of 1/256 px
    bias: u32,                // how far behind the surface a dot counts as on it, in steps of depths' bits
    hidden: u32,              // what is left of a hidden dot
    model: u32,               // 1: the model shows beneath
    first_probed: u32,        // dot of the first record that is read back
    zero: u32,                // 0, which no compiler knows
}

@group(0) @binding(20) var<uniform> dot_frame: DotFrame;
