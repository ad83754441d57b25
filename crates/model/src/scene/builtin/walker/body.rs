//! The walker's body: the capsules on its joints and the colors of its hide.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{
    gait::{LEGS, SIDES_M, SPINE},
    surface_net::Bone,
};

/// Radii of a hind leg and of a foreleg at their joints, meters.
const LEG_RADII_M: [[f64; 4]; 2] = [[0.16, 0.092, 0.052, 0.046], [0.125, 0.076, 0.054, 0.046]];

/// All capsules.
pub fn bones() -> Vec<Bone> {
    let mut bones = Vec::new();
    let mut bone = |joint, z: [f64; 2], blend, [[x0, y0, r0], [x1, y1, r1]]: [[f64; 3]; 2]| {
        let ends = [DVec3::new(x0, y0, z[0]), DVec3::new(x1, y1, z[1])];
        bones.push(Bone {
            joint,
            ends,
            radii: [r0, r1],
            blend,
            is_foot: false,
        });
    };
    let spine: [(usize, [[f64; 3]; 2]); 12] = [
        (0, [[-0.42, 1.00, 0.21], [0.0, 0.975, 0.235]]),
        (1, [[0.0, 0.975, 0.235], [0.34, 0.98, 0.215]]),
        (1, [[0.34, 1.00, 0.20], [0.46, 1.09, 0.15]]),
        (2, [[0.46, 1.09, 0.15], [0.70, 1.32, 0.105]]),
        (3, [[0.70, 1.32, 0.105], [0.88, 1.60, 0.085]]),
        (4, [[0.88, 1.60, 0.085], [1.00, 1.86, 0.078]]),
        (5, [[1.00, 1.88, 0.095], [1.08, 1.88, 0.09]]),
        (0, [[-0.50, 1.02, 0.18], [-0.60, 1.02, 0.14]]),
        (6, [[-0.60, 1.02, 0.14], [-0.92, 0.98, 0.09]]),
        (7, [[-0.92, 0.98, 0.09], [-1.24, 0.90, 0.06]]),
        (8, [[-1.24, 0.90, 0.06], [-1.56, 0.85, 0.042]]),
        (9, [[-1.56, 0.85, 0.042], [-1.86, 0.87, 0.03]]),
    ];
    spine
        .into_iter()
        .for_each(|(joint, shape)| bone(joint, [0.0; 2], 0.05, shape));
    bone(
        5,
        [0.0; 2],
        0.05,
        [[1.08, 1.87, 0.085], [1.25, 1.79, 0.056]],
    );
    for side in [-1.0, 1.0] {
        bone(
            5,
            [0.05 * side, 0.075 * side],
            0.02,
            [[0.98, 1.94, 0.024], [0.94, 2.06, 0.028]],
        );
    }
    for (leg, z) in SIDES_M.into_iter().enumerate() {
        let (joints, radii, first) = (LEGS[leg % 2], LEG_RADII_M[leg % 2], SPINE.len() + 4 * leg);
        for part in 0..3 {
            let end = |at: usize| [joints[at][0], joints[at][1], radii[at]];
            bone(
                first + part,
                [z; 2],
                [0.12, 0.04, 0.03][part],
                [end(part), end(part + 1)],
            );
        }
        let [x, y] = joints[3];
        bone(
            first + 3,
            [z; 2],
            0.03,
            [[x, y - 0.015, 0.06], [x + 0.08, y - 0.035, 0.05]],
        );
    }
    bones.iter_mut().for_each(|bone| {
        bone.is_foot = bone.joint >= SPINE.len() && (bone.joint - SPINE.len()) % 4 == 3
    });
    bones
}

/// Color of the hide: dark back, pale belly, bands over rump, tail and neck, dark feet, muzzle and
/// eyes.
pub fn hide_color(p: DVec3, normal: DVec3) -> [f64; 3] {
    const BACK: DVec3 = DVec3::new(0.52, 0.19, 0.06);
    const BELLY: DVec3 = DVec3::new(0.92, 0.74, 0.47);
    const BAND: DVec3 = DVec3::new(0.10, 0.045, 0.04);
    let step = |low: f64, high: f64, v: f64| {
        let t = ((v - low) / (high - low)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    // Distance along the spine; the neck rises.
    let along = p.x + 0.9 * (p.y - 1.0).max(0.0);
    let pale = step(0.1, -0.75, normal.y).max(step(0.66, 0.44, p.y));
    let mut color = BACK.lerp(BELLY, 0.9 * pale);
    let banded = step(0.05, -0.45, along).max(step(0.55, 0.9, along) * step(1.84, 1.72, p.y))
        * step(-0.35, 0.25, normal.y)
        * step(0.56, 0.7, p.y);
    let band = step(-0.3, 0.5, libm::sin(TAU * along / 0.29));
    color = color.lerp(BAND, 0.9 * banded * band);
    color = color.lerp(
        BAND,
        step(0.15, 0.08, p.y)
            .max(step(1.2, 1.27, p.x))
            .max(step(1.99, 2.03, p.y)),
    );
    let eye = DVec3::new(1.09, 1.91, 0.085);
    color
        .lerp(
            DVec3::splat(0.01),
            step(0.045, 0.025, DVec3::new(p.x, p.y, p.z.abs()).distance(eye)),
        )
        .to_array()
}
