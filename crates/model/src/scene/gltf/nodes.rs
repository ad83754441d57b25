//! Nodes: the node tree, without recursion; world matrices in f64, morph weights, cameras and
//! lights.

use std::collections::HashSet;

use glam::{DMat4, DVec3};

use super::{
    document::{self, Document},
    error::{LoadError, called, menu_name, part_name},
    limits,
    notes::Notes,
};
use crate::scene::{
    bounds::Bounds,
    camera::{Camera, MIN_NEAR_M},
    model::{NamedNode, SceneCamera},
    punctual::{LightKind, MAX_LIGHTS, SceneLight},
    quaternion::unit,
    rig::{LocalTransform, Node, Property, Trs},
};

/// The node tree.
pub struct Tree {
    /// World transform of each node in the rest pose.
    pub world_from_node: Vec<DMat4>,
    /// Nodes of the shown scene (all, where the file has no scene) that are not hidden, parents
    /// before children.
    pub shown: Vec<usize>,
    /// The same with those that are hidden.
    present: Vec<usize>,
    /// The parent of each node.
    parents: Vec<Option<usize>>,
    /// The transform of each node relative to its parent.
    locals: Vec<LocalTransform>,
    /// All nodes, parents before children.
    order: Vec<usize>,
    /// Position of every node in `order`, which is its index in the rig.
    pub rig_index: Vec<usize>,
}

impl Tree {
    /// Traverses the nodes. Links that make no tree are left out: a second parent, or one that is
    /// below its child. A node whose transform is not finite is not shown, nor what is below it.
    pub fn walk(document: &Document, notes: &Notes) -> Self {
        let nodes = &document.nodes;
        let (children, parents) = links(document, notes);
        let locals: Vec<LocalTransform> = nodes.iter().map(local).collect();
        let crooked = nodes.iter().filter(|node| is_crooked(node)).count();
        if crooked > 0 {
            notes.fault(|| {
                format!("{crooked} node rotations are not unit quaternions; they are normalized")
            });
        }
        let roots = (0..nodes.len()).filter(|&node| parents[node].is_none());
        let order = visit(&children, roots);
        let mut world_from_node = vec![DMat4::IDENTITY; nodes.len()];
        let [mut is_lost, mut is_hidden] = [(); 2].map(|()| vec![false; nodes.len()]);
        for &node in &order {
            is_hidden[node] =
                nodes[node].is_hidden || parents[node].is_some_and(|parent| is_hidden[parent]);
            let parent = parents[node].map_or(DMat4::IDENTITY, |parent| world_from_node[parent]);
            let world = parent * locals[node].matrix();
            if world.is_finite() {
                world_from_node[node] = world;
            } else {
                notes.fault(|| {
                    format!(
                        "{}: its world transform is not finite; it is left out",
                        node_name(document, node)
                    )
                });
            }
            is_lost[node] =
                !world.is_finite() || parents[node].is_some_and(|parent| is_lost[parent]);
        }
        let mut rig_index = vec![0; nodes.len()];
        for (place, &node) in order.iter().enumerate() {
            rig_index[node] = place;
        }
        let mut present = match &document.scene {
            None => order.clone(),
            Some(scene) => visit(&children, tops(document, scene, &parents, &order, notes)),
        };
        present.retain(|&node| !is_lost[node]);
        let shown = present.iter().copied().filter(|&node| !is_hidden[node]);
        Self {
            world_from_node,
            shown: shown.collect(),
            present,
            parents,
            locals,
            order,
            rig_index,
        }
    }

    /// The nodes of the rig. Those with a matrix that clips animate have its parts instead.
    pub fn rig_nodes(&self, document: &Document, notes: &Notes) -> Result<Vec<Node>, LoadError> {
        let channels = document.clips.iter().flat_map(|clip| &clip.channels);
        let mut is_animated = vec![false; document.nodes.len()];
        for (_, channel) in channels {
            if let Ok(channel) = channel {
                is_animated[channel.node] |= channel.property != Property::Weights;
            }
        }
        let mut weights_in_all = 0;
        let node = |&index: &usize| {
            let name = node_name(document, index);
            let weights = morph_weights(document, index, notes);
            weights_in_all += weights.len();
            if weights_in_all > limits::WEIGHTS {
                return Err(LoadError::end(format!(
                    "{name}: the nodes have {weights_in_all} morph weights or more; allowed: at most {}",
                    limits::WEIGHTS
                )));
            }
            let mut rest = self.locals[index];
            if is_animated[index]
                && let LocalTransform::Matrix(matrix) = rest
                && let Some(parts) = Trs::of(&matrix)
            {
                notes.fault(|| {
                    format!("{name}: it has a matrix, and a clip animates it; the clip animates the parts of the matrix")
                });
                rest = LocalTransform::Trs(parts);
            }
            Ok(Node {
                parent: self.parents[index].map(|parent| self.rig_index[parent]),
                rest,
                weights,
                name,
            })
        };
        self.order.iter().map(node).collect()
    }

