//! Walker: a long-necked animal on four legs, alone or in a herd, with a clip for each gait.

mod body;
mod gait;
mod surface_net;

use body::{bones, hide_color};
use gait::{GAITS, Gait, JOINTS, Joint, joints, pose_at};
use glam::{DMat4, DVec3};
use surface_net::CapsuleBody;

use super::{
    query::{BuiltinError, MAX_TRIANGLES, Values},
    weights,
};
use crate::scene::mesh_builder::MeshBuilder;
use crate::scene::{
    material::Material,
    model::{Instance, Scene},
    pose,
    rig::{Channel, Clip, Interpolation, LocalTransform, Node, Property, Sampler, Skin, Trs},
};

/// Keyframes per cycle, and phases at which an animal may start, so that neighbors are out of step.
const KEYS: usize = 64;
const PHASES: usize = 8;

/// Builds the scene `walker`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (tess, instances) = (values.whole("tess"), values.whole("instances"));
    let mut scene = Scene {
        materials: vec![Material {
            name: "hide".into(),
            ..Material::default()
        }],
        ..Scene::default()
    };
    let cell = 0.1 / f64::from(tess);
    let body = CapsuleBody {
        bones: bones(),
        min_radius: 0.6 * cell,
    };
    let surface_net::Surface {
        vertices,
        triangles,
    } = body.surface(cell);
    let all = triangles.len() as u64 * u64::from(instances);
    if all > MAX_TRIANGLES {
        return Err(BuiltinError(format!(
            "walker: {all} triangles in all; allowed: at most {MAX_TRIANGLES}. Lower tess or instances"
        )));
    }
    let mut mesh = MeshBuilder::with_capacity(vertices.len(), triangles.len());
    for &[position, normal] in &vertices {
        mesh.colored_vertex(position, normal, hide_color(position, normal));
    }
    triangles.iter().for_each(|&corners| mesh.triangle(corners));
    mesh.append(&mut scene, "walker", 0);
    let joint_weights: Vec<_> = vertices
        .iter()
        .map(|[position, _]| body.joint_weights(*position))
        .collect();
    weights::append(&mut scene, 0, JOINTS, 1, &joint_weights);
    let clip = |gait: &Gait| Clip {
        name: gait.name.into(),
        duration_s: gait.period_s,
        channels: Vec::new(),
    };
    scene.rig.clips = GAITS.iter().map(clip).collect();
    let first: Vec<Vec<usize>> = (0..PHASES.min(instances as usize))
        .map(|phase| {
            GAITS
                .iter()
                .map(|gait| add_samplers(&mut scene, gait, phase))
                .collect()
        })
        .collect();
    (0..instances).for_each(|instance| {
        add_instance(
            &mut scene,
            instance,
            instances,
            &first[instance as usize % PHASES],
        )
    });
    scene.rig.motion_bounds = pose::motion_bounds(&scene);
    Ok(scene)
}

/// Adds the samplers of a gait shifted by `phase`: the pelvis translation, then the rotation of
/// every joint. Returns the first.
fn add_samplers(scene: &mut Scene, gait: &Gait, phase: usize) -> usize {
    let rest = joints();
    let (first, times) = (scene.rig.samplers.len(), |key| {
        (gait.period_s * key as f64 / KEYS as f64) as f32
    });
    let times: Vec<f32> = (0..=KEYS).map(times).collect();
    // The last keyframe equals the first, bit by bit.
    let key = |key: usize| {
        pose_at(
            gait,
            &rest,
            ((key + phase * KEYS / PHASES) % KEYS) as f64 / KEYS as f64,
        )
    };
    let keys: Vec<_> = (0..=KEYS).map(key).collect();
    let mut sampler = |components, values| {
        scene.rig.samplers.push(Sampler {
            interpolation: Interpolation::Linear,
            times: times.clone(),
            values,
            components,
        })
    };
    sampler(
        3,
        keys.iter()
            .flat_map(|(shift, _)| (rest[0].at + *shift).as_vec3().to_array())
            .collect(),
    );
    for joint in 0..JOINTS {
        sampler(
            4,
            keys.iter()
                .flat_map(|(_, turns)| turns[joint].as_quat().to_array())
                .collect(),
        );
    }
    first
}

