//! The JSON of a model: version and extensions are checked first, then it is parsed and validated.

use gltf::json;
use serde::Deserialize;

use super::{
    compression::{DRACO, MESHOPT},
    error::{LoadError, called, quoted},
    limits,
    repair::{WEBP, repair},
};

/// Parses and validates the JSON with the crate `gltf`: all indices are in range and all
/// enumerations known.
///
/// `notes` receives messages about what had to be left out.
pub fn parse_document(json: &[u8], notes: &mut Vec<String>) -> Result<json::Root, LoadError> {
    if json.len() as u64 > limits::JSON_BYTES {
        return Err(LoadError::new(format!(
            "the JSON has {} bytes; allowed: at most {}",
            json.len(),
            limits::JSON_BYTES
        )));
    }
    let objects = json.iter().filter(|&&byte| byte == b'{').count();
    if objects > limits::JSON_OBJECTS {
        return Err(LoadError::new(format!(
            "the JSON has {objects} objects; allowed: at most {}",
            limits::JSON_OBJECTS
        )));
    }
    let values = json.iter().filter(|&&byte| byte == b',').count();
    if values > limits::JSON_VALUES {
        return Err(LoadError::new(format!(
            "the JSON has {values} values; allowed: at most {}",
            limits::JSON_VALUES
        )));
    }
    check_head(json)?;
    let malformed = |error: serde_json::Error| LoadError::new(format!("malformed glTF: {error}"));
    let has_custom = json.windows(2).any(|pair| pair == b"\"_");
    let has_sources = |root: &json::Root| {
        root.textures
            .iter()
            .all(|texture| texture.source.value() != NO_SOURCE)
    };
    let read = if has_custom {
        None
    } else {
        json::Root::from_slice(json).ok().filter(has_sources)
    };
    let mut root = match read {
        Some(root) => root,
        // The crate refuses some of what the standard allows.
        None => {
            let mut root: serde_json::Value = serde_json::from_slice(json).map_err(malformed)?;
            repair(&mut root, notes);
            serde_json::from_value(root).map_err(malformed)?
        }
    };
    let has_draco = root
        .extensions_used
        .iter()
        .chain(&root.extensions_required)
        .any(|name| name == DRACO);
    // This loader supports them; the crate refuses extensions that it does not support itself.
    root.extensions_required
        .retain(|name| !READ_HERE.contains(&name.as_str()));
    check_positions(&root)?;
    let without_view = |accessor: &json::Accessor| {
        has_draco && accessor.buffer_view.is_none() && accessor.sparse.is_none()
    };
    let compressed: Vec<usize> = (0..root.accessors.len())
        .filter(|&index| without_view(&root.accessors[index]))
        .collect();
    // The validation asks for a view, which Draco data takes the place of.
    compressed
        .iter()
        .for_each(|&index| root.accessors[index].buffer_view = Some(json::Index::new(0)));
    let document = gltf::Document::from_json(root)
        .map_err(|error| LoadError::new(format!("malformed glTF: {}", first_fault(error))))?;
    let mut root = document.into_json();
    compressed
        .iter()
        .for_each(|&index| root.accessors[index].buffer_view = None);
    Ok(root)
}

/// What the crate reads where a texture names no image.
const NO_SOURCE: usize = u32::MAX as usize;

/// Extension that allows small integers as attributes. Every attribute is read by its component
/// type anyway.
pub const QUANTIZATION: &str = "KHR_mesh_quantization";

/// Extensions that this loader reads and the crate `gltf` does not know.
pub const READ_HERE: [&str; 4] = [QUANTIZATION, WEBP, MESHOPT, DRACO];

/// Checks the version and the required extensions first, for clearer errors than those of the full
/// parser.
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
    let head: Head = serde_json::from_slice(json)
        .map_err(|error| LoadError::new(format!("it is not a glTF file: {error}")))?;
    let version = head
        .asset
        .version
        .as_str()
        .map_or_else(|| head.asset.version.to_string(), str::to_owned);
    if version != "2" && !version.starts_with("2.") {
        return Err(LoadError::new(format!(
            "glTF version {} is not supported; export as version 2.0",
            quoted(&version)
        )));
    }
    let is_read = |name: &str| {
        READ_HERE.contains(&name) || json::extensions::ENABLED_EXTENSIONS.contains(&name)
    };
    match head.extensions_required.iter().find(|name| !is_read(name)) {
        Some(name) => Err(LoadError::new(format!(
            "it requires the extension {}, which is not supported{}",
            quoted(name),
            remedy(name)
        ))),
        None => Ok(()),
    }
}

/// The validation of the crate `gltf` would index with this number before checking it, and panic.
fn check_positions(root: &json::Root) -> Result<(), LoadError> {
    let position = json::validation::Checked::Valid(json::mesh::Semantic::Positions);
    for (index, mesh) in root.meshes.iter().enumerate() {
        for accessor in mesh
            .primitives
            .iter()
            .filter_map(|primitive| primitive.attributes.get(&position))
        {
            if accessor.value() >= root.accessors.len() {
                let reason = format!(
                    "POSITION refers to accessor {accessor}, but there are only {}",
                    root.accessors.len()
                );
                return Err(LoadError::new(reason).within(called(
                    "mesh",
                    index,
                    mesh.name.as_deref(),
                )));
            }
        }
    }
    Ok(())
}

fn remedy(extension: &str) -> &'static str {
    match extension {
        "KHR_meshopt_compression" => {
            "; export the model with EXT_meshopt_compression, or without compression"
        }
        _ => "",
    }
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
