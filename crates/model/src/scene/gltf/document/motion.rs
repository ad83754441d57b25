//! Skins and clips.

use ::gltf::json::{self, animation, validation::Checked};
use serde_json::{Value, json};

use super::{Channel, Clip, KeySampler, Part, Skin, element::Element, read::Lists};
use crate::scene::rig::{Interpolation, Property};

pub fn skin(lists: &Lists, mut part: Element) -> Part<Skin> {
    let mut lost = None;
    if let Some(joints) = part.json.get("joints").filter(|joints| !joints.is_array()) {
        return Err(super::element::wrong("joints", joints, "a list"));
    }
    let joints = part.take_indices("joints", ("nodes", lists.nodes.len()), |_, reason| {
        lost.get_or_insert(reason);
    });
    match lost {
        // Vertices refer to joints by their places in the list.
        Some(reason) => return Err(reason),
        None if joints.is_empty() => return Err("it has no joints".into()),
        None => part.json.insert("joints".into(), json!([])),
    };
    lists.check(&part.json, "inverseBindMatrices", lists.accessors())?;
    let skin: json::Skin = part.read(&["inverseBindMatrices"])?;
    Ok(Skin {
        name: skin.name,
        joints,
        inverse_bind: skin.inverse_bind_matrices.map(|index| index.value()),
    })
}

/// A clip; one without channels where it is no object.
pub fn clip(lists: &Lists, index: usize, value: &Value) -> Clip {
    let Some(mut part) = lists.element("clip", index, value) else {
        return Clip::default();
    };
    let (samplers, channels) = (part.take_list("samplers"), part.take_list("channels"));
    for key in ["samplers", "channels"] {
        part.json.insert(key.into(), json!([]));
    }
    let clip: Option<json::Animation> = lists.read(&mut part);
    let mut read = Vec::with_capacity(channels.len());
    for (at, value) in channels.iter().enumerate() {
        let channel = || channel(lists, lists.nameless(value)?, samplers.len());
        match channel() {
            Ok(None) => lists
                .notes
                .add(|| format!("{} channel {at} animates no node; it is ignored", part.name)),
            Ok(Some(channel)) => read.push((at, Ok(channel))),
            Err(reason) => read.push((at, Err(reason))),
        }
    }
    Clip {
        name: clip.and_then(|clip| clip.name),
        channels: read,
        samplers: samplers
            .iter()
            .map(|value| key_sampler(lists, lists.nameless(value)?))
            .collect(),
    }
}

/// A channel; none that animates anything but a node, which is valid.
fn channel(lists: &Lists, mut part: Element, samplers: usize) -> Part<Option<Channel>> {
    if let Some(target) = part.object(&["target"]) {
        if !target.contains_key("node") {
            return Ok(None);
        }
        lists.check(target, "node", ("nodes", lists.nodes.len()))?;
    }
    lists.check(&part.json, "sampler", ("samplers", samplers))?;
    let channel: animation::Channel = part.read(&["target", "sampler"])?;
    let property = match channel.target.path {
        Checked::Valid(animation::Property::Translation) => Property::Translation,
        Checked::Valid(animation::Property::Rotation) => Property::Rotation,
        Checked::Valid(animation::Property::Scale) => Property::Scale,
        Checked::Valid(animation::Property::MorphTargetWeights) => Property::Weights,
        Checked::Invalid => {
            let path = part.json["target"]["path"].clone();
            let known = animation::VALID_PROPERTIES.join(", ");
            return Err(super::element::wrong(
                "path",
                &path,
                format_args!("one of {known}"),
            ));
        }
    };
    Ok(Some(Channel {
        node: channel.target.node.value(),
        property,
        sampler: channel.sampler.value(),
    }))
}

fn key_sampler(lists: &Lists, mut part: Element) -> Part<KeySampler> {
    lists.check(&part.json, "input", lists.accessors())?;
    lists.check(&part.json, "output", lists.accessors())?;
    let sampler: animation::Sampler = part.read(&["input", "output", "interpolation"])?;
    let known = animation::VALID_INTERPOLATIONS;
    Ok(KeySampler {
        times: sampler.input.value(),
        values: sampler.output.value(),
        interpolation: match part.known("interpolation", sampler.interpolation, known)? {
            animation::Interpolation::Linear => Interpolation::Linear,
            animation::Interpolation::Step => Interpolation::Step,
            animation::Interpolation::CubicSpline => Interpolation::Cubic,
        },
    })
}
