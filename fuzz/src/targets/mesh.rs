//! OBJ with MTL, STL and PLY models, and clouds of LAS, LAZ and XYZ: every input is read as each of them, and is its own material
//! file.

use rasterlab::scene::{
    gltf::LoadError,
    memory::MemoryBudget,
    mesh_files::{load_las, load_obj, load_ply, load_stl, load_xyz},
};

use super::{Outcome, Target, assert_told, model::use_scene};
use crate::guard::Limit;

pub const TARGET: Target = Target {
    name: "mesh",
    about: "OBJ, MTL, STL and PLY models, LAS, LAZ and XYZ clouds",
    views: &[],
    limit: Limit::new(20, 2048),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let mut outcome = Err("it is no mesh".into());
    for load in [load_obj, load_stl, load_ply, load_las, load_xyz] {
        let read = load(&bytes, MemoryBudget::LEAST, &mut |path, _| match path
            .extension()
            .is_some_and(|extension| extension == "mtl")
        {
            true => Ok(bytes.to_vec()),
            false => Err(LoadError::new("no images here")),
        });
        match read {
            Ok(scene) => {
                use_scene(&scene);
                outcome = Ok(());
            }
            Err(error) => assert_told(&error.to_string()),
        }
    }
    outcome
}
