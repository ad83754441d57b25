//! Keys: everything a preset says besides its effects, one line per key; reader, writer, `--set`, schema and listing loop over it.

use std::path::PathBuf;

use glam::DVec3;

use super::{
    form::{Precision, Value, ValueType},
    pins::pin,
    polyline,
    rules::{encloses, is_polyline, rises},
};
use crate::{
    accuracy::{
        Clipping, Coverage, Culling, CurlNoise, DepthFormat, DotCulling, Parameters, ParticleStorage, Perspective, PositionFormat,
        RenderScale, SampleCounter, ShaderChecks, ShadowMapSize, ShadowTaps, Skinning, VertexTransform, Visibility, XraySums,
    },
    preset::{Preset, SceneSource, Test, Tier},
    scene::camera::{Camera, MIN_NEAR_M, Projection},
};

/// One key of a preset.
pub struct Key {
    /// Table it stands in; empty at the top.
    pub section: &'static str,
    pub name: &'static str,
    pub doc: &'static str,
    pub form: ValueType,
    /// Key of the same section that says the same thing another way.
    pub rival: Option<&'static str>,
    /// What its lanes must be to one another.
    pub rule: Option<Rule>,
    /// None where the key does not apply to this session.
    pub get: fn(&Preset) -> Option<Value>,
    /// Takes a value that has this key's form.
    pub set: fn(&mut Preset, Value),
}

impl Key {
    /// `camera.eye`, `name`.
    pub fn path(&self) -> String {
        if self.section.is_empty() { self.name.into() } else { format!("{}.{}", self.section, self.name) }
    }

    /// The key at `path`.
    pub fn find(path: &str) -> Option<&'static Self> {
        let (section, name) = path.split_once('.').unwrap_or(("", path));
        Self::within(section, name)
    }

    pub fn within(section: &str, name: &str) -> Option<&'static Self> {
        KEYS.iter().find(|key| key.section == section && key.name == name)
    }

    /// Does a value of this key's form obey its rule?
    pub fn check(&self, plain: &Value) -> Result<(), String> {
        self.rule.map_or(Ok(()), |rule| rule(plain))
    }
}

/// A table of a preset. An optional one means something by being there.
pub struct Section {
    pub name: &'static str,
    pub doc: &'static str,
    pub is_there: Option<fn(&Preset) -> bool>,
}

/// Every table besides `effects`, in the order in which they are written; effects stand before `accuracy`.
pub const SECTIONS: &[Section] = &[
    Section { name: "scene", doc: "What is shown", is_there: None },
    Section { name: "camera", doc: "Where it is seen from; without it the whole scene is framed", is_there: Some(|s| s.camera.is_some()) },
    Section { name: "clock", doc: "The time of the picture, and what the timeline spans", is_there: None },
    Section { name: "accuracy", doc: "How exact the picture must be", is_there: None },
    Section { name: "output", doc: "The picture to be made", is_there: None },
    Section { name: "test", doc: "What a golden may differ by; a preset without it has none", is_there: Some(|s| s.test.is_some()) },
];

impl Section {
    pub fn find(name: &str) -> Option<&'static Self> {
        SECTIONS.iter().find(|section| section.name == name)
    }

    /// Writes down that the section is there, with defaults.
    pub fn enter(&self, preset: &mut Preset) {
        match self.name {
            "camera" => drop(preset.camera.get_or_insert_default()),
            "test" => drop(preset.test.get_or_insert_default()),
            _ => {}
        }
    }

    /// A session whose section is there if it is in `session`, and otherwise all defaults: what sparse writing leaves out.
    pub fn baseline(preset: &Preset) -> Preset {
        let mut baseline = Preset::default();
        SECTIONS.iter().filter(|section| section.is_there.is_some_and(|there| there(preset))).for_each(|s| s.enter(&mut baseline));
        baseline
    }
}

