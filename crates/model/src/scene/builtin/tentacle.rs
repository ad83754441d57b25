//! Tentacle: a skinned tube of many joints with clips, one or many, each with its own skeleton.

use std::f64::consts::TAU;

use glam::{DMat4, DVec3};

use super::{
    query::{BuiltinError, MAX_TRIANGLES, Values},
    weights::{self, JointWeight},
};
use crate::scene::mesh_builder::{MeshBuilder, Ring};
use crate::scene::{
    accessor::Accessor,
    deformation::MorphTarget,
    material::Material,
    model::{Instance, Scene},
    pose,
    rig::{Channel, Clip, Interpolation, LocalTransform, Node, Property, Sampler, Skin, Trs},
};

/// Length of the tube, meters.
const LENGTH_M: f64 = 2.0;
/// Radii at the bottom and at the tip, meters.
const RADII_M: [f64; 2] = [0.26, 0.07];
/// Duration of every clip, seconds.
const PERIOD_S: f64 = 4.0;
/// Phases at which an instance may start, so that neighbors move differently.
const PHASES: usize = 8;
/// Keyframes per cycle of a linear sampler.
const KEYS: usize = 16;

/// Builds the scene `tentacle`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (joints, tess, instances) = (
        values.whole("joints"),
        values.whole("tess"),
        values.whole("instances"),
    );
    let (around, along) = (4 + 2 * tess, 4 * tess);
    let triangles = u64::from(2 * around * along) * u64::from(instances);
    if triangles > MAX_TRIANGLES {
        return Err(BuiltinError(format!(
            "tentacle: {triangles} triangles in all; allowed: at most {MAX_TRIANGLES}. Lower tess or instances"
        )));
    }
    let mut scene = Scene {
        materials: vec![Material {
            name: "skin".into(),
            ..Material::default()
        }],
        ..Scene::default()
    };
    let heights = tube(&mut scene, around, along);
    add_deformation(
        &mut scene,
        &heights,
        joints,
        values.whole("influences") as usize,
    );
    let samplers = clips(&mut scene, joints);
    for instance in 0..instances {
        add_instance(&mut scene, instance, instances, joints, &samplers);
    }
    scene.rig.motion_bounds = pose::motion_bounds(&scene);
    Ok(scene)
}

/// Radius and slope of the tube at a fraction of its height; `bulge` (0 to 1) adds the bulge.
fn profile(fraction: f64, bulge: f64) -> [f64; 2] {
    let taper = RADII_M[1] - RADII_M[0];
    let (sin, cos) = libm::sincos(TAU * 5.0 * fraction);
    let hump = libm::exp(-(fraction - 0.42) * (fraction - 0.42) * 60.0);
    let radius = RADII_M[0] + taper * fraction + 0.008 * sin + bulge * 0.16 * hump;
    let slope = taper + 0.008 * TAU * 5.0 * cos - bulge * 0.16 * hump * 120.0 * (fraction - 0.42);
    [radius, slope / LENGTH_M]
}

