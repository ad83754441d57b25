//! Buffers, accessors, meshes, nodes, scenes and cameras.

use std::collections::BTreeMap;

use ::gltf::json::{
    self,
    accessor::{ComponentType as JsonType, Type, VALID_ACCESSOR_TYPES, VALID_COMPONENT_TYPES},
    camera::{Type as Lens, VALID_CAMERA_TYPES},
    mesh::{Mode, Semantic, VALID_MODES},
    validation::Checked,
};
use serde::{
    Deserialize,
    de::{IntoDeserializer, value::Error as WordError},
};
use serde_json::{Value, json};

use super::{
    super::{
        compression::{DRACO, MESHOPT},
        error::quoted,
        instancing::INSTANCING,
    },
    Accessor, Buffer, Camera, Chain, Instancing, Mesh, Node, Part, Primitive, Scene, Sparse, View,
    element::{Element, Object, legible_value, whole, wrong},
    read::{LIGHTS, Lists, VISIBILITY, is_unknown_compression},
    variants,
};
use crate::scene::{accessor::ComponentType, camera::Projection, model::Topology};

fn component_type(known: JsonType) -> ComponentType {
    match known {
        JsonType::I8 => ComponentType::I8,
        JsonType::U8 => ComponentType::U8,
        JsonType::I16 => ComponentType::I16,
        JsonType::U16 => ComponentType::U16,
        JsonType::U32 => ComponentType::U32,
        JsonType::F32 => ComponentType::F32,
    }
}

pub fn accessor(lists: &Lists, mut part: Element) -> Part<Accessor> {
    let bounds = ["min", "max"].map(|key| (key, part.take_numbers(key)));
    let views = ("buffer views", lists.views.len());
    lists.check(&part.json, "bufferView", views)?;
    for key in ["indices", "values"] {
        if let Some(of) = part.object(&["sparse", key]) {
            lists
                .check(of, "bufferView", views)
                .map_err(|reason| format!("sparse: {reason}"))?;
        }
    }
    let accessor: json::Accessor = part.read(&[
        "type",
        "bufferView",
        "byteOffset",
        "count",
        "componentType",
        "normalized",
        "sparse",
    ])?;
    let components = match part.known("type", accessor.type_, VALID_ACCESSOR_TYPES)? {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    };
    let mut has_bounds = true;
    for (key, numbers) in bounds {
        let count = numbers.map(|numbers| numbers.len());
        has_bounds &= count == Some(components);
        if let Some(count) = count.filter(|&count| count != components) {
            part.fault(format_args!(
                "its {key} has {count} of {components} numbers"
            ));
        }
    }
    let kind = part.known(
        "componentType",
        accessor.component_type,
        VALID_COMPONENT_TYPES,
    )?;
    Ok(Accessor {
        view: accessor.buffer_view.map(|index| index.value()),
        offset: accessor.byte_offset.map_or(0, |offset| offset.0),
        count: accessor.count.0,
        component_type: component_type(kind.0),
        components: components as u32,
        normalized: accessor.normalized,
        sparse: accessor.sparse.map(sparse).transpose()?,
        has_bounds,
    })
}

fn sparse(part: json::accessor::sparse::Sparse) -> Part<Sparse> {
    let (indices, values) = (part.indices, part.values);
    let Checked::Valid(kind) = indices.component_type else {
        return Err("sparse: its componentType must be one of 5121, 5123, 5125".into());
    };
    Ok(Sparse {
        count: part.count.0,
        indices: (indices.buffer_view.value(), indices.byte_offset.0),
        index_type: component_type(kind.0),
        values: (values.buffer_view.value(), values.byte_offset.0),
    })
}

/// An extension that the crate does not read.
fn extension<T: for<'a> Deserialize<'a>>(part: &Element, name: &str) -> Part<Option<T>> {
    let extension = part.object(&["extensions"]).and_then(|all| all.get(name));
    let malformed = |error| format!("its {name} is malformed: {error}");
    extension
        .map(|extension| T::deserialize(extension).map_err(malformed))
        .transpose()
}

