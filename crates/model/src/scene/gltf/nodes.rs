//! Nodes: traverses the node tree without recursion; world matrices in f64, morph weights and
//! cameras.

use glam::{DMat4, DVec3};
use gltf::json::{self, camera::Type, validation::Checked};

use super::{
    error::{LoadError, called, part_name},
    limits,
    notes::Notes,
};
use crate::scene::{
    bounds::Bounds,
    camera::{Camera, MIN_NEAR_M, Projection},
    model::{NamedNode, SceneCamera},
    quaternion::unit,
    rig::{LocalTransform, Node, Trs},
};

/// The node tree.
pub struct Tree {
    /// World transform of each node in the rest pose.
    pub world_from_node: Vec<DMat4>,
    /// Nodes of the default scene (else of the first scene, else all), parents before children.
    pub shown: Vec<usize>,
    /// All nodes, parents before children.
    order: Vec<usize>,
    /// Position of every node in `order`, which is its index in the rig.
    pub rig_index: Vec<usize>,
    /// What breaks the standard, though every viewer draws it.
    pub fault: Option<String>,
}

impl Tree {
    /// Traverses the nodes. Refuses cycles, nodes with two parents, more than
    /// [`limits::NODE_DEPTH`] levels and matrices that are not affine.
    pub fn walk(root: &json::Root) -> Result<Self, LoadError> {
        let parents = parents(root)?;
        let roots: Vec<usize> = (0..root.nodes.len())
            .filter(|&node| parents[node].is_none())
            .collect();
        let mut world_from_node = vec![DMat4::IDENTITY; root.nodes.len()];
        let all = visit(root, &roots, |node| {
            let parent = parents[node].map_or(DMat4::IDENTITY, |parent| world_from_node[parent]);
            let local =
                local(&root.nodes[node]).map_err(|error| error.within(node_name(root, node)))?;
            world_from_node[node] = parent * local.matrix();
            if world_from_node[node].is_finite() {
                Ok(())
            } else {
                Err(LoadError::new("its world transform is not finite")
                    .within(node_name(root, node)))
            }
        })?;
        if all.len() < root.nodes.len() {
            return Err(
                LoadError::new("it is its own ancestor; nodes must form a tree")
                    .within(node_name(root, on_a_cycle(&parents, &all))),
            );
        }
        let scene = root
            .scene
            .map(|scene| scene.value())
            .or((!root.scenes.is_empty()).then_some(0));
        let mut rig_index = vec![0; all.len()];
        all.iter()
            .enumerate()
            .for_each(|(in_node, &node)| rig_index[node] = in_node);
        let Some(scene) = scene else {
            return Ok(Self {
                world_from_node,
                shown: all.clone(),
                order: all,
                rig_index,
                fault: None,
            });
        };
        let tops: Vec<usize> = root.scenes[scene]
            .nodes
            .iter()
            .map(|node| node.value())
            .collect();
        let mut listed = tops.clone();
        listed.sort_unstable();
        if let Some(pair) = listed.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(LoadError::new(format!(
                "{} is listed twice; remove one entry",
                node_name(root, pair[0])
            ))
            .within(format!("scene {scene}")));
        }
        // A node below another of the list is drawn once, with that one.
        let is_below = |node: usize| {
            std::iter::successors(parents[node], |&parent| parents[parent])
                .any(|parent| listed.binary_search(&parent).is_ok())
        };
        let highest: Vec<usize> = tops
            .iter()
            .copied()
            .filter(|&node| !is_below(node))
            .collect();
        let children: Vec<usize> = tops
            .into_iter()
            .filter(|&node| parents[node].is_some())
            .collect();
        let fault = children.first().map(|&first| {
            let more =
                if children.len() > 1 { format!(" and {} more nodes have parents", children.len() - 1) } else { " has a parent".into() };
            format!(
                "scene {scene} must list root nodes only, but {}{more}; each is drawn once, where its parent places it",
                node_name(root, first)
            )
        });
        let shown = visit(root, &highest, |_| Ok(()))?;
        Ok(Self {
            world_from_node,
            shown,
            order: all,
            rig_index,
            fault,
        })
    }

    /// The nodes of the rig.
    pub fn rig_nodes(&self, root: &json::Root) -> Result<Vec<Node>, LoadError> {
        let parents = parents(root)?;
        let mut weights_in_all = 0;
        let node = |&index: &usize| {
            let node = &root.nodes[index];
            let in_node = |error: LoadError| error.within(node_name(root, index));
            let weights = morph_weights(root, node).map_err(in_node)?;
            weights_in_all += weights.len();
            if weights_in_all > limits::WEIGHTS {
                let reason = format!(
                    "the nodes have {weights_in_all} morph weights or more; allowed: at most {}",
                    limits::WEIGHTS
                );
                return Err(in_node(LoadError::new(reason)));
            }
            Ok(Node {
                name: node_name(root, index),
                parent: parents[index].map(|parent| self.rig_index[parent]),
                rest: local(node).map_err(in_node)?,
                weights,
            })
        };
        self.order.iter().map(node).collect()
    }

    /// The names of all nodes, in the order of the rig.
    pub fn named_nodes(&self, root: &json::Root) -> Result<Vec<NamedNode>, LoadError> {
        let parents = parents(root)?;
        let named = |&node: &usize| NamedNode {
            name: part_name("node", node, root.nodes[node].name.as_deref()),
            parent: parents[node].map(|parent| self.rig_index[parent]),
        };
        Ok(self.order.iter().map(named).collect())
    }

    /// A message about rotations that are not unit quaternions, if there are any.
    pub fn rotation_note(&self, root: &json::Root) -> Option<String> {
        let length = |q: &[f32; 4]| {
            q.iter()
                .map(|&v| f64::from(v) * f64::from(v))
                .sum::<f64>()
                .sqrt()
        };
        let is_not_normalized = |&&node: &&usize| {
            root.nodes[node]
                .rotation
                .is_some_and(|q| (length(&q.0) - 1.0).abs() > LENGTH_TOLERANCE)
        };
        let count = self.order.iter().filter(is_not_normalized).count();
        (count > 0).then(|| {
            format!("{count} node rotations are not unit quaternions; they are normalized")
        })
    }

    /// The cameras of the shown nodes. Their targets are as far away as the center of `bounds`.
    /// With `moves` they follow their nodes.
    pub fn cameras(
        &self,
        root: &json::Root,
        bounds: &Bounds,
        moves: bool,
        notes: &mut Notes,
    ) -> Vec<SceneCamera> {
        let mut cameras = Vec::new();
        for &node in &self.shown {
            let Some(index) = root.nodes[node].camera else {
                continue;
            };
            let camera = &root.cameras[index.value()];
            let name = camera
                .name
                .clone()
                .or_else(|| root.nodes[node].name.clone())
                .unwrap_or_else(|| format!("camera {}", index.value()));
            match pose(camera, &self.world_from_node[node], bounds) {
                Ok(pose) => cameras.push(SceneCamera {
                    name: shown(&name, cameras.len()),
                    pose,
                    node: moves.then(|| self.rig_index[node]),
                }),
                Err(reason) => notes.add(|| {
                    format!(
                        "{} is skipped: {reason}",
                        called("camera", index.value(), Some(&name))
                    )
                }),
            }
        }
        cameras
    }
}

