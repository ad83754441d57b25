//! Clips: the animations of a file, with every keyframe checked.

use std::collections::{HashMap, HashSet};

use super::{
    buffers::Buffers,
    document::{self, MIN_QUATERNION_LENGTH},
    error::{LoadError, called, menu_name},
    limits,
    nodes::{LENGTH_TOLERANCE, Tree, node_name},
};
use crate::scene::{
    accessor::{Accessor, ComponentType},
    rig::{Channel, Clip, Interpolation, LocalTransform, Property, Rig, Sampler},
};

/// Reads every animation into `rig`, whose nodes must be complete. A channel that cannot be read is
/// left out.
///
/// # Errors
/// The clips exceed their limits.
pub fn read(buffers: &Buffers, tree: &Tree, rig: &mut Rig) -> Result<(), LoadError> {
    let document = buffers.document;
    let channels: usize = document.clips.iter().map(|clip| clip.channels.len()).sum();
    if channels > limits::CHANNELS {
        return Err(LoadError::end(format!(
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
    for (index, about) in document.clips.iter().enumerate() {
        let name = called("clip", index, about.name.as_deref());
        let mut clip = Clip {
            name: menu_name("clip", index, about.name.as_deref()),
            duration_s: 0.0,
            channels: Vec::new(),
        };
        let mut taken = HashSet::new();
        for (at, channel) in &about.channels {
            let place = format!("{name} channel {at}");
            let channel = match channel {
                Ok(channel) => reader.channel(tree, index, about, channel, &place),
                Err(reason) => Err(LoadError::new(reason)),
            };
            let channel = channel.and_then(|channel| {
                match taken.insert((channel.node, channel.property.name())) {
                    true => Ok(channel),
                    false => Err(LoadError::new(format!(
                        "another channel already animates the {} of its node; a clip may animate it once",
                        channel.property.name()
                    ))),
                }
            });
            match channel {
                Ok(channel) => {
                    let last = reader.rig.samplers[channel.sampler].times.last();
                    clip.duration_s =
                        last.map_or(clip.duration_s, |&last| clip.duration_s.max(last.into()));
                    clip.channels.push(channel);
                }
                Err(error) => {
                    let reason = error.within(place).of_part()?;
                    buffers.notes.fault(|| format!("{reason}; it is left out"));
                }
            }
        }
        reader.rig.clips.push(clip);
    }
    if reader.not_normalized > 0 {
        buffers.notes.fault(|| {
            format!(
                "{} rotation keyframes are not unit quaternions; they are normalized",
                reader.not_normalized
            )
        });
    }
    Ok(())
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
        from: &document::Clip,
        channel: &document::Channel,
        place: &str,
    ) -> Result<Channel, LoadError> {
        let (node, property) = (tree.rig_index[channel.node], channel.property);
        let components = match property {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::Weights => self.rig.nodes[node].weights.len(),
        };
        let name = node_name(self.buffers.document, channel.node);
        let in_property =
            |error: LoadError| error.within(format_args!("{} of {name}", property.name()));
        if property == Property::Weights && components == 0 {
            return Err(in_property(LoadError::new(
                "the node has no mesh with morph targets",
            )));
        }
        if property != Property::Weights
            && matches!(self.rig.nodes[node].rest, LocalTransform::Matrix(_))
        {
            return Err(in_property(LoadError::new(
                "the node has a matrix with shear; only a node with translation, rotation and scale can be animated",
            )));
        }
        let at = channel.sampler;
        let sampler = match self.known.get(&(clip, at, components)) {
            Some(&sampler) => sampler,
            None => {
                let about = from.samplers[at].as_ref().map_err(|reason| {
                    LoadError::new(reason).within(format_args!("sampler {at}"))
                })?;
                let sampler = self
                    .sampler(about, property, components, place)
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
        from: &document::KeySampler,
        property: Property,
        components: usize,
        place: &str,
    ) -> Result<Sampler, LoadError> {
        let interpolation = from.interpolation;
        let parts = if interpolation == Interpolation::Cubic {
            3
        } else {
            1
        };
        let times = self
            .times(from.times, place)
            .map_err(|error| error.within("input"))?;
        let expected = times.len()
            * parts
            * if property == Property::Weights {
                components
            } else {
                1
            };
        let mut values = self
            .values(from.values, property, expected)
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
            let keys = values.chunks_exact_mut(4).skip(parts / 2).step_by(parts);
            for (key, q) in keys.enumerate() {
                let length = q
                    .iter()
                    .map(|&v| f64::from(v) * f64::from(v))
                    .sum::<f64>()
                    .sqrt();
                if length < MIN_QUATERNION_LENGTH {
                    self.buffers.notes.fault(|| {
                        format!("{place}: keyframe {key} is a quaternion of length {length:e}; it is read as no rotation")
                    });
                    q.copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
                    continue;
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

    /// Keyframe times: finite, not negative and not falling. Of equal ones the last is seen.
    fn times(&mut self, index: usize, place: &str) -> Result<Vec<f32>, LoadError> {
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
            let Some(before) = key.checked_sub(1).map(|before| times[before]) else {
                continue;
            };
            if before > time {
                return Err(LoadError::new(format!(
                    "keyframe {key} at {time} s follows {before} s; times must increase"
                )));
            }
            if before == time {
                self.buffers.notes.fault(|| {
                    format!("{place}: keyframe {key} has the same time as the one before, {time} s; times must increase, and the value jumps there")
                });
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
            return Err(LoadError::end(format!(
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