pub fn view(lists: &Lists, mut part: Element) -> Part<View> {
    lists.check(&part.json, "buffer", ("buffers", lists.buffers.len()))?;
    let needed = ["buffer", "byteOffset", "byteLength", "byteStride"];
    let view: json::buffer::View = part.read(&needed)?;
    Ok(View {
        buffer: view.buffer.value(),
        offset: view.byte_offset.map_or(0, |offset| offset.0),
        length: view.byte_length.0,
        // Some writers give every view one, of 0 where there is none.
        stride: view
            .byte_stride
            .map(|stride| stride.0 as u64)
            .filter(|&stride| stride > 0),
        meshopt: extension(&part, MESHOPT)?,
    })
}

pub fn buffer(_: &Lists, mut part: Element) -> Part<Buffer> {
    if !part.json.contains_key("byteLength") {
        return Err("it has no byteLength".into());
    }
    let buffer: json::Buffer = part.read(&["uri", "byteLength"])?;
    let fallback = part
        .object(&["extensions", MESHOPT])
        .and_then(|all| all.get("fallback"));
    Ok(Buffer {
        uri: buffer.uri,
        length: buffer.byte_length.0,
        is_fallback: fallback.and_then(Value::as_bool).unwrap_or(false),
    })
}

/// Mesh `index`; an empty one where it is no object.
pub fn mesh(lists: &Lists, index: usize, value: &Value) -> Mesh {
    let Some(mut part) = lists.element("mesh", index, value) else {
        return Mesh::default();
    };
    let primitives = part.take_list("primitives");
    part.json.insert("primitives".into(), json!([]));
    let mesh: Option<json::Mesh> = lists.read(&mut part);
    let primitive = |(at, value): (usize, &Value)| {
        let name = format!("{} primitive {at}", part.name);
        primitive(lists, Element::of(lists.notes, name, value)?)
    };
    let primitives = primitives.iter().enumerate().map(primitive).collect();
    let (name, weights) = mesh.map_or((None, None), |mesh| (mesh.name, mesh.weights));
    Mesh {
        name,
        primitives,
        weights: weights.unwrap_or_default(),
    }
}

fn primitive(lists: &Lists, mut part: Element) -> Part<Primitive> {
    let attributes = match part.json.insert("attributes".into(), json!({})) {
        Some(Value::Object(attributes)) => accessors(lists, &part, &attributes),
        Some(_) => return Err(part.wrong("attributes", "an object")),
        None => return Err("it has no attributes".into()),
    };
    let mut targets = Vec::new();
    for target in part.take_list("targets") {
        targets.push(match &target {
            Value::Object(target) => accessors(lists, &part, target),
            other => {
                part.fault(format_args!(
                    "of its targets, one is {}; it must be an object",
                    legible_value(other)
                ));
                BTreeMap::new()
            }
        });
    }
    let variants = variants::materials(lists, &mut part);
    part.drop_index("material", ("materials", lists.materials.len()));
    lists.check(&part.json, "indices", lists.accessors())?;
    let read: json::mesh::Primitive = part.read(&["indices", "mode", "extensions"])?;
    let (topology, chain) = match part.known("mode", read.mode, VALID_MODES)? {
        Mode::Points => (Topology::Points, None),
        Mode::Lines => (Topology::Lines, None),
        Mode::LineLoop => (Topology::Lines, Some(Chain::Closed)),
        Mode::LineStrip => (Topology::Lines, Some(Chain::Open)),
        Mode::Triangles => (Topology::List, None),
        Mode::TriangleStrip => (Topology::Strip, None),
        Mode::TriangleFan => (Topology::Fan, None),
    };
    let primitive = Primitive {
        attributes,
        indices: read.indices.map(|index| index.value()),
        topology,
        chain,
        material: read.material.map(|index| index.value()),
        variants,
        targets,
        draco: extension(&part, DRACO)?,
    };
    let is_empty = |accessor: usize| {
        let about = lists.accessors.get(accessor).and_then(Value::as_object);
        let has = |about: &Object, key| about.get(key).is_some_and(|value| !value.is_null());
        about.is_some_and(|about| !has(about, "bufferView") && !has(about, "sparse"))
    };
    let extensions = part.object(&["extensions"]);
    let packed = extensions
        .into_iter()
        .flat_map(Object::keys)
        .find(|name| is_unknown_compression(name));
    match packed {
        Some(name) if primitive.accessors().any(is_empty) => Err(format!(
            "it is compressed with {}, which is not supported",
            quoted(name)
        )),
        _ => Ok(primitive),
    }
}