/// Builds the tube along +y and returns the height of every vertex as a fraction.
fn tube(scene: &mut Scene, around: u32, along: u32) -> Vec<f64> {
    const TONES: [[f64; 3]; 3] = [[0.05, 0.20, 0.28], [0.80, 0.30, 0.20], [0.95, 0.78, 0.52]];
    let mut mesh = MeshBuilder::with_capacity(
        (around * (along + 1) + 2) as usize,
        (2 * around * along) as usize,
    );
    let mut heights = Vec::new();
    let tone = |fraction: f64, turn: f64| {
        let belly = (3.0 * libm::cos(TAU * (turn - 0.6)) - 0.8).clamp(0.0, 1.0);
        let band = 0.5 + 0.5 * libm::sin(TAU * 5.0 * fraction);
        std::array::from_fn(|c| {
            let back = TONES[0][c] + (TONES[1][c] - TONES[0][c]) * fraction * (0.55 + 0.45 * band);
            back + (TONES[2][c] - back) * belly * 0.8
        })
    };
    let mut below: Option<Ring> = None;
    for row in 0..=along + 2 {
        // Poles below the bottom and above the tip close the tube.
        let is_pole = row == 0 || row == along + 2;
        let fraction = f64::from(row.clamp(1, along + 1) - 1) / f64::from(along);
        let [radius, slope] = profile(fraction, 0.0);
        let ring = mesh.ring(if is_pole { 1 } else { around }, |mesh, i| {
            let turn = f64::from(i) / f64::from(around);
            let (sin, cos) = libm::sincos(TAU * turn);
            heights.push(fraction);
            if is_pole {
                let up = if row == 0 { -DVec3::Y } else { DVec3::Y };
                mesh.colored_vertex(
                    DVec3::Y * (LENGTH_M * fraction) + up * (0.3 * radius),
                    up,
                    tone(fraction, turn),
                );
            } else {
                mesh.colored_vertex(
                    DVec3::new(radius * sin, LENGTH_M * fraction, radius * cos),
                    DVec3::new(sin, -slope, cos),
                    tone(fraction, turn),
                );
            }
        });
        if let Some(below) = below {
            mesh.band(below, ring);
        }
        below = Some(ring);
    }
    mesh.append(scene, "tentacle", 0);
    heights
}

/// Adds joints and weights to the tube, and the morph target of its bulge.
fn add_deformation(scene: &mut Scene, heights: &[f64], joints: u32, influences: usize) {
    let weights_of: Vec<Vec<JointWeight>> = heights
        .iter()
        .map(|fraction| {
            basis_weights(
                fraction * f64::from(joints - 1).max(1.0),
                joints,
                influences,
            )
        })
        .collect();
    weights::append(
        scene,
        0,
        joints as usize,
        influences.div_ceil(4),
        &weights_of,
    );
    let primitive = scene.primitives[0].clone();
    let (mut displacements, mut normal_changes) = (Vec::<[f32; 3]>::new(), Vec::<[f32; 3]>::new());
    for (vertex, &fraction) in heights.iter().enumerate() {
        let position = DVec3::from(primitive.position(scene, vertex as u32).map(f64::from));
        let normal = DVec3::from([0, 1, 2].map(|component| {
            primitive
                .normals
                .value(&scene.vertex_bytes, vertex as u32, component)
        }));
        let aside = DVec3::new(position.x, 0.0, position.z);
        let [[plain, _], [full, slope]] = [0.0, 1.0].map(|bulge| profile(fraction, bulge));
        let is_pole = aside.length() < 1e-9;
        let bulged = if is_pole {
            normal
        } else {
            (aside.normalize() - DVec3::Y * slope).normalize()
        };
        displacements.push((aside * ((full - plain) / plain)).as_vec3().into());
        normal_changes.push((bulged - normal).as_vec3().into());
    }
    let mut append = |components: &[[f32; 3]]| {
        let at = scene.vertex_bytes.len();
        scene
            .vertex_bytes
            .extend_from_slice(bytemuck::cast_slice(components));
        Accessor::packed_f32(at, 3, components.len())
    };
    let (positions, normals) = (append(&displacements), append(&normal_changes));
    let max_displacement = displacements
        .iter()
        .flatten()
        .fold(0.0f64, |most, v| most.max(f64::from(v.abs())));
    scene.primitives[0].deformation.morph_targets = vec![MorphTarget {
        positions: Some(positions),
        normals: Some(normals),
        max_displacement,
    }];
}

