// Functions of the kind that people bring along: hashes, noise, distances, palettes, bits. None calls another by name, so that any
// of them can be taken. Above each, the largest magnitude of its result.

//@ cell_noise 1.0
fn cell_hash(cell: vec2f) -> f32 {
    let at = bitcast<vec2u>(vec2i(cell));
    return hash_unit(at.x * 1597u + at.y * 51749u);
}

fn cell_noise(p: vec2f) -> f32 {
    let i = floor(p);
    let f = fract(p);
    let u = f * f * (3.0 - 2.0 * f);
    let a = cell_hash(i);
    let b = cell_hash(i + vec2f(1.0, 0.0));
    let c = cell_hash(i + vec2f(0.0, 1.0));
    let d = cell_hash(i + vec2f(1.0, 1.0));
    return mix(mix(a, b, u.x), mix(c, d, u.x), u.y);
}

//@ fractal 2.0
const FRACTAL_TURN = mat2x2f(0.8, 0.6, -0.6, 0.8);

fn fractal_octave(p: vec2f) -> f32 {
    return 0.5 + 0.25 * (sin(p.x * 1.7 + 0.3) + sin(p.y * 1.3 - 0.8));
}

fn fractal(p: vec2f, octaves: u32) -> f32 {
    var sum = 0.0;
    var amplitude = 0.5;
    var q = p;
    for (var i = 0u; i < min(octaves, 4u); i++) {
        sum += amplitude * fractal_octave(q);
        q = FRACTAL_TURN * q * 2.0 + vec2f(0.13, -0.41);
        amplitude *= 0.5;
    }
    return sum;
}

//@ cosine_palette 1.0
fn cosine_palette(t: f32) -> vec3f {
    let a = vec3f(0.5, 0.5, 0.5);
    let b = vec3f(0.5, 0.5, 0.5);
    let c = vec3f(1.0, 1.0, 1.0);
    let d = vec3f(0.00, 0.33, 0.67);
    return a + b * cos(6.28318 * (c * t + d));
}

//@ hue 1.0
fn hue(h: f32, s: f32) -> vec3f {
    let k = vec4f(1.0, 2.0 / 3.0, 1.0 / 3.0, 3.0);
    let p = abs(fract(vec3f(h) + k.xyz) * 6.0 - k.www);
    return mix(k.xxx, clamp(p - k.xxx, vec3f(0.0), vec3f(1.0)), clamp(s, 0.0, 1.0));
}

//@ box_distance 12.0
fn box_distance(p: vec2f, side: f32) -> f32 {
    let half_size = vec2f(0.3, 0.2) * (1.0 + side * 0.1);
    let d = abs(p) - half_size;
    return length(max(d, vec2f())) + min(max(d.x, d.y), 0.0);
}

//@ hexagon_distance 12.0
fn hexagon_distance(point: vec2f) -> f32 {
    const k = vec3f(-0.866025404, 0.5, 0.577350269);
    const r = 0.4;
    var p = abs(point);
    p -= 2.0 * min(dot(k.xy, p), 0.0) * k.xy;
    p -= vec2f(clamp(p.x, -k.z * r, k.z * r), r);
    return length(p) * sign(p.y);
}

//@ smooth_union 16.0
fn smooth_union(a: f32, b: f32) -> f32 {
    const K = 0.25;
    let h = max(K - abs(a - b), 0.0) / K;
    return min(a, b) - h * h * K * (1.0 / 4.0);
}

//@ marched 8.0
const MARCH_STEPS = 12;
const MARCH_CENTERS = array<vec3f, 2>(vec3f(0.0, 0.0, 3.0), vec3f(0.7, 0.2, 2.5));

struct MarchHit { distance_m: f32, id: u32 }

fn march_nearer(a: MarchHit, b: MarchHit) -> MarchHit {
    if a.distance_m < b.distance_m { return a; }
    return b;
}

fn march_map(p: vec3f) -> MarchHit {
    let sphere = MarchHit(length(p - MARCH_CENTERS[0]) - 1.0, 1u);
    var box: MarchHit;
    box.distance_m = length(p - MARCH_CENTERS[1]) - 0.5;
    box.id = 2u;
    return march_nearer(sphere, box);
}

fn marched(direction: vec3f) -> f32 {
    let ray = direction / (length(direction) + 1.0);
    var t = 0.0;
    for (var i = 0; i < MARCH_STEPS; i += 1) {
        let hit = march_map(ray * t);
        if t > 6.0 { break; }
        t += clamp(hit.distance_m, 0.05, 0.8) * 0.7;
    }
    return clamp(t, 0.0, 7.0);
}

//@ voronoi 2.0
fn voronoi(p: vec2f) -> f32 {
    let cell = floor(p);
    let inside = fract(p);
    var nearest = 8.0;
    for (var y: i32 = -1; y <= 1; y++) {
        for (var x: i32 = -1; x <= 1; x++) {
            let neighbor = vec2f(f32(x), f32(y));
            let key = vec2i(cell + neighbor);
            let point = vec2f(hash_unit(u32(key.x) * 3u + u32(key.y) * 7919u), 0.5) * 0.8;
            nearest = min(nearest, distance(neighbor + point, inside));
        }
    }
    return min(nearest, 2.0);
}

