// Curl noise: a velocity field without sources or sinks, the curl of lattice noise.
// Chosen by the accuracy axis `curl_noise`. Default: analytic.
//
// Curl at a point, in units of the lattice; `salt` selects one of many fields.
//@ declare fn curl_noise(q: vec3f, salt: u32) -> vec3f

//@ variant analytic
// From the exact derivatives of lattice noise.
//@ use lib/hash
//@ use lib/lattice

fn curl_noise(q: vec3f, salt: u32) -> vec3f {
    let corner = floor(q);
    let t = q - corner;
    let at = bitcast<vec3u>(vec3i(corner));
    let w = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let slope = 30.0 * t * t * (t - 1.0) * (t - 1.0);

    let low = hash(at.x + salt);
    let high = hash(at.x + 1u + salt);
    let v00 = lattice_pair(hash(low + at.y), at.z);
    let v01 = lattice_pair(hash(low + at.y + 1u), at.z);
    let v10 = lattice_pair(hash(high + at.y), at.z);
    let v11 = lattice_pair(hash(high + at.y + 1u), at.z);

    // Blended along z first: values, and their differences.
    let b00 = mix(v00[0], v00[1], w.z);
    let b01 = mix(v01[0], v01[1], w.z);
    let b10 = mix(v10[0], v10[1], w.z);
    let b11 = mix(v11[0], v11[1], w.z);
    let d0 = mix(v00[1] - v00[0], v01[1] - v01[0], w.y);
    let d1 = mix(v10[1] - v10[0], v11[1] - v11[0], w.y);
    let by_x = slope.x * mix(b10 - b00, b11 - b01, w.y);
    let by_y = slope.y * mix(b01 - b00, b11 - b10, w.x);
    let by_z = slope.z * mix(d0, d1, w.x);
    return vec3f(by_y.z - by_z.y, by_z.x - by_x.z, by_x.y - by_y.x);
}

//@ variant difference
// From central differences of lattice noise.
//@ use lib/hash
//@ use lib/lattice

const CURL_STEP = 0.0078125; // 1/128 of the lattice

fn curl_noise(q: vec3f, salt: u32) -> vec3f {
    let x = vec3f(CURL_STEP, 0.0, 0.0);
    let by_x = (curl_potential(q + x, salt) - curl_potential(q - x, salt)) / (2.0 * CURL_STEP);
    let by_y = (curl_potential(q + x.yxz, salt) - curl_potential(q - x.yxz, salt)) / (2.0 * CURL_STEP);
    let by_z = (curl_potential(q + x.yzx, salt) - curl_potential(q - x.yzx, salt)) / (2.0 * CURL_STEP);
    return vec3f(by_y.z - by_z.y, by_z.x - by_x.z, by_x.y - by_y.x);
}

fn curl_potential(q: vec3f, salt: u32) -> vec3f {
    let corner = floor(q);
    let t = q - corner;
    let at = bitcast<vec3u>(vec3i(corner));
    let w = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let low = hash(at.x + salt);
    let high = hash(at.x + 1u + salt);
    let v00 = lattice_pair(hash(low + at.y), at.z);
    let v01 = lattice_pair(hash(low + at.y + 1u), at.z);
    let v10 = lattice_pair(hash(high + at.y), at.z);
    let v11 = lattice_pair(hash(high + at.y + 1u), at.z);
    let b0 = mix(mix(v00[0], v00[1], w.z), mix(v01[0], v01[1], w.z), w.y);
    let b1 = mix(mix(v10[0], v10[1], w.z), mix(v11[0], v11[1], w.z), w.y);
    return mix(b0, b1, w.x);
}
