// How a material reflects light, in the terms of glTF 2.0. Mirrors `effects::hooks::Finish`, which explains each member.

struct Finish {
    specular: vec4f,
    metallic: f32,
    roughness: f32,
    occlusion: f32,
}
