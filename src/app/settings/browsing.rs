//! How the left panel shows presets, effects and scenes.

use serde::{Deserialize, Serialize};

/// What the left panel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tab {
    #[default]
    Presets,
    Effects,
    Scene,
}

impl Tab {
    pub const ALL: [Self; 3] = [Self::Presets, Self::Effects, Self::Scene];

    pub const fn label(self) -> &'static str {
        match self {
            Self::Presets => "Presets",
            Self::Effects => "Effects",
            Self::Scene => "Scene",
        }
    }
}

/// How presets are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    #[default]
    List,
    Grid,
}

/// In which order presets are listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sort {
    #[default]
    Name,
    /// Files that were changed last come first; built-in presets come behind all files.
    Newest,
    #[serde(rename = "favorites")]
    FavoritesFirst,
}

impl Sort {
    pub const ALL: [Self; 3] = [Self::Name, Self::Newest, Self::FavoritesFirst];

    pub const fn label(self) -> &'static str {
        match self {
            Self::Name => "By name",
            Self::Newest => "Newest first",
            Self::FavoritesFirst => "Favorites first",
        }
    }
}

/// What the left panel shows, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Browsing {
    pub tab: Tab,
    #[serde(rename = "presets")]
    pub layout: Layout,
    #[serde(rename = "order")]
    pub sort: Sort,
}
