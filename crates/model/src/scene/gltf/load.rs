//! Loads a model: follows its parts in order and assembles the scene.

use std::collections::BTreeSet;

use super::{
    buffers::Buffers,
    clips, container, deformation,
    document::{self, Document},
    error::{LoadError, ReadFile, quoted},
    limits::Limits,
    materials,
    meshes::Loader,
    nodes::Tree,
    notes::Notes,
    skin,
    source::{Bytes, Source},
};
use crate::scene::{
    camera::MIN_NEAR_M,
    memory::MemoryBudget,
    model::Scene,
    pose,
    punctual::{TOO_STRONG, dimmed},
    rig::Rig,
};

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
    load_variant(model, budget, "", read)
}

/// [`load_within`], with the materials of the variant of this name (KHR_materials_variants), or
/// `#1` for that at index 1. With those of the file where it has no such variant;
/// [`Scene::variants`] tells.
///
/// # Errors
/// As [`load_within`].
pub fn load_variant(
    model: &dyn Source,
    budget: MemoryBudget,
    variant: &str,
    read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    let limits = Limits::of_files(budget);
    if model.size() > limits.file_bytes {
        return Err(limits.exceeded(
            format_args!("it has {} bytes", model.size()),
            limits.file_bytes,
        ));
    }
    let notes = Notes::default();
    let (json, binary) = container::split(model, &notes)?;
    let mut document = document::parse_document(json.all()?, &notes)?;
    drop(json);
    document.show_variant(variant);
    let mut scene = read_model(&document, binary, (model.size(), budget), read, &notes)?;
    for (name, reason) in document.broken() {
        notes.fault_once(reason, || format!("{name}: {reason}; nothing uses it"));
    }
    notes.extend(omissions(&document));
    scene.variants = document.variants;
    [scene.notes, scene.faults] = notes.into_lists();
    Ok(scene)
}

/// Of a smaller model the near plane would cut off all.
const LEAST_RADIUS_M: f64 = 2.0 * MIN_NEAR_M;

/// # Errors
/// The model is too small to draw.
pub fn check_size(scene: &Scene) -> Result<(), LoadError> {
    let radius_m = scene.bounds().radius();
    if radius_m > 0.0 && radius_m < LEAST_RADIUS_M {
        return Err(LoadError::new(format!(
            "the model is {:.1e} m large; models below {:.0e} m are too small to draw: scale it up",
            2.0 * radius_m,
            2.0 * LEAST_RADIUS_M
        )));
    }
    Ok(())
}

/// Reads a whole model. `file` is the size of its file.
fn read_model(
    document: &Document,
    binary: Option<Bytes<'_>>,
    (file, budget): (u64, MemoryBudget),
    read: &mut ReadFile,
    notes: &Notes,
) -> Result<Scene, LoadError> {
    let is_cut_off = notes.is_cut_off();
    let tree = Tree::walk(document, notes);
    let mut buffers = Buffers::read(document, binary, (file, budget), read, notes)?;
    let (materials, images) = materials::read(&mut buffers, &tree.shown, read)?;
    let mut rig = Rig::default();
    if deformation::has_motion(document) {
        rig.nodes = tree.rig_nodes(document, notes)?;
        rig.skins = skin::read_skins(&buffers, &tree)?;
        clips::read(&buffers, &tree, &mut rig)?;
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
    let Loader {
        writer,
        first_lost,
        placements,
        ..
    } = loader;
    let mut scene = writer.scene;
    if scene.instances.is_empty() {
        // Nothing is left because of what was left out.
        let cut_off = notes.first_fault().filter(|_| is_cut_off);
        if let Some(reason) = cut_off.or(first_lost).or_else(|| notes.first_fault()) {
            return Err(LoadError::new(reason));
        }
        notes.add(|| "nothing to draw: the scene shows no triangles");
    }
    scene.rig = rig;
    scene.rig.placements = placements;
    scene.named_nodes = tree.named_nodes(document);
    if !scene.rig.is_empty() {
        scene.rig.motion_bounds = pose::motion_bounds(&scene);
    }
    check_size(&scene)?;
    let moves = !scene.rig.is_empty();
    scene.cameras = tree.cameras(document, &scene.bounds(), moves, notes);
    scene.lights = tree.lights(document, moves, notes);
    if let Some(times) = scene.glare() {
        let dimmed = dimmed(times);
        notes.add(|| {
            // One digit: 20, 50000.
            let times: f64 = format!("{times:.0e}").parse().unwrap_or(times);
            format!(
                "its lights are about {times} {TOO_STRONG}; studio.lights = {dimmed} dims them, as in the plain look"
            )
        });
    }
    Ok(scene)
}

/// Messages about features of the file that are not drawn; each is built when it is asked for.
fn omissions(document: &Document) -> impl Iterator<Item = String> {
    let names: BTreeSet<&String> = document.extensions_used.iter().collect();
    let ignored = names
        .into_iter()
        .filter(|name| !document::is_read(name) && !document.extensions_required.contains(name));
    let notes = ignored.map(|name| {
        format!(
            "the extension {} is not supported and is ignored",
            quoted(name)
        )
    });
    let textures = document
        .materials
        .iter()
        .any(|material| material.has_more)
        .then(|| "textures of specular reflection and of glossiness are not drawn".into());
    notes.chain(textures)
}
