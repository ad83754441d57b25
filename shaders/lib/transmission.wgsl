// Light that passes through materials: what the material atlas says of it, before the finish of a primitive, and the layer of glass that follows.
// Mirrors `gpu::records::TransmissionRecord` and `effects::glass`.
//@ use lib/surface
//@ use lib/glass
//@ use lib/finish_atlas
//@ use lib/material_atlas

// What the atlas says of what passes through a primitive.
struct TransmissionRecord {
    red: f32, // fraction of light that passes straight on, behind its thickness
    green: f32,
    blue: f32,
    amount: f32, // fraction that its color does not scatter
    is_opaque: u32, // 1: its alpha covers all; 2: its alpha is how much passes
}

const TRANSMISSION_WORDS = 5u;

// Of the primitive whose record begins at this word.
fn transmission_record(record: u32) -> TransmissionRecord {
    let first = (atlas_word(record) >> FINISH_SHIFT) - TRANSMISSION_WORDS;
    return TransmissionRecord(
        atlas_float(first), atlas_float(first + 1u), atlas_float(first + 2u), atlas_float(first + 3u), atlas_word(first + 4u));
}

// The layer of a shaded surface: what its color does not cover, and what passes through the rest and is not reflected.
fn transmission_layer(s: Surface) -> GlassLayer {
    let layer = glass_blended(s);
    let slant = 1.0 - min(abs(dot(s.normal, s.view)), 1.0);
    let squared = slant * slant;
    let reflected = mix(s.finish.specular.rgb, vec3f(s.finish.specular.a), squared * squared * slant);
    let passed = clamp(s.passed * (1.0 - reflected), vec3f(0.0), vec3f(1.0));
    return GlassLayer(layer.passed + passed * clamp(s.color.a, 0.0, 1.0), layer.added);
}