/// The accessors of attributes. Those of names that begin with `_` are of applications.
fn accessors(lists: &Lists, part: &Element, attributes: &Object) -> BTreeMap<String, usize> {
    let is_known = |name: &str| {
        let word: Result<Checked<Semantic>, WordError> =
            Checked::deserialize(name.into_deserializer());
        matches!(word, Ok(Checked::Valid(known)) if known.to_string() == name)
    };
    let mut accessors = BTreeMap::new();
    for (name, value) in attributes.iter().filter(|(name, _)| !name.starts_with('_')) {
        let count = lists.accessors.len();
        match whole(value).filter(|&index| index < count as u64) {
            _ if !is_known(name) => part.fault(format_args!(
                "its attribute {} is none of glTF; names of applications begin with _",
                quoted(name)
            )),
            Some(index) => drop(accessors.insert(name.clone(), index as usize)),
            None => part.fault(format_args!(
                "its {name} refers to accessor {}, but there are only {count}",
                legible_value(value)
            )),
        }
    }
    accessors
}

/// Node `index`; an empty one where it is no object.
pub fn node(lists: &Lists, index: usize, value: &Value) -> Node {
    let Some(mut part) = lists.element("node", index, value) else {
        return Node::default();
    };
    let children = part.take_indices("children", ("nodes", lists.nodes.len()), Element::fault);
    part.drop_index("mesh", ("meshes", lists.meshes.len()));
    part.drop_index("skin", ("skins", lists.skins.len()));
    part.drop_index("camera", ("cameras", lists.cameras.len()));
    if let Some(light) = part.object(&["extensions", LIGHTS])
        && let Err(reason) = lists.check(light, "light", ("lights", lists.lights.len()))
    {
        part.fault(reason);
        part.remove(&["extensions", LIGHTS]);
    }
    let instancing = instancing(lists, &mut part);
    let visible = part
        .object(&["extensions", VISIBILITY])
        .and_then(|given| given.get("visible").cloned());
    let is_hidden = visible == Some(Value::Bool(false));
    if let Some(other) = visible.filter(|value| !value.is_boolean()) {
        part.fault(wrong("visible", &other, "true or false"));
    }
    let given = ["matrix", "translation"].map(|key| part.json.get(key).cloned());
    let Some(read): Option<json::Node> = lists.read(&mut part) else {
        return Node::default();
    };
    let light = read.extensions.and_then(|all| all.khr_lights_punctual);
    let mut node = Node {
        name: read.name,
        children,
        is_hidden,
        matrix: read.matrix.map(|matrix| far(matrix, &given[0])),
        translation: read.translation.map(|place| far(place, &given[1])),
        rotation: read.rotation.map(|rotation| rotation.0),
        scale: read.scale,
        mesh: read.mesh.map(|index| index.value()),
        skin: read.skin.map(|index| index.value()),
        camera: read.camera.map(|index| index.value()),
        light: light.map(|light| light.light.value()),
        weights: read.weights.unwrap_or_default(),
        instancing,
    };
    if let Some(matrix) = &mut node.matrix {
        let last_row = [matrix[3], matrix[7], matrix[11], matrix[15]];
        if last_row != [0.0, 0.0, 0.0, 1.0] {
            lists.notes.fault(|| {
                format!(
                    "{}: the last row of its matrix is {last_row:?}; it is read as 0 0 0 1",
                    part.name
                )
            });
            (matrix[3], matrix[7], matrix[11], matrix[15]) = (0.0, 0.0, 0.0, 1.0);
        }
        if node.translation.is_some() || node.scale.is_some() || node.rotation.is_some() {
            lists.notes.fault(|| {
                format!(
                    "{}: it has a matrix and also translation, rotation or scale; the matrix is used",
                    part.name
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
        part.fault(format_args!(
            "its rotation is a quaternion of length {short:e}"
        ));
        node.rotation = None;
    }
    node
}

/// Numbers as the file says them where they are so far from 0 that an f32 would move them.
fn far<const N: usize>(read: [f32; N], given: &Option<Value>) -> [f64; N] {
    const FAR: f32 = 1024.0;
    let given = given.as_ref().and_then(Value::as_array);
    let exact = |i: usize| given?.get(i)?.as_f64();
    std::array::from_fn(|i| match exact(i) {
        Some(exact) if read[i].abs() >= FAR && exact as f32 == read[i] => exact,
        _ => read[i].into(),
    })
}

/// The accessors that place the instances of a node.
fn instancing(lists: &Lists, node: &mut Element) -> Option<Box<Instancing>> {
    let extension = node.object(&["extensions"])?.get(INSTANCING)?.clone();
    let Value::Object(extension) = &extension else {
        node.fault(wrong(INSTANCING, &extension, "an object"));
        return None;
    };
    let name = format!("{} {INSTANCING}", node.name);
    let read = || {
        let attributes = match extension.get("attributes") {
            Some(Value::Object(attributes)) => attributes,
            Some(other) => return Err(wrong("attributes", other, "an object")),
            None => return Err("it has no attributes".into()),
        };
        let accessor = |key: &str| match attributes.get(key) {
            Some(value) => {
                lists.check(attributes, key, lists.accessors())?;
                let index = value.as_u64().map(|index| Some(index as usize));
                index.ok_or_else(|| wrong(key, value, "an integer from 0 up"))
            }
            None => Ok(None),
        };
        let instancing = Instancing {
            translation: accessor("TRANSLATION")?,
            rotation: accessor("ROTATION")?,
            scale: accessor("SCALE")?,
        };
        if instancing == Instancing::default() {
            return Err("it has none of the attributes TRANSLATION, ROTATION and SCALE".into());
        }
        if attributes.keys().any(|name| name.starts_with("_COLOR")) {
            lists
                .notes
                .add(|| format!("{name}: colors of instances are not drawn"));
        }
        Ok(Box::new(instancing))
    };
    let fault = |reason: String| {
        lists
            .notes
            .fault(|| format!("{name}: {reason}; it is left out"))
    };
    read().map_err(fault).ok()
}

/// The smallest length of a quaternion that is normalized; shorter ones have no meaningful
/// direction.
pub const MIN_QUATERNION_LENGTH: f64 = 1e-6;

/// The scene that is shown: the default scene, else the first.
pub fn scene(lists: &Lists, index: Option<&Value>, scenes: &[Value]) -> Option<Scene> {
    let given = index.filter(|index| !index.is_null());
    let index = given.and_then(|given| {
        let reason = match whole(given) {
            Some(index) if index < scenes.len() as u64 => return Some(index as usize),
            Some(index) => format!(
                "its scene is {index}, but there are only {} scenes",
                scenes.len()
            ),
            None => wrong("scene", given, "an integer from 0 up"),
        };
        lists
            .notes
            .fault(|| format!("the file: {reason}; it is left out"));
        None
    });
    let index = index.or((!scenes.is_empty()).then_some(0))?;
    let mut part = lists.element("scene", index, &scenes[index])?;
    part.name = format!("scene {index}");
    Some(Scene {
        index,
        nodes: part.take_indices("nodes", ("nodes", lists.nodes.len()), Element::fault),
    })
}

pub fn camera(mut part: Element) -> Part<Camera> {
    // What is not used may be missing or wrong.
    for lens in ["perspective", "orthographic"] {
        if let Some(lens) = part.json.get_mut(lens).and_then(Value::as_object_mut) {
            lens.retain(|key, _| ["yfov", "ymag", "znear"].contains(&key.as_str()));
            for (key, default) in [("xmag", 1.0), ("zfar", 1.0), ("znear", 0.0)] {
                lens.entry(key).or_insert(json!(default));
            }
        }
    }
    let camera: json::Camera = part.read(&["type", "perspective", "orthographic"])?;
    let (projection, near) = match part.known("type", camera.type_, VALID_CAMERA_TYPES)? {
        Lens::Perspective => {
            let lens = camera.perspective.ok_or("it has no perspective")?;
            let yfov = f64::from(lens.yfov);
            let fov_y_deg = yfov.to_degrees();
            if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
                return Err(format!("yfov is {yfov}; it must be above 0 and below pi"));
            }
            (Projection::Perspective { fov_y_deg }, lens.znear)
        }
        Lens::Orthographic => {
            let lens = camera.orthographic.ok_or("it has no orthographic")?;
            if lens.ymag == 0.0 {
                return Err("ymag is 0; it must be another number".into());
            }
            let height_m = 2.0 * f64::from(lens.ymag).abs();
            (Projection::Orthographic { height_m }, lens.znear)
        }
    };
    Ok(Camera {
        name: camera.name,
        projection,
        near: near.into(),
    })
}
