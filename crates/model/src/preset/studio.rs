//! The studio: how a scene is shown that was opened plain. Its materials under lamps and a sun with
//! soft shadows, on a ground that fades into the background.

use super::{LengthUnit, Output, Preset, SceneSource};
use crate::{
    accuracy::{PinnedOptions, ShadowMapSize, ShadowTaps},
    effects::{Effect, Stack, shadow::Shadow, studio::Studio},
    preset::AccuracyRequest,
    scene::{
        Ground,
        parts::{PartKind, PartPattern, Scope},
    },
};

/// Linear RGBA before tone mapping: behind the scene at the top, where the ground ends, and at the
/// bottom.
const BACKDROP: [[f32; 4]; 2] = [[0.28, 0.29, 0.305, 1.0], [0.34, 0.345, 0.35, 1.0]];

impl Preset {
    /// The preset of a scene that was chosen, under the name that is shown.
    pub fn studio(name: &str, scene: SceneSource) -> Self {
        Self {
            name: name.into(),
            scene,
            ground: Some(Ground {
                size: 24.0,
                color: [0.38, 0.382, 0.39, 1.0],
                cells: 16,
                ..Ground::default()
            }),
            // Fog is as far away as the scene is large.
            unit: LengthUnit::Scene,
            stack: stack(),
            accuracy: AccuracyRequest {
                pins: PinnedOptions::of(ShadowMapSize::Side512).with(ShadowTaps::TwentyFive),
                ..AccuracyRequest::default()
            },
            output: Output {
                background: BACKDROP[0],
                background_bottom: Some(BACKDROP[1]),
                ..Output::default()
            },
            ..Self::default()
        }
    }
}

fn stack() -> Stack {
    use crate::effects::{shadow, studio};
    let mut stack = Stack::default();
    stack.enable(&studio::EFFECT).put(&Studio {
        sun: [0.66, 0.635, 0.595, 1.0],
        sun_direction: [-0.6, 0.95, 0.75, 0.0],
        strength: 0.72,
        ..Studio::default()
    });
    stack
        .enable(Effect::named("tonemap"))
        .set("background", &[1.0]);
    stack.enable(&shadow::EFFECT).put(&Shadow {
        strength: 0.85,
        ..Shadow::default()
    });
    let fog = stack.enable(Effect::named("fog"));
    fog.set("color", &BACKDROP[0].map(f64::from))
        .set("density", &[0.22])
        .set("start_m", &[2.6]);
    fog.on = Scope::new([PartPattern::of_name(PartKind::Node, "ground")]);
    stack
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::effects::hooks::{Lighting, Surface};

    #[test]
    fn the_brightest_white_face_is_light_and_not_clipped() {
        let mut light = stack();
        for name in ["shadow", "fog"] {
            light.disable(name);
        }
        let brightest = (0..=32)
            .flat_map(|up| (0..64).map(move |around| (up, around)))
            .map(|(up, around)| {
                let (up, around) = (f64::from(up) / 16.0 - 1.0, f64::from(around) / 64.0);
                let aside = (1.0 - up * up).sqrt();
                let (sin, cos) = (around * std::f64::consts::TAU).sin_cos();
                let normal = DVec3::new(aside * sin, up, aside * cos);
                let face = Surface {
                    normal,
                    view: normal,
                    ..Surface::example(DVec3::ONE, 0)
                };
                light
                    .shade(face, u32::MAX, &Lighting::default())
                    .color
                    .truncate()
                    .max_element()
            })
            .fold(0.0, f64::max);
        assert!((0.85..0.98).contains(&brightest), "{brightest}");
    }
}
