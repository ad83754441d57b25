//! What the window remembers between runs: its settings (`settings.toml`) and its last session
//! (`session.toml`), both in the folder of the user's configuration.

pub mod browsing;
pub mod film;
pub mod keeper;
pub mod keymap;
pub mod last_session;
pub mod recents;
pub mod up_axes;

use serde::{Deserialize, Deserializer, Serialize};

use self::{
    browsing::Browsing, film::FilmSettings, keymap::Keymap, recents::Recents, up_axes::UpAxes,
};
use crate::{
    app::{
        files::plain_file::{checked, number_in, write_rounded},
        widgets::theme::ThemeChoice,
    },
    link,
};

/// Sizes of texts and controls that can be chosen, as a factor of the system's.
pub const SCALES: [f32; 2] = [0.5, 3.0];

/// A step of the scale.
pub const SCALE_STEP: f32 = 0.1;

/// Size of the window's contents that can be restored, points.
const WINDOW_SIZES: [f32; 2] = [200.0, 16384.0];

/// Width of a side panel that can be restored, points.
const PANEL_WIDTHS: [f32; 2] = [100.0, 2000.0];

/// What the window remembers of how the user works.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    pub theme: ThemeChoice,
    /// Size of texts and controls, as a factor of the system's.
    #[serde(serialize_with = "write_rounded", deserialize_with = "scale")]
    pub scale: f32,
    #[serde(rename = "recent")]
    pub recents: Recents,
    /// Models whose axis that is up the user chose.
    #[serde(rename = "up")]
    pub up_axes: UpAxes,
    pub window: WindowSize,
    #[serde(rename = "panels")]
    pub open: OpenPanels,
    pub widths: PanelWidths,
    /// What the left panel shows, and how.
    pub browsing: Browsing,
    /// How the last film was exported.
    pub film: FilmSettings,
    pub keys: Keymap,
    /// Address of the page of *Copy link*.
    #[serde(deserialize_with = "page")]
    pub page: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            scale: 1.0,
            recents: Recents::default(),
            up_axes: UpAxes::default(),
            window: WindowSize::default(),
            open: OpenPanels::default(),
            widths: PanelWidths::default(),
            browsing: Browsing::default(),
            film: FilmSettings::default(),
            keys: Keymap::default(),
            page: link::PAGE.into(),
        }
    }
}

impl Settings {
    /// Makes texts and controls larger by `steps`, or smaller.
    pub fn change_scale(&mut self, steps: f32) {
        let scale = (self.scale / SCALE_STEP).round() + steps;
        self.scale = (scale * SCALE_STEP).clamp(SCALES[0], SCALES[1]);
    }
}

impl Settings {
    /// Widths of the left and the right panel in a window of this width, points.
    pub fn panel_widths(&self, window: f32) -> [f32; 2] {
        let [left, right] = if window < NARROW {
            NARROW_WIDTHS
        } else {
            WIDTHS
        };
        [
            self.widths.left.unwrap_or(left),
            self.widths.right.unwrap_or(right),
        ]
    }

    /// Remembers the width of the left (0) or right (1) panel that was and is open; one that opens
    /// or closes is narrower. A width that nobody has changed is not remembered.
    pub fn keep_width(
        &mut self,
        side: usize,
        is_open: bool,
        rect: Option<egui::Rect>,
        window: f32,
    ) {
        let usual = self.panel_widths(window)[side];
        if let Some(width) = rect
            .map(|rect| rect.width().round())
            .filter(|width| is_open && *width >= MIN_KEPT)
            && (width - usual).abs() > 1.5
        {
            let widths = &mut self.widths;
            *[&mut widths.left, &mut widths.right][side] = Some(width);
        }
    }
}

/// Widths of the side panels unless the user has changed them, and the least that is remembered,
/// points.
const WIDTHS: [f32; 2] = [264.0, 344.0];
const NARROW: f32 = 1080.0;
const NARROW_WIDTHS: [f32; 2] = [216.0, 316.0];
const MIN_KEPT: f32 = 190.0;

/// Widths of the side panels, points; none where nobody has changed them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PanelWidths {
    #[serde(deserialize_with = "panel_width")]
    pub left: Option<f32>,
    #[serde(deserialize_with = "panel_width")]
    pub right: Option<f32>,
}

/// Which panels, windows and handles are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OpenPanels {
    pub left: bool,
    pub right: bool,
    pub timeline: bool,
    pub trade: bool,
    pub timing: bool,
    pub log: bool,
    /// The rings in the picture, and the ball of the light.
    pub handles: bool,
    /// The box of the scene, its axes and a grid under it, over the picture.
    pub bounding_box: bool,
    pub axes: bool,
    pub grid: bool,
    #[serde(skip)]
    pub settings: bool,
}

