// Tonemap: fits light of any strength into what a screen shows.
//@ use lib/surface

struct Tonemap {
    /// The curve from light to what is shown.
    @choice(none, reinhard, neutral, aces, agx) @default(neutral) curve: u32,
    /// Exposure before the curve; each stop doubles the light.
    @range(-4, 4, 0) @hard(-16, 16) @unit(stops) exposure: f32,
    /// The background is exposed and mapped, too.
    @toggle(0) background: u32,
}

@smooth
fn tonemap(surface: Surface, p: Tonemap) -> Surface {
    var s = surface;
    let shown = tonemap_shown(s.color.rgb, p);
    // The part of the light that is emitted stays the same part.
    s.glow = shown * clamp(s.glow / max(s.color.rgb, vec3f(1e-6)), vec3f(0.0), vec3f(1.0));
    s.color = vec4f(shown, s.color.a);
    return s;
}

fn tonemap_shown(color: vec3f, p: Tonemap) -> vec3f {
    let light = max(color, vec3f(0.0)) * exp2(p.exposure);
    var shown = light;
    switch p.curve {
        case TONEMAP_CURVE_REINHARD: { shown = light / (light + 1.0); }
        case TONEMAP_CURVE_NEUTRAL: { shown = tonemap_neutral(light); }
        case TONEMAP_CURVE_ACES: { shown = tonemap_aces(light); }
        case TONEMAP_CURVE_AGX: { shown = tonemap_agx(light); }
        default: {}
    }
    return clamp(shown, vec3f(0.0), vec3f(1.0));
}

// Khronos PBR Neutral.
const TONEMAP_DIELECTRIC = 0.04;
const TONEMAP_COMPRESSED_FROM = 0.76;
const TONEMAP_COMPRESSED_ROOM = 0.24;
const TONEMAP_DESATURATION = 0.15;

fn tonemap_neutral(light: vec3f) -> vec3f {
    let least = min(min(light.r, light.g), light.b);
    let offset = select(TONEMAP_DIELECTRIC, least - least * least / (4.0 * TONEMAP_DIELECTRIC), least < 2.0 * TONEMAP_DIELECTRIC);
    let color = light - offset;
    let peak = max(max(color.r, color.g), color.b);
    if peak < TONEMAP_COMPRESSED_FROM { return color; }
    let room = TONEMAP_COMPRESSED_ROOM;
    let new_peak = 1.0 - room * room / (peak + room - TONEMAP_COMPRESSED_FROM);
    let whiteness = 1.0 - 1.0 / (TONEMAP_DESATURATION * (peak - new_peak) + 1.0);
    return mix(color * (new_peak / peak), vec3f(new_peak), whiteness);
}

// ACES as Hill fitted it: columns of the matrices.
const TONEMAP_ACES_IN = mat3x3f(vec3f(0.59719, 0.076, 0.0284), vec3f(0.35458, 0.90834, 0.13383), vec3f(0.04823, 0.01566, 0.83777));
const TONEMAP_ACES_OUT = mat3x3f(vec3f(1.60475, -0.10208, -0.00327), vec3f(-0.53108, 1.10813, -0.07276), vec3f(-0.07367, -0.00605, 1.07602));

fn tonemap_aces(light: vec3f) -> vec3f {
    // The same quotient for light up to 1e9, whose squares a float still holds.
    let v = min(TONEMAP_ACES_IN * light, vec3f(1e9));
    return TONEMAP_ACES_OUT * ((v * (v + 0.0245786) - 0.000090537) / (v * (v * 0.983729 + 0.432951) + 0.238081));
}

// AgX in linear Rec. 2020: columns of the matrices.
const TONEMAP_REC2020_OF_SRGB = mat3x3f(vec3f(0.6274, 0.0691, 0.0164), vec3f(0.3293, 0.9195, 0.0880), vec3f(0.0433, 0.0113, 0.8956));
const TONEMAP_SRGB_OF_REC2020 = mat3x3f(vec3f(1.6605, -0.1246, -0.0182), vec3f(-0.5876, 1.1329, -0.1006), vec3f(-0.0728, -0.0083, 1.1187));
const TONEMAP_AGX_IN =
    mat3x3f(vec3f(0.85662715, 0.13731897, 0.11189821), vec3f(0.09512124, 0.76124199, 0.07679942), vec3f(0.04825161, 0.10143904, 0.81130237));
const TONEMAP_AGX_OUT =
    mat3x3f(vec3f(1.12710058, -0.14132976, -0.14132976), vec3f(-0.11060664, 1.15782370, -0.11060664), vec3f(-0.01649394, -0.01649394, 1.25193641));
// The binary logarithm of light that becomes black, and the stops from there to white.
const TONEMAP_AGX_DARKEST = -12.47393;
const TONEMAP_AGX_STOPS = 16.5;

fn tonemap_agx(light: vec3f) -> vec3f {
    let inset = max(TONEMAP_AGX_IN * (TONEMAP_REC2020_OF_SRGB * light), vec3f(1e-10));
    let x = clamp((log2(inset) - TONEMAP_AGX_DARKEST) / TONEMAP_AGX_STOPS, vec3f(0.0), vec3f(1.0));
    let curved = (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232;
    return TONEMAP_SRGB_OF_REC2020 * pow(max(TONEMAP_AGX_OUT * curved, vec3f(1e-10)), vec3f(2.2));
}
