// Surroundings: what an effect shows of an environment: a formula, or the picture that comes with the scene.
// Chosen by the scene: picture where it has one and an effect shows what surrounds it. Default: formulas.
//
// `sky` is the formula of the environment. Light that a white matt surface with this normal shows.
//@ declare fn surroundings_irradiance(environment: u32, sky: Environment, normal: vec3f) -> vec3f
// What a mirror of this roughness shows in a direction.
//@ declare fn surroundings_radiance(environment: u32, sky: Environment, d: vec3f, alpha: f32) -> vec3f

//@ variant formulas
//@ use lib/environment

fn surroundings_irradiance(environment: u32, sky: Environment, normal: vec3f) -> vec3f {
    return environment_irradiance(sky, normal);
}

fn surroundings_radiance(environment: u32, sky: Environment, d: vec3f, alpha: f32) -> vec3f {
    return environment_radiance(sky, d, alpha);
}

//@ variant picture
//@ use lib/environment
//@ use lib/panorama

// Number of the environment that is the picture.
const SURROUNDINGS_PICTURE = 4u;

fn surroundings_irradiance(environment: u32, sky: Environment, normal: vec3f) -> vec3f {
    if environment == SURROUNDINGS_PICTURE { return panorama_irradiance(normal); }
    return environment_irradiance(sky, normal);
}

fn surroundings_radiance(environment: u32, sky: Environment, d: vec3f, alpha: f32) -> vec3f {
    if environment == SURROUNDINGS_PICTURE { return panorama_radiance(d, alpha); }
    return environment_radiance(sky, d, alpha);
}
