//! EXT_mesh_gpu_instancing: the transforms of a node that shows its mesh many times.
//!
//! Attributes of applications, whose names begin with `_`, are not read: every instance looks like
//! its mesh.

use glam::DMat4;

use super::{
    buffers::{Buffers, FLOAT, Format},
    document::{Instancing, MIN_QUATERNION_LENGTH},
    error::LoadError,
};
use crate::{
    scene::{
        accessor::{Accessor, ComponentType},
        quaternion::unit,
        rig::{LocalTransform, Trs},
    },
    work::checkpoint,
};

/// The extension.
pub const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The formats of rotations.
const ROTATIONS: &[Format] = &[
    (ComponentType::F32, false),
    (ComponentType::I8, true),
    (ComponentType::I16, true),
];

/// Instances between two looks at whether loading was canceled.
const STRIDE: u32 = 1 << 16;

/// The number of instances.
///
/// # Errors
/// An accessor cannot be read or has a type that the extension does not allow, or two have
/// different numbers of elements.
pub fn count(buffers: &Buffers, about: &Instancing) -> Result<u32, LoadError> {
    let mut known: Option<(&str, u32)> = None;
    for (name, accessor, components, formats) in [
        ("TRANSLATION", about.translation, 3, FLOAT),
        ("ROTATION", about.rotation, 4, ROTATIONS),
        ("SCALE", about.scale, 3, FLOAT),
    ] {
        let Some(index) = accessor else { continue };
        let layout = buffers.layout(index).map_err(|error| error.within(name))?;
        let Accessor { count, .. } = layout.accessor;
        let format = (layout.accessor.component_type, layout.accessor.normalized);
        if layout.accessor.components != components || !formats.contains(&format) {
            let reason = "must be of a type that the extension allows for it";
            return Err(LoadError::new(reason).within(name));
        }
        match known {
            Some((first, counted)) if counted != count => {
                return Err(LoadError::new(format!(
                    "{first} has {counted} elements and {name} has {count}; all must have as many"
                )));
            }
            _ => known = Some((name, count)),
        }
    }
    Ok(known.map_or(0, |(_, count)| count))
}

/// The transform of every instance relative to its node, which lies at `world_from_node`. There are
/// as many as [`count`] says, in the order of the file.
///
/// # Errors
/// A number is not finite, a rotation has no direction, or loading was canceled.
pub fn placements(
    buffers: &Buffers,
    about: &Instancing,
    world_from_node: &DMat4,
) -> Result<Vec<DMat4>, LoadError> {
    let count = count(buffers, about)?;
    let [translations, rotations, scales] =
        [about.translation, about.rotation, about.scale].map(|accessor| {
            accessor
                .map(|accessor| Elements::read(buffers, accessor))
                .transpose()
        });
    let (translations, rotations, scales) = (translations?, rotations?, scales?);
    let checkpoint = checkpoint();
    let mut placements = Vec::new();
    placements
        .try_reserve_exact(count as usize)
        .map_err(|_| LoadError::end(format!("the system has no memory for {count} instances")))?;
    for instance in 0..count {
        if instance.is_multiple_of(STRIDE) {
            checkpoint.pass()?;
        }
        let mut parts = Trs::default();
        if let Some(translations) = &translations {
            parts.translation = translations.numbers(instance).into();
        }
        if let Some(rotations) = &rotations {
            let rotation = rotations.numbers(instance);
            let length = rotation.iter().map(|v| v * v).sum::<f64>().sqrt();
            // A length that is no number is not below it.
            if !(length >= MIN_QUATERNION_LENGTH && length.is_finite()) {
                return Err(LoadError::new(format!(
                    "instance {instance} has as rotation a quaternion of length {length:e}"
                )));
            }
            parts.rotation = unit(rotation);
        }
        if let Some(scales) = &scales {
            parts.scale = scales.numbers(instance).into();
        }
        let node_from_instance = LocalTransform::Trs(parts).matrix();
        if !(*world_from_node * node_from_instance).is_finite() {
            return Err(LoadError::new(format!(
                "the transform of instance {instance} is not finite"
            )));
        }
        placements.push(node_from_instance);
    }
    Ok(placements)
}

/// The elements of an accessor, packed.
struct Elements {
    accessor: Accessor,
    bytes: Vec<u8>,
}

impl Elements {
    fn read(buffers: &Buffers, index: usize) -> Result<Self, LoadError> {
        let layout = buffers.layout(index)?;
        let element = layout.accessor.component_type.bytes() * layout.accessor.components;
        Ok(Self {
            bytes: buffers.materialized(index, &layout)?,
            accessor: Accessor {
                offset: 0,
                stride: element,
                ..layout.accessor
            },
        })
    }

    /// The first `N` components of an element.
    fn numbers<const N: usize>(&self, element: u32) -> [f64; N] {
        std::array::from_fn(|component| self.accessor.value(&self.bytes, element, component as u32))
    }
}
