//! Container: reads files within limits, splits a GLB into its chunks, and parses the JSON with its version and extensions.

use std::{fs, io::Read, path::Path};

use gltf::json;
use serde::Deserialize;

use super::{LoadError, called, limits, quoted};

/// Reads a regular file of at most `most` bytes. Pipes, devices and folders are refused before they are opened.
pub fn read_regular(path: &Path, most: u64) -> Result<Vec<u8>, LoadError> {
    let failed = |error: std::io::Error| LoadError::new(format!("cannot read the file: {error}"));
    let about = fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err(LoadError::new("it is not a regular file"));
    }
    let too_large = |bytes: u64| LoadError::new(format!("it has {bytes} bytes; allowed: at most {most}"));
    if about.len() > most {
        return Err(too_large(about.len()));
    }
    let mut bytes = Vec::with_capacity(about.len() as usize);
    // The file may grow while it is read.
    fs::File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > most { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

/// Reads `beside`, a relative path without `..`, from the folder of `model`. Symbolic links must not lead out of the folder.
pub fn read_beside(model: &Path, beside: &Path, most: u64) -> Result<Vec<u8>, LoadError> {
    let folder = model.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let failed = |error: std::io::Error| LoadError::new(format!("cannot read the file: {error}"));
    let folder = folder.canonicalize().map_err(failed)?;
    let file = folder.join(beside).canonicalize().map_err(failed)?;
    if !file.starts_with(&folder) {
        return Err(LoadError::new("it lies outside the model's folder; copy it there"));
    }
    read_regular(&file, most)
}

/// The JSON and, of a GLB, the binary chunk.
pub fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), LoadError> {
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

/// Parses and validates the JSON with the crate `gltf`: all indices are in range and all enumerations known.
pub fn root(json: &[u8]) -> Result<json::Root, LoadError> {
    if json.len() as u64 > limits::JSON_BYTES {
        return Err(LoadError::new(format!("the JSON has {} bytes; allowed: at most {}", json.len(), limits::JSON_BYTES)));
    }
    let objects = json.iter().filter(|&&byte| byte == b'{').count();
    if objects > limits::JSON_OBJECTS {
        return Err(LoadError::new(format!("the JSON has {objects} objects; allowed: at most {}", limits::JSON_OBJECTS)));
    }
    check_head(json)?;
    let malformed = |error: serde_json::Error| LoadError::new(format!("malformed glTF: {error}"));
    let stripped = without_custom_attributes(json).map_err(malformed)?;
    let mut root = json::Root::from_slice(stripped.as_deref().unwrap_or(json)).map_err(malformed)?;
    // This loader supports it; the crate refuses extensions that it does not support itself.
    root.extensions_required.retain(|name| name != QUANTIZATION);
    check_positions(&root)?;
    let document = gltf::Document::from_json(root).map_err(|error| LoadError::new(format!("malformed glTF: {}", first_fault(error))))?;
    Ok(document.into_json())
}

/// Extension that allows small integers as attributes. Every attribute is read by its component type anyway.
pub const QUANTIZATION: &str = "KHR_mesh_quantization";

/// Checks the version and the required extensions first, for clearer errors than those of the full parser.
fn check_head(json: &[u8]) -> Result<(), LoadError> {
    #[derive(Deserialize)]
    struct Head {
        asset: Asset,
        #[serde(default, rename = "extensionsRequired")]
        extensions_required: Vec<String>,
    }
    #[derive(Deserialize)]
    struct Asset {
        version: serde_json::Value,
    }
    let head: Head = serde_json::from_slice(json).map_err(|error| LoadError::new(format!("it is not a glTF file: {error}")))?;
    let version = head.asset.version.as_str().map_or_else(|| head.asset.version.to_string(), str::to_owned);
    if version != "2" && !version.starts_with("2.") {
        return Err(LoadError::new(format!("glTF version {} is not supported; export as version 2.0", quoted(&version))));
    }
    let is_read = |name: &str| name == QUANTIZATION || json::extensions::ENABLED_EXTENSIONS.contains(&name);
    match head.extensions_required.iter().find(|name| !is_read(name)) {
        Some(name) => Err(LoadError::new(format!("it requires the extension {}, which is not supported{}", quoted(name), remedy(name)))),
        None => Ok(()),
    }
}

/// The validation of the crate `gltf` would index with this number before checking it, and panic.
fn check_positions(root: &json::Root) -> Result<(), LoadError> {
    let position = json::validation::Checked::Valid(json::mesh::Semantic::Positions);
    for (index, mesh) in root.meshes.iter().enumerate() {
        for accessor in mesh.primitives.iter().filter_map(|primitive| primitive.attributes.get(&position)) {
            if accessor.value() >= root.accessors.len() {
                let reason = format!("POSITION refers to accessor {accessor}, but there are only {}", root.accessors.len());
                return Err(LoadError::new(reason).within(called("mesh", index, mesh.name.as_deref())));
            }
        }
    }
    Ok(())
}

fn remedy(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => ; export the model without compression",
        _ => "",
    }
}

/// Removes application-specific attributes (`_TEMPERATURE`): glTF 2.0 allows them, but the crate `gltf` refuses them.
fn without_custom_attributes(json: &[u8]) -> Result<Option<Vec<u8>>, serde_json::Error> {
    if !json.windows(2).any(|pair| pair == b"\"_") {
        return Ok(None);
    }
    let mut root: serde_json::Value = serde_json::from_slice(json)?;
    let meshes = root.get_mut("meshes").and_then(|meshes| meshes.as_array_mut()).into_iter().flatten();
    let primitives = meshes.filter_map(|mesh| mesh.get_mut("primitives")?.as_array_mut()).flatten();
    for attributes in primitives.filter_map(|primitive| primitive.get_mut("attributes")?.as_object_mut()) {
        attributes.retain(|name, _| !name.starts_with('_'));
    }
    serde_json::to_vec(&root).map(Some)
}

/// The first validation error as one sentence.
fn first_fault(error: gltf::Error) -> String {
    match error {
        gltf::Error::Validation(faults) => match faults.first() {
            Some((path, fault)) => format!("{path}: {fault}"),
            None => "validation failed".into(),
        },
        other => other.to_string(),
    }
}
