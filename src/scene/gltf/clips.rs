//! Clips: the file's animations, with every key checked before it is kept.

use std::collections::{HashMap, HashSet};

use gltf::json::{
    self,
    animation::{Interpolation as Way, Property as Path},
    validation::Checked,
};

use super::{
    LoadError,
    buffers::Buffers,
    called, limits,
    nodes::{LEAST_LENGTH, Tree, UNEVEN, node_name},
};
use crate::scene::{
    Accessor, Component,
    rig::{Channel, Clip, Interpolation, Local, Property, Rig, Sampler},
};

/// Reads every animation into `rig`, whose nodes stand; `notes` takes what was put right.
pub fn read(buffers: &Buffers, tree: &Tree, rig: &mut Rig, notes: &mut Vec<String>) -> Result<(), LoadError> {
    let root = buffers.root;
    let channels: usize = root.animations.iter().map(|animation| animation.channels.len()).sum();
    if channels > limits::CHANNELS {
        return Err(LoadError::new(format!("the clips have {channels} channels; at most {} are read", limits::CHANNELS)));
    }
    let mut reader = Reader { buffers, rig, known: HashMap::new(), numbers: 0, uneven: 0 };
    for (index, animation) in root.animations.iter().enumerate() {
        let name = called("clip", index, animation.name.as_deref());
        let mut clip = Clip { name: name_of(animation, index), duration_s: 0.0, channels: Vec::new() };
        let mut taken = HashSet::new();
        for (place, channel) in animation.channels.iter().enumerate() {
            let at = |error: LoadError| error.within(format!("{name} channel {place}"));
            let channel = reader.channel(tree, index, animation, channel).map_err(at)?;
            if !taken.insert((channel.node, channel.property.name())) {
                return Err(at(LoadError::new(format!("its node has another channel of {}", channel.property.name()))));
            }
            let last = reader.rig.samplers[channel.sampler].times.last();
            clip.duration_s = last.map_or(clip.duration_s, |&last| clip.duration_s.max(last.into()));
            clip.channels.push(channel);
        }
        reader.rig.clips.push(clip);
    }
    if reader.uneven > 0 {
        notes.push(format!("{} rotation keys are no unit quaternions; they are taken by their direction", reader.uneven));
    }
    Ok(())
}

/// As menus and presets name it.
fn name_of(animation: &json::Animation, index: usize) -> String {
    let name: String = animation.name.iter().flat_map(|name| name.chars()).filter(|c| !c.is_control()).take(60).collect();
    if name.trim().is_empty() { format!("clip {index}") } else { name }
}

