//! Settings: the registry of everything that a preset says besides its effects, in the order in
//! which it is written.
//!
//! The reader and writer of preset files, `--set`, the JSON schema, listings and the inspector loop
//! over [`SECTIONS`].

use std::{path::PathBuf, sync::LazyLock};

pub use super::setting::{Presence, Section, Setting};
use super::{
    LengthUnit, Preset, SceneSource,
    fitted::UNIT,
    polyline,
    rules::{are_patterns, encloses_scene, is_file, is_polyline, rises},
    setting::Storage,
};
use crate::{
    accuracy::{AXES, Tier},
    params::{Stored, Value, ValueError, ValueType},
    scene::{
        GroundShape, UpAxis,
        camera::{Camera, MIN_NEAR_M, Projection},
        ground::MAX_CELLS,
        parts::{MAX_PATTERNS, Scope},
    },
};

impl Setting {
    /// The setting at `path`.
    pub fn find(path: &str) -> Option<&'static Self> {
        let (section, name) = path.split_once('.').unwrap_or(("", path));
        Section::find(section)?.setting(name)
    }

    /// Gives the setting its default. One that has none gives way to its alternative's.
    pub fn reset(&self, preset: &mut Preset) {
        if self.get(preset).is_none() {
            return;
        }
        if let Storage::State {
            clear: Some(clear), ..
        } = self.storage
        {
            return clear(preset);
        }
        let baseline = baseline(preset);
        let alternative = self
            .alternative
            .and_then(|name| Section::find(self.section)?.setting(name));
        for setting in std::iter::once(self).chain(alternative) {
            if let Some(default) = setting.get(&baseline) {
                setting.set(preset, &default).expect("a default is allowed");
                return;
            }
        }
    }

    /// Does the preset say something else than a file that leaves the setting out?
    pub fn is_modified(&self, preset: &Preset) -> bool {
        self.get(preset) != self.get(&baseline(preset))
    }
}

impl Section {
    pub fn find(name: &str) -> Option<&'static Self> {
        SECTIONS
            .iter()
            .copied()
            .find(|section| section.name == name)
    }

    /// Removes an optional section, and resets every setting of another.
    pub fn reset(&self, preset: &mut Preset) {
        match &self.presence {
            Some(presence) => (presence.remove)(preset),
            None => self
                .settings
                .iter()
                .for_each(|setting| setting.reset(preset)),
        }
    }
}

/// All defaults, with the optional sections that `preset` has: what sparse writing leaves out.
pub fn baseline(preset: &Preset) -> Preset {
    let mut baseline = Preset::default();
    let present = SECTIONS
        .iter()
        .filter_map(|section| section.presence.as_ref())
        .filter(|presence| (presence.is_present)(preset));
    present.for_each(|presence| (presence.add)(&mut baseline));
    baseline
}

/// Every setting, in the order in which files have them.
pub fn settings() -> impl Iterator<Item = &'static Setting> {
    SECTIONS.iter().flat_map(|section| section.settings.iter())
}

/// Storage in a field of the preset that is always there.
macro_rules! field {
    ($($field:ident).+) => {
        Storage::State {
            get: |preset| Some(preset.$($field).+.to_value()),
            set: |preset, value| Stored::from_value(value).map(|value| preset.$($field).+ = value),
            clear: None,
        }
    };
}

/// Storage in an `Option` of the preset.
macro_rules! option {
    ($($field:ident).+) => {
        Storage::State {
            get: |preset| preset.$($field).+.as_ref().map(Stored::to_value),
            set: |preset, value| Stored::from_value(value).map(|value| preset.$($field).+ = Some(value)),
            clear: Some(|preset| preset.$($field).+ = None),
        }
    };
}

/// Storage in a field of an optional section of the preset.
macro_rules! section_field {
    ($section:ident . $field:ident) => {
        Storage::State {
            get: |preset| {
                preset
                    .$section
                    .as_ref()
                    .map(|section| section.$field.to_value())
            },
            set: |preset, value| {
                Stored::from_value(value)
                    .map(|value| preset.$section.get_or_insert_default().$field = value)
            },
            clear: None,
        }
    };
}

