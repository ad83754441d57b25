//! What the standard allows and the crate `gltf` refuses: the JSON is changed before it is parsed.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

/// Extension of textures whose image is a WebP.
pub const WEBP: &str = "EXT_texture_webp";

/// Changes `root` so that the crate `gltf` reads it. `notes` receives a message about what is not
/// drawn.
pub fn repair(root: &mut Value, notes: &mut Vec<String>) {
    without_extras(root);
    without_custom_attributes(root);
    for scene in list(root, "scenes").filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| json!([]));
    }
    without_empty_textures(root, notes);
}

/// The entries of a list at the top of the document.
fn list<'a>(root: &'a mut Value, name: &str) -> impl Iterator<Item = &'a mut Value> {
    root.get_mut(name)
        .and_then(Value::as_array_mut)
        .into_iter()
        .flatten()
}

/// Removes `extras`: application-specific data that may be any JSON value.
fn without_extras(value: &mut Value) {
    match value {
        Value::Object(map) => {
            map.remove("extras");
            map.values_mut().for_each(without_extras);
        }
        Value::Array(list) => list.iter_mut().for_each(without_extras),
        _ => {}
    }
}

/// Removes application-specific attributes (`_TEMPERATURE`).
fn without_custom_attributes(root: &mut Value) {
    let primitives = list(root, "meshes")
        .filter_map(|mesh| mesh.get_mut("primitives")?.as_array_mut())
        .flatten();
    for attributes in
        primitives.filter_map(|primitive| primitive.get_mut("attributes")?.as_object_mut())
    {
        attributes.retain(|name, _| !name.starts_with('_'));
    }
}

/// Gives textures without a source that of their WebP, and removes the use of those that have none
/// at all.
fn without_empty_textures(root: &mut Value, notes: &mut Vec<String>) {
    let mut empty = BTreeSet::new();
    let no_image = root
        .get("images")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    for (index, texture) in list(root, "textures").enumerate() {
        let Some(texture) = texture
            .as_object_mut()
            .filter(|texture| !texture.contains_key("source"))
        else {
            continue;
        };
        let webp = texture
            .get("extensions")
            .and_then(|extensions| extensions.get(WEBP)?.get("source"))
            .cloned();
        if webp.is_none() {
            empty.insert(index as u64);
        }
        texture.insert("source".into(), webp.unwrap_or_else(|| json!(no_image)));
    }
    if empty.is_empty() {
        return;
    }
    // A source must name an image; this one is never decoded, since nothing uses these textures any
    // more.
    if let Some(root) = root.as_object_mut()
        && let Some(images) = root
            .entry("images")
            .or_insert_with(|| json!([]))
            .as_array_mut()
    {
        images.push(json!({ "uri": "data:," }));
    }
    list(root, "materials")
        .filter_map(Value::as_object_mut)
        .for_each(|material| without_textures(material, &empty));
    notes.push(match empty.len() {
        1 => "a texture has no image that can be read; it is not drawn".into(),
        count => format!("{count} textures have no image that can be read; they are not drawn"),
    });
}

/// Removes the references to `empty` textures from a material and from the objects inside it.
fn without_textures(object: &mut Map<String, Value>, empty: &BTreeSet<u64>) {
    let is_empty = |name: &str, value: &Value| {
        let index = value.get("index").and_then(Value::as_u64);
        name.ends_with("Texture") && index.is_some_and(|index| empty.contains(&index))
    };
    object.retain(|name, value| !is_empty(name, value));
    object
        .values_mut()
        .filter_map(Value::as_object_mut)
        .for_each(|inner| without_textures(inner, empty));
}
