//! Loads a model: reads its files, follows its parts in order, and assembles the scene.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

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
    source::{Bytes, ModelFile, read_regular},
};
use crate::{
    scene::{memory::MemoryBudget, model::Scene, pose, rig::Rig},
    work::checkpoint,
};

/// Loads a `.gltf` or `.glb` file within the memory budget of the process. Only files in its folder and below are read.
///
/// Within [`Work`](crate::work::Work) it counts its bytes, and ends where that was canceled.
///
/// # Errors
/// If a file cannot be read, is malformed, or exceeds [`limits`](super::limits); the sentence begins with the file name.
pub fn load(path: &Path) -> Result<Scene, LoadError> {
    load_within(path, MemoryBudget::of_process())
}

/// [`load`] within another memory budget.
///
/// # Errors
/// As [`load`].
pub fn load_within(path: &Path, budget: MemoryBudget) -> Result<Scene, LoadError> {
    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let open = || {
        let limits = Limits::of_files(budget);
        let read = &mut |beside: &Path, most| read_beside(path, beside, most, &limits);
        match ModelFile::open(path, limits.file_bytes, &limits)? {
            ModelFile::Whole(bytes) => parse_within(&bytes, budget, read),
            ModelFile::Glb { json, binary, size } => {
                let scene = caught(|| read_model(&json, Some(Bytes::File(&binary)), (size, budget), read))?;
                checkpoint().advance(binary.unread())?;
                Ok(scene)
            }
        }
    };
    match open() {
        Ok(scene) => Ok(Scene { name, ..scene }),
        Err(error) => Err(error.within(file)),
    }
}

/// Loads a model from memory, within the least memory budget. `read` supplies the files that it refers to, by relative paths without `..`.
///
/// # Errors
/// If the model is malformed, exceeds [`limits`](super::limits), or `read` fails.
pub fn parse(bytes: &[u8], read: &mut ReadFile) -> Result<Scene, LoadError> {
    parse_within(bytes, MemoryBudget::LEAST, read)
}

/// [`parse`] within another memory budget.
///
/// # Errors
/// As [`parse`].
pub fn parse_within(bytes: &[u8], budget: MemoryBudget, read: &mut ReadFile) -> Result<Scene, LoadError> {
    caught(|| {
        let (json, binary) = split(bytes)?;
        read_model(json, binary.map(|binary| Bytes::Memory(binary.into())), (bytes.len() as u64, budget), read)
    })
}

/// Runs `work`. A panic in the validation of the crate `gltf` must not close the window.
fn caught(work: impl FnOnce() -> Result<Scene, LoadError>) -> Result<Scene, LoadError> {
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|_| Err(LoadError::new("the loader failed on this file, which is a bug: please report it")))
}

/// Reads `beside`, a relative path without `..`, from the folder of `model`. Symbolic links must not lead out of the folder.
fn read_beside(model: &Path, beside: &Path, most: u64, limits: &Limits) -> Result<Vec<u8>, LoadError> {
    let folder = model.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let failed = |error: std::io::Error| LoadError::new(format!("cannot read the file: {error}"));
    let folder = folder.canonicalize().map_err(failed)?;
    let file = folder.join(beside).canonicalize().map_err(failed)?;
    if !file.starts_with(&folder) {
        return Err(LoadError::new("it lies outside the model's folder; copy it there"));
    }
    read_regular(&file, most, limits)
}

/// The JSON and, of a GLB, the binary chunk.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), LoadError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(LoadError::new(format!("the GLB header has {} of 12 bytes; the file is truncated", bytes.len())));
    };
    if version != 2 {
        return Err(LoadError::new(format!("GLB version {version} is not supported; export as version 2")));
    }
    if (length as usize) < 12 || length as usize > bytes.len() {
        return Err(LoadError::new(format!("the GLB header states {length} bytes, but the file has {}", bytes.len())));
    }
    let mut rest = &bytes[12..length as usize];
    let mut chunk = |kind: &[u8; 4]| -> Result<Option<&[u8]>, LoadError> {
        let Some((head, body)) = rest.split_at_checked(8) else { return Ok(None) };
        let length = u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if &head[4..8] != kind {
            return Ok(None);
        }
        let (body, after) = body
            .split_at_checked(length)
            .ok_or_else(|| LoadError::new(format!("a GLB chunk states {length} bytes, but only {} follow", body.len())))?;
        rest = after;
        Ok(Some(body))
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
    let mut buffers = Buffers::read(&mut root, binary, &Compression::of(json)?, (file, budget), read)?;
    let root = buffers.root;
    materials::check_images(&buffers)?;
    let tree = Tree::walk(root)?;
    let (mut rig, mut repairs) = (Rig::default(), Notes::default());
    repairs.extend(left_out.into_iter().chain(tree.fault.clone()).chain(tree.rotation_note(root)));
    let (materials, images) = materials::read(&mut buffers, &tree.shown, read, &mut repairs)?;
    if deformation::has_motion(root) {
        rig.nodes = tree.rig_nodes(root)?;
        rig.skins = skin::read_skins(&buffers, &tree)?;
        clips::read(&buffers, &tree, &mut rig, &mut repairs)?;
    }
    let mut loader = Loader::new(&buffers, &tree, Scene { materials, images, ..Scene::default() });
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
    all.extend(notes.into_iter().chain(repairs.into_vec()).chain(omissions(root)));
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
    let is_read = |name: &str| document::READ_HERE.contains(&name) || materials::EXTENSIONS.contains(&name);
    let ignored = root.extensions_used.iter().filter(move |name| !is_read(name));
    let notes = ignored.map(|name| format!("the extension {} is not supported and is ignored", quoted(name)));
    let has_more = |material: &json::Material| {
        let roughness = material.pbr_metallic_roughness.metallic_roughness_texture.is_some();
        roughness || material.normal_texture.is_some() || material.occlusion_texture.is_some()
    };
    let textures = root.materials.iter().any(has_more).then(|| "normal, occlusion and metallic-roughness textures are not drawn".into());
    notes.chain(textures)
}