const LINE: ValueType = ValueType::Text { max_chars: 200 };
const PARAGRAPH: ValueType = ValueType::Text { max_chars: 2000 };

/// The top of the file, then every table of settings.
pub static SECTIONS: &[&Section] = &[
    &TOP, &SCENE, &GROUND, &CAMERA, &CLOCK, &ACCURACY, &OUTPUT, &TEST,
];

fn in_section<const N: usize>(section: &'static str, settings: [Setting; N]) -> Vec<Setting> {
    settings
        .map(|setting| Setting { section, ..setting })
        .into()
}

pub static TOP: Section = Section {
    name: "",
    doc: "The preset as a whole",
    settings: LazyLock::new(|| {
        vec![
            Setting::new("name", LINE, "Shown in lists and titles", field!(name)),
            Setting::new(
                "about",
                PARAGRAPH,
                "One sentence about the preset",
                field!(about),
            ),
            Setting::new(
                "tags",
                ValueType::TextList {
                    max_entries: 32,
                    max_chars: 64,
                },
                "Words to find it by",
                field!(tags),
            ),
        ]
    }),
    presence: None,
};

pub static SCENE: Section = Section {
    name: "scene",
    doc: "What is shown",
    settings: LazyLock::new(|| {
        in_section(
            "scene",
            [
                Setting::new("builtin", LINE, "A procedural scene, for instance teapot?tess=16", BUILTIN).or("path"),
                Setting::new(
                    "path",
                    ValueType::Text { max_chars: 4096 },
                    "A .glb, .gltf, .vrm, .obj, .stl, .ply, .xyz, .pts, .las or .laz file, relative to the folder of the preset",
                    MODEL,
                )
                .rule(is_file)
                .or("builtin"),
                Setting::new(
                    "only",
                    PATTERNS,
                    "The only parts of the scene that are shown, as patterns such as \"node:Body\" or \"mesh:Lens*\"; empty: all",
                    ONLY,
                )
                .rule(are_patterns),
                Setting::new(
                    "hidden",
                    PATTERNS,
                    "Parts of the scene that are not shown, as patterns such as \"material:Glass\"",
                    HIDDEN,
                )
                .rule(are_patterns),
                Setting::new(
                    "variant",
                    LINE,
                    "The variant of its materials in which a glTF model is shown (KHR_materials_variants), or what colors the points of a cloud: color, intensity or class; by its name or as #0, #1 …; empty: none",
                    field!(parts.variant),
                ),
                Setting::new(
                    "up",
                    ValueType::choice(UpAxis::WORDS),
                    "The axis of the scene's file that is up; auto: y of a glTF model, and of others guessed from names and from how they stand",
                    UP,
                ),
                Setting::new(
                    "room",
                    ValueType::F64,
                    "Walls around the scene, seen from inside: their distance as a multiple of the scene's width; 0: none",
                    field!(room),
                )
                .range(0.0, 100.0)
                .slider(0.0, 4.0)
                .rule(encloses_scene),
                Setting::new(
                    "surroundings",
                    ValueType::Text { max_chars: 600_000 },
                    "A picture of what surrounds the scene, a Radiance .hdr file in the folder of the preset, shown where the environment of studio or sky is picture; empty: none",
                    field!(surroundings),
                )
                .rule(is_file),
                Setting::new("spin_deg_per_s", ValueType::F64, "Turns the scene about its vertical axis", field!(spin_deg_per_s))
                    .range(-1e6, 1e6)
                    .slider(-180.0, 180.0)
                    .unit("°/s"),
                Setting::new(
                    "clip",
                    LINE,
                    "The animation clip that moves the scene, by its name or as #0, #1 …; empty: none",
                    field!(playback.clip),
                ),
                Setting::new(
                    "clip_speed",
                    ValueType::F64,
                    "Seconds of the clip that pass in one second of the clock",
                    field!(playback.speed),
                )
                .range(-100.0, 100.0)
                .slider(-2.0, 2.0),
                Setting::new("clip_time_s", ValueType::F64, "Freezes the clip at this time", option!(playback.clip_time_s))
                    .range(0.0, 1e9)
                    .unit("s"),
                Setting::new("second_clip", LINE, "A second clip to blend with; empty: none", field!(playback.second_clip)),
                Setting::new("clip_blend", ValueType::F64, "Weight of the second clip: 0 none of it, 1 it alone", field!(playback.blend))
                    .range(0.0, 1.0)
                    .slider(0.0, 1.0),
                Setting::new(
                    "unit",
                    ValueType::choice(LengthUnit::WORDS),
                    "Unit of lengths and points of effects and of the polyline: meters, or scene, the radius of the scene's box from its center",
                    UNIT,
                ),
                Setting::new(
                    "polyline",
                    ValueType::Text { max_chars: 200_000 },
                    "A line for dots to follow: points of three numbers in meters, one per text line or separated by semicolons",
                    POLYLINE,
                )
                .rule(is_polyline),
                Setting::new(
                    "camera",
                    LINE,
                    "The camera of the scene to use where there is no [camera], by its name or as #0, #1 …; empty: the first; #none: the whole scene is framed",
                    field!(scene_camera),
                ),
            ],
        )
    }),
    presence: None,
};