    /// The names of all nodes, in the order of the rig.
    pub fn named_nodes(&self, document: &Document) -> Vec<NamedNode> {
        let named = |&node: &usize| NamedNode {
            name: part_name("node", node, document.nodes[node].name.as_deref()),
            parent: self.parents[node].map(|parent| self.rig_index[parent]),
        };
        self.order.iter().map(named).collect()
    }

    /// The cameras of the shown nodes. Their targets are as far away as the center of `bounds`.
    /// With `moves` they follow their nodes.
    pub fn cameras(
        &self,
        document: &Document,
        bounds: &Bounds,
        moves: bool,
        notes: &Notes,
    ) -> Vec<SceneCamera> {
        let mut cameras = Vec::new();
        for &node in &self.present {
            let Some(index) = document.nodes[node].camera else {
                continue;
            };
            let named = |camera: Option<&str>| {
                let name = camera.or(document.nodes[node].name.as_deref());
                (name.map(str::to_owned), called("camera", index, name))
            };
            let (name, camera) = match &document.cameras[index] {
                Ok(camera) => (named(camera.name.as_deref()), Ok(camera)),
                Err(reason) => (named(None), Err(reason)),
            };
            let (name, in_messages) = name;
            let camera = match camera {
                Ok(camera) => camera,
                Err(reason) => {
                    notes.fault(|| format!("{in_messages} is skipped: {reason}"));
                    continue;
                }
            };
            match pose(camera, &self.world_from_node[node], bounds) {
                Some(pose) => cameras.push(SceneCamera {
                    name: match name {
                        Some(name) => menu_name("camera", cameras.len(), Some(&name)),
                        None => format!("camera {index}"),
                    },
                    pose,
                    node: moves.then(|| self.rig_index[node]),
                }),
                None => {
                    notes.add(|| format!("{in_messages} is skipped: its node has no direction"))
                }
            }
        }
        cameras
    }

    /// The first lights of the shown nodes. With `moves` they follow their nodes.
    pub fn lights(&self, document: &Document, moves: bool, notes: &Notes) -> Vec<SceneLight> {
        let mut lights = Vec::new();
        let mut count = 0;
        for &node in &self.shown {
            let Some(index) = document.nodes[node].light else {
                continue;
            };
            let light = match &document.lights[index] {
                Ok(light) => light,
                Err(reason) => {
                    notes.fault(|| {
                        format!("{} is left out: {reason}", called("light", index, None))
                    });
                    continue;
                }
            };
            let in_messages = || called("light", index, light.name.as_deref());
            let Some(kind) = light.kind else {
                notes.add(|| format!("{} is left out: its type is unknown", in_messages()));
                continue;
            };
            let world_from_light = self.world_from_node[node];
            let has_direction = world_from_light.z_axis.truncate().try_normalize().is_some();
            if kind != LightKind::Point && !has_direction {
                notes.add(|| format!("{} is left out: its node has no direction", in_messages()));
                continue;
            }
            count += 1;
            if lights.len() < MAX_LIGHTS {
                lights.push(SceneLight {
                    name: menu_name("light", index, light.name.as_deref()),
                    kind,
                    light: light.light,
                    range_m: light.range_m,
                    world_from_light,
                    node: moves.then(|| self.rig_index[node]),
                });
            }
        }
        if count > MAX_LIGHTS {
            notes.add(|| {
                format!(
                    "it has {count} lights; the first {MAX_LIGHTS} shine, and {} are left out",
                    count - MAX_LIGHTS
                )
            });
        }
        lights
    }
}

/// A node as error messages name it.
pub fn node_name(document: &Document, node: usize) -> String {
    called("node", node, document.nodes[node].name.as_deref())
}

/// The children and the parent of every node, such that they form trees. Other links are left out.
fn links(document: &Document, notes: &Notes) -> (Vec<Vec<usize>>, Vec<Option<usize>>) {
    let count = document.nodes.len();
    let mut parents: Vec<Option<usize>> = vec![None; count];
    let mut children = vec![Vec::new(); count];
    for (node, about) in document.nodes.iter().enumerate() {
        for &child in &about.children {
            if parents[child].is_some() {
                notes.fault(|| {
                    format!(
                        "{}: it has more than one parent; nodes must form a tree, and the first is used",
                        node_name(document, child)
                    )
                });
                continue;
            }
            parents[child] = Some(node);
            children[node].push(child);
        }
    }
    // Nodes that no root reaches lie below a cycle, and going up from one leads onto it.
    let mut is_reached = vec![false; count];
    let roots: Vec<usize> = (0..count).filter(|&node| parents[node].is_none()).collect();
    let mut open: Vec<usize> = visit(&children, roots);
    let mut start = 0;
    loop {
        open.drain(..).for_each(|node| is_reached[node] = true);
        let Some(lost) = (start..count).find(|&node| !is_reached[node]) else {
            break;
        };
        start = lost;
        let mut is_passed = HashSet::new();
        let mut top = lost;
        while is_passed.insert(top) {
            top = parents[top].unwrap_or(top);
        }
        if let Some(parent) = parents[top].take() {
            children[parent].retain(|&child| child != top);
        }
        notes.fault(|| {
            format!(
                "{}: it is its own ancestor; nodes must form a tree, and it is read as a root",
                node_name(document, top)
            )
        });
        open = visit(&children, std::iter::once(top));
    }
    (children, parents)
}