/// Largest coordinate, metres: far enough for every extreme case, and its square is finite in f32.
const FARTHEST_M: f64 = 1e9;
const LINE: ValueType = ValueType::Text { longest: 200 };
const PARAGRAPH: ValueType = ValueType::Text { longest: 2000 };
const POINT: ValueType = ValueType::Numbers { lanes: 3, low: -FARTHEST_M, high: FARTHEST_M, precision: Precision::Double };
const TIERS: &[&str] = &[Tier::ALL[0].name(), Tier::ALL[1].name(), Tier::ALL[2].name(), Tier::ALL[3].name(), Tier::ALL[4].name()];

/// Whether a value may be; the error completes a sentence that begins with its key.
pub type Rule = fn(&Value) -> Result<(), String>;
type Get = fn(&Preset) -> Option<Value>;
type Set = fn(&mut Preset, Value);

pub(super) const fn key(section: &'static str, name: &'static str, form: ValueType, doc: &'static str, get: Get, set: Set) -> Key {
    Key { section, name, doc, form, rival: None, rule: None, get, set }
}

const fn ruled(key: Key, rule: Rule) -> Key {
    Key { rule: Some(rule), ..key }
}

const fn rivals(key: Key, rival: &'static str) -> Key {
    Key { rival: Some(rival), ..key }
}

