// Punctual lights: the lights that come with a scene. Mirrors `scene::punctual`, which explains each member, and
// `gpu::records::PunctualLightRecord`.

struct PunctualLight {
    light: vec4f, // linear RGB; the fourth is 1 if it shines from its position, 0 from infinitely far away
    position: vec4f, // world space, meters; the fourth is 1 / range
    toward: vec4f, // unit, against the direction in which it shines
    cone: vec2f,
    spare: vec2f,
}

@group(0) @binding(38) var<uniform> punctual_lights: array<PunctualLight, 16>;

// How many there are.
override PUNCTUAL_LIGHTS: u32 = 1u;

fn punctual_count() -> u32 {
    return PUNCTUAL_LIGHTS;
}

// Square of the nearest distance that makes a light stronger, meters.
const PUNCTUAL_NEAREST = 0.0001;

// The light of one source at a point.
struct PunctualArriving {
    toward: vec3f, // unit, to where it comes from
    light: vec3f, // what a white matt surface shows that faces it
}

fn punctual_arriving(i: u32, position: vec3f) -> PunctualArriving {
    let source = punctual_lights[i];
    if source.light.w == 0.0 { return PunctualArriving(source.toward.xyz, source.light.rgb); }
    let path = source.position.xyz - position;
    let squared = max(dot(path, path), PUNCTUAL_NEAREST);
    let toward = path / sqrt(squared);
    let reach = squared * source.position.w * source.position.w;
    let window = max(1.0 - reach * reach, 0.0);
    let cone = clamp(dot(source.toward.xyz, toward) * source.cone.x + source.cone.y, 0.0, 1.0);
    return PunctualArriving(toward, source.light.rgb * (window * cone * cone / squared));
}
