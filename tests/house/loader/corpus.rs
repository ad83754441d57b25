//! Promise: of the models of assimp, every one that has something to draw loads and the others are
//! refused with the expected message; the loader agrees with the validator of the standard on faults.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use rasterlab::{host, scene::gltf::LoadError};

use super::model::*;

const CORPUS: &str = "/usr/share/assimp/models";

fn models_below(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).expect("assimp-testmodels");
    let mut entries: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let ending = path
            .extension()
            .unwrap_or_default()
            .to_string_lossy()
            .to_lowercase();
        if path.is_dir() {
            models_below(&path, endings, found);
        } else if endings.contains(&&*ending) {
            found.push(path);
        }
    }
}

/// Loads the models of these folders, more than `least`: those whose names begin as `refused` says
/// must be refused so, the others must open.
pub fn check(
    folders: &[&str],
    endings: &[&str],
    least: usize,
    refused: &[(&str, &str)],
    open: impl Fn(&Path) -> Result<(), LoadError>,
) {
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
    folders
        .iter()
        .for_each(|folder| models_below(&corpus.join(folder), endings, &mut models));
    assert!(models.len() > least, "{} models", models.len());
    for path in models {
        let name = path.strip_prefix(corpus).unwrap().display().to_string();
        let expected = refused.iter().find(|(start, _)| name.starts_with(start));
        match (open(&path).map_err(|error| error.to_string()), expected) {
            (Ok(()), None) => {}
            (Ok(()), Some((_, sentence))) => panic!("{name} was accepted; expected: {sentence}"),
            (Err(error), Some((_, sentence))) => {
                assert!(
                    error.contains(sentence),
                    "{name} said: {error}\nnot: {sentence}"
                );
            }
            (Err(error), None) => panic!("{name} was refused: {error}"),
        }
    }
}

#[test]
fn corpus_loads_what_is_well_formed_and_refuses_the_rest() {
    check(&["glTF", "glTF2"], &["gltf", "glb"], 40, EXPECTED, |path| {
        let scene = host::model::load(path)?;
        assert_sound(&scene);
        let name = path.display().to_string();
        let mut empty = ["PrimitiveMode", "cameras", "SceneWithoutNodes"].iter();
        let may_be_empty = empty.any(|part| name.contains(part));
        assert!(
            scene.triangle_count() > 0 || may_be_empty,
            "{name}: {:?}",
            scene.notes
        );
        Ok(())
    });
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
        "POSITION: vertex 0 has a value that is not finite, as has each of its triangles",
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
    let found = node("require('gltf-validator')").output();
    if !found.is_ok_and(|output| output.status.success()) {
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
    let text = String::from_utf8(output.stdout).expect("JSON");
    let lines: Vec<Vec<String>> = text
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
    let corpus = Path::new(CORPUS).join("glTF2");
    let mut files = Vec::new();
    if corpus.is_dir() {
        models_below(&corpus, &["gltf", "glb"], &mut files);
    }
    files.sort();
    let folder = tempfile::tempdir().expect("a temporary folder");
    // What is wrong with a model, if anything is.
    let fault = |file: &Path| match host::model::load(file) {
        Ok(scene) => scene.faults.first().cloned(),
        Err(error) => Some(error.to_string()),
    };
    for (index, changes) in MALFORMED.iter().chain([&""]).enumerate() {
        let path = folder.path().join(format!("{index}.glb"));
        fs::write(&path, Model::textured().set(changes).glb()).expect("written");
        assert_eq!(fault(&path).is_some(), !changes.is_empty(), "{changes}");
        files.push(path);
    }
    let Some(errors) = validated(&files) else {
        return;
    };
    let mut disagreements = Vec::new();
    for (file, mut codes) in files.iter().zip(errors) {
        codes.retain(|code| !UNREAD.contains(&code.as_str()));
        match fault(file) {
            None if !codes.is_empty() => {
                disagreements.push(format!(
                    "{} has no fault, and the validator says {codes:?}",
                    file.display()
                ));
            }
            Some(fault) if codes.is_empty() => {
                disagreements.push(format!("the validator has nothing against it: {fault}"));
            }
            _ => {}
        }
    }
    assert_eq!(disagreements, Vec::<String>::new());
}

/// Changes that break a rule of the standard about textures, one each.
const MALFORMED: [&str; 11] = [
    "M/pbrMetallicRoughness/baseColorTexture/index 9",
    "/textures/0/source 9",
    "/textures/0/sampler 9",
    "/images/0 {}",
    "/images/0/uri \"flag.png\"",
    "/bufferViews/3/byteLength 100000",
    "P/attributes {\"POSITION\":0}",
    "/accessors/1/type \"SCALAR\"",
    "& VEC2 F32 0*2 nan 0 1*2 0 1\nA/TEXCOORD_0 3",
    "& VEC2 F32 0*6\nA/TEXCOORD_0 3",
    "M/alphaMode \"MASK\"\nM/alphaCutoff -1",
];
