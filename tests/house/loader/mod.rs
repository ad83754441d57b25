//! Promise: the glTF loader: what it accepts arrives exactly, what it refuses is refused with a
//! message, and nothing panics, hangs, or is read outside the model's folder. One file for each
//! part of the promise; all write their models with [`model::Model`].

mod accepted;
mod compressed;
mod corpus;
mod far;
mod files;
mod first_looks;
mod images;
mod instancing;
mod kinds;
mod lights;
mod maps;
mod materials;
mod mesh_files;
mod mesh_hostile;
mod model;
mod motion;
mod names;
mod passing;
mod refused;
mod scale;
mod sound;
mod tolerated;
mod variants;

use model::Model;

/// Every part of the file, beginning with the model that its first word names.
#[test]
fn models_become_what_the_transcripts_say() {
    for part in include_str!("transcripts.txt").split("=== ").skip(1) {
        let (title, transcript) = part.split_once('\n').expect("a title and a transcript");
        let model = match title.split(':').next() {
            Some("square") => Model::square(),
            Some("textured") => Model::textured(),
            Some("skinned") => motion::skinned(0.0),
            Some("morphed") => motion::morphed(),
            Some("moving") => motion::clip("translation", "LINEAR", "VEC3 F32 0*6"),
            _ => panic!("{title} names no model"),
        };
        model.play(transcript);
    }
}
