//! Nodes: the tree walked without recursion, world matrices in f64, and cameras.

use glam::{DMat4, DVec3};
use gltf::json::{self, camera::Type, validation::Checked};

use super::{LoadError, called, limits, soft};
use crate::scene::{
    Bounds, SceneCamera,
    camera::{Camera, MIN_NEAR_M, Projection},
    pose::unit,
    rig::{Local, Node, Trs},
};

/// World matrix of every node, and the nodes that are shown.
pub struct Tree {
    pub world_from_node: Vec<DMat4>,
    /// Nodes of the default scene (else the first, else all), parents before children.
    pub shown: Vec<usize>,
    /// All nodes, parents before children.
    order: Vec<usize>,
    /// Place of every node in that order.
    pub place_of: Vec<usize>,
}

impl Tree {
    /// Refuses cycles, nodes with two parents, more than [`limits::NODE_DEPTH`] levels and matrices that are not affine.
    pub fn walk(root: &json::Root) -> Result<Self, LoadError> {
        let parents = parents(root)?;
        let roots: Vec<usize> = (0..root.nodes.len()).filter(|&node| parents[node].is_none()).collect();
        let mut world_from_node = vec![DMat4::IDENTITY; root.nodes.len()];
        let all = visit(root, &roots, |node| {
            let parent = parents[node].map_or(DMat4::IDENTITY, |parent| world_from_node[parent]);
            let local = local(&root.nodes[node]).map_err(|error| error.within(node_name(root, node)))?;
            world_from_node[node] = parent * local.matrix();
            if world_from_node[node].is_finite() {
                Ok(())
            } else {
                Err(LoadError::new("its place in the world is not finite").within(node_name(root, node)))
            }
        })?;
        if all.len() < root.nodes.len() {
            return Err(LoadError::new("is its own ancestor").within(node_name(root, on_a_cycle(&parents, &all))));
        }
        let scene = root.scene.map(|scene| scene.value()).or((!root.scenes.is_empty()).then_some(0));
        let mut place_of = vec![0; all.len()];
        all.iter().enumerate().for_each(|(place, &node)| place_of[node] = place);
        let Some(scene) = scene else { return Ok(Self { world_from_node, shown: all.clone(), order: all, place_of }) };
        let tops: Vec<usize> = root.scenes[scene].nodes.iter().map(|node| node.value()).collect();
        let mut listed = tops.clone();
        listed.sort_unstable();
        if let Some(&node) = tops.iter().find(|&&node| parents[node].is_some()) {
            return Err(LoadError::new(format!("{} is not a root node", node_name(root, node))).within(format!("scene {scene}")));
        }
        if let Some(pair) = listed.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(LoadError::new(format!("{} is listed twice", node_name(root, pair[0]))).within(format!("scene {scene}")));
        }
        let shown = visit(root, &tops, |_| Ok(()))?;
        Ok(Self { world_from_node, shown, order: all, place_of })
    }

    /// The nodes as a rig has them.
    pub fn rig_nodes(&self, root: &json::Root) -> Result<Vec<Node>, LoadError> {
        let parents = parents(root)?;
        let mut weights_in_all = 0;
        let node = |&index: &usize| {
            let node = &root.nodes[index];
            let place = |error: LoadError| error.within(node_name(root, index));
            let weights = soft::weights(root, node).map_err(place)?;
            weights_in_all += weights.len();
            if weights_in_all > limits::WEIGHTS {
                let reason = format!("brings the nodes to {weights_in_all} morph weights; at most {} are read", limits::WEIGHTS);
                return Err(place(LoadError::new(reason)));
            }
            Ok(Node {
                name: node_name(root, index),
                parent: parents[index].map(|parent| self.place_of[parent]),
                rest: local(node).map_err(place)?,
                weights,
            })
        };
        self.order.iter().map(node).collect()
    }

    /// What to say of rotations that are no unit quaternions.
    pub fn uneven(&self, root: &json::Root) -> Option<String> {
        let length = |q: &[f32; 4]| q.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt();
        let is_uneven = |&&node: &&usize| root.nodes[node].rotation.is_some_and(|q| (length(&q.0) - 1.0).abs() > UNEVEN);
        let count = self.order.iter().filter(is_uneven).count();
        (count > 0).then(|| format!("{count} node rotations are no unit quaternions; they are taken by their direction"))
    }

    /// The cameras among the shown nodes. Their targets lie as far away as the middle of `bounds`; where things move, they
    /// go with their nodes.
    pub fn cameras(&self, root: &json::Root, bounds: &Bounds, moves: bool, notes: &mut Vec<String>) -> Vec<SceneCamera> {
        let mut cameras = Vec::new();
        for &node in &self.shown {
            let Some(index) = root.nodes[node].camera else { continue };
            let camera = &root.cameras[index.value()];
            let name = camera.name.clone().or_else(|| root.nodes[node].name.clone()).unwrap_or_else(|| format!("camera {}", index.value()));
            match pose(camera, &self.world_from_node[node], bounds) {
                Ok(pose) => cameras.push(SceneCamera { name: shown(&name, cameras.len()), pose, node: moves.then(|| self.place_of[node]) }),
                Err(reason) => notes.push(format!("{} is left out: {reason}", called("camera", index.value(), Some(&name)))),
            }
        }
        cameras
    }
}

