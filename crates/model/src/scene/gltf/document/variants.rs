//! KHR_materials_variants: other materials for the same primitives.

use std::collections::{BTreeMap, btree_map::Entry};

use serde_json::Value;

use super::{
    super::error::menu_name,
    Document,
    fields::{Lenient, Object, needed},
    read::Lists,
};
use crate::scene::model::named;

/// The extension.
pub const VARIANTS: &str = "KHR_materials_variants";

/// The variants that the document names.
pub fn listed<'a>(lenient: &Lenient, root: Object<'a>) -> &'a [Value] {
    let extension = lenient.field(root.extension(VARIANTS));
    extension.map_or(&[], |extension| lenient.list(extension.list("variants")))
}

/// Their names in menus and presets.
pub fn names(listed: &[Value]) -> Vec<String> {
    let name = |(index, variant): (usize, &Value)| {
        let name = Object::of(variant).and_then(|variant| variant.text("name"));
        menu_name("variant", index, name.ok().flatten())
    };
    listed.iter().enumerate().map(name).collect()
}

/// The material of a primitive in each variant that gives it one. A mapping that cannot be read is
/// left out.
pub fn materials(lists: &Lists, lenient: &Lenient, part: Object) -> BTreeMap<usize, usize> {
    let mut materials = BTreeMap::new();
    let Some(extension) = lenient.field(part.extension(VARIANTS)) else {
        return materials;
    };
    let mappings = lenient.list(extension.list("mappings"));
    for (at, mapping) in mappings.iter().enumerate() {
        let lenient = Lenient {
            notes: lists.notes,
            name: format!("{} {VARIANTS} mapping {at}", lenient.name),
        };
        let read = || {
            let mapping = Object::of(mapping)?;
            let material = mapping.index("material", "materials", lists.materials.len());
            let variants = ("variants", lists.variants.len());
            let variants = mapping.indices("variants", variants, |reason| lenient.fault(reason))?;
            Ok(Some((needed("material", material)?, variants)))
        };
        let Some((material, variants)) = lenient.field(read()) else {
            continue;
        };
        for variant in variants {
            match materials.entry(variant) {
                Entry::Vacant(entry) => _ = entry.insert(material),
                Entry::Occupied(_) => lenient.fault(format_args!(
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
