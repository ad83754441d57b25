//! Skins and clips.

use serde_json::Value;

use super::{
    super::error::called,
    Channel, Clip, KeySampler, Part, Skin,
    fields::{Lenient, Object, needed},
    read::Lists,
};
use crate::scene::rig::{Interpolation, Property};

pub fn skin(lists: &Lists, part: Object) -> Part<Skin> {
    let mut lost = None;
    let nodes = ("nodes", lists.nodes.len());
    let joints = part.indices("joints", nodes, |reason| {
        lost.get_or_insert(reason);
    })?;
    let accessors = lists.accessors.len();
    match lost {
        // Vertices refer to joints by their places in the list.
        Some(reason) => Err(reason),
        None if joints.is_empty() => Err("it has no joints".into()),
        None => Ok(Skin {
            name: part.text("name").ok().flatten().map(str::to_owned),
            joints,
            inverse_bind: part.index("inverseBindMatrices", "accessors", accessors)?,
        }),
    }
}

/// Clip `index`; one without channels where it is no object.
pub fn clip(lists: &Lists, index: usize, value: &Value) -> Clip {
    let Some(part) = lists.object("clip", index, value) else {
        return Clip {
            name: None,
            channels: Vec::new(),
            samplers: Vec::new(),
        };
    };
    let name = part.text("name");
    let lenient = Lenient {
        notes: lists.notes,
        name: called("clip", index, name.clone().ok().flatten()),
    };
    let name = lenient.field(name).map(str::to_owned);
    let samplers = lenient.list(part.list("samplers"));
    let channels = lenient.list(part.list("channels")).iter().enumerate();
    Clip {
        name,
        channels: channels
            .filter_map(|(at, value)| {
                let channel =
                    Object::of(value).and_then(|part| channel(lists, part, samplers.len()));
                if matches!(channel, Ok(None)) {
                    lists.notes.add(|| {
                        format!(
                            "{} channel {at} animates no node; it is ignored",
                            lenient.name
                        )
                    });
                }
                Some((at, channel.transpose()?))
            })
            .collect(),
        samplers: samplers
            .iter()
            .map(|value| key_sampler(lists, Object::of(value)?))
            .collect(),
    }
}

/// A channel; none that animates anything but a node, which is valid.
fn channel(lists: &Lists, part: Object, samplers: usize) -> Part<Option<Channel>> {
    let properties = [
        Property::Translation,
        Property::Rotation,
        Property::Scale,
        Property::Weights,
    ]
    .map(|property| (property.name(), property));
    let target = needed("target", part.object("target"))?;
    let Some(node) = target.index("node", "nodes", lists.nodes.len())? else {
        return Ok(None);
    };
    Ok(Some(Channel {
        node,
        property: needed("path", target.word("path", &properties))?,
        sampler: needed("sampler", part.index("sampler", "samplers", samplers))?,
    }))
}

fn key_sampler(lists: &Lists, part: Object) -> Part<KeySampler> {
    let interpolations = [
        ("STEP", Interpolation::Step),
        ("LINEAR", Interpolation::Linear),
        ("CUBICSPLINE", Interpolation::Cubic),
    ];
    let accessor = |key: &str| needed(key, part.index(key, "accessors", lists.accessors.len()));
    Ok(KeySampler {
        times: accessor("input")?,
        values: accessor("output")?,
        interpolation: part
            .word("interpolation", &interpolations)?
            .unwrap_or(Interpolation::Linear),
    })
}