pub static GROUND: Section = Section {
    name: "ground",
    doc: "A flat mesh under the scene, which receives shadows and casts none; without this table there is none",
    settings: LazyLock::new(|| {
        in_section(
            "ground",
            [
                Setting::new("shape", ValueType::choice(GroundShape::WORDS), "Outline of the ground", GROUND_SHAPE),
                Setting::new(
                    "size",
                    ValueType::F64,
                    "From the center to the edge, in radii of the scene's box",
                    section_field!(ground.size),
                )
                .range(0.1, 1000.0)
                .slider(0.5, 10.0),
                Setting::new("color", ValueType::Color, "Color of the ground, linear RGBA", section_field!(ground.color)),
                Setting::new(
                    "cells",
                    ValueType::U32,
                    "Rings of triangles of a disc, or squares of two triangles from the center of a square to its edge",
                    section_field!(ground.cells),
                )
                .range(1.0, MAX_CELLS as f64)
                .slider(1.0, 48.0),
            ],
        )
    }),
    presence: Some(Presence {
        is_present: |preset| preset.ground.is_some(),
        add: |preset| _ = preset.ground.get_or_insert_default(),
        remove: |preset| preset.ground = None,
    }),
};

/// Name of the table of bookmarks; each is a table with the settings of [`CAMERA`].
pub const BOOKMARKS: &str = "bookmarks";

pub static CAMERA: Section = Section {
    name: "camera",
    doc: "Where the scene is seen from; without this table the whole scene is framed",
    settings: LazyLock::new(|| {
        in_section(
            "camera",
            [
                Setting::new(
                    "eye",
                    ValueType::Position,
                    "Position of the eye",
                    section_field!(camera.eye),
                )
                .unit("m"),
                Setting::new(
                    "target",
                    ValueType::Position,
                    "The point that the eye looks at",
                    section_field!(camera.target),
                )
                .unit("m"),
                Setting::new(
                    "up",
                    ValueType::Position,
                    "Direction that is up in the picture, of any length",
                    section_field!(camera.up),
                ),
                Setting::new("fov_y_deg", ValueType::F64, "Vertical field of view", FOV_Y)
                    .range(1.0, 179.0)
                    .slider(10.0, 120.0)
                    .unit("°")
                    .or("orthographic_height_m"),
                Setting::new(
                    "orthographic_height_m",
                    ValueType::F64,
                    "Height of the visible box, without perspective",
                    ORTHOGRAPHIC_HEIGHT,
                )
                .range(1e-6, 1e9)
                .unit("m")
                .or("fov_y_deg"),
                Setting::new(
                    "near_m",
                    ValueType::F64,
                    "Distance of the near plane, with perspective",
                    section_field!(camera.near_m),
                )
                .range(MIN_NEAR_M, 1e6)
                .unit("m"),
            ],
        )
    }),
    presence: Some(Presence {
        is_present: |preset| preset.camera.is_some(),
        add: |preset| _ = preset.camera.get_or_insert_default(),
        remove: |preset| preset.camera = None,
    }),
};

