//! Writes the corpus anew: `cargo run --release -p rasterlab-fuzz --bin rasterlab-fuzz-seeds`.
//! Files that libFuzzer or a person has added under other names stay.

mod mesh_files;
mod meshes;
mod models;
mod pictures;
mod texts;

/// The models that the tests of the loader write.
#[allow(dead_code)]
#[path = "../../../tests/house/loader/model.rs"]
mod model;

use std::{fs, io};

use rasterlab_fuzz::{TARGETS, corpus};

/// Name of a file and its bytes.
type Seed = (String, Vec<u8>);

fn main() -> io::Result<()> {
    for target in &TARGETS {
        let seeds = match target.name {
            "model" => models::seeds(),
            "mesh" => mesh_files::seeds(),
            "image" => pictures::images(),
            "light" => pictures::light(),
            "compressed" => meshes::seeds(),
            "preset" => texts::presets(),
            "share" => texts::shared(),
            "picture" => pictures::saved(),
            "command_line" => texts::command_lines(),
            "effect" => texts::effects(),
            name => panic!("there are no seeds for {name}"),
        };
        let folder = corpus::folder(target);
        fs::create_dir_all(&folder)?;
        let bytes: usize = seeds.iter().map(|(_, bytes)| bytes.len()).sum();
        for (name, bytes) in &seeds {
            fs::write(folder.join(name), bytes)?;
        }
        println!("{:14} {} files, {bytes} bytes", target.name, seeds.len());
    }
    Ok(())
}
