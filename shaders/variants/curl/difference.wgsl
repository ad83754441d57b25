// Curl noise, difference: from central differences of lattice noise.
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