/// The nodes of a scene of which no other one of them is an ancestor.
fn tops(
    document: &Document,
    scene: &document::Scene,
    parents: &[Option<usize>],
    order: &[usize],
    notes: &Notes,
) -> Vec<usize> {
    let index = scene.index;
    let mut is_listed = vec![false; parents.len()];
    let mut listed = Vec::new();
    for &node in &scene.nodes {
        if std::mem::replace(&mut is_listed[node], true) {
            notes.fault(|| {
                format!(
                    "scene {index}: {} is listed twice; it is drawn once",
                    node_name(document, node)
                )
            });
        } else {
            listed.push(node);
        }
    }
    let children: Vec<usize> = listed
        .iter()
        .copied()
        .filter(|&node| parents[node].is_some())
        .collect();
    if let Some(&first) = children.first() {
        notes.fault(|| {
            let more = match children.len() - 1 {
                0 => " has a parent".into(),
                more => format!(" and {more} more nodes have parents"),
            };
            format!(
                "scene {index} must list root nodes only, but {}{more}; each is drawn once, where its parent places it",
                node_name(document, first)
            )
        });
    }
    // A node below another of the list is drawn once, with that one.
    let mut is_below = vec![false; parents.len()];
    for &node in order {
        is_below[node] = parents[node].is_some_and(|parent| is_listed[parent] || is_below[parent]);
    }
    listed.retain(|&node| !is_below[node]);
    listed
}

/// All nodes below `tops`, depth first.
fn visit(children: &[Vec<usize>], tops: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut open: Vec<usize> = tops.into_iter().collect();
    open.reverse();
    let mut visited = Vec::new();
    while let Some(node) = open.pop() {
        visited.push(node);
        open.extend(children[node].iter().rev());
    }
    visited
}

/// Deviations from length 1 above this are reported.
pub const LENGTH_TOLERANCE: f64 = 0.01;

/// Is its rotation no unit quaternion?
fn is_crooked(node: &document::Node) -> bool {
    let length = |q: [f32; 4]| q.map(|v| f64::from(v).powi(2)).iter().sum::<f64>().sqrt();
    node.rotation
        .is_some_and(|q| (length(q) - 1.0).abs() > LENGTH_TOLERANCE)
}

/// The transform of a node relative to its parent.
fn local(node: &document::Node) -> LocalTransform {
    if let Some(matrix) = node.matrix {
        return LocalTransform::Matrix(DMat4::from_cols_array(&matrix));
    }
    LocalTransform::Trs(Trs {
        translation: node.translation.map_or(DVec3::ZERO, DVec3::from),
        rotation: unit(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]).map(f64::from)),
        scale: (node.scale).map_or(DVec3::ONE, |scale| scale.map(f64::from).into()),
    })
}

/// Morph weights of a node in the rest pose: its own, else those of its mesh, else zeros. One for
/// each target of the primitive of its mesh that has most.
fn morph_weights(document: &Document, index: usize, notes: &Notes) -> Vec<f32> {
    let node = &document.nodes[index];
    let Some(mesh) = node.mesh.map(|mesh| &document.meshes[mesh]) else {
        return Vec::new();
    };
    let counts = || mesh.sound().map(|(_, primitive)| primitive.targets.len());
    let morph_targets = counts().max().unwrap_or(0);
    let name = || node_name(document, index);
    if let Some(fewer) = counts().find(|&count| count != morph_targets) {
        notes.fault(|| {
            format!(
                "{}: the primitives of its mesh have {fewer} and {morph_targets} morph targets; all should have the same number",
                name()
            )
        });
    }
    let given = match node.weights.is_empty() {
        true => &mesh.weights,
        false => &node.weights,
    };
    if !given.is_empty() && given.len() != morph_targets {
        notes.fault(|| {
            format!(
                "{}: it has {} weights for {morph_targets} morph targets; both numbers must be equal",
                name(),
                given.len()
            )
        });
    }
    let mut weights = given.clone();
    weights.resize(morph_targets, 0.0);
    weights
}

/// The camera at a node: it looks along -z with +y up. Scale does not affect it. None where the
/// node has no direction.
fn pose(camera: &document::Camera, world_from_node: &DMat4, bounds: &Bounds) -> Option<Camera> {
    let eye = world_from_node.w_axis.truncate();
    let forward = (-world_from_node.z_axis.truncate()).try_normalize()?;
    let up = world_from_node
        .y_axis
        .truncate()
        .try_normalize()
        .unwrap_or(DVec3::Y);
    let distance = (bounds.center() - eye).length();
    let distance = if distance > 1e-6 && distance.is_finite() {
        distance
    } else {
        1.0
    };
    Some(Camera {
        eye,
        target: eye + forward * distance,
        up,
        projection: camera.projection,
        near_m: camera.near.max(MIN_NEAR_M),
    })
}
