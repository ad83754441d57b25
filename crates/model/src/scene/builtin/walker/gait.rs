//! Gaits: a four-legged skeleton and its motion. Foot trajectories come first; inverse kinematics
//! gives hips and knees.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

/// Spine and tail: name, parent and rest position (x, y) in meters. The animal faces +x. The joints
/// of the legs follow.
pub const SPINE: [(&str, usize, [f64; 2]); 10] = [
    ("pelvis", 0, [-0.42, 1.00]),
    ("chest", 0, [0.02, 1.01]),
    ("neck", 1, [0.46, 1.09]),
    ("nape", 2, [0.70, 1.32]),
    ("throat", 3, [0.88, 1.60]),
    ("head", 4, [1.00, 1.86]),
    ("tail 1", 0, [-0.60, 1.02]),
    ("tail 2", 6, [-0.92, 0.98]),
    ("tail 3", 7, [-1.24, 0.90]),
    ("tail 4", 8, [-1.56, 0.85]),
];
/// Joints of a hind leg and of a foreleg: knees point forward, elbows backward, feet stand on their
/// toes.
pub const LEGS: [[[f64; 2]; 4]; 2] = [
    [[-0.42, 0.92], [-0.26, 0.65], [-0.48, 0.38], [-0.45, 0.08]],
    [[0.43, 0.88], [0.27, 0.63], [0.35, 0.36], [0.35, 0.08]],
];
const PARTS: [[&str; 4]; 2] = [
    ["hip", "knee", "hock", "foot"],
    ["shoulder", "elbow", "wrist", "foot"],
];
/// Sideways offset of the left hind, left fore, right hind and right fore leg, meters.
pub const SIDES_M: [f64; 4] = [-0.15, -0.14, 0.15, 0.14];
/// The number of joints.
pub const JOINTS: usize = SPINE.len() + 16;
/// Toe tip and heel, relative to the foot's joint.
const SOLE: [[f64; 2]; 2] = [[0.13, -0.08], [-0.05, -0.08]];
/// Forward lean in radians of the lowest bone of a hind leg and of a foreleg: at landing, at
/// mid-stance, at lift-off, and twice in the air.
const LEANS: [[f64; 5]; 2] = [
    [-0.28, 0.0, 0.55, 0.80, 0.25],
    [-0.28, 0.0, 0.45, 1.00, 0.50],
];
/// Distance between hips and shoulders, meters.
const TRUNK_M: f64 = 0.8;

/// Parameters of a gait. Angles are in radians, times in cycles.
pub struct Gait {
    pub name: &'static str,
    /// Duration of a cycle, seconds.
    pub period_s: f64,
    /// Fraction of the cycle during which a foot is on the ground.
    duty: f64,
    /// Time at which each foot lands.
    landing: [f64; 4],
    stride_m: f64,
    lift_m: f64,
    /// Amplitudes of the trunk: vertical, and sideways towards the standing feet.
    bob_m: f64,
    lean_m: f64,
    /// Amplitudes of hip and shoulder rotation, neck and tail sway, and head nod.
    sway: f64,
    neck: f64,
    tail: f64,
    nod: f64,
}

#[rustfmt::skip]
pub const GAITS: [Gait; 3] = [
    Gait {
        name: "Walk", period_s: 1.5, duty: 0.625, landing: [0.0, 0.25, 0.5, 0.75], stride_m: 0.5, lift_m: 0.13,
        bob_m: 0.016, lean_m: 0.02, sway: 0.09, neck: 0.06, tail: 0.13, nod: 0.035,
    },
    Gait {
        name: "Trot", period_s: 0.75, duty: 0.5, landing: [0.0, 0.5, 0.5, 0.0], stride_m: 0.48, lift_m: 0.17,
        bob_m: 0.026, lean_m: 0.0, sway: 0.06, neck: 0.03, tail: 0.08, nod: 0.03,
    },
    Gait {
        name: "Idle", period_s: 3.0, duty: 1.0, landing: [0.0, 0.25, 0.5, 0.75], stride_m: 0.0, lift_m: 0.0,
        bob_m: 0.006, lean_m: 0.03, sway: 0.02, neck: 0.10, tail: 0.10, nod: 0.03,
    },
];

/// A joint in the rest pose.
pub struct Joint {
    pub name: String,
    /// Index of its parent.
    pub parent: usize,
    /// Rest position, meters.
    pub at: DVec3,
}

