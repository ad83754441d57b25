// Noise: smooth random numbers in space, of integer hashes at whole coordinates, so that all adapters and the oracle agree on every hash.
// Another seed gives another noise. Coordinates are held within NOISE_FARTHEST; f32 has few places between whole numbers far out.

const NOISE_FARTHEST = 4194304.0;

// Three hashed words at whole coordinates ("pcg3d" of Jarzynski and Olano, 2020).
fn noise_hash(cell: vec3i, seed: u32) -> vec3u {
    var v = (vec3u(cell) + vec3u(seed * 0x9e3779b9u)) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// A word as a number in [0, 1) with 24 bits, exact.
fn noise_unit(word: u32) -> f32 {
    return f32(word >> 8u) / 16777216.0;
}

// The whole coordinates at or below a place.
fn noise_cell(at: vec3f) -> vec3i {
    return vec3i(floor(clamp(at, vec3f(-NOISE_FARTHEST), vec3f(NOISE_FARTHEST))));
}

// From 0 to 1 with slope and curvature 0 at both ends.
fn noise_fade(t: vec3f) -> vec3f {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

fn noise_corner_value(cell: vec3i, seed: u32) -> f32 {
    return noise_unit(noise_hash(cell, seed).x);
}

// Value noise: random numbers at whole coordinates, smooth between them. 0 to 1.
fn noise_value(at: vec3f, seed: u32) -> f32 {
    let cell = noise_cell(at);
    let t = noise_fade(at - vec3f(cell));
    let along = vec4f(
        mix(noise_corner_value(cell, seed), noise_corner_value(cell + vec3i(1, 0, 0), seed), t.x),
        mix(noise_corner_value(cell + vec3i(0, 1, 0), seed), noise_corner_value(cell + vec3i(1, 1, 0), seed), t.x),
        mix(noise_corner_value(cell + vec3i(0, 0, 1), seed), noise_corner_value(cell + vec3i(1, 0, 1), seed), t.x),
        mix(noise_corner_value(cell + vec3i(0, 1, 1), seed), noise_corner_value(cell + vec3i(1, 1, 1), seed), t.x),
    );
    let across = mix(along.xz, along.yw, vec2f(t.y));
    return mix(across.x, across.y, t.z);
}

// Height above a plane through a whole coordinate, which rises towards one of the twelve edges of a cube.
fn noise_slope(word: u32, away: vec3f) -> f32 {
    let signs = 1.0 - 2.0 * vec2f(f32(word & 1u), f32((word >> 1u) & 1u));
    let axis = (word >> 2u) % 3u;
    let pair = select(select(away.xy, away.xz, axis == 1u), away.yz, axis == 2u);
    return dot(signs, pair);
}

fn noise_corner_slope(cell: vec3i, corner: vec3i, part: vec3f, seed: u32) -> f32 {
    return noise_slope(noise_hash(cell + corner, seed).x >> 8u, part - vec3f(corner));
}

// Gradient noise (Perlin, 2002): 0 at whole coordinates, smooth between them. -1 to 1, mostly within 0.6.
fn noise_gradient(at: vec3f, seed: u32) -> f32 {
    let cell = noise_cell(at);
    let part = at - vec3f(cell);
    let t = noise_fade(part);
    let along = vec4f(
        mix(noise_corner_slope(cell, vec3i(0, 0, 0), part, seed), noise_corner_slope(cell, vec3i(1, 0, 0), part, seed), t.x),
        mix(noise_corner_slope(cell, vec3i(0, 1, 0), part, seed), noise_corner_slope(cell, vec3i(1, 1, 0), part, seed), t.x),
        mix(noise_corner_slope(cell, vec3i(0, 0, 1), part, seed), noise_corner_slope(cell, vec3i(1, 0, 1), part, seed), t.x),
        mix(noise_corner_slope(cell, vec3i(0, 1, 1), part, seed), noise_corner_slope(cell, vec3i(1, 1, 1), part, seed), t.x),
    );
    let across = mix(along.xz, along.yw, vec2f(t.y));
    return clamp(0.96 * mix(across.x, across.y, t.z), -1.0, 1.0);
}

fn noise_bump(cell: vec3i, away: vec3f, seed: u32) -> f32 {
    let weight = max(0.5 - dot(away, away), 0.0);
    return weight * weight * weight * weight * noise_slope(noise_hash(cell, seed).x >> 8u, away);
}

// Simplex noise: as gradient noise, of the four corners of a tetrahedron, without its axes. -1 to 1, mostly within 0.7.
fn noise_simplex(at: vec3f, seed: u32) -> f32 {
    let cell = noise_cell(at + (at.x + at.y + at.z) / 3.0);
    // Places from corners: a step along all three axes of the cells leads along (1/2, 1/2, 1/2).
    let away = at - (vec3f(cell) - f32(cell.x + cell.y + cell.z) / 6.0);
    // The longest part comes first, the shortest last; where two are equal, both ways around give the same.
    let is_first = vec3f(f32(away.x >= away.y && away.x >= away.z), f32(away.y > away.x && away.y >= away.z), f32(away.z > away.x && away.z > away.y));
    let is_last = vec3f(f32(away.x < away.y && away.x < away.z), f32(away.y <= away.x && away.y < away.z), f32(away.z <= away.x && away.z <= away.y));
    let second = vec3i(is_first);
    let third = vec3i(1.0 - is_last);
    let sum = noise_bump(cell, away, seed)
        + noise_bump(cell + second, away - is_first + 0.16666666666666666, seed)
        + noise_bump(cell + third, away - (1.0 - is_last) + 0.3333333333333333, seed)
        + noise_bump(cell + vec3i(1), away - 0.5, seed);
    return clamp(74.0 * sum, -1.0, 1.0);
}

// Cellular noise (Worley, 1996), of one random point in every cell: the distance to the nearest one, that to the second, both at most 1,
// and a random number in [0, 1) of the nearest one.
fn noise_cellular(at: vec3f, seed: u32) -> vec3f {
    let cell = noise_cell(at);
    let part = at - vec3f(cell);
    // Points of cells that are not looked at are farther than 1.
    var found = vec3f(1.0, 1.0, 0.0);
    for (var i = 0; i < 27; i += 1) {
        let offset = vec3i(i % 3, (i / 3) % 3, i / 9) - 1;
        let words = noise_hash(cell + offset, seed);
        let point = vec3f(offset) + vec3f(noise_unit(words.x), noise_unit(words.y), noise_unit(words.z));
        let distance = length(point - part);
        if distance < found.x {
            found = vec3f(distance, found.x, noise_unit(words.z * 0x9e3779b9u));
        } else {
            found.y = min(found.y, distance);
        }
    }
    return found;
}

// Gradient noise in layers, each twice as fine and half as high as the one before. -1 to 1. At most 8 layers.
fn noise_layers(at: vec3f, layers: u32, seed: u32) -> f32 {
    var sum = 0.0;
    var most = 0.0;
    var height = 1.0;
    var place = at;
    for (var i = 0u; i < clamp(layers, 1u, 8u); i += 1u) {
        sum += height * noise_gradient(place, seed + i);
        most += height;
        height *= 0.5;
        place *= 2.0;
    }
    return sum / most;
}