/// A node as error messages name it.
pub fn node_name(root: &json::Root, node: usize) -> String {
    called("node", node, root.nodes[node].name.as_deref())
}

fn parents(root: &json::Root) -> Result<Vec<Option<usize>>, LoadError> {
    let mut parents = vec![None; root.nodes.len()];
    for (node, children) in root
        .nodes
        .iter()
        .enumerate()
        .filter_map(|(i, node)| Some((i, node.children.as_ref()?)))
    {
        for child in children {
            if parents[child.value()].replace(node).is_some() {
                return Err(
                    LoadError::new("it has more than one parent; nodes must form a tree")
                        .within(node_name(root, child.value())),
                );
            }
        }
    }
    Ok(parents)
}

/// A node on a cycle: nodes that no root reaches lie below a cycle, and going up from one leads
/// onto it.
fn on_a_cycle(parents: &[Option<usize>], reached: &[usize]) -> usize {
    let mut lost = vec![true; parents.len()];
    reached.iter().for_each(|&node| lost[node] = false);
    let start = lost.iter().position(|&lost| lost).unwrap_or_default();
    (0..parents.len()).fold(start, |node, _| parents[node].unwrap_or(node))
}

/// All nodes below `tops`, depth first. Each has one parent, so a node is visited twice only if
/// `tops` lists a node twice.
fn visit(
    root: &json::Root,
    tops: &[usize],
    mut arrive: impl FnMut(usize) -> Result<(), LoadError>,
) -> Result<Vec<usize>, LoadError> {
    let mut visited = Vec::new();
    let mut open: Vec<(usize, usize)> = tops.iter().rev().map(|&node| (node, 1)).collect();
    while let Some((node, depth)) = open.pop() {
        if depth > limits::NODE_DEPTH {
            return Err(LoadError::new(format!(
                "it lies deeper than {} levels; flatten the hierarchy",
                limits::NODE_DEPTH
            ))
            .within(node_name(root, node)));
        }
        arrive(node)?;
        visited.push(node);
        open.extend(
            root.nodes[node]
                .children
                .iter()
                .flatten()
                .rev()
                .map(|child| (child.value(), depth + 1)),
        );
    }
    Ok(visited)
}

/// The smallest length of a quaternion that is normalized; shorter ones have no meaningful
/// direction.
pub const MIN_QUATERNION_LENGTH: f64 = 1e-6;

