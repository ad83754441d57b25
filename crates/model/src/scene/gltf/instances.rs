//! Instances: the nodes show the primitives of their meshes, once or many times.

use glam::{DMat3, DMat4};

use super::{
    deformation, document,
    error::LoadError,
    instancing::{self, INSTANCING},
    meshes::Loader,
    nodes::node_name,
};
use crate::scene::{
    material::Material,
    model::{Instance, Primitive},
    rig::{Property, Rig},
};

/// How many times as thick as in the space of its mesh a node makes the volume of a material, in
/// steps so small that no color shows them: a model of many sizes makes few materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Thickness(i32);

impl Thickness {
    const STEPS_PER_OCTAVE: f64 = 256.0;

    /// That of a node, by the volume of what it makes of a unit cube.
    fn of(world_from_node: &DMat4) -> Self {
        let volume = DMat3::from_mat4(*world_from_node).determinant().abs();
        // Beyond these a wall lets nothing or all through.
        let octaves = (libm::log2(volume) / 3.0).clamp(-30.0, 30.0);
        Self((octaves * Self::STEPS_PER_OCTAVE).round() as i32)
    }

    fn scale(self) -> f64 {
        libm::exp2(f64::from(self.0) / Self::STEPS_PER_OCTAVE)
    }
}