pub static CLOCK: Section = Section {
    name: "clock",
    doc: "The time of the picture and the range of the timeline",
    settings: LazyLock::new(|| {
        in_section(
            "clock",
            [
                Setting::new(
                    "time_s",
                    ValueType::F64,
                    "Time of the picture",
                    field!(clock.time_s),
                )
                .slider(0.0, 12.0)
                .unit("s"),
                Setting::new(
                    "range_s",
                    ValueType::Interval,
                    "Begin and end of the timeline and of a sequence; the end is not drawn",
                    field!(clock.range_s),
                )
                .unit("s")
                .rule(rises),
                Setting::new(
                    "loop",
                    ValueType::Bool,
                    "Starts again at the begin of the range after its end",
                    field!(clock.is_looping),
                ),
                Setting::new(
                    "speed",
                    ValueType::F64,
                    "Seconds of the clock that pass in one second of playback",
                    field!(clock.speed),
                )
                .range(0.01, 100.0),
            ],
        )
    }),
    presence: None,
};

pub static ACCURACY: Section = Section {
    name: "accuracy",
    doc: "How exact the picture must be",
    settings: LazyLock::new(accuracy_settings),
    presence: None,
};

/// The tier, the tolerances that replace the tier's, and every axis.
fn accuracy_settings() -> Vec<Setting> {
    let tolerances = [
        Setting::new(
            "tier",
            ValueType::choice(&Tier::ALL.map(Tier::name)),
            "Named tolerance from which the planner chooses the options",
            TIER,
        ),
        Setting::new(
            "max_wrong_ppm",
            ValueType::F64,
            "Tolerance instead of the tier's: pixels with the wrong triangle, per million",
            option!(accuracy.wrong_ppm),
        )
        .range(0.0, 1e6),
        Setting::new(
            "max_channel",
            ValueType::U32,
            "Tolerance instead of the tier's: difference of a color channel, of 255",
            option!(accuracy.channel),
        )
        .range(0.0, 255.0),
    ];
    let settings = tolerances
        .into_iter()
        .chain(AXES.iter().map(Setting::of_axis));
    settings
        .map(|setting| Setting {
            section: "accuracy",
            ..setting
        })
        .collect()
}

pub static OUTPUT: Section = Section {
    name: "output",
    doc: "The picture to draw",
    settings: LazyLock::new(|| {
        in_section(
            "output",
            [
                Setting::new(
                    "size",
                    ValueType::Size,
                    "Width and height in pixels",
                    SIZE,
                )
                .range(0.0, 16_384.0),
                Setting::new(
                    "background",
                    ValueType::Color,
                    "Color where there is no triangle, linear RGBA",
                    field!(output.background),
                ),
                Setting::new(
                    "background_bottom",
                    ValueType::Color,
                    "Color at the bottom edge: the background is a vertical gradient from background to it, in linear light",
                    option!(output.background_bottom),
                ),
                Setting::new(
                    "reference_height_px",
                    ValueType::U32,
                    "Height of a picture in which lengths in pixels are what they say; in others they grow and shrink with it. Without it: the height of size",
                    option!(output.reference_height_px),
                )
                .range(1.0, 16_384.0),
            ],
        )
    }),
    presence: None,
};