pub fn node_name(root: &json::Root, node: usize) -> String {
    called("node", node, root.nodes[node].name.as_deref())
}

fn parents(root: &json::Root) -> Result<Vec<Option<usize>>, LoadError> {
    let mut parents = vec![None; root.nodes.len()];
    for (node, children) in root.nodes.iter().enumerate().filter_map(|(i, node)| Some((i, node.children.as_ref()?))) {
        for child in children {
            if parents[child.value()].replace(node).is_some() {
                return Err(LoadError::new("has more than one parent").within(node_name(root, child.value())));
            }
        }
    }
    Ok(parents)
}

/// What no root reaches hangs on a cycle; going up from there leads onto it.
fn on_a_cycle(parents: &[Option<usize>], reached: &[usize]) -> usize {
    let mut lost = vec![true; parents.len()];
    reached.iter().for_each(|&node| lost[node] = false);
    let start = lost.iter().position(|&lost| lost).unwrap_or_default();
    (0..parents.len()).fold(start, |node, _| parents[node].unwrap_or(node))
}

/// All nodes below `tops`, depth first. Each has one parent, so a node is met once unless `tops` holds a node twice.
fn visit(root: &json::Root, tops: &[usize], mut arrive: impl FnMut(usize) -> Result<(), LoadError>) -> Result<Vec<usize>, LoadError> {
    let mut visited = Vec::new();
    let mut open: Vec<(usize, usize)> = tops.iter().rev().map(|&node| (node, 1)).collect();
    while let Some((node, depth)) = open.pop() {
        if depth > limits::NODE_DEPTH {
            return Err(LoadError::new(format!("lies deeper than {} levels", limits::NODE_DEPTH)).within(node_name(root, node)));
        }
        arrive(node)?;
        visited.push(node);
        open.extend(root.nodes[node].children.iter().flatten().rev().map(|child| (child.value(), depth + 1)));
    }
    Ok(visited)
}

/// Where a node stands in its parent.
/// Shorter quaternions have no direction that anybody meant.
pub const LEAST_LENGTH: f64 = 1e-6;

/// Quaternions whose length is further from 1 are remarked on.
pub const UNEVEN: f64 = 0.01;

fn local(node: &json::Node) -> Result<Local, LoadError> {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        let last_row = matrix.row(3);
        return if last_row == glam::DVec4::W {
            Ok(Local::Matrix(matrix))
        } else {
            Err(LoadError::new(format!("the last row of its matrix is {last_row}, not 0 0 0 1")))
        };
    }
    let vector = |v: Option<[f32; 3]>, default: DVec3| v.map_or(default, |v| v.map(f64::from).into());
    let rotation = node.rotation.unwrap_or_default().0.map(f64::from);
    let length = rotation.iter().map(|v| v * v).sum::<f64>().sqrt();
    if !(length.is_finite() && length >= LEAST_LENGTH) {
        return Err(LoadError::new("its rotation is not a quaternion with a direction"));
    }
    let (translation, scale) = (vector(node.translation, DVec3::ZERO), vector(node.scale, DVec3::ONE));
    Ok(Local::Trs(Trs { translation, rotation: unit(rotation), scale }))
}

/// As menus and presets name it, the `place`th of them.
fn shown(name: &str, place: usize) -> String {
    let name: String = name.chars().filter(|c| !c.is_control()).take(60).collect();
    if name.trim().is_empty() { format!("camera {place}") } else { name }
}

/// A camera looks along its node's -z with +y up; scale has no meaning for it.
fn pose(camera: &json::Camera, world_from_node: &DMat4, bounds: &Bounds) -> Result<Camera, String> {
    let eye = world_from_node.w_axis.truncate();
    let forward = (-world_from_node.z_axis.truncate()).try_normalize().ok_or("it looks nowhere")?;
    let up = world_from_node.y_axis.truncate().try_normalize().unwrap_or(DVec3::Y);
    let distance = (bounds.center() - eye).length();
    let distance = if distance > 1e-6 && distance.is_finite() { distance } else { 1.0 };
    let (projection, near) = match (&camera.type_, &camera.perspective, &camera.orthographic) {
        (Checked::Valid(Type::Perspective), Some(lens), _) => {
            let fov_y_deg = f64::from(lens.yfov).to_degrees();
            if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
                return Err(format!("yfov {} lies outside 0..pi", lens.yfov));
            }
            (Projection::Perspective { fov_y_deg }, f64::from(lens.znear))
        }
        (Checked::Valid(Type::Orthographic), _, Some(lens)) => {
            let height_m = 2.0 * f64::from(lens.ymag);
            if !(height_m > 0.0 && height_m.is_finite()) {
                return Err(format!("ymag {} is not a positive number", lens.ymag));
            }
            (Projection::Orthographic { height_m }, f64::from(lens.znear))
        }
        _ => return Err("its lens is missing".into()),
    };
    let near_m = if near.is_finite() { near.max(MIN_NEAR_M) } else { MIN_NEAR_M };
    Ok(Camera { eye, target: eye + forward * distance, up, projection, near_m })
}
