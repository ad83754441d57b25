//! Keys: everything a look says besides its effects, one line per key; reader, writer, `--set`, schema and listing loop over it.

use std::path::PathBuf;

use glam::DVec3;

use super::{
    form::{Form, Plain, Precision},
    pins::pin,
    polyline,
    rules::{encloses, is_polyline, rises},
};
use crate::{
    ladder::{
        Checks, Clipping, Counting, Coverage, Culling, Curl, Depth, DotWay, Parameters, Perspective, Scale, ShadowMap, Skinning, State,
        Sums, Taps, Vertex, Vertices, Visibility,
    },
    scene::camera::{Camera, MIN_NEAR_M, Projection},
    session::{SceneSource, Session, Test, Tier},
};

/// One key of a look.
pub struct Key {
    /// Table it stands in; empty at the top.
    pub section: &'static str,
    pub name: &'static str,
    pub doc: &'static str,
    pub form: Form,
    /// Key of the same section that says the same thing another way.
    pub rival: Option<&'static str>,
    /// What its lanes must be to one another.
    pub rule: Option<Rule>,
    /// None where the key does not apply to this session.
    pub get: fn(&Session) -> Option<Plain>,
    /// Takes a value that has this key's form.
    pub set: fn(&mut Session, Plain),
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
    pub fn check(&self, plain: &Plain) -> Result<(), String> {
        self.rule.map_or(Ok(()), |rule| rule(plain))
    }
}

/// A table of a look. An optional one means something by being there.
pub struct Section {
    pub name: &'static str,
    pub doc: &'static str,
    pub is_there: Option<fn(&Session) -> bool>,
}

/// Every table besides `effects`, in the order in which they are written; effects stand before `accuracy`.
pub const SECTIONS: &[Section] = &[
    Section { name: "scene", doc: "What is shown", is_there: None },
    Section { name: "camera", doc: "Where it is seen from; without it the whole scene is framed", is_there: Some(|s| s.camera.is_some()) },
    Section { name: "clock", doc: "The time of the picture, and what the timeline spans", is_there: None },
    Section { name: "accuracy", doc: "How exact the picture must be", is_there: None },
    Section { name: "output", doc: "The picture to be made", is_there: None },
    Section { name: "test", doc: "What a golden may differ by; a look without it has none", is_there: Some(|s| s.test.is_some()) },
];

impl Section {
    pub fn find(name: &str) -> Option<&'static Self> {
        SECTIONS.iter().find(|section| section.name == name)
    }

    /// Writes down that the section is there, with defaults.
    pub fn enter(&self, session: &mut Session) {
        match self.name {
            "camera" => drop(session.camera.get_or_insert_default()),
            "test" => drop(session.test.get_or_insert_default()),
            _ => {}
        }
    }

    /// A session whose section is there if it is in `session`, and otherwise all defaults: what sparse writing leaves out.
    pub fn baseline(session: &Session) -> Session {
        let mut baseline = Session::default();
        SECTIONS.iter().filter(|section| section.is_there.is_some_and(|there| there(session))).for_each(|s| s.enter(&mut baseline));
        baseline
    }
}

/// Largest coordinate, metres: far enough for every extreme case, and its square is finite in f32.
const FARTHEST_M: f64 = 1e9;
const LINE: Form = Form::Text { longest: 200 };
const PARAGRAPH: Form = Form::Text { longest: 2000 };
const POINT: Form = Form::Numbers { lanes: 3, low: -FARTHEST_M, high: FARTHEST_M, precision: Precision::Double };
const TIERS: &[&str] = &[Tier::ALL[0].name(), Tier::ALL[1].name(), Tier::ALL[2].name(), Tier::ALL[3].name(), Tier::ALL[4].name()];

/// Whether a value may be; the error completes a sentence that begins with its key.
pub type Rule = fn(&Plain) -> Result<(), String>;
type Get = fn(&Session) -> Option<Plain>;
type Set = fn(&mut Session, Plain);

