//! Promise: containers, URIs and files: only files in the model's folder are read, within limits.

use std::{
    fs,
    path::{Path, PathBuf},
};

use base64::{Engine, prelude::BASE64_STANDARD};
use rasterlab::{host, scene::gltf, scene::memory::MemoryBudget};
use serde_json::json;

use super::model::*;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), bytes).unwrap();
    }

    /// What is said against a file of this folder.
    #[track_caller]
    fn refusal(&self, name: &str) -> String {
        host::model::load(&self.path(name)).unwrap_err().to_string()
    }
}

/// The square as a `.gltf` whose bytes are there.
fn beside(uri: &str) -> String {
    Model::square().with("/buffers/0/uri", uri).json.to_string()
}

#[test]
fn buffers_come_from_data_uris_and_from_files_beside_the_model() {
    let bytes = Model::square().bytes;
    let data = format!(
        "data:application/octet-stream;base64,{}",
        BASE64_STANDARD.encode(&bytes)
    );
    assert_eq!(
        triangles(&load(beside(&data).as_bytes()).unwrap()),
        square()
    );
    let folder = Folder::new();
    folder.write("parts/my data.bin", &bytes);
    folder.write("model.gltf", beside("./parts/my%20data.bin"));
    let scene = host::model::load(&folder.path("model.gltf")).unwrap();
    assert_eq!(
        (triangles(&scene), scene.name.as_str()),
        (square(), "model")
    );
}

