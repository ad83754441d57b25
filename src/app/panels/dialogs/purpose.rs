//! The words of a dialog for paths, by what it is for.

use crate::{app::files::command::Purpose, preset_file::ModelFormat};

impl Purpose {
    pub const fn title(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::SaveAs => "Save preset as",
            Self::Export => "Export PNG",
            Self::Sheet => "Save contact sheet",
        }
    }

    pub fn hint(self) -> String {
        match self {
            Self::Open => format!(
                "A preset (.toml), a model ({}), an exported picture (.png), an effect (.wgsl), a preset's id, or builtin:teapot",
                ModelFormat::names(", ")
            ),
            Self::SaveAs => "Presets in the suggested folder appear in the list on the left. The description, tags and test of the preset that it comes from are left out".into(),
            Self::Export => {
                "The picture contains the preset: open the picture to get it back".into()
            }
            Self::Sheet => "The pictures of the sweep, each with its values".into(),
        }
    }

    pub const fn verb(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::SaveAs | Self::Export | Self::Sheet => "Save",
        }
    }

    /// What a name without an extension gets.
    pub const fn extension(self) -> Option<&'static str> {
        match self {
            Self::Open => None,
            Self::SaveAs => Some("toml"),
            Self::Export | Self::Sheet => Some("png"),
        }
    }
}