//@ banded 1.0
fn banded(t: f32) -> vec3f {
    switch i32(floor(abs(t) * 4.0)) % 5 {
        case 0: { return vec3f(0.9, 0.3, 0.2); }
        case 1, 3: { return vec3f(0.2, 0.5, 0.9); }
        case 2: {
            let gray = vec3f(0.5);
            return gray * gray;
        }
        default: { return vec3f(1.0, 0.9, 0.4).zyx; }
    }
}

//@ bayer 1.0
const BAYER = array<u32, 16>(0u, 8u, 2u, 10u, 12u, 4u, 14u, 6u, 3u, 11u, 1u, 9u, 15u, 7u, 13u, 5u);

fn bayer(x: u32, y: u32) -> f32 {
    return f32(BAYER[(x & 3u) + 4u * (y & 3u)]) / 16.0;
}

//@ half_words 8.0
fn half_words(v: vec2f) -> vec2f {
    let word = pack2x16float(v);
    let low = word & 0xffffu;
    let high = extractBits(word, 16u, 16u);
    return unpack2x16float(low | (high << 16u));
}

//@ byte_words 1.0
fn byte_words(v: vec4f) -> vec4f {
    let word = pack4x8unorm(clamp(v, vec4f(0.0), vec4f(1.0)));
    let turned = (word >> 8u) | (word << 24u);
    return unpack4x8unorm(turned ^ 0u);
}

//@ xorshift 1.0
fn xorshift(seed: u32) -> f32 {
    var x = seed * 747796405u + 2891336453u;
    x ^= x << 13u;
    x ^= x >> 17u;
    x ^= x << 5u;
    return f32(x & 0xffffu) / 65535.0;
}

//@ turned 24.0
fn turned(p: vec2f, angle: f32) -> vec2f {
    let c = cos(angle);
    let s = sin(angle);
    let m = mat2x2f(c, -s, s, c);
    return m * p;
}

//@ graded 1.0
const GRADE = mat3x3f(
    0.393, 0.349, 0.272,
    0.769, 0.686, 0.534,
    0.189, 0.168, 0.131,
);

fn graded(color: vec3f) -> vec3f {
    let inverse_grade = transpose(GRADE);
    let both = GRADE * inverse_grade;
    let c = GRADE * clamp(color, vec3f(), vec3f(1.0)) + both[1] * 0.01 + vec3f(both[0][2], GRADE[1].y, 0.0) * 0.1;
    return clamp(c, vec3f(0.0), vec3f(1.0));
}

//@ accumulated 8.0
fn accumulate(sum: ptr<function, f32>, x: f32) {
    *sum += x;
}

fn accumulated(x: f32, count: u32) -> f32 {
    var sum = 0.0;
    var i = 0u;
    loop {
        if i >= min(count, 6u) { break; }
        accumulate(&sum, sin(x + f32(i)));
        continuing {
            i += 1u;
            break if i == 5u;
        }
    }
    return sum;
}

//@ posterized 1.0
fn posterized(color: vec3f, levels: u32) -> vec3f {
    let n = f32(max(levels, 2u));
    return floor(clamp(color, vec3f(0.0), vec3f(1.0)) * n + 0.5) / n;
}

//@ gradient 1.0
fn gradient(t: f32) -> vec3f {
    var stops = array<vec3f, 4>(vec3f(0.05, 0.1, 0.2), vec3f(0.3, 0.2, 0.6), vec3f(0.9, 0.5, 0.3), vec3f(1.0));
    let x = clamp(t, 0.0, 1.0) * 3.0;
    let i = min(u32(x), 2u);
    return mix(stops[i], stops[i + 1], x - f32(i));
}

//@ toned 1.0
fn toned(x: vec3f) -> vec3f {
    let a = 2.51;
    let b = 0.03;
    let c = 2.43;
    let d = 0.59;
    let e = 0.14;
    let y = abs(x);
    return clamp((y * (a * y + b)) / (y * (c * y + d) + e), vec3f(0), vec3f(1));
}

//@ rim 1.0
fn rim(normal: vec3f, view: vec3f) -> f32 {
    let facing = 1.0 - clamp(dot(normal, view), 0.0, 1.0);
    if facing < 0.2 {
        return 0.0;
    } else if facing > 0.9 {
        return 1.0;
    }
    return smoothstep(0.2, 0.9, facing);
}

//@ sine_hash 1.0
fn sine_hash(p: vec2f) -> f32 {
    return fract(sin(dot(floor(p * 20.0), vec2f(12.9898, 78.233))) * 43758.5453);
}

//@ checker 1.0
fn checker(p: vec2f) -> f32 {
    let q = vec2i(floor(p));
    return select(0.2, 0.8, ((q.x ^ q.y) & 1) == 0);
}
