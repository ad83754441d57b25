//! Promise: of the models of assimp, every one that has something to draw loads and the others are
//! refused with the expected message; the loader agrees with the validator of the standard on faults.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use rasterlab::host;
use serde_json::{Value, json};

use super::{materials::BASE, model::*};

const CORPUS: &str = "/usr/share/assimp/models";

fn models_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            models_below(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn corpus_loads_what_is_well_formed_and_refuses_the_rest() {
    if std::env::var_os("RASTERLAB_CORPUS").is_some_and(|value| value == "skip") {
        eprintln!("RASTERLAB_CORPUS=skip: the models of assimp-testmodels were not read");
        return;
    }
    let corpus = Path::new(CORPUS);
    assert!(
        corpus.is_dir(),
        "{CORPUS} is missing: install the Debian package assimp-testmodels, or set RASTERLAB_CORPUS=skip"
    );
    let mut models = Vec::new();
    ["glTF", "glTF2"]
        .iter()
        .for_each(|folder| models_below(&corpus.join(folder), &mut models));
    assert!(models.len() > 40, "{} models", models.len());
    for path in models {
        let name = path.strip_prefix(corpus).unwrap().display().to_string();
        let expected = EXPECTED
            .iter()
            .find(|(start, _)| name.starts_with(start))
            .map(|(_, expected)| *expected);
        match (host::model::load(&path), expected) {
            (Ok(scene), None) => {
                assert_sound(&scene);
                let may_be_empty = ["PrimitiveMode", "cameras", "SceneWithoutNodes"]
                    .iter()
                    .any(|part| name.contains(part));
                assert!(
                    scene.triangle_count() > 0 || may_be_empty,
                    "{name}: {:?}",
                    scene.notes
                );
            }
            (Ok(_), Some(sentence)) => panic!("{name} was accepted; expected: {sentence}"),
            (Err(error), Some(sentence)) => assert!(
                error.to_string().contains(sentence),
                "{name} said: {error}\nnot: {sentence}"
            ),
            (Err(error), None) => panic!("{name} was refused: {error}"),
        }
    }
}

/// Models of the corpus that must be refused, and what the refusal says.
const EXPECTED: &[(&str, &str)] = &[
    (
        "glTF/BoxTextured-glTF-Binary",
        "GLB version 1 is not supported",
    ),
    ("glTF/", "is not supported; export as version 2.0"),
    (
        "glTF2/BoxWithInfinites",
        "POSITION: vertex 0 has a value that is not finite",
    ),
    (
        "glTF2/IndexOutOfRange/All",
        "mesh \"Mesh\" primitive 0 indices: corner 0 refers to vertex 65535, but there are only 24",
    ),
    (
        "glTF2/IndexOutOfRange/Index",
        "mesh \"Mesh\" primitive 0 indices: corner 0 refers to vertex 255, but there are only 24",
    ),
    (
        "glTF2/MissingBin",
        "buffer 0: \"BoxTextured0.bin\": cannot read the file",
    ),
    ("glTF2/RecursiveNodes", "node 0: it is its own ancestor"),
    (
        "glTF2/SchemaFailures",
        "buffer 0: \"BoxTextured0.bin\": cannot read the file",
    ),
    (
        "glTF2/TestNoRootNode/NoScene",
        "the file: its scene is 0, but there are only 0 scenes",
    ),
    (
        "glTF2/wrongTypes/badArray",
        "mesh \"Mesh\": its primitives is an object; it must be a list",
    ),
];

/// Classes of errors that we leave alone: what a file says about itself and rasterlab does not
/// read, and normals of any length.
const UNREAD: [&str; 4] = [
    "ACCESSOR_MIN_MISMATCH",
    "ACCESSOR_MAX_MISMATCH",
    "ACCESSOR_VECTOR3_NON_UNIT",
    "MESH_PRIMITIVE_NO_TANGENT_SPACE",
];

/// Reads every file named after it and prints a line of JSON each: the codes of its errors.
const VALIDATE: &str = r#"
const validator = require('gltf-validator'), fs = require('fs'), path = require('path');
const beside = file => uri => new Promise((found, failed) =>
    fs.readFile(path.resolve(path.dirname(file), decodeURIComponent(uri)), (error, bytes) => error ? failed(String(error)) : found(new Uint8Array(bytes))));
const codes = report => report.issues.messages.filter(message => message.severity === 0).map(message => message.code);
(async () => {
    for (const file of process.argv.slice(1)) {
        const options = { uri: path.basename(file), externalResourceFunction: beside(file) };
        const found = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), options).then(codes, error => [String(error)]);
        console.log(JSON.stringify(found));
    }
})();
"#;

