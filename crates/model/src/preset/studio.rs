//! The studio: how a scene is shown that was opened plain. A sun with soft shadows, and a ground
//! that fades into the background.

use super::{LengthUnit, Output, Preset, SceneSource};
use crate::{
    accuracy::{PinnedOptions, ShadowMapSize, ShadowTaps},
    effects::{Stack, fog::Fog, lambert::Lambert, shadow::Shadow},
    preset::AccuracyRequest,
    scene::{
        Ground,
        parts::{PartKind, PartPattern, Scope},
    },
};

/// Linear RGBA: behind the scene at the top, where the ground ends, and at the bottom.
const BACKDROP: [[f32; 4]; 2] = [[0.24, 0.25, 0.265, 1.0], [0.3, 0.305, 0.31, 1.0]];

impl Preset {
    /// The preset of a scene that was chosen, under the name that is shown.
    pub fn studio(name: &str, scene: SceneSource) -> Self {
        Self {
            name: name.into(),
            scene,
            ground: Some(Ground {
                size: 24.0,
                color: [0.6, 0.602, 0.61, 1.0],
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
    use crate::effects::{fog, lambert, shadow};
    let mut stack = Stack::default();
    // A white face that looks at the sun gets 0.93 of what the picture holds: nothing is clipped.
    stack.enable(&lambert::EFFECT).put(&Lambert {
        sun: [0.625, 0.6, 0.562, 1.0],
        sky: [0.265, 0.277, 0.297, 1.0],
        ground: [0.156, 0.148, 0.14, 1.0],
        sun_direction: [-0.6, 0.95, 0.75, 0.0],
        headlight: 0.06,
    });
    stack.enable(&shadow::EFFECT).put(&Shadow {
        strength: 0.75,
        ..Shadow::default()
    });
    let fog = stack.enable(&fog::EFFECT);
    fog.put(&Fog {
        color: BACKDROP[0],
        density: 0.22,
        start_m: 2.6,
        ..Fog::default()
    });
    fog.on = Scope::new([PartPattern::of_name(PartKind::Node, "ground")]);
    stack
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::effects::hooks::Surface;

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
                    .shade(face, u32::MAX, &[])
                    .color
                    .truncate()
                    .max_element()
            })
            .fold(0.0, f64::max);
        assert!((0.85..0.98).contains(&brightest), "{brightest}");
    }
}
