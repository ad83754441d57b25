//! The perturbations under which a picture is shaded to find what an f32 renderer may draw.

use std::sync::LazyLock;

use glam::DVec3;

use super::{
    super::perturbation::{Perturbation, PlacePerturbation, TexturePerturbation},
    surface::{Doubt, SampleErrors},
};
use crate::{
    effects::{Stack, hooks::Layers},
    scene::{Scene, view::View},
};

/// How far from a step a value may lie for both sides to be right; values are about 1 at most.
/// 2^-15: a shade takes some 2^7 operations that err by 2^-23 each, if all err alike; the rest is
/// for `pow` and for weights that cancel.
pub const STEP: f64 = 1.0 / (1 << 15) as f64;

/// All texture perturbations, none first.
const TEXTURE: [TexturePerturbation; 5] = [
    [0.0; 3],
    [1.0; 3],
    [-1.0; 3],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, -1.0],
];

/// Roundings of a place, of 2^-24 each: the depth is a quotient of sums of three products, and the
/// place a sum of four.
const ROUNDINGS: f64 = 16.0;

/// All perturbations of places.
const PLACES: [PlacePerturbation; 8] = {
    let mut places = [[0.0; 4]; 8];
    let mut axis = 0;
    while axis < 4 {
        places[2 * axis][axis] = ROUNDINGS;
        places[2 * axis + 1][axis] = -ROUNDINGS;
        axis += 1;
    }
    places
};

/// From so far away that the depth of the scene is less than this fraction of the distances that
/// are added, the places of layers are perturbed.
const FAR: f64 = 1.0 / 256.0;

/// In error bounds. A normal errs by a vector of at most one bound, and the depth by at most one
/// beside it. To first order that changes a color by at most √3 + 1 times as much as the one of
/// these four numbers that matters most does alone.
const INTERPOLATED: f64 = 2.75;

/// All perturbations of what is interpolated, where colors change in proportion: of the normal in
/// x, y and z, and of the depth, each in error bounds.
const INTERPOLATIONS: [[f64; 4]; 8] = {
    let mut interpolations = [[0.0; 4]; 8];
    let mut axis = 0;
    while axis < 4 {
        interpolations[2 * axis][axis] = INTERPOLATED;
        interpolations[2 * axis + 1][axis] = -INTERPOLATED;
        axis += 1;
    }
    interpolations
};

/// Depths within their interval. A color that changes periodically with the place, like that of
/// lines on a surface, may be darker or brighter there than at the ends of the interval. In powers
/// too, because an error may be a multiple of the depth.
static STRETCHES: LazyLock<Vec<[f64; 4]>> = LazyLock::new(|| {
    let even = (1..32).map(|i| f64::from(i) / 32.0);
    let powers = (0..24).map(|i| 1.1 * 0.5f64.powi(i));
    even.chain(powers)
        .flat_map(|stretch| [stretch, -stretch])
        .map(|stretch| [0.0, 0.0, 0.0, stretch])
        .collect()
});

/// Perturbations of what is interpolated where colors do not change in proportion: normals all over
/// the cone in which they lie, depths all over their interval, and both together.
static WIDE_INTERPOLATIONS: LazyLock<Vec<[f64; 4]>> = LazyLock::new(|| {
    const DIRECTIONS: u32 = 96;
    // Interval of a direction in z, and the golden angle: directions that are evenly spread on a
    // sphere.
    let direction = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(DIRECTIONS);
        let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    let turns = (0..DIRECTIONS).flat_map(|i| [0.4, 1.1].map(|length| direction(i) * length));
    let turned =
        turns.flat_map(|turn| [0.0, 1.1, -1.1].map(|stretch| [turn.x, turn.y, turn.z, stretch]));
    turned.chain(STRETCHES.iter().copied()).collect()
});

/// Perturbations of the color that a triangle's corners mix, in error bounds: every channel at
/// either end of its interval. What follows from it, ever brighter or ever darker as a channel
/// grows, is extreme at one of these. Alpha is mixed with no channel.
const TINTS: [[f64; 4]; 8] = {
    let mut tints = [[-1.0; 4]; 8];
    let mut i = 0;
    while i < 8 {
        let mut channel = 0;
        while channel < 3 {
            if i >> channel & 1 == 1 {
                tints[i][channel] = 1.0;
            }
            channel += 1;
        }
        tints[i][3] = tints[i][0];
        i += 1;
    }
    tints
};

/// Those of all channels alike. Beside perturbations that are too many for all.
const EVEN_TINTS: [[f64; 4]; 2] = [TINTS[0], TINTS[7]];

/// Of a color that does not err.
const NO_TINT: [[f64; 4]; 1] = [[0.0; 4]];

/// How far answers between [`WIDE_INTERPOLATIONS`] may lie outside theirs, as a fraction of their
/// span.
pub const WIDE_SLACK: f64 = 0.25;

/// Perturbations of color steps, none first.
pub fn color_steps(stack: &Stack) -> &'static [f64] {
    // Layers are summed in linear light, and gamma encoding, which is 13 times as steep in the
    // dark, precedes a step.
    const LAYERS: f64 = 4.0 * STEP;
    match (stack.has_steps(), stack.layers(0)) {
        (false, _) => &[0.0],
        (true, None | Some(Layers::Race)) => &[0.0, -STEP, STEP],
        (true, Some(Layers::Xray { .. } | Layers::Overdraw | Layers::Glass)) => {
            &[0.0, -LAYERS, LAYERS]
        }
    }
}

