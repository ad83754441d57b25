//! Loads a model: follows its parts in order and assembles the scene.

use std::panic::{AssertUnwindSafe, catch_unwind};

use gltf::json;

use super::{
    buffers::Buffers,
    clips,
    compression::Compression,
    deformation, document,
    error::{LoadError, ReadFile, quoted},
    limits::Limits,
    materials,
    meshes::Loader,
    nodes::Tree,
    notes::Notes,
    skin,
    source::{Bytes, Source, reserve},
};
use crate::scene::{memory::MemoryBudget, model::Scene, pose, rig::Rig};

/// Loads a model from memory, within the least memory budget. `read` supplies the files that it
/// refers to.
///
/// Within [`Work`](crate::work::Work) it ends where that was canceled.
///
/// # Errors
/// If the model is malformed, exceeds [`limits`](super::limits), or `read` fails.
pub fn load(bytes: &[u8], read: &mut ReadFile) -> Result<Scene, LoadError> {
    load_within(&bytes, MemoryBudget::LEAST, read)
}

/// Loads a model from any source, within a memory budget. `read` supplies the files that it refers
/// to.
///
/// # Errors
/// As [`load`], or if the source cannot be read.
pub fn load_within(
    model: &dyn Source,
    budget: MemoryBudget,
    read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    let limits = Limits::of_files(budget);
    if model.size() > limits.file_bytes {
        return Err(limits.exceeded(
            format_args!("it has {} bytes", model.size()),
            limits.file_bytes,
        ));
    }
    caught(|| {
        let (json, binary) = split(model)?;
        read_model(json.all()?, binary, (model.size(), budget), read)
    })
}

/// Runs `work`. A panic in the validation of the crate `gltf` must not close the window.
fn caught(work: impl FnOnce() -> Result<Scene, LoadError>) -> Result<Scene, LoadError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Err(LoadError::new(
            "the loader failed on this file, which is a bug: please report it",
        ))
    })
}

/// The JSON and, of a GLB, the binary chunk.
fn split<'a>(model: &'a dyn Source) -> Result<(Bytes<'a>, Option<Bytes<'a>>), LoadError> {
    let size = model.size();
    let mut head = Vec::new();
    model.append_to(&mut head, 0..size.min(12))?;
    if !head.starts_with(b"glTF") {
        if model.in_memory().is_some() {
            return Ok((Bytes::of(model, 0..size), None));
        }
        let read = head.len() as u64;
        reserve(&mut head, size - read)?;
        model.append_to(&mut head, read..size)?;
        return Ok((Bytes::Memory(head.into()), None));
    }
    let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    if size < 12 {
        return Err(LoadError::new(format!(
            "the GLB header has {size} of 12 bytes; the file is truncated"
        )));
    }
    let (version, length) = (word(&head[4..]), u64::from(word(&head[8..])));
    if version != 2 {
        return Err(LoadError::new(format!(
            "GLB version {version} is not supported; export as version 2"
        )));
    }
    if length < 12 || length > size {
        return Err(LoadError::new(format!(
            "the GLB header states {length} bytes, but the file has {size}"
        )));
    }
    let mut at = 12;
    let mut chunk = |kind: &[u8; 4]| -> Result<Option<Bytes<'a>>, LoadError> {
        if length - at < 8 {
            return Ok(None);
        }
        let mut head = Vec::new();
        model.append_to(&mut head, at..at + 8)?;
        if &head[4..] != kind {
            return Ok(None);
        }
        let (start, bytes) = (at + 8, u64::from(word(&head)));
        if bytes > length - start {
            return Err(LoadError::new(format!(
                "a GLB chunk states {bytes} bytes, but only {} follow",
                length - start
            )));
        }
        at = start + bytes;
        Ok(Some(Bytes::of(model, start..at)))
    };
    let json = chunk(b"JSON")?.ok_or_else(|| LoadError::new("the first GLB chunk is not JSON"))?;
    let binary = chunk(b"BIN\0")?;
    Ok((json, binary))
}

/// Reads a whole model. `file` is the size of its file, bytes.
fn read_model(
    json: &[u8],
    binary: Option<Bytes<'_>>,
    (file, budget): (u64, MemoryBudget),
    read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    let mut left_out = Vec::new();
    let mut root = document::parse_document(json, &mut left_out)?;
    let mut buffers = Buffers::read(
        &mut root,
        binary,
        &Compression::of(json)?,
        (file, budget),
        read,
    )?;
    let root = buffers.root;
    materials::check_images(&buffers)?;
    let tree = Tree::walk(root)?;
    let (mut rig, mut repairs) = (Rig::default(), Notes::default());
    repairs.extend(
        left_out
            .into_iter()
            .chain(tree.fault.clone())
            .chain(tree.rotation_note(root)),
    );
    let (materials, images) = materials::read(&mut buffers, &tree.shown, read, &mut repairs)?;
    if deformation::has_motion(root) {
        rig.nodes = tree.rig_nodes(root)?;
        rig.skins = skin::read_skins(&buffers, &tree)?;
        clips::read(&buffers, &tree, &mut rig, &mut repairs)?;
    }
    let mut loader = Loader::new(
        &buffers,
        &tree,
        Scene {
            materials,
            images,
            ..Scene::default()
        },
    );
    loader.expect();
    for &node in &tree.shown {
        loader.add_instances(node, &rig)?;
    }
    let Loader { writer, notes, .. } = loader;
    let mut scene = writer.scene;
    scene.rig = rig;
    scene.named_nodes = tree.named_nodes(root)?;
    if !scene.rig.is_empty() {
        scene.rig.motion_bounds = pose::motion_bounds(&scene);
    }
    let mut all = Notes::default();
    all.extend(
        notes
            .into_iter()
            .chain(repairs.into_vec())
            .chain(omissions(root)),
    );
    if scene.instances.is_empty() {
        all.add(|| "nothing to draw: the scene shows no triangles");
    }
    scene.cameras = tree.cameras(root, &scene.bounds(), !scene.rig.is_empty(), &mut all);
    scene.notes = all.into_vec();
    scene.faults.extend(tree.fault);
    Ok(scene)
}

/// Messages about features of the file that are not drawn; each is built when it is asked for.
fn omissions(root: &json::Root) -> impl Iterator<Item = String> {
    let is_read =
        |name: &str| document::READ_HERE.contains(&name) || materials::EXTENSIONS.contains(&name);
    let ignored = root
        .extensions_used
        .iter()
        .filter(move |name| !is_read(name));
    let notes = ignored.map(|name| {
        format!(
            "the extension {} is not supported and is ignored",
            quoted(name)
        )
    });
    let has_more = |material: &json::Material| {
        let roughness = material
            .pbr_metallic_roughness
            .metallic_roughness_texture
            .is_some();
        roughness || material.normal_texture.is_some() || material.occlusion_texture.is_some()
    };
    let textures = root
        .materials
        .iter()
        .any(has_more)
        .then(|| "normal, occlusion and metallic-roughness textures are not drawn".into());
    notes.chain(textures)
}
