//! Clips: the animations of a file, with every keyframe checked.

use std::collections::{HashMap, HashSet};

use gltf::json::{
    self,
    animation::{Interpolation as Way, Property as Path},
    validation::Checked,
};

use super::{
    buffers::Buffers,
    error::{LoadError, called},
    limits,
    nodes::{LENGTH_TOLERANCE, MIN_QUATERNION_LENGTH, Tree, node_name},
    notes::Notes,
};
use crate::scene::{
    accessor::{Accessor, ComponentType},
    rig::{Channel, Clip, Interpolation, LocalTransform, Property, Rig, Sampler},
};

/// Reads every animation into `rig`, whose nodes must be complete. `notes` receives messages about
/// repairs.
pub fn read(
    buffers: &Buffers,
    tree: &Tree,
    rig: &mut Rig,
    notes: &mut Notes,
) -> Result<(), LoadError> {
    let root = buffers.root;
    let channels: usize = root
        .animations
        .iter()
        .map(|animation| animation.channels.len())
        .sum();
    if channels > limits::CHANNELS {
        return Err(LoadError::new(format!(
            "the animations have {channels} channels; allowed: at most {}",
            limits::CHANNELS
        )));
    }
    let mut reader = Reader {
        buffers,
        rig,
        known: HashMap::new(),
        numbers: 0,
        not_normalized: 0,
    };
    for (index, animation) in root.animations.iter().enumerate() {
        let name = called("clip", index, animation.name.as_deref());
        let mut clip = Clip {
            name: name_of(animation, index),
            duration_s: 0.0,
            channels: Vec::new(),
        };
        let mut taken = HashSet::new();
        for (in_property, channel) in animation.channels.iter().enumerate() {
            let at = |error: LoadError| error.within(format!("{name} channel {in_property}"));
            let channel = reader
                .channel(tree, index, animation, channel)
                .map_err(at)?;
            if !taken.insert((channel.node, channel.property.name())) {
                return Err(at(LoadError::new(format!(
                    "another channel already animates the {} of its node; a clip may animate it once",
                    channel.property.name()
                ))));
            }
            let last = reader.rig.samplers[channel.sampler].times.last();
            clip.duration_s =
                last.map_or(clip.duration_s, |&last| clip.duration_s.max(last.into()));
            clip.channels.push(channel);
        }
        reader.rig.clips.push(clip);
    }
    if reader.not_normalized > 0 {
        notes.add(|| {
            format!(
                "{} rotation keyframes are not unit quaternions; they are normalized",
                reader.not_normalized
            )
        });
    }
    Ok(())
}

/// The name in menus and presets.
fn name_of(animation: &json::Animation, index: usize) -> String {
    let name: String = animation
        .name
        .iter()
        .flat_map(|name| name.chars())
        .filter(|c| !c.is_control())
        .take(60)
        .collect();
    if name.trim().is_empty() {
        format!("clip {index}")
    } else {
        name
    }
}

struct Reader<'a> {
    buffers: &'a Buffers<'a>,
    rig: &'a mut Rig,
    /// Index of the sampler read for each animation, sampler index and number of components.
    known: HashMap<(usize, usize, usize), usize>,
    /// Numbers read so far.
    numbers: usize,
    /// Rotation keyframes that are not unit quaternions.
    not_normalized: usize,
}