/// Codes of the errors that the validator finds in every file; none where node or the validator is
/// missing.
fn validated(files: &[PathBuf]) -> Option<Vec<Vec<String>>> {
    let node = |script: &str| {
        let mut command = Command::new("node");
        command
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["-e", script]);
        command
    };
    let is_there = node("require('gltf-validator')")
        .output()
        .is_ok_and(|output| output.status.success());
    if !is_there {
        eprintln!(
            "gltf-validator is not installed (npm install gltf-validator here, or NODE_PATH): nothing is held against it"
        );
        return None;
    }
    let output = node(VALIDATE)
        .arg("--")
        .args(files)
        .output()
        .expect("node runs");
    let lines = String::from_utf8(output.stdout).expect("JSON");
    let lines: Vec<Vec<String>> = lines
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(
        lines.len(),
        files.len(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(lines)
}

#[test]
fn faults_are_what_the_validator_calls_errors() {
    let corpus = Path::new("/usr/share/assimp/models/glTF2");
    let mut files = Vec::new();
    if corpus.is_dir() {
        models_below(corpus, &mut files);
    }
    files.sort();
    let folder = tempfile::tempdir().expect("a temporary folder");
    // What is wrong with a model, if anything is.
    let fault = |file: &Path| match host::model::load(file) {
        Ok(scene) => scene.faults.first().cloned(),
        Err(error) => Some(error.to_string()),
    };
    for (name, model) in &malformed() {
        let path = folder.path().join(format!("{name}.glb"));
        fs::write(&path, model.glb()).expect("written");
        assert!(fault(&path).is_some(), "{name}");
        files.push(path);
    }
    fs::write(folder.path().join("well.glb"), Model::textured().glb()).expect("written");
    files.push(folder.path().join("well.glb"));
    let Some(errors) = validated(&files) else {
        return;
    };
    let mut disagreements = Vec::new();
    for (file, codes) in files.iter().zip(&errors) {
        let codes: Vec<&String> = codes
            .iter()
            .filter(|code| !UNREAD.contains(&code.as_str()))
            .collect();
        match fault(file) {
            None if !codes.is_empty() => disagreements.push(format!(
                "{} has no fault, and the validator says {codes:?}",
                file.display()
            )),
            Some(fault) if codes.is_empty() => {
                disagreements.push(format!("the validator has nothing against it: {fault}"))
            }
            _ => {}
        }
    }
    assert_eq!(disagreements, Vec::<String>::new());
}

/// Files that break a rule of the standard about textures, one each.
fn malformed() -> Vec<(&'static str, Model)> {
    let at = |place: &str, value: Value| Model::textured().with(place, value);
    let mut not_finite = Model::textured();
    let texcoords = not_finite.accessor(
        &le_floats(&[0.0, 0.0, f32::NAN, 0.0, 1.0, 1.0, 0.0, 1.0]),
        F32,
        "VEC2",
        4,
    );
    let mut few = Model::textured();
    let three = few.accessor(&le_floats(&[0.0; 6]), F32, "VEC2", 3);
    let set = "/meshes/0/primitives/0/attributes/TEXCOORD_0";
    vec![
        (
            "texture beyond the list",
            at(&format!("{BASE}/index"), json!(9)),
        ),
        ("image beyond the list", at("/textures/0/source", json!(9))),
        (
            "sampler beyond the list",
            at("/textures/0/sampler", json!(9)),
        ),
        ("an image of nothing", at("/images/0", json!({}))),
        (
            "an image of two things",
            at("/images/0/uri", json!("flag.png")),
        ),
        (
            "a view beyond its buffer",
            at("/bufferViews/3/byteLength", json!(100_000)),
        ),
        (
            "no coordinates",
            at(
                "/meshes/0/primitives/0/attributes",
                json!({ "POSITION": 0 }),
            ),
        ),
        (
            "coordinates of one component",
            at("/accessors/1/type", json!("SCALAR")),
        ),
        (
            "coordinates that are no numbers",
            not_finite.with(set, json!(texcoords)),
        ),
        (
            "fewer coordinates than vertices",
            few.with(set, json!(three)),
        ),
        (
            "a negative cutoff",
            at("/materials/0/alphaMode", json!("MASK")).with("/materials/0/alphaCutoff", json!(-1)),
        ),
    ]
}
