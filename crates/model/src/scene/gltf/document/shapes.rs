//! Buffers, accessors, meshes, nodes, scenes and cameras.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{
    super::{
        compression::{DRACO, MESHOPT},
        error::{called, quoted},
        instancing::INSTANCING,
    },
    Accessor, Buffer, Camera, Instancing, Mesh, Node, Part, Primitive, Scene, Sparse, View,
    fields::{Lenient, Object, needed, whole},
    lights,
    read::{Lists, is_unknown_compression},
    variants,
};
use crate::scene::{accessor::ComponentType, camera::Projection, model::Topology};

const COMPONENT_TYPES: [(u64, ComponentType); 6] = [
    (5120, ComponentType::I8),
    (5121, ComponentType::U8),
    (5122, ComponentType::I16),
    (5123, ComponentType::U16),
    (5125, ComponentType::U32),
    (5126, ComponentType::F32),
];

/// Component types of indices.
const INDEX_TYPES: [(u64, ComponentType); 3] = [
    (5121, ComponentType::U8),
    (5123, ComponentType::U16),
    (5125, ComponentType::U32),
];

/// Types of elements, and their components.
const TYPES: [(&str, u32); 7] = [
    ("SCALAR", 1),
    ("VEC2", 2),
    ("VEC3", 3),
    ("VEC4", 4),
    ("MAT2", 4),
    ("MAT3", 9),
    ("MAT4", 16),
];

/// Modes of primitives; points and lines have no topology.
const MODES: [(u64, Option<Topology>); 7] = [
    (0, None),
    (1, None),
    (2, None),
    (3, None),
    (4, Some(Topology::List)),
    (5, Some(Topology::Strip)),
    (6, Some(Topology::Fan)),
];

pub fn accessor(lists: &Lists, index: usize, part: Object) -> Part<Accessor> {
    let lenient = Lenient {
        notes: lists.notes,
        name: format!("accessor {index}"),
    };
    let components = needed("type", part.word("type", &TYPES))?;
    let bounds = |key: &str| match lenient.field(part.numbers(key)) {
        Some(numbers) if numbers.len() == components as usize => true,
        Some(numbers) => {
            let count = numbers.len();
            lenient.fault(format_args!(
                "its {key} has {count} of {components} numbers"
            ));
            false
        }
        None => false,
    };
    let (has_min, has_max) = (bounds("min"), bounds("max"));
    Ok(Accessor {
        view: part.index("bufferView", "buffer views", lists.views.len())?,
        offset: part.integer("byteOffset")?.unwrap_or(0),
        count: needed("count", part.integer("count"))?,
        component_type: needed(
            "componentType",
            part.choice("componentType", &COMPONENT_TYPES),
        )?,
        components,
        normalized: part.flag("normalized")?.unwrap_or(false),
        sparse: match part.object("sparse")? {
            Some(sparse) => {
                Some(self::sparse(lists, sparse).map_err(|reason| format!("sparse: {reason}"))?)
            }
            None => None,
        },
        has_bounds: has_min && has_max,
    })
}

fn sparse(lists: &Lists, part: Object) -> Part<Sparse> {
    let place = |part: Object| {
        let view = part.index("bufferView", "buffer views", lists.views.len());
        Ok::<_, String>((
            needed("bufferView", view)?,
            part.integer("byteOffset")?.unwrap_or(0),
        ))
    };
    let (indices, values) = (
        needed("indices", part.object("indices"))?,
        needed("values", part.object("values"))?,
    );
    Ok(Sparse {
        count: needed("count", part.integer("count"))?,
        indices: place(indices)?,
        index_type: needed(
            "componentType",
            indices.choice("componentType", &INDEX_TYPES),
        )?,
        values: place(values)?,
    })
}

pub fn view(lists: &Lists, part: Object) -> Part<View> {
    let meshopt = match part.extension(MESHOPT)? {
        Some(extension) => Some(
            extension
                .parsed()
                .map_err(|error| format!("its {MESHOPT} is malformed: {error}"))?,
        ),
        None => None,
    };
    let buffer = part.index("buffer", "buffers", lists.buffers.len());
    Ok(View {
        buffer: needed("buffer", buffer)?,
        offset: part.integer("byteOffset")?.unwrap_or(0),
        length: needed("byteLength", part.integer("byteLength"))?,
        // Some writers give every view one, of 0 where there is none.
        stride: part.integer("byteStride")?.filter(|&stride| stride > 0),
        meshopt,
    })
}

pub fn buffer(lists: &Lists, index: usize, part: Object) -> Part<Buffer> {
    let fallback = match part.extension(MESHOPT)? {
        Some(extension) => extension.flag("fallback")?,
        None => None,
    };
    lists.lenient("buffer", index, part);
    Ok(Buffer {
        uri: part.text("uri")?.map(str::to_owned),
        length: needed("byteLength", part.integer("byteLength"))?,
        is_fallback: fallback.unwrap_or(false),
    })
}

