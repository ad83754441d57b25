// Film: interference colors of a thin film, as on a soap bubble, on oil, or on steel that was hot.
//
// Light is reflected at both faces of a film. Where the two reflections arrive in step, a wavelength is bright; half a wave out of
// step, it is gone. What decides is the path inside the film against the wavelength, so the color changes with thickness and angle.
//@ use lib/surface
//@ use lib/angle

struct Film {
    /// Color of the metal below the film.
    @color(0.02, 0.022, 0.03) metal: vec4f,
    /// Thickness of the film where it is thinnest.
    @range(0, 1000, 90) @hard(0, 5000) @unit(nm) thin_nm: f32,
    /// How much thicker it is where it is thickest.
    @range(0, 1000, 260) @hard(0, 5000) @unit(nm) varies_nm: f32,
    /// Size of the swirls in which the thickness varies.
    @range(0.1, 10, 1.6) @hard(0.01, 1000) @unit(m) @log swirl_m: f32,
    /// How far the swirls have drifted. One turn returns to the beginning.
    @range(0, 1, 0) drift: f32,
    /// Refractive index: 1.33 is water, 2.4 the oxide of titanium.
    @range(1, 2.5, 1.45) index: f32,
    /// Brightness of the lamps that the surface mirrors.
    @range(0, 4, 1.6) @hard(0, 100) lamps: f32,
}

// Wavelengths that stand for red, green and blue.
const WAVES_NM = vec3f(640.0, 540.0, 450.0);

// Thickness of the film, 0 to 1: waves along waves. `sine_turns` is accurate to the last bits of an f32; the sin() of WGSL is not.
fn swirl(position: vec3f, p: Film) -> f32 {
    let at = position / p.swirl_m;
    let bent = at.x + 0.35 * sine_turns(0.9 * at.y + 0.4 * at.z + p.drift) + 0.2 * sine_turns(1.7 * at.z - 0.6 * at.x);
    return 0.5 + 0.5 * sine_turns(bent + 0.5 * at.y - p.drift);
}

// A studio as the surface mirrors it: a wide lamp overhead, a narrow one at the side, a pale floor.
fn studio(toward: vec3f) -> vec3f {
    let overhead = smoothstep(0.45, 0.8, toward.y + 0.25 * toward.z);
    let side = (1.0 - smoothstep(0.03, 0.1, abs(toward.x + 0.72))) * smoothstep(-0.7, -0.2, toward.y);
    let pale = 0.1 * (1.0 - smoothstep(-0.9, 0.1, toward.y));
    return vec3f(1.0, 0.96, 0.9) * overhead + vec3f(0.75, 0.87, 1.0) * side + vec3f(0.12 + pale);
}

fn film(surface: Surface, p: Film) -> Surface {
    var s = surface;
    let facing = clamp(dot(s.normal, s.view), 0.0, 1.0);
    // Snell's law; the index is at least 1, so the root is of no negative number.
    let inside = sqrt(max(1.0 - (1.0 - facing * facing) / (p.index * p.index), 0.0));
    let path_nm = 2.0 * p.index * inside * (p.thin_nm + p.varies_nm * swirl(s.position, p));
    let turns = path_nm / WAVES_NM;
    let cosines = vec3f(cosine_turns(turns.x), cosine_turns(turns.y), cosine_turns(turns.z));
    // One of the reflections loses half a wave, so a film without thickness is black.
    let color = 0.5 - 0.5 * cosines;
    // Seen edge-on, everything mirrors (Schlick).
    let grazing = (1.0 - facing) * (1.0 - facing) * (1.0 - facing);
    let mirrored = studio(2.0 * facing * s.normal - s.view) * p.lamps;
    s.color = vec4f(p.metal.rgb + mirrored * (color + (1.0 - color) * (0.6 * grazing)), s.color.a);
    return s;
}