struct Reader<'a> {
    buffers: &'a Buffers<'a>,
    rig: &'a mut Rig,
    /// Samplers by animation, place and lanes.
    known: HashMap<(usize, usize, usize), usize>,
    /// Key numbers read so far.
    numbers: usize,
    /// Rotation keys that are no unit quaternions.
    uneven: usize,
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
        // The crate leaves this index unchecked.
        let node =
            tree.place_of.get(target).copied().ok_or_else(|| LoadError::new(format!("moves node {target}, which does not exist")))?;
        let (property, components) = match channel.target.path {
            Checked::Valid(Path::Translation) => (Property::Translation, 3),
            Checked::Valid(Path::Rotation) => (Property::Rotation, 4),
            Checked::Valid(Path::Scale) => (Property::Scale, 3),
            Checked::Valid(Path::MorphTargetWeights) => (Property::Weights, self.rig.nodes[node].weights.len()),
            Checked::Invalid => return Err(LoadError::new("moves a property that glTF does not have")),
        };
        let name = node_name(self.buffers.root, target);
        let place = |error: LoadError| error.within(format!("{} of {name}", property.name()));
        if property == Property::Weights && components == 0 {
            return Err(place(LoadError::new("the node shows no mesh with morph targets")));
        }
        if property != Property::Weights && matches!(self.rig.nodes[node].rest, Local::Matrix(_)) {
            return Err(place(LoadError::new("the node has a matrix, which no clip may move")));
        }
        let sampler = match self.known.get(&(clip, at, components)) {
            Some(&sampler) => sampler,
            None => {
                let sampler = self.sampler(&from.samplers[at], property, components).map_err(place)?;
                self.rig.samplers.push(sampler);
                self.known.insert((clip, at, components), self.rig.samplers.len() - 1);
                self.rig.samplers.len() - 1
            }
        };
        Ok(Channel { node, property, sampler })
    }

    fn sampler(&mut self, from: &json::animation::Sampler, property: Property, components: usize) -> Result<Sampler, LoadError> {
        let (interpolation, parts) = match from.interpolation {
            Checked::Valid(Way::Step) => (Interpolation::Step, 1),
            Checked::Valid(Way::Linear) => (Interpolation::Linear, 1),
            Checked::Valid(Way::CubicSpline) => (Interpolation::Cubic, 3),
            Checked::Invalid => return Err(LoadError::new("its interpolation is unknown")),
        };
        let times = self.times(from.input.value()).map_err(|error| error.within("input"))?;
        let wanted = times.len() * parts * if property == Property::Weights { components } else { 1 };
        let values = self.values(from.output.value(), property, wanted).map_err(|error| error.within("output"))?;
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(LoadError::new(format!("key {} has the value {}", at / (components * parts), values[at])).within("output"));
        }
        if property == Property::Rotation {
            let keys = values.chunks_exact(4).skip(parts / 2).step_by(parts);
            for (key, q) in keys.enumerate() {
                let length = q.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt();
                if length < LEAST_LENGTH {
                    return Err(LoadError::new(format!("key {key} is no quaternion with a direction")).within("output"));
                }
                self.uneven += usize::from((length - 1.0).abs() > UNEVEN);
            }
        }
        Ok(Sampler { interpolation, times, values, components })
    }

    /// Key times: finite, not negative, and strictly rising.
    fn times(&mut self, index: usize) -> Result<Vec<f32>, LoadError> {
        let about = self.buffers.layout(index)?.accessor;
        if (about.component, about.components) != (Component::F32, 1) {
            return Err(LoadError::new("is not SCALAR of FLOAT"));
        }
        let times = self.numbers(index)?;
        for (key, &time) in times.iter().enumerate() {
            if !(time >= 0.0 && time.is_finite()) {
                return Err(LoadError::new(format!("key {key} lies at {time} s; a time is a number from 0 up")));
            }
            if key > 0 && times[key - 1] >= time {
                return Err(LoadError::new(format!("times must rise, but key {key} at {time} s follows {} s", times[key - 1])));
            }
        }
        Ok(times)
    }

    fn values(&mut self, index: usize, property: Property, wanted: usize) -> Result<Vec<f32>, LoadError> {
        let about = self.buffers.layout(index)?.accessor;
        let may_be_integer = matches!(property, Property::Rotation | Property::Weights);
        let is_number = match about.component {
            Component::F32 => !about.normalized,
            Component::U32 => false,
            _ => about.normalized && may_be_integer,
        };
        let components = match property {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::Weights => 1,
        };
        if !is_number || about.components != components {
            return Err(LoadError::new("has a type that glTF does not allow here"));
        }
        if about.count as usize != wanted {
            return Err(LoadError::new(format!("has {} elements; its keys ask for {wanted}", about.count)));
        }
        self.numbers(index)
    }

    /// All numbers of an accessor, normalized.
    fn numbers(&mut self, index: usize) -> Result<Vec<f32>, LoadError> {
        let layout = self.buffers.layout(index)?;
        let Accessor { component, components, count, .. } = layout.accessor;
        self.numbers += (count * components) as usize;
        if self.numbers > limits::KEY_NUMBERS {
            return Err(LoadError::new(format!("brings the clips to {} numbers; at most {} are read", self.numbers, limits::KEY_NUMBERS)));
        }
        let bytes = self.buffers.materialized(index, &layout)?;
        let packed = Accessor { offset: 0, stride: component.bytes() * components, ..layout.accessor };
        let element = |element: u32| (0..components).map(move |lane| (element, lane));
        Ok((0..count).flat_map(element).map(|(element, lane)| packed.value(&bytes, element, lane) as f32).collect())
    }
}