/// Mesh `index`; an empty one where it is no object.
pub fn mesh(lists: &Lists, index: usize, value: &Value) -> Mesh {
    let Some(part) = lists.object("mesh", index, value) else {
        return Mesh {
            name: None,
            primitives: Vec::new(),
            weights: Vec::new(),
        };
    };
    let lenient = lists.lenient("mesh", index, part);
    let primitives = lenient.list(part.list("primitives"));
    Mesh {
        name: part.text("name").ok().flatten().map(str::to_owned),
        weights: lenient.field(part.numbers("weights")).unwrap_or_default(),
        primitives: primitives
            .iter()
            .enumerate()
            .map(|(at, value)| {
                let lenient = Lenient {
                    notes: lists.notes,
                    name: format!("{} primitive {at}", lenient.name),
                };
                primitive(lists, &lenient, Object::of(value)?)
            })
            .collect(),
    }
}

fn primitive(lists: &Lists, lenient: &Lenient, part: Object) -> Part<Primitive> {
    let attributes = needed("attributes", part.object("attributes"))?;
    let targets = lenient.list(part.list("targets"));
    let draco = match part.extension(DRACO)? {
        Some(extension) => Some(
            extension
                .parsed()
                .map_err(|error| format!("its {DRACO} is malformed: {error}"))?,
        ),
        None => None,
    };
    let primitive = Primitive {
        attributes: accessors(lists, lenient, attributes),
        indices: part.index("indices", "accessors", lists.accessors.len())?,
        topology: part.choice("mode", &MODES)?.unwrap_or(Some(Topology::List)),
        material: lenient.field(part.index("material", "materials", lists.materials.len())),
        variants: variants::materials(lists, lenient, part),
        targets: targets
            .iter()
            .map(|target| match Object::of(target) {
                Ok(target) => accessors(lists, lenient, target),
                Err(reason) => {
                    lenient.fault(format_args!("of its targets, {reason}"));
                    BTreeMap::new()
                }
            })
            .collect(),
        draco,
    };
    let is_empty = |accessor: usize| {
        let Some(Ok(about)) = lists.accessors.get(accessor).map(Object::of) else {
            return false;
        };
        about.value("bufferView").is_none() && about.value("sparse").is_none()
    };
    let extensions = part.object("extensions")?;
    let packed = extensions
        .into_iter()
        .flat_map(Object::entries)
        .find(|(name, _)| is_unknown_compression(name));
    match packed {
        Some((name, _)) if primitive.accessors().any(is_empty) => Err(format!(
            "it is compressed with {}, which is not supported",
            quoted(name)
        )),
        _ => Ok(primitive),
    }
}

/// The sets of attributes of the standard, without their numbers.
const SETS: [&str; 4] = ["TEXCOORD", "COLOR", "JOINTS", "WEIGHTS"];

/// The accessors of attributes. Those of names that begin with `_` are of applications.
fn accessors(lists: &Lists, lenient: &Lenient, part: Object) -> BTreeMap<String, usize> {
    let is_known = |name: &str| {
        let in_set = |(set, number): (&str, &str)| {
            SETS.contains(&set) && number.parse::<u32>().is_ok_and(|n| n.to_string() == number)
        };
        matches!(name, "POSITION" | "NORMAL" | "TANGENT")
            || name.split_once('_').is_some_and(in_set)
    };
    let mut accessors = BTreeMap::new();
    for (name, value) in part.entries().filter(|(name, _)| !name.starts_with('_')) {
        let count = lists.accessors.len();
        match whole(value).filter(|&index| index < count as u64) {
            _ if !is_known(name) => lenient.fault(format_args!(
                "its attribute {} is none of glTF; names of applications begin with _",
                quoted(name)
            )),
            Some(index) => drop(accessors.insert(name.to_owned(), index as usize)),
            None => lenient.fault(format_args!(
                "its {name} refers to accessor {value}, but there are only {count}"
            )),
        }
    }
    accessors
}