#[test]
fn uris_that_lead_out_of_the_folder_are_refused_unread() {
    // The bytes are there to be had: one folder up, and by absolute path.
    let outer = Folder::new();
    outer.write("secret.bin", Model::square().bytes);
    let absolute = outer.path("secret.bin").display().to_string();
    let schemes = ["", "file:", "file://", "FILE://"].map(|scheme| scheme.to_owned() + &absolute);
    let others = r"../secret.bin ./../secret.bin a/../../secret.bin %2e%2e/secret.bin %2E%2E%2Fsecret.bin
        ..\secret.bin ..%5csecret.bin http://localhost/secret.bin C:/secret.bin C%3A/secret.bin
        secret%.bin secret%+1.bin secret%00.bin .";
    for uri in others
        .split_whitespace()
        .chain([""])
        .chain(schemes.iter().map(String::as_str))
    {
        let error = load(beside(uri).as_bytes()).expect_err(uri).to_string();
        assert!(error.contains("buffer 0: URI "), "{error}");
        outer.write("inner/model.gltf", beside(uri));
        outer.refusal("inner/model.gltf");
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_refused() {
    use std::os::unix::fs::symlink;
    let (outer, inner) = (Folder::new(), Folder::new());
    outer.write("data.bin", Model::square().bytes);
    inner.write("model.gltf", beside("data.bin"));
    symlink(outer.path("data.bin"), inner.path("data.bin")).unwrap();
    let wanted = "model.gltf: mesh \"X\" primitive 0 POSITION: accessor 0: buffer 0: \"data.bin\": it lies outside the model's folder; copy it there";
    assert_eq!(inner.refusal("model.gltf"), wanted);
    // A link that stays inside is an ordinary file.
    fs::remove_file(inner.path("data.bin")).unwrap();
    inner.write("real.bin", Model::square().bytes);
    symlink("real.bin", inner.path("data.bin")).unwrap();
    assert!(host::model::load(&inner.path("model.gltf")).is_ok());
}

#[cfg(unix)]
#[test]
fn pipes_and_folders_are_refused_without_being_opened() {
    let folder = Folder::new();
    let pipe = |name: &str| {
        let made = std::process::Command::new("mkfifo")
            .arg(folder.path(name))
            .status();
        assert!(made.unwrap().success());
    };
    folder.write("model.gltf", beside("data.bin"));
    fs::create_dir(folder.path("data.bin")).unwrap();
    assert!(
        folder
            .refusal("model.gltf")
            .ends_with("it is not a regular file")
    );
    fs::remove_dir(folder.path("data.bin")).unwrap();
    // Opening a pipe without a writer would wait for ever.
    pipe("data.bin");
    assert!(
        folder
            .refusal("model.gltf")
            .ends_with("it is not a regular file")
    );
    pipe("pipe.glb");
    assert_eq!(
        folder.refusal("pipe.glb"),
        "pipe.glb: it is not a regular file"
    );
    assert!(host::model::load(Path::new("/dev/zero")).is_err());
}

#[test]
fn huge_and_absent_files_are_refused() {
    let folder = Folder::new();
    folder.write("model.gltf", beside("data.bin"));
    let wanted = "POSITION: accessor 0: buffer 0: \"data.bin\": cannot read the file: ";
    assert!(folder.refusal("model.gltf").contains(wanted));
    assert!(
        folder
            .refusal("absent.glb")
            .starts_with("absent.glb: cannot read the file: ")
    );
    // Sparse on disk: no test writes 600 MiB.
    let data = fs::File::create(folder.path("data.bin")).unwrap();
    data.set_len(600 << 20).unwrap();
    let error =
        host::model::load_within(&folder.path("model.gltf"), MemoryBudget::LEAST).unwrap_err();
    let wanted = "model.gltf: buffer 0: \"data.bin\": it has 629145600 bytes; allowed: at most 536870912 within the memory budget of 1280 MiB; raise it with --memory";
    assert_eq!(error.to_string(), wanted);
}

#[test]
fn buffers_together_have_a_budget() {
    let buffers = ["a", "b", "c"].map(|uri| json!({ "byteLength": 1, "uri": uri }));
    let json = Model::square()
        .with("/buffers", json!(buffers))
        .json
        .to_string();
    let mut asked = Vec::new();
    let error = gltf::load(json.as_bytes(), &mut |path, most| {
        asked.push((path.display().to_string(), most >> 20));
        Ok(vec![0; most.min(200 << 20) as usize])
    })
    .unwrap_err()
    .to_string();
    assert_eq!(
        asked,
        [("a", 512), ("b", 312), ("c", 112)].map(|(path, most)| (path.into(), most))
    );
    assert!(
        error.contains("bufferView 0 (48 bytes from byte 0) exceeds buffer 0, which has 1 bytes"),
        "{error}"
    );
}

#[test]
fn glb_lengths_are_checked_before_use() {
    let good = Model::square().glb();
    let patched = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    for (bytes, sentence) in [
        (&b"glTF"[..], "the GLB header has 4 of 12 bytes"),
        (&good[..11], "the GLB header has 11 of 12 bytes"),
        (&good[..12], "the GLB has no chunk of JSON; it is truncated"),
        (&patched(4, 1), "GLB version 1 is not supported"),
        (
            &patched(12, u32::MAX),
            "a GLB chunk states 4294967295 bytes",
        ),
        (&patched(16, 0), "the first GLB chunk is not JSON"),
        (b"", "not a glTF file"),
        (b"\x89PNG", "not a glTF file"),
        ("[".repeat(200_000).as_bytes(), "not a glTF file"),
    ] {
        let error = load(bytes).expect_err(sentence).to_string();
        assert!(error.contains(sentence), "said: {error}\nnot:  {sentence}");
    }
    for length in [0, 11, 12, u32::MAX, good.len() as u32 + 1] {
        let scene = load(&patched(8, length)).unwrap();
        let fault = format!(
            "the GLB header states {length} bytes, but the file has {}",
            good.len()
        );
        assert_eq!((triangles(&scene), scene.faults), (square(), vec![fault]));
    }
}

#[test]
fn versions_and_extensions_are_named() {
    // Without compressed data the extensions for it ask for nothing.
    let accepted = "KHR_draco_mesh_compression EXT_meshopt_compression KHR_mesh_quantization KHR_lights_punctual \
        KHR_materials_unlit KHR_materials_ior KHR_materials_emissive_strength KHR_texture_transform";
    for name in accepted.split(' ') {
        Model::square()
            .with("/extensionsRequired", json!([name]))
            .scene();
    }
}