pub static TEST: Section = Section {
    name: "test",
    doc: "What must hold of a picture, and how far it may differ from the golden; a preset without this table has no golden",
    settings: LazyLock::new(|| {
        in_section(
            "test",
            [
                Setting::new(
                    "max_channel",
                    ValueType::U32,
                    "Largest difference of a color channel, of 255",
                    section_field!(test.max_channel),
                )
                .range(0.0, 255.0),
                Setting::new(
                    "max_pixels",
                    ValueType::U32,
                    "Number of pixels that may differ by more",
                    section_field!(test.max_pixels),
                ),
                Setting::new(
                    "max_wrong_triangles",
                    ValueType::U32,
                    "Number of pixels that may show another triangle, or none, where the preset pins an option that is not exact",
                    section_field!(test.max_wrong_triangles),
                ),
                Setting::new(
                    "why",
                    PARAGRAPH,
                    "Why a budget above the default is needed",
                    section_field!(test.why),
                ),
                Setting::new(
                    "covered",
                    ValueType::Interval,
                    "Fewest and most pixels that show a triangle",
                    section_field!(test.covered),
                ),
                Setting::new(
                    "hits",
                    ValueType::Interval,
                    "Fewest and most samples that triangles cover, each triangle counted",
                    section_field!(test.hits),
                ),
                Setting::new(
                    "clipped",
                    ValueType::Interval,
                    "Fewest and most triangles that are clipped",
                    section_field!(test.clipped),
                ),
                Setting::new(
                    "degenerate",
                    ValueType::Interval,
                    "Fewest and most triangles without area after the snap",
                    section_field!(test.degenerate),
                ),
                Setting::new(
                    "rejected",
                    ValueType::Interval,
                    "Fewest and most triangles with a corner that is not finite or too far away",
                    section_field!(test.rejected),
                ),
                Setting::new(
                    "refused",
                    LINE,
                    "The preset must be refused with a sentence that has these words",
                    section_field!(test.refused),
                ),
            ],
        )
    }),
    presence: Some(Presence {
        is_present: |preset| preset.test.is_some(),
        add: |preset| _ = preset.test.get_or_insert_default(),
        remove: |preset| preset.test = None,
    }),
};

const BUILTIN: Storage = Storage::State {
    get: |preset| match &preset.scene {
        SceneSource::Builtin(query) => Some(query.to_value()),
        SceneSource::File(_) => None,
    },
    set: |preset, value| {
        Stored::from_value(value).map(|query| preset.scene = SceneSource::Builtin(query))
    },
    clear: None,
};

const MODEL: Storage = Storage::State {
    get: |preset| match &preset.scene {
        SceneSource::Builtin(_) => None,
        SceneSource::File(path) => Some(path.to_string_lossy().into_owned().to_value()),
    },
    set: |preset, value| {
        String::from_value(value).map(|path| preset.scene = SceneSource::File(PathBuf::from(path)))
    },
    clear: None,
};

/// Lengths in pixels keep the part of the picture that they fill.
const SIZE: Storage = Storage::State {
    get: |preset| Some(preset.output.size.to_value()),
    set: |preset, value| Stored::from_value(value).map(|size| preset.output.resize(size)),
    clear: None,
};

const PATTERNS: ValueType = ValueType::TextList {
    max_entries: MAX_PATTERNS,
    max_chars: 300,
};

const ONLY: Storage = Storage::State {
    get: |preset| Some(preset.parts.only.texts().to_value()),
    set: |preset, value| {
        preset.parts.only = Scope::of_texts(&Vec::from_value(value)?).map_err(ValueError::Rule)?;
        Ok(())
    },
    clear: None,
};

const HIDDEN: Storage = Storage::State {
    get: |preset| Some(preset.parts.hidden.texts().to_value()),
    set: |preset, value| {
        preset.parts.hidden =
            Scope::of_texts(&Vec::from_value(value)?).map_err(ValueError::Rule)?;
        Ok(())
    },
    clear: None,
};

const POLYLINE: Storage = Storage::State {
    get: |preset| Some(polyline::to_text(&preset.polyline).to_value()),
    set: |preset, value| {
        let points = polyline::parse(&String::from_value(value)?).map_err(ValueError::Rule)?;
        preset.polyline = points.into();
        Ok(())
    },
    clear: None,
};

const UP: Storage = Storage::State {
    get: |preset| Some(Value::Choice(preset.parts.up as usize)),
    set: |preset, value| {
        if let Value::Choice(index) = value {
            preset.parts.up = UpAxis::ALL[*index];
        }
        Ok(())
    },
    clear: None,
};

