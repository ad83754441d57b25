//! The formats of model files.

use std::path::Path;

use crate::{
    host::model,
    scene::{
        Primitive, Scene, UpAxis,
        gltf::{self, LoadError},
        memory::MemoryBudget,
        mesh_files::{self, LoadCloud, LoadModel},
    },
};

/// A format of model files.
pub struct ModelFormat {
    /// In small letters, without the dot.
    pub extension: &'static str,
    /// Extensions of the files beside a model that it may refer to.
    pub beside: &'static [&'static str],
    reader: Reader,
}

/// What reads a format.
enum Reader {
    /// Its materials may have variants, and its +y is up.
    Gltf,
    /// With the axis that is up in most files.
    Mesh(LoadModel, UpAxis),
    /// Its points may have several colors; with the axis that is up in most files.
    Cloud(LoadCloud, UpAxis),
    /// Its points may have several colors, and its +z is up.
    Survey(LoadCloud),
}

/// Every format that is read. `tests/house/registry.rs` compares the texts that name them.
pub const MODEL_FORMATS: &[ModelFormat] = &[
    ModelFormat {
        extension: "glb",
        beside: &[],
        reader: Reader::Gltf,
    },
    ModelFormat {
        extension: "gltf",
        beside: &["bin", "png", "jpg", "jpeg", "ktx2"],
        reader: Reader::Gltf,
    },
    // A GLB with a person in it.
    ModelFormat {
        extension: "vrm",
        beside: &[],
        reader: Reader::Gltf,
    },
    ModelFormat {
        extension: "obj",
        beside: &["mtl", "png", "jpg", "jpeg", "webp"],
        reader: Reader::Mesh(mesh_files::load_obj, UpAxis::Y),
    },
    ModelFormat {
        extension: "stl",
        beside: &[],
        // Of parts that are made, which lie on the bed of a machine.
        reader: Reader::Mesh(mesh_files::load_stl, UpAxis::Z),
    },
    ModelFormat {
        extension: "ply",
        beside: &["png", "jpg", "jpeg", "webp"],
        reader: Reader::Mesh(mesh_files::load_ply, UpAxis::Y),
    },
    ModelFormat {
        extension: "xyz",
        beside: &[],
        reader: Reader::Cloud(mesh_files::load_xyz_shown, UpAxis::Z),
    },
    ModelFormat {
        extension: "pts",
        beside: &[],
        reader: Reader::Cloud(mesh_files::load_xyz_shown, UpAxis::Z),
    },
    ModelFormat {
        extension: "las",
        beside: &[],
        reader: Reader::Survey(mesh_files::load_las_shown),
    },
    ModelFormat {
        extension: "laz",
        beside: &[],
        reader: Reader::Survey(mesh_files::load_las_shown),
    },
];

impl ModelFormat {
    /// The format of a file, by its extension; none if it is no model.
    pub fn of(path: &Path) -> Option<&'static Self> {
        MODEL_FORMATS.iter().find(|format| {
            path.extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case(format.extension))
        })
    }

    /// Loads a file within the memory budget of the process, with its own materials.
    pub fn load(&self, path: &Path) -> Result<Scene, LoadError> {
        self.load_variant(path, "")
    }

    /// [`Self::load`], with the materials, or the colors of points, of a variant where the file has one of
    /// this name.
    pub fn load_variant(&self, path: &Path, variant: &str) -> Result<Scene, LoadError> {
        let budget = MemoryBudget::of_process();
        match self.reader {
            Reader::Gltf => model::load_as(path, budget, |model, budget, read| {
                gltf::load_variant(model, budget, variant, read)
            }),
            Reader::Mesh(load, _) => model::load_as(path, budget, load),
            Reader::Cloud(load, _) | Reader::Survey(load) => {
                model::load_as(path, budget, |model, budget, read| {
                    load(model, budget, variant, read)
                })
            }
        }
    }

    /// The axis that is up in a scene of this format, as its file has it.
    pub fn guess_up(&self, scene: &Scene) -> UpAxis {
        let names = scene.named_nodes.iter().map(|node| node.name.as_str());
        match self.reader {
            Reader::Gltf => UpAxis::Y,
            Reader::Survey(_) => UpAxis::Z,
            Reader::Mesh(_, usual) | Reader::Cloud(_, usual) => UpAxis::guessed(
                &scene.bounds(),
                [&*scene.name].into_iter().chain(names),
                (|| scene.height_axis(), || scene.foot_axis()),
                // Points alone come from a scanner, whose files have z up.
                match scene.primitives.iter().all(Primitive::is_points) {
                    true => UpAxis::Z,
                    false => usual,
                },
            ),
        }
    }

    /// Every extension with its dot, with commas between them, and `last` before the last.
    pub fn names(last: &str) -> String {
        let names: Vec<String> = MODEL_FORMATS
            .iter()
            .map(|format| format!(".{}", format.extension))
            .collect();
        match names.split_last() {
            Some((end, rest)) => format!("{}{last}{end}", rest.join(", ")),
            None => String::new(),
        }
    }
}