impl Default for OpenPanels {
    fn default() -> Self {
        Self {
            left: true,
            right: true,
            timeline: true,
            trade: false,
            timing: false,
            log: false,
            handles: true,
            bounding_box: false,
            axes: false,
            grid: false,
            settings: false,
        }
    }
}

/// Size of the window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WindowSize {
    /// Width and height of its contents at a scale of 1, points.
    #[serde(deserialize_with = "window_size")]
    pub size: [f32; 2],
    #[serde(rename = "maximized")]
    pub is_maximized: bool,
}

impl Default for WindowSize {
    fn default() -> Self {
        Self {
            size: [1280.0, 800.0],
            is_maximized: false,
        }
    }
}

impl WindowSize {
    /// Takes the size of the window while it is neither maximized nor minimized.
    pub fn follow(&mut self, viewport: &egui::ViewportInfo, scale: f32) {
        self.is_maximized = viewport.maximized.unwrap_or(self.is_maximized);
        let is_free = !self.is_maximized
            && viewport.fullscreen != Some(true)
            && viewport.minimized != Some(true);
        if let Some(rect) = viewport.inner_rect.filter(|_| is_free) {
            let size = [rect.width(), rect.height()].map(|side| (side * scale).round());
            if is_window_size(&size) {
                self.size = size;
            }
        }
    }
}

fn is_window_size(size: &[f32; 2]) -> bool {
    size.iter()
        .all(|side| (WINDOW_SIZES[0]..=WINDOW_SIZES[1]).contains(side))
}

fn window_size<'de, D: Deserializer<'de>>(from: D) -> Result<[f32; 2], D::Error> {
    checked(
        from,
        is_window_size,
        "it takes [width, height] from 200 to 16384 points",
    )
}

fn page<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    checked(
        from,
        |page: &String| page.starts_with("http://") || page.starts_with("https://"),
        "it takes an address that begins with http:// or https://",
    )
}

fn scale<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number_in(from, SCALES)
}

fn panel_width<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f32>, D::Error> {
    number_in(from, PANEL_WIDTHS).map(Some)
}

#[cfg(test)]
mod tests {
    use egui::{Key, Modifiers};

    use super::{
        browsing::{Layout, Sort, Tab},
        *,
    };
    use crate::{
        accuracy::RenderScale,
        app::{files::plain_file, jobs::film::Format, shell::action::Action},
        film::Container,
    };

    fn unusual() -> Settings {
        let mut keys = Keymap::default();
        keys.bind(
            Action::Randomize,
            keymap::pressed(Key::J, Modifiers::COMMAND),
        )
        .expect("it is free");
        keys.clear(Action::Verify);
        Settings {
            theme: ThemeChoice::Light,
            scale: 1.3,
            recents: ["/models/a b.glb", "/presets/\"x\".toml"].iter().collect(),
            up_axes: toml_edit::de::from_str("'/models/a.b.ply' = '-z'").expect("an axis"),
            window: WindowSize {
                size: [900.0, 600.0],
                is_maximized: true,
            },
            open: OpenPanels {
                left: false,
                log: true,
                ..OpenPanels::default()
            },
            widths: PanelWidths {
                left: Some(212.0),
                right: None,
            },
            browsing: Browsing {
                tab: Tab::Effects,
                layout: Layout::Grid,
                sort: Sort::FavoritesFirst,
            },
            film: FilmSettings {
                format: Format::Video(Container::Webm),
                size: Some([640, 360]),
                fps: 23.976,
                scale: Some(RenderScale::Double),
                range_s: Some([0.5, 2.25]),
                range_of: Some("walk".into()),
                folder: Some("/films".into()),
            },
            keys,
            page: "https://example.org/lab/".into(),
        }
    }