/// All joints, parents first. The pelvis is its own parent.
pub fn joints() -> Vec<Joint> {
    let spine = |&(name, parent, [x, y]): &(&str, usize, [f64; 2])| Joint {
        name: name.to_owned(),
        parent,
        at: DVec3::new(x, y, 0.0),
    };
    let mut joints: Vec<Joint> = SPINE.iter().map(spine).collect();
    for (leg, side) in ["left hind", "left fore", "right hind", "right fore"]
        .into_iter()
        .enumerate()
    {
        for (part, [x, y]) in LEGS[leg % 2].into_iter().enumerate() {
            let parent = if part == 0 { leg % 2 } else { joints.len() - 1 };
            joints.push(Joint {
                name: format!("{side} {}", PARTS[leg % 2][part]),
                parent,
                at: DVec3::new(x, y, SIDES_M[leg]),
            });
        }
    }
    joints
}

/// A cosine of period 1.
fn wave(t: f64) -> f64 {
    libm::cos(TAU * t)
}

fn turn(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * angle);
    DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

/// A foot at one time.
struct Step {
    /// Position of its joint: forward of the rest position, and above the ground.
    at: [f64; 2],
    /// Downward rotation of the toes.
    pitch: f64,
    /// Forward lean of the bone above it.
    lean: f64,
}

/// A periodic cubic spline through these values at these times.
fn round_curve(times: [f64; 5], values: [f64; 5], t: f64) -> f64 {
    let key = |i: usize| (times[i % 5] + (i / 5) as f64 - 1.0, values[i % 5]);
    let after = (5..).find(|&i| key(i + 1).0 > t).expect("times end at 1");
    let slope = |i: usize| (key(i + 1).1 - key(i - 1).1) / (key(i + 1).0 - key(i - 1).0);
    let ((t0, v0), (t1, v1)) = (key(after), key(after + 1));
    let (s, wide) = ((t - t0) / (t1 - t0), t1 - t0);
    let (s2, s3) = (s * s, s * s * s);
    let deformed = slope(after) * (s3 - 2.0 * s2 + s) + slope(after + 1) * (s3 - s2);
    v0 + (v1 - v0) * (3.0 * s2 - 2.0 * s3) + wide * deformed
}

/// A foot of a girdle, `t` cycles after landing.
fn step(gait: &Gait, girdle: usize, t: f64) -> Step {
    let t = t.rem_euclid(1.0);
    let back = 0.5 * gait.stride_m;
    let air = 1.0 - gait.duty;
    let [ahead, lift] = if t < gait.duty || gait.duty >= 1.0 {
        [back - gait.stride_m * t / gait.duty, 0.0]
    } else {
        // A cubic that starts and ends at the speed of the ground.
        let (s, fast) = ((t - gait.duty) / air, -gait.stride_m * air / gait.duty);
        let (s2, s3) = (s * s, s * s * s);
        [
            back * (6.0 * s2 - 4.0 * s3 - 1.0) + fast * (2.0 * s3 - 3.0 * s2 + s),
            16.0 * gait.lift_m * s2 * (1.0 - s) * (1.0 - s),
        ]
    };
    let hump = |low: f64, high: f64| {
        let s = ((t - low) / (high - low)).clamp(0.0, 1.0);
        16.0 * s * s * (1.0 - s) * (1.0 - s)
    };
    let is_still = gait.lift_m == 0.0;
    // The heel rises before the toes leave the ground, and the toes rise before landing.
    let pitch = if is_still {
        0.0
    } else {
        0.85 * hump(gait.duty - 0.14, gait.duty + 0.24) - 0.3 * hump(gait.duty + 0.16, 1.0)
    };
    let times = [
        0.0,
        0.5 * gait.duty,
        gait.duty,
        gait.duty + 0.35 * air,
        gait.duty + 0.7 * air,
    ];
    let lean = if is_still {
        0.0
    } else {
        round_curve(times, LEANS[girdle], t)
    };
    let (sin, cos) = libm::sincos(-pitch);
    let [toe, heel] = SOLE.map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]);
    // The toes follow their trajectory. Neither they nor the heel go below the ground; in the air a
    // smooth minimum blends them.
    let both = (lift - (toe[1] - heel[1]).abs()).max(0.0);
    let lower = toe[1].min(heel[1])
        - if both > 0.0 {
            both * both / (4.0 * lift)
        } else {
            0.0
        };
    Step {
        at: [ahead + SOLE[0][0] - toe[0], lift - lower],
        pitch,
        lean,
    }
}

