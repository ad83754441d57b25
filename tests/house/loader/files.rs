//! Promise: containers, URIs and files: only files in the model's folder are read, within limits.

use std::{
    fs,
    path::{Path, PathBuf},
};

use base64::{Engine, prelude::BASE64_STANDARD};
use rasterlab::{
    host,
    scene::{
        Scene,
        gltf::{self, LoadError},
        memory::MemoryBudget,
    },
};
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

    fn load(&self, model: &Model) -> Result<Scene, LoadError> {
        fs::write(self.path("model.gltf"), model.json.to_string()).unwrap();
        host::model::load(&self.path("model.gltf"))
    }
}

#[test]
fn buffers_come_from_data_uris_and_from_files_beside_the_model() {
    let model = Model::square();
    let data = format!(
        "data:application/octet-stream;base64,{}",
        BASE64_STANDARD.encode(&model.bytes)
    );
    let embedded = model
        .clone()
        .with("/buffers/0/uri", json!(data))
        .json
        .to_string();
    let scene = gltf::load(embedded.as_bytes(), &mut |_, _| unreachable!()).unwrap();
    assert_eq!(triangles(&scene), square());

    let folder = Folder::new();
    fs::create_dir(folder.path("parts")).unwrap();
    fs::write(folder.path("parts/my data.bin"), &model.bytes).unwrap();
    let scene = folder
        .load(&model.with("/buffers/0/uri", json!("./parts/my%20data.bin")))
        .unwrap();
    assert_eq!(
        (triangles(&scene), scene.name.as_str()),
        (square(), "model")
    );
}