/// The joints that influence a vertex at joint coordinate `along`, with weights of a uniform
/// B-spline that sum to 65,535.
fn basis_weights(along: f64, joints: u32, influences: usize) -> Vec<JointWeight> {
    // Cox-de Boor recursion up to the degree one below the number of influences.
    let shifted = along + 0.5 * (influences % 2) as f64;
    let (base, t) = (shifted.floor(), shifted - shifted.floor());
    let mut basis = vec![1.0];
    for degree in 1..influences {
        let mut next = vec![0.0; degree + 1];
        for (i, &value) in basis.iter().enumerate() {
            // The basis piece that starts `at` before this point.
            let at = t + (degree - 1 - i) as f64;
            next[i] += value * (degree as f64 - at) / degree as f64;
            next[i + 1] += value * at / degree as f64;
        }
        basis = next;
    }
    let mut weights_of: Vec<(u8, f64)> = Vec::new();
    for (i, &fraction) in basis.iter().enumerate() {
        let joint = (base as i64 + i as i64 - (influences as i64 - 1) / 2)
            .clamp(0, i64::from(joints) - 1) as u8;
        match weights_of.iter_mut().find(|(other, _)| *other == joint) {
            Some((_, sum)) => *sum += fraction,
            None => weights_of.push((joint, fraction)),
        }
    }
    weights::to_integers(&weights_of)
}

/// Samplers of the clips: one per phase and joint; of Breathe one per phase.
struct Samplers {
    joints: Vec<Vec<Vec<usize>>>,
    breath: Vec<usize>,
}

fn clips(scene: &mut Scene, joints: u32) -> Samplers {
    let rig = &mut scene.rig;
    let clip = |name: &str| Clip {
        name: name.into(),
        duration_s: PERIOD_S,
        channels: Vec::new(),
    };
    rig.clips = ["Sway", "Curl", "Twist", "Breathe"].map(clip).into();
    let mut sampler = |interpolation, components, times: Vec<f32>, values: Vec<f32>| {
        rig.samplers.push(Sampler {
            interpolation,
            times,
            values,
            components,
        });
        rig.samplers.len() - 1
    };
    let round: Vec<f32> = (0..=KEYS)
        .map(|key| (PERIOD_S * key as f64 / KEYS as f64) as f32)
        .collect();
    let quaternion = |axis: DVec3, angle: f64| {
        let (sin, cos) = libm::sincos(0.5 * angle);
        [axis.x * sin, axis.y * sin, axis.z * sin, cos].map(|v| v as f32)
    };
    let step = 1.0 / f64::from(joints);
    let turn = |key: usize, phase: usize| key as f64 / KEYS as f64 + phase as f64 / PHASES as f64;
    let each = |make: &mut dyn FnMut(usize, f64) -> usize| -> Vec<Vec<usize>> {
        (0..PHASES)
            .map(|phase| {
                (0..joints)
                    .map(|joint| make(phase, f64::from(joint)))
                    .collect()
            })
            .collect()
    };
    let sway = each(&mut |phase, joint| {
        let lean = |key| {
            let at = turn(key, phase) - 0.8 * joint * step;
            let axis = DVec3::new(0.5 * libm::sin(TAU * (at + 0.3)), 0.0, libm::cos(TAU * at));
            quaternion(axis.normalize_or(DVec3::Z), 2.6 * step * axis.length())
        };
        sampler(
            Interpolation::Linear,
            4,
            round.clone(),
            (0..=KEYS).flat_map(lean).collect(),
        )
    });
    let curl = each(&mut |phase, _| {
        let axis = DVec3::new(
            libm::sin(TAU * phase as f64 / PHASES as f64),
            0.0,
            libm::cos(TAU * phase as f64 / PHASES as f64),
        );
        let key = |angle: f64| [[0.0; 4], quaternion(axis, angle), [0.0; 4]].concat();
        let values = [0.0, 5.5 * step, -0.8 * step, 0.0]
            .iter()
            .flat_map(|&angle| key(angle))
            .collect();
        sampler(
            Interpolation::Cubic,
            4,
            vec![0.0, 1.6, 3.2, PERIOD_S as f32],
            values,
        )
    });
    let twist = each(&mut |phase, joint| {
        let angle = |key| {
            if joint == 0.0 {
                0.0
            } else {
                12.0 * step * libm::sin(TAU * turn(key, phase))
            }
        };
        let values = (0..=KEYS)
            .flat_map(|key| quaternion(DVec3::Y, angle(key)))
            .collect();
        sampler(Interpolation::Linear, 4, round.clone(), values)
    });
    let breath = (0..PHASES)
        .map(|phase| {
            let values = (0..=KEYS)
                .map(|key| (0.5 - 0.5 * libm::cos(TAU * turn(key, phase))) as f32)
                .collect();
            sampler(Interpolation::Linear, 1, round.clone(), values)
        })
        .collect();
    Samplers {
        joints: vec![sway, curl, twist],
        breath,
    }
}