pub(super) const fn key(section: &'static str, name: &'static str, form: Form, doc: &'static str, get: Get, set: Set) -> Key {
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
    key("", "name", LINE, "Shown in lists and titles", |s| Some(Plain::Text(s.name.clone())), |s, v| s.name = v.into_text()),
    key("", "about", PARAGRAPH, "One sentence about the look", |s| Some(Plain::Text(s.about.clone())), |s, v| s.about = v.into_text()),
    key(
        "",
        "tags",
        Form::Texts { most: 32, longest: 64 },
        "Words to find it by",
        |s| Some(Plain::Texts(s.tags.clone())),
        |s, v| s.tags = v.into_texts(),
    ),
    rivals(
        key(
            "scene",
            "builtin",
            LINE,
            "A procedural scene, for instance teapot?tess=16",
            |s| match &s.scene {
                SceneSource::Builtin(query) => Some(Plain::Text(query.clone())),
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
            Form::Text { longest: 4096 },
            "A .glb or .gltf file, relative to the look's own folder",
            |s| match &s.scene {
                SceneSource::Builtin(_) => None,
                SceneSource::File(path) => Some(Plain::Text(path.to_string_lossy().into_owned())),
            },
            |s, v| s.scene = SceneSource::File(PathBuf::from(v.into_text())),
        ),
        "builtin",
    ),
    ruled(
        key(
            "scene",
            "room",
            Form::number(0.0, 100.0),
            "Walls round the scene, seen from inside, so many times as far apart as it is wide; 0: none",
            |s| Some(Plain::number(s.room)),
            |s, v| s.room = v.first(),
        ),
        encloses,
    ),
    key(
        "scene",
        "spin_deg_per_s",
        Form::number(-1e6, 1e6),
        "Turns the scene about its vertical axis",
        |s| Some(Plain::number(s.spin_deg_per_s)),
        |s, v| s.spin_deg_per_s = v.first(),
    ),
    key(
        "scene",
        "clip",
        LINE,
        "The clip that moves the scene, by its name or as #0, #1 …; empty: it stands at rest",
        |s| Some(Plain::Text(s.play.clip.clone())),
        |s, v| s.play.clip = v.into_text(),
    ),
    key(
        "scene",
        "clip_speed",
        Form::number(-100.0, 100.0),
        "Seconds of the clip that pass in one second of the clock",
        |s| Some(Plain::number(s.play.speed)),
        |s, v| s.play.speed = v.first(),
    ),
    key(
        "scene",
        "pose_s",
        Form::number(0.0, 1e9),
        "Freezes the clip at this time",
        |s| s.play.pose_s.map(Plain::number),
        |s, v| s.play.pose_s = Some(v.first()),
    ),
    key(
        "scene",
        "clip_b",
        LINE,
        "A second clip to blend with",
        |s| Some(Plain::Text(s.play.other.clone())),
        |s, v| s.play.other = v.into_text(),
    ),
    key(
        "scene",
        "blend",
        Form::number(0.0, 1.0),
        "Share of the second clip",
        |s| Some(Plain::number(s.play.blend)),
        |s, v| s.play.blend = v.first(),
    ),
    ruled(
        key(
            "scene",
            "polyline",
            Form::Text { longest: 200_000 },
            "A line of the look's own for dots to be strung on: points of three numbers, a line each or between semicolons, metres",
            |s| Some(Plain::Text(polyline::written(&s.polyline))),
            |s, v| s.polyline = polyline::parse(&v.into_text()).unwrap_or_default().into(),
        ),
        is_polyline,
    ),
    key(
        "scene",
        "camera",
        LINE,
        "The scene's own camera to look through where there is no [camera], by its name or as #0, #1 …; empty: its first",
        |s| Some(Plain::Text(s.scene_camera.clone())),
        |s, v| s.scene_camera = v.into_text(),
    ),
    key("camera", "eye", POINT, "Where the eye stands, metres", |s| camera(s, |c| point(c.eye)), |s, v| posed(s).eye = v.lanes().into()),
    key(
        "camera",
        "target",
        POINT,
        "What the eye looks at, metres",
        |s| camera(s, |c| point(c.target)),
        |s, v| posed(s).target = v.lanes().into(),
    ),
    key("camera", "up", POINT, "Which way is up, of any length", |s| camera(s, |c| point(c.up)), |s, v| posed(s).up = v.lanes().into()),
    rivals(
        key(
            "camera",
            "fov_y_deg",
            Form::number(1.0, 179.0),
            "Vertical field of view",
            |s| match s.camera?.projection {
                Projection::Perspective { fov_y_deg } => Some(Plain::number(fov_y_deg)),
                Projection::Orthographic { .. } => None,
            },
            |s, v| posed(s).projection = Projection::Perspective { fov_y_deg: v.first() },
        ),
        "orthographic_height_m",
    ),
    rivals(
        key(
            "camera",
            "orthographic_height_m",
            Form::number(1e-6, FARTHEST_M),
            "Height of the visible box, without perspective",
            |s| match s.camera?.projection {
                Projection::Perspective { .. } => None,
                Projection::Orthographic { height_m } => Some(Plain::number(height_m)),
            },
            |s, v| posed(s).projection = Projection::Orthographic { height_m: v.first() },
        ),
        "fov_y_deg",
    ),
    key(
        "camera",
        "near_m",
        Form::number(MIN_NEAR_M, 1e6),
        "Distance of the near plane of a perspective",
        |s| camera(s, |c| Plain::number(c.near_m)),
        |s, v| posed(s).near_m = v.first(),
    ),
    key(
        "clock",
        "time_s",
        Form::number(-1e9, 1e9),
        "Time of the picture",
        |s| Some(Plain::number(s.clock.time_s)),
        |s, v| s.clock.time_s = v.first(),
    ),
    ruled(
        key(
            "clock",
            "range_s",
            Form::Numbers { lanes: 2, low: -1e9, high: 1e9, precision: Precision::Double },
            "What the timeline spans and a sequence draws: begin and end, which belongs to the next round",
            |s| Some(Plain::Numbers(s.clock.range_s.to_vec())),
            |s, v| s.clock.range_s = v.lanes(),
        ),
        rises,
    ),
    key(
        "clock",
        "loops",
        Form::Flag,
        "After the end of the range comes its beginning",
        |s| Some(Plain::number(s.clock.loops)),
        |s, v| s.clock.loops = v.first() != 0.0,
    ),
    key(
        "clock",
        "speed",
        Form::number(0.01, 100.0),
        "Seconds of the look that pass in one second of film",
        |s| Some(Plain::number(s.clock.speed)),
        |s, v| s.clock.speed = v.first(),
    ),
    key(
        "accuracy",
        "tier",
        Form::Word(TIERS),
        "Named tolerance from which the rungs follow",
        |s| Some(Plain::number(s.accuracy.tier as u32)),
        |s, v| s.accuracy.tier = Tier::ALL[v.first() as usize],
    ),
    key(
        "accuracy",
        "wrong_ppm",
        Form::number(0.0, 1e6),
        "Tolerance in place of the tier's: pixels with the wrong owner, per million",
        |s| s.accuracy.wrong_ppm.map(Plain::number),
        |s, v| s.accuracy.wrong_ppm = Some(v.first()),
    ),
    key(
        "accuracy",
        "channel",
        Form::whole(1, 255.0),
        "Tolerance in place of the tier's: difference of a colour channel, of 255",
        |s| s.accuracy.channel.map(Plain::number),
        |s, v| s.accuracy.channel = Some(v.first() as u8),
    ),
    pin::<Coverage>(),
    pin::<Vertices>(),
    pin::<Vertex>(),
    pin::<Skinning>(),
    pin::<Curl>(),
    pin::<State>(),
    pin::<Depth>(),
    pin::<Visibility>(),
    pin::<Perspective>(),
    pin::<Clipping>(),
    pin::<Culling>(),
    pin::<Counting>(),
    pin::<Sums>(),
    pin::<Scale>(),
    pin::<DotWay>(),
    pin::<ShadowMap>(),
    pin::<Taps>(),
    pin::<Parameters>(),
    pin::<Checks>(),
    key(
        "output",
        "size",
        Form::whole(2, 16_384.0),
        "Width and height in pixels",
        |s| Some(Plain::Numbers(s.output.size.map(f64::from).to_vec())),
        |s, v| s.output.size = v.lanes().map(|side: f64| side as u32),
    ),
    key(
        "output",
        "background",
        Form::Numbers { lanes: 4, low: 0.0, high: 1.0, precision: Precision::Single },
        "Colour where no triangle is, linear RGBA",
        |s| Some(Plain::Numbers(s.output.background.map(f64::from).to_vec())),
        |s, v| s.output.background = v.lanes().map(|lane: f64| lane as f32),
    ),
    key(
        "test",
        "max_channel",
        Form::whole(1, 255.0),
        "Largest difference of a colour channel, of 255",
        |s| s.test.as_ref().map(|t| Plain::number(t.max_channel)),
        |s, v| tested(s).max_channel = v.first() as u8,
    ),
    key(
        "test",
        "max_pixels",
        Form::whole(1, 4_294_967_295.0),
        "Pixels that may differ by more",
        |s| s.test.as_ref().map(|t| Plain::number(t.max_pixels)),
        |s, v| tested(s).max_pixels = v.first() as u32,
    ),
    key(
        "test",
        "max_wrong_owner",
        Form::whole(1, 4_294_967_295.0),
        "Pixels that may have another owner, or none, where the look pins a rung that promises less than exactness",
        |s| s.test.as_ref().map(|t| Plain::number(t.max_wrong_owner)),
        |s, v| tested(s).max_wrong_owner = v.first() as u32,
    ),
    key(
        "test",
        "why",
        PARAGRAPH,
        "Why a budget above the default is needed",
        |s| s.test.as_ref().map(|t| Plain::Text(t.why.clone())),
        |s, v| tested(s).why = v.into_text(),
    ),
];

fn camera(session: &Session, get: impl Fn(&Camera) -> Plain) -> Option<Plain> {
    session.camera.as_ref().map(get)
}

fn posed(session: &mut Session) -> &mut Camera {
    session.camera.get_or_insert_default()
}

fn tested(session: &mut Session) -> &mut Test {
    session.test.get_or_insert_default()
}

fn point(p: DVec3) -> Plain {
    Plain::Numbers(p.to_array().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::AXES;

    #[test]
    fn every_axis_of_the_ladder_has_a_key() {
        let keys: Vec<&str> =
            KEYS.iter().filter(|key| matches!(key.form, Form::Word(words) if words[0] == "planned")).map(|key| key.name).collect();
        assert_eq!(keys, AXES.iter().map(|axis| axis.name).collect::<Vec<_>>());
    }
}
