//! The perturbations under which a picture is shaded to find what an f32 renderer may draw.

use super::super::perturbation::{Perturbation, TexturePerturbation};
use crate::{
    effects::{Stack, hooks::Slot},
    scene::Scene,
};

/// How far from a step a value may lie for both sides to be right; values are about 1 at most. 2^-15: a shade takes some 2^7
/// operations that err by 2^-23 each, if all err alike; the rest is for `pow` and for weights that cancel.
pub const STEP: f64 = 1.0 / (1 << 15) as f64;

/// All texture perturbations, none first.
const TEXTURE: [TexturePerturbation; 5] = [[0.0; 3], [1.0; 3], [-1.0; 3], [1.0, -1.0, 1.0], [-1.0, 1.0, -1.0]];

/// Perturbations of color steps, none first.
pub fn color_steps(stack: &Stack) -> &'static [f64] {
    // Layers are summed in linear light, and gamma encoding, which is 13 times as steep in the dark, precedes a step.
    const LAYERS: f64 = 4.0 * STEP;
    match (stack.has_steps(), stack.in_slot(Slot::Visibility)) {
        (false, _) => &[0.0],
        (true, None) => &[0.0, -STEP, STEP],
        (true, Some(_)) => &[0.0, -LAYERS, LAYERS],
    }
}

/// All perturbations of a picture of `scene`, none first.
pub fn perturbations(scene: &Scene, stack: &Stack) -> Vec<Perturbation> {
    let textures = if has_textures(scene) { &TEXTURE[..] } else { &TEXTURE[..1] };
    let with_step = |&color_step: &f64| textures.iter().map(move |&texture| Perturbation { color_step, texture });
    color_steps(stack).iter().flat_map(with_step).collect()
}

/// Returns true if a picture looks up textures.
pub fn has_textures(scene: &Scene) -> bool {
    !scene.images.is_empty()
}
