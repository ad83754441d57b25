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
                color: [0.47, 0.472, 0.478, 1.0],
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
    stack.enable(&lambert::EFFECT).put(&Lambert {
        sun: [0.8, 0.77, 0.72, 1.0],
        sky: [0.34, 0.355, 0.38, 1.0],
        ground: [0.2, 0.19, 0.18, 1.0],
        sun_direction: [-0.6, 0.95, 0.75, 0.0],
        headlight: 0.08,
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
