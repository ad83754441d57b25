//! How the left panel shows presets, effects and scenes.

/// What the left panel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tab {
    #[default]
    Presets,
    Effects,
    Scene,
}

impl Tab {
    pub const ALL: [Self; 3] = [Self::Presets, Self::Effects, Self::Scene];

    /// Its name in the settings file.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Presets => "presets",
            Self::Effects => "effects",
            Self::Scene => "scene",
        }
    }

    pub const fn label(self) -> &'static str {
        match self {
            Self::Presets => "Presets",
            Self::Effects => "Effects",
            Self::Scene => "Scene",
        }
    }
}

/// How presets are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    #[default]
    List,
    Grid,
}

impl Layout {
    pub const ALL: [Self; 2] = [Self::List, Self::Grid];

    /// Its name in the settings file.
    pub const fn word(self) -> &'static str {
        match self {
            Self::List => "list",
            Self::Grid => "grid",
        }
    }
}

/// In which order presets are listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sort {
    #[default]
    Name,
    /// Files that were changed last come first; built-in presets come behind all files.
    Newest,
    FavoritesFirst,
}

impl Sort {
    pub const ALL: [Self; 3] = [Self::Name, Self::Newest, Self::FavoritesFirst];

    /// Its name in the settings file.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Name => "name",
            Self::Newest => "newest",
            Self::FavoritesFirst => "favorites",
        }
    }

    pub const fn label(self) -> &'static str {
        match self {
            Self::Name => "By name",
            Self::Newest => "Newest first",
            Self::FavoritesFirst => "Favorites first",
        }
    }
}

/// What the left panel shows, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Browsing {
    pub tab: Tab,
    pub layout: Layout,
    pub sort: Sort,
}