/// Adds one animal: its nodes, skin, channels in every clip, and instance.
fn add_instance(scene: &mut Scene, instance: u32, of: u32, samplers: &[usize]) {
    // Positions on a stretched sunflower spiral; a single animal stands at the origin.
    let reach = if of == 1 {
        0.0
    } else {
        (f64::from(instance) + 0.3).sqrt()
    };
    let (sin, cos) = libm::sincos(f64::from(instance) * 2.399_963_229_728_653);
    let part = |translation| {
        LocalTransform::Trs(Trs {
            translation,
            ..Trs::default()
        })
    };
    let (rest, first, rig) = (joints(), scene.rig.nodes.len() + 1, &mut scene.rig);
    let position = part(DVec3::new(2.3 * reach * sin, 0.0, 1.0 * reach * cos));
    rig.nodes.push(Node {
        name: format!("walker {instance}"),
        parent: None,
        rest: position,
        weights: Vec::new(),
    });
    for (joint, Joint { name, parent, at }) in rest.iter().enumerate() {
        let (parent, from) = if joint == 0 {
            (first - 1, DVec3::ZERO)
        } else {
            (first + parent, rest[*parent].at)
        };
        rig.nodes.push(Node {
            name: format!("walker {instance} {name}"),
            parent: Some(parent),
            rest: part(*at - from),
            weights: Vec::new(),
        });
    }
    rig.skins.push(Skin {
        name: format!("walker {instance}"),
        joints: (first..first + JOINTS).collect(),
        joint_from_mesh: rest
            .iter()
            .map(|joint| DMat4::from_translation(-joint.at))
            .collect(),
    });
    for (clip, &sampler) in rig.clips.iter_mut().zip(samplers) {
        clip.channels.push(Channel {
            node: first,
            property: Property::Translation,
            sampler,
        });
        let channel = |joint| Channel {
            node: first + joint,
            property: Property::Rotation,
            sampler: sampler + 1 + joint,
        };
        clip.channels.extend((0..JOINTS).map(channel));
    }
    let skin = rig.skins.len() - 1;
    scene.instances.push(Instance {
        primitive: 0,
        world_from_object: DMat4::IDENTITY,
        node: Some(first - 1),
        skin: Some(skin),
        named_node: None,
        placement: None,
    });
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::scene::builtin::build as scene_of;
    use crate::{
        accuracy::Skinning,
        scene::pose::{Motion, Pose},
    };

    /// Every vertex of every instance at a time of a clip.
    fn deformed(scene: &Scene, clip: usize, time_s: f64, skinning: Skinning) -> Vec<DVec3> {
        let pose = Pose::at(
            scene,
            &Motion {
                clip: Some(clip),
                time_s,
                skinning,
                ..Motion::default()
            },
        );
        let primitive = &scene.primitives[0];
        let all = |instance: usize| {
            let deform = pose.deform(instance).expect("its skin holds it").clone();
            (0..primitive.vertex_count())
                .map(move |vertex| deform.position(scene, primitive, vertex))
        };
        (0..scene.instances.len()).flat_map(all).collect()
    }

    /// Times on keyframes and between them.
    fn moments(clip: &Clip) -> impl Iterator<Item = f64> {
        (0..=75).map(|at| clip.duration_s * f64::from(at) / 75.0)
    }

    #[test]
    fn it_is_one_closed_body_at_every_fineness() {
        for tess in 1..=12 {
            let scene = scene_of(&format!("walker?tess={tess}")).unwrap();
            let primitive = &scene.primitives[0];
            let corners = || {
                (0..primitive.triangle_count()).map(|triangle| primitive.corners(&scene, triangle))
            };
            let edges: HashSet<[u32; 2]> = corners()
                .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]])
                .collect();
            assert_eq!(
                edges.len() as u64,
                3 * u64::from(primitive.triangle_count()),
                "tess {tess}: an edge occurs twice in one direction"
            );
            assert!(
                edges.iter().all(|&[a, b]| edges.contains(&[b, a])),
                "tess {tess}"
            );
            let mut seen = vec![false; primitive.vertex_count() as usize];
            let mut open = vec![0];
            let mut next = vec![Vec::new(); seen.len()];
            edges.iter().for_each(|&[a, b]| next[a as usize].push(b));
            while let Some(vertex) = open.pop() {
                if !std::mem::replace(&mut seen[vertex as usize], true) {
                    open.extend(&next[vertex as usize]);
                }
            }
            assert!(
                seen.iter().all(|seen| *seen),
                "tess {tess}: it is not connected"
            );
            let at = |vertex: u32| DVec3::from(primitive.position(&scene, vertex).map(f64::from));
            let volume: f64 = corners()
                .map(|corners| corners.map(at))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            assert!(
                (0.2..0.6).contains(&volume),
                "tess {tess}: {volume} m³, outwards"
            );
        }
    }

    #[test]
    fn weights_are_whole_and_soles_follow_their_foot_alone() {
        let body = CapsuleBody {
            bones: bones(),
            min_radius: 0.03,
        };
        let mut most = 0;
        for [position, _] in body.surface(0.05).vertices {
            let joint_weights = body.joint_weights(position);
            most = most.max(joint_weights.len());
            assert!(
                joint_weights.len() <= 4
                    && joint_weights
                        .iter()
                        .map(|&(_, weight)| u32::from(weight))
                        .sum::<u32>()
                        == 65_535,
                "{position}: {joint_weights:?}"
            );
            assert!(
                position.y > 0.0
                    || (joint_weights.len() == 1
                        && joints()[usize::from(joint_weights[0].0)]
                            .name
                            .ends_with("foot")),
                "{position}: {joint_weights:?}"
            );
        }
        assert_eq!(most, 4, "joints blend");
    }

    #[test]
    fn its_keys_go_round_to_the_bit() {
        let scene = scene_of("walker?tess=1&instances=3").unwrap();
        for sampler in &scene.rig.samplers {
            let keys: Vec<&[f32]> = sampler.values.chunks(sampler.components).collect();
            assert_eq!(
                (keys.len(), sampler.times.len(), keys[0]),
                (KEYS + 1, KEYS + 1, keys[KEYS])
            );
        }
        for (index, clip) in scene.rig.clips.iter().enumerate() {
            let apart = |a: f64, b: f64| {
                let [a, b] = [a, b].map(|fraction| {
                    deformed(&scene, index, fraction * clip.duration_s, Skinning::Linear)
                });
                a.iter()
                    .zip(&b)
                    .map(|(a, b)| a.distance(*b))
                    .fold(0.0, f64::max)
            };
            assert!(
                apart(0.0, 1.0) < 1e-6 && apart(0.25, 4.25) < 1e-6 && apart(0.0, 0.25) > 0.05,
                "{}",
                clip.name
            );
        }
        // Animals out of step move alike: the second is an eighth of a cycle ahead.
        let [a, b] = [0, 1].map(|instance| {
            let position = scene.rig.nodes[scene.instances[instance].node.unwrap()]
                .rest
                .matrix()
                .w_axis
                .truncate();
            let (count, late) = (
                scene.primitives[0].vertex_count() as usize,
                0.1875 * (1 - instance) as f64,
            );
            deformed(&scene, 0, 0.3 + late, Skinning::Linear)[instance * count..][..count]
                .iter()
                .map(|p| *p - position)
                .collect::<Vec<_>>()
        });
        assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-5));
    }

    #[test]
    fn feet_stand_on_the_ground_and_never_below_it() {
        let scene = scene_of("walker?instances=2").unwrap();
        for (index, clip) in scene.rig.clips.iter().enumerate() {
            for (time_s, skinning) in moments(clip).flat_map(|time_s| {
                Skinning::ALL
                    .iter()
                    .map(move |skinning| (time_s, *skinning))
            }) {
                let lowest = deformed(&scene, index, time_s, skinning)
                    .iter()
                    .map(|p| p.y)
                    .fold(f64::INFINITY, f64::min);
                assert!(
                    (-1e-3..8e-3).contains(&lowest),
                    "{} at {time_s} s: {lowest}",
                    clip.name
                );
            }
        }
    }

    #[test]
    fn the_hide_stretches_without_a_tear_and_stays_in_its_boxes() {
        let scene = scene_of("walker").unwrap();
        let primitive = &scene.primitives[0];
        let rest = |vertex: u32| DVec3::from(primitive.position(&scene, vertex).map(f64::from));
        let mut longest: f64 = 0.0;
        for (index, clip) in scene.rig.clips.iter().enumerate() {
            for time_s in moments(clip) {
                let positions = deformed(&scene, index, time_s, Skinning::Linear);
                for [a, b, c] in (0..primitive.triangle_count())
                    .map(|triangle| primitive.corners(&scene, triangle))
                {
                    for [a, b] in [[a, b], [b, c], [c, a]] {
                        // The shortest edges are exempt: a cell is 5 cm wide.
                        let stretched = positions[a as usize].distance(positions[b as usize])
                            / rest(a).distance(rest(b)).max(0.02);
                        longest = longest.max(stretched);
                    }
                }
                let bounds = Pose::at(
                    &scene,
                    &Motion {
                        clip: Some(index),
                        time_s,
                        ..Motion::default()
                    },
                )
                .bounds(&scene);
                let [bounds, framed] = [(bounds, 1e-6), (scene.rig.motion_bounds, 0.02)]
                    .map(|(b, margin)| (b.min - margin, b.max + margin));
                for (low, high) in [bounds, framed] {
                    let beyond = positions
                        .iter()
                        .map(|p| (low - *p).max(*p - high).max_element())
                        .fold(0.0, f64::max);
                    assert_eq!(beyond, 0.0, "{} at {time_s} s, m", clip.name);
                }
            }
        }
        // The largest factor occurs where two legs swing apart: 2.5.
        assert!(longest < 2.8, "an edge grows {longest} times");
    }
}