    /// Reads a file with this text, writes the settings that `change` makes of it, and returns them
    /// with the remarks and the text that is written.
    fn rewritten(
        text: &str,
        change: impl FnOnce(Settings) -> Settings,
    ) -> (Settings, Vec<String>, String) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (path, mut remarks) = (folder.path().join("settings.toml"), Vec::new());
        std::fs::write(&path, text).expect("a file");
        let (read, mut document) = plain_file::read::<Settings>(&path, &mut remarks);
        plain_file::write(&change(read.clone()), &mut document, &path)
            .expect("a folder that can be written");
        (
            read,
            remarks,
            std::fs::read_to_string(&path).expect("a file"),
        )
    }

    #[test]
    fn settings_are_read_back_as_they_were_written() {
        for settings in [Settings::default(), unusual()] {
            let (.., text) = rewritten("", |_| settings.clone());
            let (read, remarks, again) = rewritten(&text, |read| read);
            assert_eq!((read, remarks, &again), (settings, vec![], &text));
        }
    }

    #[test]
    fn comments_stay_and_what_is_at_its_default_again_goes() {
        let text = "# mine\ntheme = \"dark\" # at night\n[keys] # own\n# no verify\nverify = []\n";
        let (.., written) = rewritten(text, |read| Settings { scale: 2.0, ..read });
        for kept in [
            "# mine",
            "theme = \"dark\" # at night",
            "[keys] # own",
            "# no verify",
            "verify = []",
            "scale = 2.0",
        ] {
            assert!(written.contains(kept), "{kept}: {written}");
        }
        let (.., written) = rewritten(text, |_| Settings::default());
        assert!(
            written.contains("# mine") && !written.contains("verify = []"),
            "{written}"
        );
    }

    #[test]
    fn each_bad_field_is_named_and_keeps_its_default() {
        let text = "theme = \"blue\"\nscale = 9\npage = \"ftp://x\"\nrecent = [1]\nfuture = 7\nwindow = 3\n[panels]\nleft = \"yes\"\nlog = true\n[widths]\nleft = -1\n\
            [browsing]\norder = \"size\"\n[film]\nformat = \"avi\"\nsize = [0, 5]\nfps = 1000\nrange_s = [2, 1]\nanti_aliasing = \"8x8\"\n\
            [keys]\nrandomize = [\"Ctrl+S\"]\nverify = [\"Nokey\"]\nfly = [\"F\"]\n";
        let (settings, remarks, _) = rewritten(text, |read| read);
        assert_eq!(
            settings,
            Settings {
                open: OpenPanels {
                    log: true,
                    ..OpenPanels::default()
                },
                ..Settings::default()
            }
        );
        let named = [
            ("theme = \"blue\"", "`system`, `light`, `dark`"),
            ("page = \"ftp://x\"", "http:// or https://"),
            ("scale = 9", "it takes a number from 0.5 to 3"),
            ("recent = [1]", "string"),
            ("future = 7", "unknown field"),
            ("window = 3", "struct"),
            ("panels.left = \"yes\"", "boolean"),
            ("widths.left = -1", "it takes a number from 100 to 2000"),
            ("browsing.order = \"size\"", "`name`, `newest`, `favorites`"),
            ("film.format = \"avi\"", "\"apng\" or \"mp4\""),
            ("film.size = [0, 5]", "from 1 to 8192 pixels"),
            ("film.fps = 1000", "from 1 to 240"),
            ("film.range_s = [2, 1]", "[begin, end]"),
            ("film.anti_aliasing = \"8x8\"", "\"preset\" or \"off\""),
            ("keys.randomize = [\"Ctrl+S\"]", "Ctrl+S belongs to"),
            ("keys.verify = [\"Nokey\"]", "such as \"Ctrl+Shift+Z\""),
            ("keys.fly = [\"F\"]", "no action"),
        ];
        for (field, why) in named {
            let is_named = |remark: &&String| {
                remark.contains(&format!("settings.toml: {field}: ")) && remark.contains(why)
            };
            assert_eq!(
                remarks.iter().filter(is_named).count(),
                1,
                "{field}: {remarks:#?}"
            );
        }
        assert!(
            remarks.len() == named.len()
                && remarks.iter().all(|remark| remark.lines().count() == 1),
            "{remarks:#?}"
        );
    }

    #[test]
    fn two_actions_can_exchange_their_keys() {
        let (settings, remarks, _) =
            rewritten("[keys]\nrandomize = [\"V\"]\nverify = [\"R\"]\n", |read| {
                read
            });
        assert_eq!(remarks, [""; 0]);
        assert_eq!(
            settings.keys.action_of(Key::V, Modifiers::NONE, |_| true),
            Some(Action::Randomize)
        );
        assert_eq!(
            settings.keys.action_of(Key::R, Modifiers::NONE, |_| true),
            Some(Action::Verify)
        );
    }

    #[test]
    fn the_scale_goes_in_tenths_and_stays_in_its_range() {
        let mut settings = Settings::default();
        settings.change_scale(1.0);
        assert!((settings.scale - 1.1).abs() < 1e-6);
        settings.change_scale(100.0);
        assert_eq!(settings.scale, SCALES[1]);
        settings.change_scale(-100.0);
        assert_eq!(settings.scale, SCALES[0]);
    }
}