impl Loader<'_> {
    /// Adds the instances of a node. A skinned mesh ignores the transform of its node: its joints
    /// place it.
    ///
    /// # Errors
    /// Loading ends.
    pub fn add_instances(&mut self, node: usize, rig: &Rig) -> Result<(), LoadError> {
        let about = &self.document.nodes[node];
        let Some(mesh) = about.mesh else {
            return Ok(());
        };
        let range = self.mesh(mesh)?;
        let thickness = Thickness::of(&self.tree.world_from_node[node]);
        let mut shown = Vec::with_capacity(range.len());
        for primitive in range {
            let skin = match about.skin {
                Some(skin) => self.followed(primitive, skin, rig)?,
                None => None,
            };
            let thickness = if skin.is_some() {
                Thickness(0)
            } else {
                thickness
            };
            let primitive = self.morphed(primitive, node, rig)?;
            shown.push((self.scaled(primitive, thickness), skin));
        }
        let placements = self.placements(node, shown.len())?;
        let rig_node = (!rig.is_empty()).then(|| self.tree.rig_index[node]);
        let named_node = Some(self.tree.rig_index[node]);
        let world_from_node = self.tree.world_from_node[node];
        let Some(placements) = placements else {
            self.claim(node, shown.len())?;
            let instance = |(primitive, skin): (usize, Option<usize>)| Instance {
                primitive,
                world_from_object: skin.map_or(world_from_node, |_| DMat4::IDENTITY),
                node: rig_node,
                skin,
                named_node,
                placement: None,
            };
            self.writer
                .scene
                .instances
                .extend(shown.into_iter().map(instance));
            return Ok(());
        };
        let instances = &mut self.writer.scene.instances;
        instances
            .try_reserve(placements.len() * shown.len())
            .map_err(|_| LoadError::end("the system has no memory for its instances"))?;
        for node_from_instance in placements {
            let placement = rig_node.map(|_| {
                self.placements.push(node_from_instance);
                self.placements.len() - 1
            });
            let instance = |&(primitive, _): &(usize, Option<usize>)| Instance {
                primitive,
                world_from_object: world_from_node * node_from_instance,
                node: rig_node,
                skin: None,
                named_node,
                placement,
            };
            instances.extend(shown.iter().map(instance));
        }
        Ok(())
    }

    /// The primitive with the colors and texture coordinates that the weights of a node at rest make:
    /// clips do not move these.
    ///
    /// # Errors
    /// There would be too many bytes, or loading was canceled.
    fn morphed(&mut self, primitive: usize, node: usize, rig: &Rig) -> Result<usize, LoadError> {
        let about = self.sources[primitive];
        let is_color = |name: &String| name == "COLOR_0" || name.starts_with("TEXCOORD_");
        let mut names = about.targets.iter().flat_map(|target| target.keys());
        let rig_node = rig.nodes.get(self.tree.rig_index[node]);
        let Some(weights) = rig_node
            .map(|node| &node.weights)
            .filter(|_| names.any(is_color))
        else {
            return Ok(primitive);
        };
        let is_animated = |(_, channel): &(usize, Result<document::Channel, String>)| {
            let of_node = |channel: &document::Channel| {
                channel.node == node && channel.property == Property::Weights
            };
            channel.as_ref().is_ok_and(of_node)
        };
        let mut channels = self.document.clips.iter().flat_map(|clip| &clip.channels);
        if channels.any(is_animated) {
            self.buffers.notes.add(|| {
                format!(
                    "{}: clips do not move its morphed colors and texture coordinates, which stay as at rest",
                    node_name(self.document, node)
                )
            });
        }
        let key = (
            primitive,
            weights.iter().map(|weight| weight.to_bits()).collect(),
        );
        if let Some(&known) = self.morphed.get(&key) {
            return Ok(known);
        }
        let mut made = self.writer.scene.primitives[primitive].clone();
        let mut accessors = vec![("COLOR_0".to_owned(), made.colors.as_mut())];
        let textures = self.writer.scene.materials[made.material].textures();
        for (texcoords, texture) in made.texcoords.iter_mut().zip(textures) {
            let set = texture.map_or(0, |texture| texture.set);
            accessors.push((format!("TEXCOORD_{set}"), texcoords.as_mut()));
        }
        for (name, accessor) in accessors {
            if let Some(accessor) = accessor {
                *accessor = deformation::moved(&mut self.writer, about, &name, *accessor, weights)?;
            }
        }
        self.writer.scene.primitives.push(made);
        self.sources.push(about);
        let made = self.writer.scene.primitives.len() - 1;
        self.morphed.insert(key, made);
        Ok(made)
    }

    /// The primitive with its material `thickness` times as thick, where that shows.
    fn scaled(&mut self, primitive: usize, thickness: Thickness) -> usize {
        let scene = &mut self.writer.scene;
        let material = scene.primitives[primitive].material;
        let absorbs =
            |material: &Material| material.transmission > 0.0 && material.attenuation != [1.0; 3];
        if thickness == Thickness(0) || !absorbs(&scene.materials[material]) {
            return primitive;
        }
        let made = self.scaled.entry((primitive, thickness));
        *made.or_insert_with(|| {
            let mut thick = scene.materials[material].clone();
            thick.attenuation = thick
                .attenuation
                .map(|left| libm::pow(left.into(), thickness.scale()) as f32);
            scene.materials.push(thick);
            scene.primitives.push(Primitive {
                material: scene.materials.len() - 1,
                ..scene.primitives[primitive].clone()
            });
            self.sources.push(self.sources[primitive]);
            scene.primitives.len() - 1
        })
    }

    /// Counts more instances, before they are made.
    ///
    /// # Errors
    /// There are too many.
    fn claim(&mut self, node: usize, more: usize) -> Result<(), LoadError> {
        self.claimed = self.claimed.saturating_add(more);
        let instances = self.claimed;
        self.limits.check_instances(instances, || {
            format!(
                "{}: the nodes show {instances} primitives or more",
                node_name(self.document, node)
            )
        })
    }

    /// What places the instances of a node with so many primitives, relative to the node. None
    /// where it shows its mesh once, as it does where this cannot be read.
    fn placements(
        &mut self,
        node: usize,
        primitives: usize,
    ) -> Result<Option<Vec<DMat4>>, LoadError> {
        let (document, notes) = (self.document, self.buffers.notes);
        let Some(about) = &document.nodes[node].instancing else {
            return Ok(None);
        };
        let name = || format!("{} {INSTANCING}", node_name(document, node));
        if document.nodes[node].skin.is_some() {
            notes.add(|| format!("{}: joints place its mesh; it is drawn once", name()));
            return Ok(None);
        }
        let count = instancing::count(self.buffers, about);
        let read = count.and_then(|count| {
            // Those that turn out to be faulty count, too: reading them takes time.
            self.claim(node, (count as usize).saturating_mul(primitives.max(1)))?;
            instancing::placements(self.buffers, about, &self.tree.world_from_node[node])
        });
        match read {
            Ok(placements) => Ok(Some(placements)),
            Err(error) => {
                let reason = error.of_part()?;
                let fault = || format!("{}: {reason}; its mesh is drawn once", name());
                notes.fault(fault);
                Ok(None)
            }
        }
    }

    /// The skin that moves a primitive; none if it cannot.
    fn followed(
        &mut self,
        primitive: usize,
        skin: usize,
        rig: &Rig,
    ) -> Result<Option<usize>, LoadError> {
        // What is wrong with a skin without joints was said already.
        let Some(joints) = rig.skins.get(skin).filter(|skin| !skin.joints.is_empty()) else {
            return Ok(None);
        };
        let notes = self.buffers.notes;
        let about = self.sources[primitive];
        match deformation::follow_skin(&mut self.writer, primitive, about, joints, notes) {
            Ok(()) => Ok(Some(skin)),
            Err(error) => {
                let name = &self.writer.scene.primitives[primitive].name;
                let reason = error.within(name).of_part()?;
                notes.fault(|| format!("{reason}; it is drawn without its skin"));
                Ok(None)
            }
        }
    }
}
