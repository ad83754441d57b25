//! The JSON of a model: version and extensions are checked first, then it is parsed and validated.

use gltf::json;
use serde::Deserialize;

use super::{
    error::{LoadError, called, quoted},
    limits,
};

/// Parses and validates the JSON with the crate `gltf`: all indices are in range and all enumerations known.
pub fn parse_document(json: &[u8]) -> Result<json::Root, LoadError> {
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
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => "; export the model without compression",
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