/// Adds one tentacle: its nodes, skin, channels in every clip, and instance.
fn add_instance(scene: &mut Scene, instance: u32, of: u32, joints: u32, samplers: &Samplers) {
    // Positions on a sunflower spiral; a single tentacle stands at the origin.
    let reach = if of == 1 {
        0.0
    } else {
        0.9 * (f64::from(instance) + 0.3).sqrt()
    };
    let (sin, cos) = libm::sincos(f64::from(instance) * 2.399_963_229_728_653);
    let foot = DVec3::new(reach * sin, 0.0, reach * cos);
    let rig = &mut scene.rig;
    let part = |translation| {
        LocalTransform::Trs(Trs {
            translation,
            ..Trs::default()
        })
    };
    let first = rig.nodes.len();
    let segment = LENGTH_M / f64::from(joints - 1).max(1.0);
    for joint in 0..joints as usize {
        rig.nodes.push(Node {
            name: format!("tentacle {instance} joint {joint}"),
            parent: joint.checked_sub(1).map(|below| first + below),
            rest: part(if joint == 0 { foot } else { DVec3::Y * segment }),
            weights: Vec::new(),
        });
    }
    rig.nodes.push(Node {
        name: format!("tentacle {instance}"),
        parent: None,
        rest: part(DVec3::ZERO),
        weights: vec![0.0],
    });
    let inverse = |joint: u32| DMat4::from_translation(DVec3::NEG_Y * (segment * f64::from(joint)));
    rig.skins.push(Skin {
        name: format!("tentacle {instance}"),
        joints: (first..first + joints as usize).collect(),
        joint_from_mesh: (0..joints).map(inverse).collect(),
    });
    let (phase, mesh) = (instance as usize % PHASES, first + joints as usize);
    for (clip, phases) in samplers.joints.iter().enumerate() {
        let channel = |(joint, &sampler): (usize, &usize)| Channel {
            node: first + joint,
            property: Property::Rotation,
            sampler,
        };
        rig.clips[clip]
            .channels
            .extend(phases[phase].iter().enumerate().map(channel));
    }
    rig.clips[3].channels.push(Channel {
        node: mesh,
        property: Property::Weights,
        sampler: samplers.breath[phase],
    });
    let skin = rig.skins.len() - 1;
    scene.instances.push(Instance {
        primitive: 0,
        world_from_object: DMat4::IDENTITY,
        node: Some(mesh),
        skin: Some(skin),
        named_node: None,
        placement: None,
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_every_height_are_whole_and_smooth() {
        for influences in 1..=8 {
            let mut before: Option<Vec<f64>> = None;
            for step in 0..=7_000 {
                let weights_of = basis_weights(f64::from(step) / 1000.0, 8, influences);
                assert!(
                    weights_of.len() <= influences
                        && weights_of
                            .iter()
                            .map(|&(_, weight)| u32::from(weight))
                            .sum::<u32>()
                            == 65_535,
                    "{weights_of:?}"
                );
                let mut dense = vec![0.0; 8];
                weights_of.iter().for_each(|&(joint, weight)| {
                    dense[usize::from(joint)] += f64::from(weight) / 65_535.0
                });
                if let Some(before) = before.filter(|_| influences > 1) {
                    assert!(
                        before.iter().zip(&dense).all(|(a, b)| (a - b).abs() < 2e-3),
                        "{influences} at {step}"
                    );
                }
                before = Some(dense);
            }
        }
    }
}