impl Reader<'_> {
    fn channel(
        &mut self,
        tree: &Tree,
        clip: usize,
        from: &json::Animation,
        channel: &json::animation::Channel,
    ) -> Result<Channel, LoadError> {
        let (target, at) = (channel.target.node.value(), channel.sampler.value());
        // The crate `gltf` does not check this index.
        let node = tree.rig_index.get(target).copied().ok_or_else(|| {
            LoadError::new(format!("its target is node {target}, which does not exist"))
        })?;
        let (property, components) = match channel.target.path {
            Checked::Valid(Path::Translation) => (Property::Translation, 3),
            Checked::Valid(Path::Rotation) => (Property::Rotation, 4),
            Checked::Valid(Path::Scale) => (Property::Scale, 3),
            Checked::Valid(Path::MorphTargetWeights) => {
                (Property::Weights, self.rig.nodes[node].weights.len())
            }
            Checked::Invalid => {
                return Err(LoadError::new(
                    "its target path must be translation, rotation, scale or weights",
                ));
            }
        };
        let name = node_name(self.buffers.root, target);
        let in_property = |error: LoadError| error.within(format!("{} of {name}", property.name()));
        if property == Property::Weights && components == 0 {
            return Err(in_property(LoadError::new(
                "the node has no mesh with morph targets",
            )));
        }
        if property != Property::Weights
            && matches!(self.rig.nodes[node].rest, LocalTransform::Matrix(_))
        {
            return Err(in_property(LoadError::new(
                "the node has a matrix; only a node with translation, rotation and scale can be animated",
            )));
        }
        let sampler = match self.known.get(&(clip, at, components)) {
            Some(&sampler) => sampler,
            None => {
                let sampler = self
                    .sampler(&from.samplers[at], property, components)
                    .map_err(in_property)?;
                self.rig.samplers.push(sampler);
                self.known
                    .insert((clip, at, components), self.rig.samplers.len() - 1);
                self.rig.samplers.len() - 1
            }
        };
        Ok(Channel {
            node,
            property,
            sampler,
        })
    }

    fn sampler(
        &mut self,
        from: &json::animation::Sampler,
        property: Property,
        components: usize,
    ) -> Result<Sampler, LoadError> {
        let (interpolation, parts) = match from.interpolation {
            Checked::Valid(Way::Step) => (Interpolation::Step, 1),
            Checked::Valid(Way::Linear) => (Interpolation::Linear, 1),
            Checked::Valid(Way::CubicSpline) => (Interpolation::Cubic, 3),
            Checked::Invalid => {
                return Err(LoadError::new(
                    "its interpolation must be STEP, LINEAR or CUBICSPLINE",
                ));
            }
        };
        let times = self
            .times(from.input.value())
            .map_err(|error| error.within("input"))?;
        let expected = times.len()
            * parts
            * if property == Property::Weights {
                components
            } else {
                1
            };
        let values = self
            .values(from.output.value(), property, expected)
            .map_err(|error| error.within("output"))?;
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(LoadError::new(format!(
                "keyframe {} has the value {}; it must be finite",
                at / (components * parts),
                values[at]
            ))
            .within("output"));
        }
        if property == Property::Rotation {
            let keys = values.chunks_exact(4).skip(parts / 2).step_by(parts);
            for (key, q) in keys.enumerate() {
                let length = q
                    .iter()
                    .map(|&v| f64::from(v) * f64::from(v))
                    .sum::<f64>()
                    .sqrt();
                if length < MIN_QUATERNION_LENGTH {
                    return Err(LoadError::new(format!(
                        "keyframe {key} is a quaternion of length {length:e}; it must be at least {MIN_QUATERNION_LENGTH:e}"
                    ))
                    .within("output"));
                }
                self.not_normalized += usize::from((length - 1.0).abs() > LENGTH_TOLERANCE);
            }
        }
        Ok(Sampler {
            interpolation,
            times,
            values,
            components,
        })
    }

    /// Keyframe times: finite, not negative and strictly increasing.
    fn times(&mut self, index: usize) -> Result<Vec<f32>, LoadError> {
        let about = self.buffers.layout(index)?.accessor;
        if (about.component_type, about.components) != (ComponentType::F32, 1) {
            return Err(LoadError::new("must be SCALAR of FLOAT"));
        }
        let times = self.numbers(index)?;
        for (key, &time) in times.iter().enumerate() {
            if !(time >= 0.0 && time.is_finite()) {
                return Err(LoadError::new(format!(
                    "keyframe {key} has the time {time} s; it must be finite and at least 0"
                )));
            }
            if key > 0 && times[key - 1] >= time {
                return Err(LoadError::new(format!(
                    "keyframe {key} at {time} s follows {} s; times must increase",
                    times[key - 1]
                )));
            }
        }
        Ok(times)
    }

    fn values(
        &mut self,
        index: usize,
        property: Property,
        expected: usize,
    ) -> Result<Vec<f32>, LoadError> {
        let about = self.buffers.layout(index)?.accessor;
        let may_be_integer = matches!(property, Property::Rotation | Property::Weights);
        let is_number = match about.component_type {
            ComponentType::F32 => !about.normalized,
            ComponentType::U32 => false,
            _ => about.normalized && may_be_integer,
        };
        let components = match property {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::Weights => 1,
        };
        if !is_number || about.components != components {
            return Err(LoadError::new(
                "has a type that glTF does not allow for this property",
            ));
        }
        if about.count as usize != expected {
            return Err(LoadError::new(format!(
                "has {} elements; its keyframes need {expected}",
                about.count
            )));
        }
        self.numbers(index)
    }

    /// All components of an accessor, normalized where it says so.
    fn numbers(&mut self, index: usize) -> Result<Vec<f32>, LoadError> {
        let layout = self.buffers.layout(index)?;
        let Accessor {
            component_type,
            components,
            count,
            ..
        } = layout.accessor;
        self.numbers += (count * components) as usize;
        if self.numbers > limits::KEY_NUMBERS {
            return Err(LoadError::new(format!(
                "the animations have {} numbers or more; allowed: at most {}",
                self.numbers,
                limits::KEY_NUMBERS
            )));
        }
        let bytes = self.buffers.materialized(index, &layout)?;
        let packed = Accessor {
            offset: 0,
            stride: component_type.bytes() * components,
            ..layout.accessor
        };
        let element = |element: u32| (0..components).map(move |component| (element, component));
        Ok((0..count)
            .flat_map(element)
            .map(|(element, component)| packed.value(&bytes, element, component) as f32)
            .collect())
    }
}
