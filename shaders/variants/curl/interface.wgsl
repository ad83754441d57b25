// Curl noise: a velocity field without sources or sinks, the curl of lattice noise.
// Chosen by the accuracy axis `curl_noise`. Default: analytic.
//
// Curl at a point, in units of the lattice; `salt` selects one of many fields.
//@ declare fn curl_noise(q: vec3f, salt: u32) -> vec3f
