//! How the last film was exported; the next one begins with that.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    accuracy::RenderScale,
    app::{
        files::plain_file::{checked, number_in, word_of},
        jobs::film::Format,
    },
};

/// How the last film was exported.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FilmSettings {
    #[serde(serialize_with = "write_format", deserialize_with = "format")]
    pub format: Format,
    /// Width and height, pixels; none: as the picture is shown.
    #[serde(deserialize_with = "size")]
    pub size: Option<[u32; 2]>,
    #[serde(deserialize_with = "fps")]
    pub fps: f64,
    /// Drawn per shown pixel; none: as the preset has it.
    #[serde(
        rename = "anti_aliasing",
        serialize_with = "write_scale",
        deserialize_with = "scale"
    )]
    pub scale: Option<RenderScale>,
    /// Begin and end, seconds; none: the whole timeline.
    #[serde(deserialize_with = "range_s")]
    pub range_s: Option<[f64; 2]>,
    /// The preset that the range belongs to.
    pub range_of: Option<String>,
    /// Its folder.
    pub folder: Option<String>,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self {
            format: Format::Apng,
            size: None,
            fps: 30.0,
            scale: None,
            range_s: None,
            range_of: None,
            folder: None,
        }
    }
}

impl FilmSettings {
    /// Longest side, pixels: that of an exported picture.
    pub const MAX_SIDE: u32 = 8192;

    /// Largest number of frames per second that the window offers.
    pub const MAX_FPS: f64 = 240.0;
}

/// The names of anti-aliasing in the settings file.
const SCALES: [(&str, Option<RenderScale>); 4] = [
    ("preset", None),
    ("off", Some(RenderScale::Full)),
    ("2x2", Some(RenderScale::Double)),
    ("4x4", Some(RenderScale::Quadruple)),
];

fn format<'de, D: Deserializer<'de>>(from: D) -> Result<Format, D::Error> {
    word_of(from, &Format::ALL.map(|format| (format.word(), format)))
}

fn write_format<S: Serializer>(format: &Format, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(format.word())
}

fn scale<'de, D: Deserializer<'de>>(from: D) -> Result<Option<RenderScale>, D::Error> {
    word_of(from, &SCALES)
}

fn write_scale<S: Serializer>(scale: &Option<RenderScale>, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(
        SCALES
            .iter()
            .find(|(_, known)| known == scale)
            .map_or("preset", |(word, _)| word),
    )
}

fn size<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[u32; 2]>, D::Error> {
    let is_size = |size: &[u32; 2]| {
        size.iter()
            .all(|side| (1..=FilmSettings::MAX_SIDE).contains(side))
    };
    checked(
        from,
        is_size,
        "it takes [width, height] from 1 to 8192 pixels",
    )
    .map(Some)
}

fn fps<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number_in(from, [1.0, FilmSettings::MAX_FPS])
}

fn range_s<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f64; 2]>, D::Error> {
    checked(
        from,
        |[begin, end]: &[f64; 2]| begin < end && end.is_finite(),
        "it takes [begin, end] in seconds",
    )
    .map(Some)
}