/// Translation of the pelvis and rotation of every joint relative to its parent, at time `t`.
pub fn pose_at(gait: &Gait, rest: &[Joint], t: f64) -> (DVec3, [DQuat; JOINTS]) {
    let mut turns = [DQuat::IDENTITY; JOINTS];
    // Each girdle is lowest just after landing, and the side that lands is ahead.
    let bob = |girdle: usize| -gait.bob_m * wave(2.0 * (t - gait.landing[girdle] - 0.06));
    let girdle = |girdle: usize| {
        let after = t - gait.landing[girdle];
        let (yaw, roll) = (
            -gait.sway * wave(after),
            -0.5 * gait.sway * wave(after + 0.5 * (1.0 - gait.duty)),
        );
        turn(DVec3::Y, yaw) * turn(DVec3::Z, (bob(1) - bob(0)) / TRUNK_M) * turn(DVec3::X, roll)
    };
    let girdles = [girdle(0), girdle(1)];
    let shift = DVec3::new(
        0.0,
        bob(0),
        -gait.lean_m * wave(t - gait.landing[0] - 0.5 * gait.duty),
    );
    (turns[0], turns[1]) = (girdles[0], girdles[0].inverse() * girdles[1]);
    for link in 0..4 {
        let (late, more) = (0.07 * link as f64, 1.0 + 0.25 * link as f64);
        let nod = if link == 3 { -3.0 * gait.nod } else { gait.nod };
        let neck = t - gait.landing[1] - late;
        turns[2 + link] =
            turn(DVec3::Y, gait.neck * wave(neck)) * turn(DVec3::Z, nod * wave(2.0 * neck - 0.12));
        let tail = t - gait.landing[0] - late - 0.05;
        turns[6 + link] = turn(DVec3::Y, gait.tail * more * wave(tail))
            * turn(DVec3::Z, 0.5 * gait.nod * more * wave(2.0 * tail));
    }
    let girdle_positions = [
        rest[0].at + shift,
        rest[0].at + shift + girdles[0] * (rest[1].at - rest[0].at),
    ];
    for leg in 0..4 {
        let (girdle, first) = (leg % 2, SPINE.len() + 4 * leg);
        let [hip, knee, hock, foot] = [0, 1, 2, 3].map(|part| rest[first + part].at);
        let Step {
            at: [ahead, up],
            pitch,
            lean,
        } = step(gait, girdle, t - gait.landing[leg]);
        let (lean, pitch) = (turn(DVec3::Z, -lean), turn(DVec3::Z, -pitch));
        let at = girdle_positions[girdle] + girdles[girdle] * (hip - rest[girdle].at);
        let goal = DVec3::new(foot.x + ahead, up, foot.z) + lean * (hock - foot) - at;
        // Two-bone inverse kinematics: the knee lies in the plane of the goal and the forward
        // direction.
        let (thigh, shank) = (knee - hip, hock - knee);
        let far = goal
            .length()
            .min(0.9999 * (thigh.length() + shank.length()));
        let (down, hinge) = (goal.normalize(), goal.cross(DVec3::X).normalize());
        let along = (thigh.length_squared() - shank.length_squared() + far * far) / (2.0 * far);
        let out = (thigh.length_squared() - along * along).max(0.0).sqrt()
            * if girdle == 0 { 1.0 } else { -1.0 };
        let deformed = down * along + hinge.cross(down) * out;
        let facing = |from: DVec3, to: DVec3| {
            let frame = |along: DVec3, hinge: DVec3| {
                DMat3::from_cols(along.normalize(), hinge.cross(along.normalize()), hinge)
            };
            DQuat::from_mat3(&(frame(to, hinge) * frame(from, DVec3::Z).transpose()))
        };
        let [upper, lower] = [
            facing(thigh, deformed),
            facing(shank, down * far - deformed),
        ];
        turns[first] = girdles[girdle].inverse() * upper;
        turns[first + 1] = upper.inverse() * lower;
        turns[first + 2] = lower.inverse() * lean;
        turns[first + 3] = lean.inverse() * pitch;
    }
    (shift, turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_keep_their_length_and_bring_the_foot_to_its_goal() {
        let rest = joints();
        for gait in &GAITS {
            for at in 0..200 {
                let t = f64::from(at) / 200.0;
                let (shift, turns) = pose_at(gait, &rest, t);
                let mut frames: Vec<(DVec3, DQuat)> = Vec::new();
                for (joint, turn) in rest.iter().zip(turns) {
                    assert!(
                        (turn.length() - 1.0).abs() < 1e-12,
                        "{} {t}: {turn}",
                        joint.name
                    );
                    let frame = if frames.is_empty() {
                        (joint.at + shift, turn)
                    } else {
                        let (position, parent) = frames[joint.parent];
                        (
                            position + parent * (joint.at - rest[joint.parent].at),
                            parent * turn,
                        )
                    };
                    frames.push(frame);
                }
                for (leg, landing) in gait.landing.into_iter().enumerate() {
                    let foot = SPINE.len() + 4 * leg + 3;
                    let [ahead, up] = step(gait, leg % 2, t - landing).at;
                    let goal = DVec3::new(rest[foot].at.x + ahead, up, rest[foot].at.z);
                    assert!(
                        frames[foot].0.distance(goal) < 1e-9,
                        "{} {} {t}: {} {goal}",
                        gait.name,
                        rest[foot].name,
                        frames[foot].0
                    );
                }
            }
        }
    }

    #[test]
    fn knees_point_ahead_and_elbows_back_and_no_leg_is_ever_stretched() {
        let rest = joints();
        for gait in &GAITS {
            for (at, leg) in (0..200).flat_map(|at| (0..4).map(move |leg| (at, leg))) {
                let (_, turns) = pose_at(gait, &rest, f64::from(at) / 200.0);
                let first = SPINE.len() + 4 * leg;
                let [upper, lower] =
                    [1, 2].map(|part| rest[first + part].at - rest[first + part - 1].at);
                // The lower bone in the frame of the upper one.
                let lower = turns[first + 1] * lower;
                let deform = upper.cross(lower) * if leg % 2 == 0 { -1.0 } else { 1.0 };
                let stretched = (upper + lower).length() / (upper.length() + lower.length());
                assert!(
                    deform.z > 0.0 && deform.x.abs().max(deform.y.abs()) < 1e-9,
                    "{} {}: {deform}",
                    gait.name,
                    rest[first + 1].name
                );
                assert!(
                    (0.5..0.985).contains(&stretched),
                    "{} {}: {stretched}",
                    gait.name,
                    rest[first + 1].name
                );
            }
        }
    }

    #[test]
    fn no_joint_snaps() {
        const STEP: f64 = 1.0 / 400.0;
        let rest = joints();
        for (gait, at) in GAITS
            .iter()
            .flat_map(|gait| (0..400).map(move |at| (gait, f64::from(at) * STEP)))
        {
            let [before, now, after] =
                [-STEP, 0.0, STEP].map(|late| pose_at(gait, &rest, at + late).1);
            for (joint, name) in rest.iter().map(|joint| &joint.name).enumerate() {
                let near = |q: DQuat| if q.dot(now[joint]) < 0.0 { -q } else { q };
                let change = 2.0
                    * (near(before[joint]) - now[joint] + (near(after[joint]) - now[joint]))
                        .length();
                assert!(
                    change < 4e-3,
                    "{} {name} at {at}: its angular speed changes by {change} per step",
                    gait.name
                );
            }
        }
    }

    #[test]
    fn feet_stand_while_the_ground_goes_back_evenly_and_land_in_four_beats() {
        let [walk, trot, idle] = &GAITS;
        let toe = |gait: &Gait, t| {
            let Step {
                at: [ahead, up],
                pitch,
                ..
            } = step(gait, 0, t);
            let (sin, cos) = libm::sincos(-pitch);
            let [x, y] = SOLE[0];
            [ahead + x * cos - y * sin, up + x * sin + y * cos]
        };
        for gait in [walk, trot, idle] {
            for at in 0..100 {
                let t = gait.duty * f64::from(at) / 100.0;
                let [x, y] = toe(gait, t);
                let even = SOLE[0][0] + gait.stride_m * (0.5 - t / gait.duty);
                assert!(
                    (x - even).abs() < 1e-12 && y.abs() < 1e-12,
                    "{} {t}: {x} {y}",
                    gait.name
                );
            }
        }
        for gait in [walk, trot] {
            let middle = 0.5 * (1.0 + gait.duty);
            assert!(toe(gait, middle)[1] > 0.8 * gait.lift_m, "{}", gait.name);
            // Position and speed are continuous at lift-off and landing.
            for t in [gait.duty, 1.0] {
                let [before, at, after] = [-1e-4, 0.0, 1e-4].map(|late| toe(gait, t + late));
                assert!(
                    [0, 1]
                        .iter()
                        .all(|&i| (before[i] - 2.0 * at[i] + after[i]).abs() < 1e-6),
                    "{} {t}",
                    gait.name
                );
            }
        }
        let standing = |gait: &Gait, t: f64| {
            gait.landing
                .iter()
                .filter(|landing| (t - **landing).rem_euclid(1.0) < gait.duty)
                .count()
        };
        let mut landings = walk.landing;
        landings.sort_by(f64::total_cmp);
        assert_eq!(landings, [0.0, 0.25, 0.5, 0.75]);
        assert!(
            (0..64)
                .map(|t| standing(walk, f64::from(t) / 64.0))
                .all(|feet| feet == 2 || feet == 3)
        );
        assert!(
            (0..64)
                .map(|t| standing(trot, f64::from(t) / 64.0))
                .all(|feet| feet == 2)
        );
        assert!(
            (0..64)
                .map(|t| standing(idle, f64::from(t) / 64.0))
                .all(|feet| feet == 4)
        );
    }
}