/// Every key besides `schema`, `stack` and the effects, in the order in which they are written.
pub const KEYS: &[Key] = &[
    key("", "name", LINE, "Shown in lists and titles", |s| Some(Value::Text(s.name.clone())), |s, v| s.name = v.into_text()),
    key("", "about", PARAGRAPH, "One sentence about the preset", |s| Some(Value::Text(s.about.clone())), |s, v| s.about = v.into_text()),
    key(
        "",
        "tags",
        ValueType::Texts { most: 32, longest: 64 },
        "Words to find it by",
        |s| Some(Value::Texts(s.tags.clone())),
        |s, v| s.tags = v.into_texts(),
    ),
    rivals(
        key(
            "scene",
            "builtin",
            LINE,
            "A procedural scene, for instance teapot?tess=16",
            |s| match &s.scene {
                SceneSource::Builtin(query) => Some(Value::Text(query.clone())),
                SceneSource::File(_) => None,
            },
            |s, v| s.scene = SceneSource::Builtin(v.into_text()),
        ),
        "path",
    ),
    rivals(
        key(
            "scene",
            "path",
            ValueType::Text { longest: 4096 },
            "A .glb or .gltf file, relative to the preset's own folder",
            |s| match &s.scene {
                SceneSource::Builtin(_) => None,
                SceneSource::File(path) => Some(Value::Text(path.to_string_lossy().into_owned())),
            },
            |s, v| s.scene = SceneSource::File(PathBuf::from(v.into_text())),
        ),
        "builtin",
    ),
    ruled(
        key(
            "scene",
            "room",
            ValueType::number(0.0, 100.0),
            "Walls round the scene, seen from inside, so many times as far apart as it is wide; 0: none",
            |s| Some(Value::number(s.room)),
            |s, v| s.room = v.first(),
        ),
        encloses,
    ),
    key(
        "scene",
        "spin_deg_per_s",
        ValueType::number(-1e6, 1e6),
        "Turns the scene about its vertical axis",
        |s| Some(Value::number(s.spin_deg_per_s)),
        |s, v| s.spin_deg_per_s = v.first(),
    ),
    key(
        "scene",
        "clip",
        LINE,
        "The clip that moves the scene, by its name or as #0, #1 …; empty: it stands at rest",
        |s| Some(Value::Text(s.play.clip.clone())),
        |s, v| s.play.clip = v.into_text(),
    ),
    key(
        "scene",
        "clip_speed",
        ValueType::number(-100.0, 100.0),
        "Seconds of the clip that pass in one second of the clock",
        |s| Some(Value::number(s.play.speed)),
        |s, v| s.play.speed = v.first(),
    ),
    key(
        "scene",
        "clip_time_s",
        ValueType::number(0.0, 1e9),
        "Freezes the clip at this time",
        |s| s.play.clip_time_s.map(Value::number),
        |s, v| s.play.clip_time_s = Some(v.first()),
    ),
    key(
        "scene",
        "clip_b",
        LINE,
        "A second clip to blend with",
        |s| Some(Value::Text(s.play.other.clone())),
        |s, v| s.play.other = v.into_text(),
    ),
    key(
        "scene",
        "blend",
        ValueType::number(0.0, 1.0),
        "Share of the second clip",
        |s| Some(Value::number(s.play.blend)),
        |s, v| s.play.blend = v.first(),
    ),
    ruled(
        key(
            "scene",
            "polyline",
            ValueType::Text { longest: 200_000 },
            "A line of the preset's own for dots to be strung on: points of three numbers, a line each or between semicolons, metres",
            |s| Some(Value::Text(polyline::written(&s.polyline))),
            |s, v| s.polyline = polyline::parse(&v.into_text()).unwrap_or_default().into(),
        ),
        is_polyline,
    ),
    key(
        "scene",
        "camera",
        LINE,
        "The scene's own camera to look through where there is no [camera], by its name or as #0, #1 …; empty: its first",
        |s| Some(Value::Text(s.scene_camera.clone())),
        |s, v| s.scene_camera = v.into_text(),
    ),
    key(
        "camera",
        "eye",
        POINT,
        "Where the eye stands, metres",
        |s| camera(s, |c| point(c.eye)),
        |s, v| camera_mut(s).eye = v.lanes().into(),
    ),
    key(
        "camera",
        "target",
        POINT,
        "What the eye looks at, metres",
        |s| camera(s, |c| point(c.target)),
        |s, v| camera_mut(s).target = v.lanes().into(),
    ),
    key(
        "camera",
        "up",
        POINT,
        "Which way is up, of any length",
        |s| camera(s, |c| point(c.up)),
        |s, v| camera_mut(s).up = v.lanes().into(),
    ),
    rivals(
        key(
            "camera",
            "fov_y_deg",
            ValueType::number(1.0, 179.0),
            "Vertical field of view",
            |s| match s.camera?.projection {
                Projection::Perspective { fov_y_deg } => Some(Value::number(fov_y_deg)),
                Projection::Orthographic { .. } => None,
            },
            |s, v| camera_mut(s).projection = Projection::Perspective { fov_y_deg: v.first() },
        ),
        "orthographic_height_m",
    ),
    rivals(
        key(
            "camera",
            "orthographic_height_m",
            ValueType::number(1e-6, FARTHEST_M),
            "Height of the visible box, without perspective",
            |s| match s.camera?.projection {
                Projection::Perspective { .. } => None,
                Projection::Orthographic { height_m } => Some(Value::number(height_m)),
            },
            |s, v| camera_mut(s).projection = Projection::Orthographic { height_m: v.first() },
        ),
        "fov_y_deg",
    ),
    key(
        "camera",
        "near_m",
        ValueType::number(MIN_NEAR_M, 1e6),
        "Distance of the near plane of a perspective",
        |s| camera(s, |c| Value::number(c.near_m)),
        |s, v| camera_mut(s).near_m = v.first(),
    ),
    key(
        "clock",
        "time_s",
        ValueType::number(-1e9, 1e9),
        "Time of the picture",
        |s| Some(Value::number(s.clock.time_s)),
        |s, v| s.clock.time_s = v.first(),
    ),
    ruled(
        key(
            "clock",
            "range_s",
            ValueType::Numbers { lanes: 2, low: -1e9, high: 1e9, precision: Precision::Double },
            "What the timeline spans and a sequence draws: begin and end, which belongs to the next round",
            |s| Some(Value::Numbers(s.clock.range_s.to_vec())),
            |s, v| s.clock.range_s = v.lanes(),
        ),
        rises,
    ),
    key(
        "clock",
        "loops",
        ValueType::Flag,
        "After the end of the range comes its beginning",
        |s| Some(Value::number(s.clock.loops)),
        |s, v| s.clock.loops = v.first() != 0.0,
    ),
    key(
        "clock",
        "speed",
        ValueType::number(0.01, 100.0),
        "Seconds of the preset that pass in one second of film",
        |s| Some(Value::number(s.clock.speed)),
        |s, v| s.clock.speed = v.first(),
    ),
    key(
        "accuracy",
        "tier",
        ValueType::Word(TIERS),
        "Named tolerance from which the options follow",
        |s| Some(Value::number(s.accuracy.tier as u32)),
        |s, v| s.accuracy.tier = Tier::ALL[v.first() as usize],
    ),
    key(
        "accuracy",
        "wrong_ppm",
        ValueType::number(0.0, 1e6),
        "Tolerance in place of the tier's: pixels with the wrong triangle id, per million",
        |s| s.accuracy.wrong_ppm.map(Value::number),
        |s, v| s.accuracy.wrong_ppm = Some(v.first()),
    ),
    key(
        "accuracy",
        "channel",
        ValueType::whole(1, 255.0),
        "Tolerance in place of the tier's: difference of a colour channel, of 255",
        |s| s.accuracy.channel.map(Value::number),
        |s, v| s.accuracy.channel = Some(v.first() as u8),
    ),
    pin::<Coverage>(),
    pin::<PositionFormat>(),
    pin::<VertexTransform>(),
    pin::<Skinning>(),
    pin::<CurlNoise>(),
    pin::<ParticleStorage>(),
    pin::<DepthFormat>(),
    pin::<Visibility>(),
    pin::<Perspective>(),
    pin::<Clipping>(),
    pin::<Culling>(),
    pin::<SampleCounter>(),
    pin::<XraySums>(),
    pin::<RenderScale>(),
    pin::<DotCulling>(),
    pin::<ShadowMapSize>(),
    pin::<ShadowTaps>(),
    pin::<Parameters>(),
    pin::<ShaderChecks>(),
    key(
        "output",
        "size",
        ValueType::whole(2, 16_384.0),
        "Width and height in pixels",
        |s| Some(Value::Numbers(s.output.size.map(f64::from).to_vec())),
        |s, v| s.output.size = v.lanes().map(|side: f64| side as u32),
    ),
    key(
        "output",
        "background",
        ValueType::Numbers { lanes: 4, low: 0.0, high: 1.0, precision: Precision::Single },
        "Colour where no triangle is, linear RGBA",
        |s| Some(Value::Numbers(s.output.background.map(f64::from).to_vec())),
        |s, v| s.output.background = v.lanes().map(|lane: f64| lane as f32),
    ),
    key(
        "test",
        "max_channel",
        ValueType::whole(1, 255.0),
        "Largest difference of a colour channel, of 255",
        |s| s.test.as_ref().map(|t| Value::number(t.max_channel)),
        |s, v| test_mut(s).max_channel = v.first() as u8,
    ),
    key(
        "test",
        "max_pixels",
        ValueType::whole(1, 4_294_967_295.0),
        "Pixels that may differ by more",
        |s| s.test.as_ref().map(|t| Value::number(t.max_pixels)),
        |s, v| test_mut(s).max_pixels = v.first() as u32,
    ),
    key(
        "test",
        "max_wrong_triangles",
        ValueType::whole(1, 4_294_967_295.0),
        "Pixels that may have another triangle id, or none, where the preset pins a option that promises less than exactness",
        |s| s.test.as_ref().map(|t| Value::number(t.max_wrong_triangles)),
        |s, v| test_mut(s).max_wrong_triangles = v.first() as u32,
    ),
    key(
        "test",
        "why",
        PARAGRAPH,
        "Why a budget above the default is needed",
        |s| s.test.as_ref().map(|t| Value::Text(t.why.clone())),
        |s, v| test_mut(s).why = v.into_text(),
    ),
];

fn camera(preset: &Preset, get: impl Fn(&Camera) -> Value) -> Option<Value> {
    preset.camera.as_ref().map(get)
}

fn camera_mut(preset: &mut Preset) -> &mut Camera {
    preset.camera.get_or_insert_default()
}

fn test_mut(preset: &mut Preset) -> &mut Test {
    preset.test.get_or_insert_default()
}

fn point(p: DVec3) -> Value {
    Value::Numbers(p.to_array().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::AXES;

    #[test]
    fn every_axis_of_the_ladder_has_a_key() {
        let keys: Vec<&str> =
            KEYS.iter().filter(|key| matches!(key.form, ValueType::Word(words) if words[0] == "planned")).map(|key| key.name).collect();
        assert_eq!(keys, AXES.iter().map(|axis| axis.name).collect::<Vec<_>>());
    }
}