const GROUND_SHAPE: Storage = Storage::State {
    get: |preset| Some(Value::Choice(preset.ground?.shape as usize)),
    set: |preset, value| {
        if let Value::Choice(index) = value {
            preset.ground.get_or_insert_default().shape = GroundShape::ALL[*index];
        }
        Ok(())
    },
    clear: None,
};

const FOV_Y: Storage = Storage::State {
    get: |preset| match preset.camera?.projection {
        Projection::Perspective { fov_y_deg } => Some(fov_y_deg.to_value()),
        Projection::Orthographic { .. } => None,
    },
    set: |preset, value| {
        Stored::from_value(value)
            .map(|fov_y_deg| camera(preset).projection = Projection::Perspective { fov_y_deg })
    },
    clear: None,
};

const ORTHOGRAPHIC_HEIGHT: Storage = Storage::State {
    get: |preset| match preset.camera?.projection {
        Projection::Perspective { .. } => None,
        Projection::Orthographic { height_m } => Some(height_m.to_value()),
    },
    set: |preset, value| {
        Stored::from_value(value)
            .map(|height_m| camera(preset).projection = Projection::Orthographic { height_m })
    },
    clear: None,
};

const TIER: Storage = Storage::State {
    get: |preset| Some(Value::Choice(preset.accuracy.tier as usize)),
    set: |preset, value| {
        if let Value::Choice(index) = value {
            preset.accuracy.tier = Tier::ALL[*index];
        }
        Ok(())
    },
    clear: None,
};

fn camera(preset: &mut Preset) -> &mut Camera {
    preset.camera.get_or_insert_default()
}

#[cfg(test)]
mod tests {
    use super::{super::GoldenTest, *};

    #[test]
    fn every_setting_reads_back_its_default_and_no_two_share_a_path() {
        let mut preset = Preset {
            camera: Some(Camera::default()),
            ground: Some(Default::default()),
            test: Some(GoldenTest::default()),
            ..Preset::default()
        };
        let before = preset.clone();
        let mut paths = std::collections::BTreeSet::new();
        for setting in settings() {
            assert!(
                paths.insert(setting.path()),
                "{} stands twice",
                setting.path()
            );
            assert!(
                std::ptr::eq(
                    Setting::find(&setting.path()).expect("it is listed"),
                    setting
                ) || setting.section == "accuracy"
            );
            if let Some(default) = setting.get(&preset) {
                setting
                    .set(&mut preset, &default)
                    .unwrap_or_else(|error| panic!("{}: {error}", setting.path()));
                assert!(!setting.is_modified(&preset), "{}", setting.path());
            }
            assert_eq!(preset, before, "{}", setting.path());
        }
    }

    #[test]
    fn every_accuracy_axis_has_a_setting_that_pins_it() {
        for axis in AXES {
            let setting = ACCURACY
                .setting(axis.name)
                .unwrap_or_else(|| panic!("accuracy.{} is missing", axis.name));
            let mut preset = Preset::default();
            for index in 0..axis.choices.len() {
                setting
                    .set(&mut preset, &Value::Choice(index))
                    .expect("a word of the axis");
                assert_eq!(
                    (setting.get(&preset), preset.accuracy.pins.get(axis)),
                    (Some(Value::Choice(index)), index.checked_sub(1))
                );
            }
            setting.reset(&mut preset);
            assert_eq!(preset, Preset::default(), "{}", axis.name);
        }
    }

    #[test]
    fn a_refused_value_changes_nothing() {
        let mut preset = Preset::default();
        let eye = Setting::find("camera.eye").expect("a setting");
        assert!(eye.set(&mut preset, &Value::number(1)).is_err());
        let path = Setting::find("scene.path").expect("a setting");
        assert_eq!(
            path.set(&mut preset, &Value::Text("https://a.b/c.glb".into()))
                .unwrap_err()
                .to_string(),
            "must be a file, not an address"
        );
        assert_eq!(preset, Preset::default());
    }
}
