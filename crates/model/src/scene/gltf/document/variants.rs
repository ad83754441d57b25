//! KHR_materials_variants: other materials for the same primitives.

use std::collections::{BTreeMap, btree_map::Entry};

use ::gltf::json::extensions::mesh::Mapping;
use serde_json::{Value, json};

use super::{
    super::error::menu_name,
    Document,
    element::{Element, wrong},
    read::Lists,
};
use crate::scene::model::named;

/// The extension.
pub const VARIANTS: &str = "KHR_materials_variants";

/// Their names in menus and presets.
pub fn names(listed: &[Value]) -> Vec<String> {
    let name = |(index, variant): (usize, &Value)| {
        menu_name(
            "variant",
            index,
            variant.get("name").and_then(Value::as_str),
        )
    };
    listed.iter().enumerate().map(name).collect()
}

/// Takes out the material of a primitive in each variant that gives it one. A mapping that cannot be
/// read is left out.
pub fn materials(lists: &Lists, part: &mut Element) -> BTreeMap<usize, usize> {
    let mut materials = BTreeMap::new();
    let extensions = part.json.get_mut("extensions");
    let extension = extensions.and_then(|extensions| extensions.as_object_mut()?.remove(VARIANTS));
    let mut mappings = Vec::new();
    if let Some(extension) = extension {
        match Element::of(lists.notes, part.name.clone(), &extension) {
            Ok(mut extension) => mappings = extension.take_list("mappings"),
            Err(_) => part.fault(wrong(VARIANTS, &extension, "an object")),
        }
    }
    for (at, mapping) in mappings.iter().enumerate() {
        let name = format!("{} {VARIANTS} mapping {at}", part.name);
        let read = Element::of(lists.notes, name.clone(), mapping).and_then(|mut mapping| {
            lists.check(
                &mapping.json,
                "material",
                ("materials", lists.materials.len()),
            )?;
            let given = mapping.json.get("variants");
            if let Some(given) = given.filter(|given| !given.is_array()) {
                return Err(wrong("variants", given, "a list"));
            }
            let count = ("variants", lists.variants.len());
            let variants = mapping.take_indices("variants", count, Element::fault);
            mapping.json.insert("variants".into(), json!([]));
            let mapping: Mapping = mapping.read(&["material"])?;
            Ok((mapping.material as usize, variants))
        });
        let fault = |reason: &dyn std::fmt::Display| {
            lists
                .notes
                .fault(|| format!("{name}: {reason}; it is left out"))
        };
        let (material, variants) = match read {
            Ok(read) => read,
            Err(reason) => {
                fault(&reason);
                continue;
            }
        };
        for variant in variants {
            match materials.entry(variant) {
                Entry::Vacant(entry) => _ = entry.insert(material),
                Entry::Occupied(_) => fault(&format_args!(
                    "variant {variant} has a material of an earlier mapping"
                )),
            }
        }
    }
    materials
}

impl Document {
    /// Gives every primitive its material in the variant called `name`; nothing changes where there
    /// is no such variant, or where it gives a primitive none.
    pub fn show_variant(&mut self, name: &str) {
        let Some(variant) = named(&self.variants, name) else {
            return;
        };
        let meshes = self.meshes.iter_mut();
        for primitive in meshes.flat_map(|mesh| &mut mesh.primitives).flatten() {
            if let Some(&material) = primitive.variants.get(&variant) {
                primitive.material = Some(material);
            }
        }
    }
}