#[test]
fn uris_that_lead_out_of_the_folder_are_refused_unread() {
    // The bytes are there to be had: one folder up, and by absolute path.
    let outer = Folder::new();
    let model = Model::square();
    fs::write(outer.path("secret.bin"), &model.bytes).unwrap();
    fs::create_dir(outer.path("inner")).unwrap();
    let absolute = outer.path("secret.bin").display().to_string();
    let uris = [
        "../secret.bin".into(),
        "./../secret.bin".into(),
        "a/../../secret.bin".into(),
        "%2e%2e/secret.bin".into(),
        "%2E%2E%2Fsecret.bin".into(),
        "..\\secret.bin".into(),
        "..%5csecret.bin".into(),
        absolute.clone(),
        format!("file:{absolute}"),
        format!("file://{absolute}"),
        format!("FILE://{absolute}"),
        "http://localhost/secret.bin".into(),
        "C:/secret.bin".into(),
        "C%3A/secret.bin".into(),
        "secret%.bin".into(),
        "secret%+1.bin".into(),
        "secret%00.bin".into(),
        "".into(),
        ".".into(),
    ];
    for uri in uris {
        let text = model
            .clone()
            .with("/buffers/0/uri", json!(uri))
            .json
            .to_string();
        let error = gltf::load(text.as_bytes(), &mut |path, _| {
            panic!("{uri}: {} was asked for", path.display())
        })
        .expect_err(&uri);
        assert!(error.to_string().contains("buffer 0: URI "), "{error}");
        let file = outer.path("inner/model.gltf");
        fs::write(&file, text).unwrap();
        assert!(host::model::load(&file).is_err(), "{uri}");
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_refused() {
    let (outer, inner) = (Folder::new(), Folder::new());
    let model = Model::square().with("/buffers/0/uri", json!("data.bin"));
    fs::write(outer.path("data.bin"), &model.bytes).unwrap();
    std::os::unix::fs::symlink(outer.path("data.bin"), inner.path("data.bin")).unwrap();
    let error = inner.load(&model).unwrap_err().to_string();
    assert_eq!(
        error,
        "model.gltf: mesh \"X\" primitive 0 POSITION: accessor 0: buffer 0: \"data.bin\": it lies outside the model's folder; copy it there"
    );
    // A link that stays inside is an ordinary file.
    fs::remove_file(inner.path("data.bin")).unwrap();
    fs::write(inner.path("real.bin"), &model.bytes).unwrap();
    std::os::unix::fs::symlink("real.bin", inner.path("data.bin")).unwrap();
    assert!(inner.load(&model).is_ok());
}

#[cfg(unix)]
#[test]
fn pipes_and_folders_are_refused_without_being_opened() {
    let folder = Folder::new();
    let model = Model::square().with("/buffers/0/uri", json!("data.bin"));
    fs::create_dir(folder.path("data.bin")).unwrap();
    assert!(
        folder
            .load(&model)
            .unwrap_err()
            .to_string()
            .ends_with("it is not a regular file")
    );
    fs::remove_dir(folder.path("data.bin")).unwrap();
    // Opening a pipe without a writer would wait for ever.
    assert!(
        std::process::Command::new("mkfifo")
            .arg(folder.path("data.bin"))
            .status()
            .unwrap()
            .success()
    );
    assert!(
        folder
            .load(&model)
            .unwrap_err()
            .to_string()
            .ends_with("it is not a regular file")
    );
    assert!(
        std::process::Command::new("mkfifo")
            .arg(folder.path("pipe.glb"))
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(
        host::model::load(&folder.path("pipe.glb"))
            .unwrap_err()
            .to_string(),
        "pipe.glb: it is not a regular file"
    );
    assert!(host::model::load(Path::new("/dev/zero")).is_err());
}

#[test]
fn huge_and_absent_files_are_refused() {
    let folder = Folder::new();
    let model = Model::square().with("/buffers/0/uri", json!("data.bin"));
    assert!(
        folder
            .load(&model)
            .unwrap_err()
            .to_string()
            .contains("POSITION: accessor 0: buffer 0: \"data.bin\": cannot read the file: ")
    );
    // Sparse on disk: no test writes 600 MiB.
    fs::File::create(folder.path("data.bin"))
        .unwrap()
        .set_len(600 << 20)
        .unwrap();
    let error = host::model::load_within(&folder.path("model.gltf"), MemoryBudget::LEAST)
        .unwrap_err()
        .to_string();
    let wanted = "it has 629145600 bytes; allowed: at most 536870912 within the memory budget of 1280 MiB; raise it with --memory";
    assert_eq!(
        error,
        format!("model.gltf: buffer 0: \"data.bin\": {wanted}")
    );
    assert!(
        host::model::load(&folder.path("absent.glb"))
            .unwrap_err()
            .to_string()
            .starts_with("absent.glb: cannot read the file: ")
    );
}

#[test]
fn buffers_together_have_a_budget() {
    let mut model = Model::square();
    model.json["buffers"] = json!([{ "byteLength": 1, "uri": "a" }, { "byteLength": 1, "uri": "b" }, { "byteLength": 1, "uri": "c" }]);
    let mut asked = Vec::new();
    let error = gltf::load(model.json.to_string().as_bytes(), &mut |path, most| {
        asked.push((path.display().to_string(), most));
        Ok(vec![0; most.min(200 << 20) as usize])
    })
    .unwrap_err();
    assert_eq!(
        asked,
        [
            ("a".into(), 512 << 20),
            ("b".into(), 312 << 20),
            ("c".into(), 112 << 20)
        ]
    );
    assert!(
        error
            .to_string()
            .contains("bufferView 0 (48 bytes from byte 0) exceeds buffer 0, which has 1 bytes"),
        "{error}"
    );
}

#[test]
fn glb_lengths_are_checked_before_use() {
    let good = Model::square().glb();
    let refused = |bytes: &[u8], sentence: &str| {
        let error = gltf::load(bytes, &mut |_, _| unreachable!())
            .expect_err(sentence)
            .to_string();
        assert!(error.contains(sentence), "said: {error}\nnot:  {sentence}");
    };
    let patched = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    refused(b"glTF", "the GLB header has 4 of 12 bytes");
    refused(&good[..11], "the GLB header has 11 of 12 bytes");
    refused(&good[..12], "the GLB has no chunk of JSON; it is truncated");
    refused(&patched(4, 1), "GLB version 1 is not supported");
    for length in [0, 11, 12, u32::MAX, good.len() as u32 + 1] {
        let scene = gltf::load(&patched(8, length), &mut |_, _| unreachable!()).unwrap();
        let fault = format!(
            "the GLB header states {length} bytes, but the file has {}",
            good.len()
        );
        assert_eq!((triangles(&scene), scene.faults), (square(), vec![fault]));
    }
    refused(
        &patched(12, u32::MAX),
        "a GLB chunk states 4294967295 bytes",
    );
    refused(&patched(16, 0), "the first GLB chunk is not JSON");
    refused(b"", "not a glTF file");
    refused(b"\x89PNG", "not a glTF file");
    refused("[".repeat(200_000).as_bytes(), "not a glTF file");
}

#[test]
fn versions_and_extensions_are_named() {
    Model::square()
        .with("/asset/version", json!("1.0"))
        .refused("glTF version \"1.0\" is not supported");
    Model::square()
        .with("/asset", json!({}))
        .dropped("its asset has no version; it is read as glTF 2.0");
    Model::square()
        .without("/asset")
        .refused("it is not a glTF file: its JSON has no asset");
    Model::square()
        .with("/asset/minVersion", json!("2.1"))
        .refused("it needs a reader of glTF \"2.1\", by its minVersion");
    let later = Model::square()
        .with("/asset", json!({ "version": "2.1", "minVersion": "2.0" }))
        .scene();
    assert_eq!(later.notes, [""; 0]);
    Model::square().with("/extensionsRequired", json!(["KHR_meshopt_compression"])).refused(
        "it requires the extension \"KHR_meshopt_compression\", which is not supported; export the model with EXT_meshopt_compression",
    );
    // Without compressed data they ask for nothing.
    Model::square()
        .with(
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression", "EXT_meshopt_compression"]),
        )
        .scene();
    Model::square()
        .with("/extensionsRequired", json!(["KHR_mesh_quantization"]))
        .scene();
    for accepted in [
        "KHR_lights_punctual",
        "KHR_materials_unlit",
        "KHR_materials_ior",
        "KHR_materials_emissive_strength",
        "KHR_texture_transform",
    ] {
        Model::square()
            .with("/extensionsRequired", json!([accepted]))
            .scene();
    }
}