/// Deviations from length 1 above this are reported.
pub const LENGTH_TOLERANCE: f64 = 0.01;

/// The transform of a node relative to its parent.
fn local(node: &json::Node) -> Result<LocalTransform, LoadError> {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        let last_row = matrix.row(3);
        return if last_row == glam::DVec4::W {
            Ok(LocalTransform::Matrix(matrix))
        } else {
            Err(LoadError::new(format!(
                "the last row of its matrix is {last_row}; it must be 0 0 0 1"
            )))
        };
    }
    let vector =
        |v: Option<[f32; 3]>, default: DVec3| v.map_or(default, |v| v.map(f64::from).into());
    let rotation = node.rotation.unwrap_or_default().0.map(f64::from);
    let length = rotation.iter().map(|v| v * v).sum::<f64>().sqrt();
    if !(length.is_finite() && length >= MIN_QUATERNION_LENGTH) {
        return Err(LoadError::new(format!(
            "its rotation is a quaternion of length {length:e}; it must be finite and at least {MIN_QUATERNION_LENGTH:e}"
        )));
    }
    let (translation, scale) = (
        vector(node.translation, DVec3::ZERO),
        vector(node.scale, DVec3::ONE),
    );
    Ok(LocalTransform::Trs(Trs {
        translation,
        rotation: unit(rotation),
        scale,
    }))
}

/// Morph weights of a node in the rest pose: its own, else those of its mesh, else zeros.
fn morph_weights(root: &json::Root, node: &json::Node) -> Result<Vec<f32>, LoadError> {
    let Some(mesh) = node.mesh.map(|mesh| &root.meshes[mesh.value()]) else {
        return Ok(Vec::new());
    };
    let counts = mesh
        .primitives
        .iter()
        .map(|primitive| primitive.targets.as_ref().map_or(0, Vec::len));
    let morph_targets = counts.clone().max().unwrap_or(0);
    if morph_targets > limits::MORPH_TARGETS {
        return Err(LoadError::new(format!(
            "its mesh has {morph_targets} morph targets; allowed: at most {}",
            limits::MORPH_TARGETS
        )));
    }
    if let Some(fewer) = counts.clone().find(|&count| count != morph_targets) {
        return Err(LoadError::new(format!(
            "the primitives of its mesh have {fewer} and {morph_targets} morph targets; all must have the same number"
        )));
    }
    let given = node
        .weights
        .as_ref()
        .or(mesh.weights.as_ref())
        .filter(|weights| !weights.is_empty());
    match given {
        None => Ok(vec![0.0; morph_targets]),
        Some(weights) if weights.len() != morph_targets => Err(LoadError::new(format!(
            "it has {} weights for {morph_targets} morph targets; both numbers must be equal",
            weights.len()
        ))),
        Some(weights) => match weights.iter().find(|weight| !weight.is_finite()) {
            Some(weight) => Err(LoadError::new(format!(
                "it has the morph weight {weight}; weights must be finite"
            ))),
            None => Ok(weights.clone()),
        },
    }
}

/// The name of camera `index` in menus and presets.
fn shown(name: &str, in_node: usize) -> String {
    let name: String = name.chars().filter(|c| !c.is_control()).take(60).collect();
    if name.trim().is_empty() {
        format!("camera {in_node}")
    } else {
        name
    }
}

/// The camera at a node: it looks along -z with +y up. Scale does not affect it.
fn pose(camera: &json::Camera, world_from_node: &DMat4, bounds: &Bounds) -> Result<Camera, String> {
    let eye = world_from_node.w_axis.truncate();
    let forward = (-world_from_node.z_axis.truncate())
        .try_normalize()
        .ok_or("its node has no direction")?;
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
    let (projection, near) = match (&camera.type_, &camera.perspective, &camera.orthographic) {
        (Checked::Valid(Type::Perspective), Some(lens), _) => {
            let fov_y_deg = f64::from(lens.yfov).to_degrees();
            if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
                return Err(format!(
                    "yfov is {}; it must be above 0 and below pi",
                    lens.yfov
                ));
            }
            (Projection::Perspective { fov_y_deg }, f64::from(lens.znear))
        }
        (Checked::Valid(Type::Orthographic), _, Some(lens)) => {
            let height_m = 2.0 * f64::from(lens.ymag);
            if !(height_m > 0.0 && height_m.is_finite()) {
                return Err(format!(
                    "ymag is {}; it must be positive and finite",
                    lens.ymag
                ));
            }
            (Projection::Orthographic { height_m }, f64::from(lens.znear))
        }
        _ => return Err("it has neither perspective nor orthographic parameters".into()),
    };
    let near_m = if near.is_finite() {
        near.max(MIN_NEAR_M)
    } else {
        MIN_NEAR_M
    };
    Ok(Camera {
        eye,
        target: eye + forward * distance,
        up,
        projection,
        near_m,
    })
}
