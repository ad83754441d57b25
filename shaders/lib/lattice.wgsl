// Lattice noise: three random numbers at every point with integer coordinates, each in (-1, 1) and exact.
//@ use lib/hash

fn lattice_numbers(word: u32) -> vec3f {
    let bits = (vec3u(word) >> vec3u(0u, 10u, 20u)) & vec3u(1023u);
    return vec3f(2u * bits + 1u) / 1024.0 - 1.0;
}

// The numbers of two points that differ only in z.
fn lattice_pair(column: u32, z: u32) -> mat2x3f {
    return mat2x3f(lattice_numbers(hash(column + z)), lattice_numbers(hash(column + z + 1u)));
}