/// Perturbations that a whole picture of `scene` is shaded with: of texture lookups, for each
/// perturbation of color steps; none first.
pub fn of_pictures(scene: &Scene, stack: &Stack) -> Vec<Perturbation> {
    let textures = if scene.images.is_empty() {
        &TEXTURE[..1]
    } else {
        &TEXTURE[..]
    };
    let at_step = |&color_step: &f64| {
        textures.iter().map(move |&texture| Perturbation {
            texture,
            color_step,
            ..Perturbation::default()
        })
    };
    color_steps(stack).iter().flat_map(at_step).collect()
}

/// Perturbations of layers: those of pictures, none first, and those of places in views from far
/// away.
///
/// Samples of layers are too many to perturb the places of all; from near by their roundings are
/// not seen in averages.
pub fn of_layers(scene: &Scene, view: &View, stack: &Stack) -> Vec<Perturbation> {
    let [near_m, far_m] = view.depth_range_m;
    let is_far = far_m - near_m < FAR * (view.eye.abs().max_element() + far_m.abs());
    of_pictures(scene, stack)
        .into_iter()
        .chain(places(stack).filter(|_| is_far))
        .collect()
}

/// Perturbations of the place of a sample, for each perturbation of color steps. They are seen in
/// colors that change with the place, like fog, where coordinates are large.
pub fn places(stack: &Stack) -> impl Iterator<Item = Perturbation> {
    let at_step = |&color_step: &f64| {
        PLACES.iter().map(move |&place| Perturbation {
            place,
            color_step,
            ..Perturbation::default()
        })
    };
    color_steps(stack).iter().flat_map(at_step)
}

/// Perturbations of texture lookups within their bounds, for each perturbation of color steps:
/// across and down by these offsets, and in the level of detail by the whole bound. None without
/// images.
pub fn textures(
    scene: &Scene,
    stack: &Stack,
    [across, down]: &[Vec<f64>; 2],
) -> impl Iterator<Item = Perturbation> {
    let levels: &[f64] = if scene.images.is_empty() {
        &[]
    } else {
        &[0.0, 1.0, -1.0]
    };
    let at_step = move |&color_step: &f64| {
        levels.iter().flat_map(move |&level| {
            across.iter().flat_map(move |&across| {
                down.iter().map(move |&down| Perturbation {
                    texture: [across, down, level],
                    color_step,
                    ..Perturbation::default()
                })
            })
        })
    };
    color_steps(stack).iter().flat_map(at_step)
}

/// How many perturbations are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Those to which colors answer in proportion.
    Quick,
    /// All of them.
    Wide,
}

/// Perturbations of what is interpolated with these errors, for each perturbation of color steps.
pub fn interpolations(
    stack: &Stack,
    errors: SampleErrors,
    search: Search,
) -> impl Iterator<Item = Perturbation> {
    let (few, many): (&[[f64; 4]], &[[f64; 4]]) = match errors.doubt() {
        Doubt::None => (&[], &[]),
        Doubt::Narrow if search == Search::Quick => (&INTERPOLATIONS, &[]),
        Doubt::Wide if search == Search::Quick => (&[], &[]),
        Doubt::Narrow => (&INTERPOLATIONS, STRETCHES.as_slice()),
        Doubt::Wide => (&[], WIDE_INTERPOLATIONS.as_slice()),
    };
    // The color may err by its bound whatever the normal and the depth err by, and alone.
    let is_doubtful = errors.has_doubtful_color();
    let alone: &[[f64; 4]] = if is_doubtful { &[[0.0; 4]] } else { &[] };
    let (tints, even_tints): (&[[f64; 4]], &[[f64; 4]]) = if is_doubtful {
        (&TINTS, &EVEN_TINTS)
    } else {
        (&NO_TINT, &NO_TINT)
    };
    let each = |offsets: &'static [[f64; 4]], tints: &'static [[f64; 4]]| {
        offsets
            .iter()
            .flat_map(move |&offset| tints.iter().map(move |&tint| errors.times(offset, tint)))
    };
    let interpolated = each(alone, tints)
        .chain(each(few, tints))
        .chain(each(many, even_tints))
        .chain(errors.edge_distances().into_iter().flatten());
    let at_step = move |&color_step: &f64| {
        interpolated.clone().map(move |interpolated| Perturbation {
            color_step,
            interpolated,
            ..Perturbation::default()
        })
    };
    color_steps(stack).iter().flat_map(at_step)
}

#[cfg(test)]
mod tests {
    use super::{STEP, color_steps};
    use crate::effects::{EFFECTS, Stack};

    #[test]
    fn steps_are_wider_only_where_layers_are_summed() {
        let steps = |names: &[&str]| {
            let mut stack = Stack::default();
            for effect in EFFECTS
                .iter()
                .filter(|effect| names.contains(&&*effect.name))
            {
                stack.enable(effect);
            }
            color_steps(&stack)
        };
        let usual = &[0.0, -STEP, STEP];
        assert_eq!(steps(&["posterize"]), usual);
        assert_eq!(steps(&["posterize", "race"]), usual);
        assert_eq!(steps(&["posterize", "xray"])[2], 4.0 * STEP);
        assert_eq!(steps(&["lambert", "race"]), &[0.0]);
    }
}