/// Node `index`; an empty one where it is no object.
pub fn node(lists: &Lists, index: usize, value: &Value) -> Node {
    let Some(part) = lists.object("node", index, value) else {
        return Node::default();
    };
    let lenient = lists.lenient("node", index, part);
    let nodes = ("nodes", lists.nodes.len());
    let children = part.indices("children", nodes, |reason| lenient.fault(reason));
    let instancing = self::instancing(lists, &lenient.name, part);
    let mut node = Node {
        name: part.text("name").ok().flatten().map(str::to_owned),
        children: lenient.list(children),
        matrix: lenient.field(part.vector("matrix")),
        translation: lenient.field(part.vector("translation")),
        rotation: lenient.field(part.vector("rotation")),
        scale: lenient.field(part.vector("scale")),
        mesh: lenient.field(part.index("mesh", "meshes", lists.meshes.len())),
        skin: lenient.field(part.index("skin", "skins", lists.skins.len())),
        camera: lenient.field(part.index("camera", "cameras", lists.cameras.len())),
        light: lenient.field(lights::of_node(lists, part)),
        weights: lenient.field(part.numbers("weights")).unwrap_or_default(),
        instancing,
    };
    if let Some(matrix) = &mut node.matrix {
        let last_row = [matrix[3], matrix[7], matrix[11], matrix[15]];
        if last_row != [0.0, 0.0, 0.0, 1.0] {
            lists.notes.fault(|| {
                format!(
                    "{}: the last row of its matrix is {last_row:?}; it is read as 0 0 0 1",
                    lenient.name
                )
            });
            (matrix[3], matrix[7], matrix[11], matrix[15]) = (0.0, 0.0, 0.0, 1.0);
        }
        if node.translation.or(node.scale).is_some() || node.rotation.is_some() {
            lists.notes.fault(|| {
                format!(
                    "{}: it has a matrix and also translation, rotation or scale; the matrix is used",
                    lenient.name
                )
            });
        }
    }
    let length = |q: [f32; 4]| q.map(|v| f64::from(v).powi(2)).iter().sum::<f64>().sqrt();
    if let Some(short) = node
        .rotation
        .map(length)
        .filter(|&length| length < MIN_QUATERNION_LENGTH)
    {
        lenient.fault(format_args!(
            "its rotation is a quaternion of length {short:e}"
        ));
        node.rotation = None;
    }
    node
}

/// The accessors that place the instances of a node, which messages call `node`.
fn instancing(lists: &Lists, node: &str, part: Object) -> Option<Box<Instancing>> {
    let lenient = Lenient {
        notes: lists.notes,
        name: format!("{node} {INSTANCING}"),
    };
    let extension = lenient.field(part.extension(INSTANCING))?;
    let read = || {
        let attributes = needed("attributes", extension.object("attributes"))?;
        let accessor = |key: &str| attributes.index(key, "accessors", lists.accessors.len());
        let instancing = Instancing {
            translation: accessor("TRANSLATION")?,
            rotation: accessor("ROTATION")?,
            scale: accessor("SCALE")?,
        };
        if instancing == Instancing::default() {
            return Err("it has none of the attributes TRANSLATION, ROTATION and SCALE".into());
        }
        if attributes
            .entries()
            .any(|(name, _)| name.starts_with("_COLOR"))
        {
            lists
                .notes
                .add(|| format!("{}: colors of instances are not drawn", lenient.name));
        }
        Ok(Some(Box::new(instancing)))
    };
    lenient.field(read())
}

/// The smallest length of a quaternion that is normalized; shorter ones have no meaningful
/// direction.
pub const MIN_QUATERNION_LENGTH: f64 = 1e-6;

/// The scene that is shown: the default scene, else the first.
pub fn scene(lists: &Lists, root: Object, scenes: &[Value]) -> Option<Scene> {
    let lenient = Lenient {
        notes: lists.notes,
        name: "the file".into(),
    };
    let index = lenient
        .field(root.index("scene", "scenes", scenes.len()))
        .or((!scenes.is_empty()).then_some(0))?;
    let part = lists.object("scene", index, &scenes[index])?;
    let lenient = Lenient {
        notes: lists.notes,
        name: called("scene", index, None),
    };
    let nodes = ("nodes", lists.nodes.len());
    let nodes = part.indices("nodes", nodes, |reason| lenient.fault(reason));
    Some(Scene {
        index,
        nodes: lenient.list(nodes),
    })
}

pub fn camera(part: Object) -> Part<Camera> {
    let is_perspective = [("perspective", true), ("orthographic", false)];
    let is_perspective = needed("type", part.word("type", &is_perspective))?;
    let kind = if is_perspective {
        "perspective"
    } else {
        "orthographic"
    };
    let lens = needed(kind, part.object(kind))?;
    let number = |key: &str| Ok::<_, String>(f64::from(needed(key, lens.number(key))?));
    let projection = if is_perspective {
        let yfov = number("yfov")?;
        let fov_y_deg = yfov.to_degrees();
        if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
            return Err(format!("yfov is {yfov}; it must be above 0 and below pi"));
        }
        Projection::Perspective { fov_y_deg }
    } else {
        let ymag = number("ymag")?;
        if ymag == 0.0 {
            return Err("ymag is 0; it must be another number".into());
        }
        Projection::Orthographic {
            height_m: 2.0 * ymag.abs(),
        }
    };
    Ok(Camera {
        name: part.text("name").ok().flatten().map(str::to_owned),
        projection,
        near: match lens.value("znear") {
            Some(_) => number("znear")?,
            None => 0.0,
        },
    })
}
