//! Settings as TOML. A field that cannot be used keeps its default and is named; comments and unknown keys are written back.

use std::path::PathBuf;

use toml_edit::{Array, DocumentMut, Item, Table, TableLike, value};

use super::{
    PANEL_WIDTHS, SCALES, Settings, WINDOW_SIZES,
    browsing::{Layout, Sort, Tab},
    film::FilmSettings,
    keymap::{self, Keymap},
    recents::Recents,
};
use crate::app::{action::Action, theme::ThemeChoice};

/// Reads settings. Each remark is a field that cannot be used.
///
/// # Errors
/// The text is no TOML: why, in one line.
pub fn read(text: &str, file: &str) -> Result<(Settings, DocumentMut, Vec<String>), String> {
    let document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].lines().count().max(1));
        format!("{file}, line {line}: {}", error.message().lines().next().unwrap_or("it is no TOML"))
    })?;
    let mut reader = Reader { file, remarks: Vec::new() };
    let settings = reader.settings(document.as_table());
    let remarks = reader.remarks;
    Ok((settings, document, remarks))
}

/// Writes settings into `document`.
pub fn write(settings: &Settings, document: &mut DocumentMut) {
    let Settings { theme, scale, recents, keys, window, open, widths, browsing, film } = settings;
    set(document.as_table_mut(), "theme", value(theme.word()));
    set(document.as_table_mut(), "scale", value(number(*scale)));
    let mut recent = Array::new();
    recents.iter().for_each(|path| recent.push(path.to_string_lossy().into_owned()));
    recent.iter_mut().for_each(|path| path.decor_mut().set_prefix("\n    "));
    recent.set_trailing(if recents.is_empty() { "" } else { "\n" });
    set(document.as_table_mut(), "recent", value(recent));

    let table = table_of(document, "window");
    set(table, "size", value(window.size.iter().map(|side| i64::from(side.round() as i32)).collect::<Array>()));
    set(table, "maximized", value(window.is_maximized));

    let table = table_of(document, "panels");
    for (key, is_open) in [
        ("left", open.left),
        ("right", open.right),
        ("timeline", open.timeline),
        ("trade", open.trade),
        ("timing", open.timing),
        ("log", open.log),
        ("handles", open.handles),
    ] {
        set(table, key, value(is_open));
    }
    for (key, width) in ["left_width", "right_width"].iter().zip(widths) {
        if let Some(width) = width {
            set(table, key, value(number(*width)));
        }
    }
    set(table, "tab", value(browsing.tab.word()));
    set(table, "presets", value(browsing.layout.word()));
    set(table, "order", value(browsing.sort.word()));

    write_film(film, table_of(document, "film"));

    let table = table_of(document, "keys");
    let known: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
    for id in known {
        if Action::of_id(&id).is_some_and(|action| !keys.is_bound(action)) {
            table.remove(&id);
        }
    }
    for (action, shortcuts) in keys.bound() {
        set(table, &action.id(), value(shortcuts.iter().map(keymap::written).collect::<Array>()));
    }
}

fn write_film(film: &FilmSettings, table: &mut dyn TableLike) {
    let FilmSettings { format, size, fps, scale, range_s } = film;
    set(table, "format", value(format.word()));
    set_or_remove(table, "size", size.map(|size| size.iter().map(|side| i64::from(*side)).collect::<Array>()));
    set(table, "fps", value(*fps));
    let scale = FilmSettings::SCALES.iter().find(|(_, known)| known == scale).map_or("preset", |(word, _)| word);
    set(table, "anti_aliasing", value(scale));
    set_or_remove(table, "range_s", range_s.as_ref().map(|(_, range_s)| range_s.iter().copied().collect::<Array>()));
    set_or_remove(table, "range_of", range_s.as_ref().map(|(preset, _)| preset.as_str()));
}

fn set_or_remove(table: &mut dyn TableLike, key: &str, new: Option<impl Into<toml_edit::Value>>) {
    match new {
        Some(new) => set(table, key, value(new)),
        None => drop(table.remove(key)),
    }
}

/// A number as people write it: `1.1`, not `1.10000002384`.
fn number(number: f32) -> f64 {
    (f64::from(number) * 1000.0).round() / 1000.0
}

/// Sets a value and keeps the comments round it.
fn set(table: &mut dyn TableLike, key: &str, new: Item) {
    match table.get_mut(key) {
        Some(Item::Value(there)) => {
            if let Item::Value(mut new) = new {
                *new.decor_mut() = there.decor().clone();
                *there = new;
            }
        }
        _ => drop(table.insert(key, new)),
    }
}

fn table_of<'a>(document: &'a mut DocumentMut, key: &str) -> &'a mut dyn TableLike {
    let item = document.entry(key).or_insert_with(|| Item::Table(Table::new()));
    if item.as_table_like().is_none() {
        *item = Item::Table(Table::new());
    }
    item.as_table_like_mut().expect("it was made a table")
}

struct Reader<'a> {
    file: &'a str,
    remarks: Vec<String>,
}

impl Reader<'_> {
    fn settings(&mut self, root: &dyn TableLike) -> Settings {
        let mut settings = Settings::default();
        if let Some(item) = root.get("theme") {
            let found = item.as_str().and_then(|word| ThemeChoice::ALL.into_iter().find(|theme| theme.word() == word));
            match found {
                Some(theme) => settings.theme = theme,
                None => self.refuse("theme", item, "it takes \"system\", \"light\" or \"dark\""),
            }
        }
        if let Some(scale) = self.number(root, "scale", SCALES) {
            settings.scale = scale;
        }
        if let Some(item) = root.get("recent") {
            match texts(item) {
                Some(paths) => settings.recents = paths.iter().map(PathBuf::from).collect::<Recents>(),
                None => self.refuse("recent", item, "it takes a list of paths"),
            }
        }
        if let Some(table) = self.table(root, "window") {
            if let Some(item) = table.get("size") {
                let sides: Vec<f32> = item.as_array().map_or(Vec::new(), |array| array.iter().filter_map(as_number).collect());
                match sides[..] {
                    [width, height] if [width, height].iter().all(|side| (WINDOW_SIZES[0]..=WINDOW_SIZES[1]).contains(side)) => {
                        settings.window.size = [width, height];
                    }
                    _ => self.refuse("window.size", item, "it takes [width, height] from 200 to 16384 points"),
                }
            }
            self.flag(table, "window", "maximized", &mut settings.window.is_maximized);
        }
        if let Some(table) = self.table(root, "panels") {
            let open = &mut settings.open;
            for (key, is_open) in [
                ("left", &mut open.left),
                ("right", &mut open.right),
                ("timeline", &mut open.timeline),
                ("trade", &mut open.trade),
                ("timing", &mut open.timing),
                ("log", &mut open.log),
                ("handles", &mut open.handles),
            ] {
                self.flag(table, "panels", key, is_open);
            }
            settings.widths = ["left_width", "right_width"].map(|key| self.number(table, key, PANEL_WIDTHS));
            let browsing = &mut settings.browsing;
            self.word(table, "panels.tab", &Tab::ALL.map(|tab| (tab.word(), tab)), &mut browsing.tab);
            self.word(table, "panels.presets", &Layout::ALL.map(|layout| (layout.word(), layout)), &mut browsing.layout);
            self.word(table, "panels.order", &Sort::ALL.map(|sort| (sort.word(), sort)), &mut browsing.sort);
        }
        if let Some(table) = self.table(root, "film") {
            settings.film = self.film(table);
        }
        if let Some(table) = self.table(root, "keys") {
            settings.keys = self.keys(table);
        }
        settings
    }

    fn film(&mut self, table: &dyn TableLike) -> FilmSettings {
        let mut film = FilmSettings::default();
        self.word(table, "film.format", &FilmSettings::formats(), &mut film.format);
        self.word(table, "film.anti_aliasing", &FilmSettings::SCALES, &mut film.scale);
        let numbers = |item: &Item| item.as_array().map(|array| array.iter().filter_map(as_f64).collect::<Vec<f64>>()).unwrap_or_default();
        if let Some(item) = table.get("size") {
            match numbers(item)[..] {
                [w, h] if [w, h].iter().all(|side| (1.0..=f64::from(FilmSettings::MAX_SIDE)).contains(side) && side.fract() == 0.0) => {
                    film.size = Some([w, h].map(|side| side as u32));
                }
                _ => self.refuse("film.size", item, "it takes [width, height] from 1 to 8192 pixels"),
            }
        }
        if let Some(item) = table.get("fps") {
            match item.as_value().and_then(as_f64).filter(|fps| (1.0..=FilmSettings::MAX_FPS).contains(fps)) {
                Some(fps) => film.fps = fps,
                None => self.refuse("film.fps", item, "it takes a number from 1 to 240"),
            }
        }
        if let Some(item) = table.get("range_s") {
            match (&numbers(item)[..], table.get("range_of").and_then(Item::as_str)) {
                (&[begin, end], Some(preset)) if begin < end => film.range_s = Some((preset.to_owned(), [begin, end])),
                _ => self.refuse("film.range_s", item, "it takes [begin, end] in seconds, and film.range_of the preset that it belongs to"),
            }
        }
        film
    }

    /// Binds the keys of all actions of the file. An action gives its keys up first, so that two can exchange theirs.
    fn keys(&mut self, table: &dyn TableLike) -> Keymap {
        let mut keys = Keymap::default();
        let mut stated = Vec::new();
        for (id, item) in table.iter() {
            let key = format!("keys.{id}");
            let Some(action) = Action::of_id(id) else {
                self.remarks.push(format!("{}: {key} is no action; it is left alone", self.file));
                continue;
            };
            let shortcuts = texts(item).and_then(|texts| texts.iter().map(|text| keymap::parse(text)).collect::<Option<Vec<_>>>());
            match shortcuts {
                Some(shortcuts) => {
                    keys.clear(action);
                    stated.push((action, key, shortcuts));
                }
                None => self.refuse(&key, item, "it takes a list of shortcuts such as \"Ctrl+Shift+Z\" or \"F5\""),
            }
        }
        for (action, key, shortcuts) in stated {
            if let Err(reason) = keys.bind_all(action, shortcuts) {
                self.remarks.push(format!("{}: {key}: {reason}", self.file));
                // Its own keys, unless another action has them now.
                drop(keys.reset(action));
            }
        }
        keys
    }

    fn table<'a>(&mut self, root: &'a dyn TableLike, key: &str) -> Option<&'a dyn TableLike> {
        let item = root.get(key)?;
        if item.as_table_like().is_none() {
            self.refuse(key, item, "it takes a table");
        }
        item.as_table_like()
    }

    fn number(&mut self, table: &dyn TableLike, key: &str, [low, high]: [f32; 2]) -> Option<f32> {
        let item = table.get(key)?;
        let number = item.as_value().and_then(as_number).filter(|number| (low..=high).contains(number));
        if number.is_none() {
            self.refuse(key, item, &format!("it takes a number from {low} to {high}"));
        }
        number
    }

    fn flag(&mut self, table: &dyn TableLike, group: &str, key: &str, flag: &mut bool) {
        let Some(item) = table.get(key) else { return };
        match item.as_bool() {
            Some(on) => *flag = on,
            None => self.refuse(&format!("{group}.{key}"), item, "it takes true or false"),
        }
    }

    /// Reads one of `words` at the path `key`, which ends with its key in `table`.
    fn word<T: Copy>(&mut self, table: &dyn TableLike, key: &str, words: &[(&str, T)], chosen: &mut T) {
        let Some(item) = table.get(key.rsplit('.').next().unwrap_or(key)) else { return };
        match words.iter().find(|(word, _)| item.as_str() == Some(word)) {
            Some((_, found)) => *chosen = *found,
            None => {
                let quoted: Vec<String> = words.iter().map(|(word, _)| format!("{word:?}")).collect();
                self.refuse(key, item, &format!("it takes {}", quoted.join(" or ")));
            }
        }
    }

    fn refuse(&mut self, key: &str, item: &Item, takes: &str) {
        let there = item.to_string();
        self.remarks.push(format!("{}: {key} = {}: {takes}; its default is used", self.file, there.trim()));
    }
}

fn as_f64(value: &toml_edit::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64)).filter(|number| number.is_finite())
}

fn as_number(value: &toml_edit::Value) -> Option<f32> {
    as_f64(value).map(|number| number as f32)
}

fn texts(item: &Item) -> Option<Vec<String>> {
    item.as_array()?.iter().map(|text| text.as_str().map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers};

    use super::*;
    use crate::{
        accuracy::RenderScale,
        app::{
            film::Format,
            settings::{OpenPanels, WindowPlace, browsing::Browsing},
        },
        film::Container,
    };

    fn round_trip(settings: &Settings, text: &str) -> String {
        let mut document: DocumentMut = text.parse().expect("TOML");
        write(settings, &mut document);
        document.to_string()
    }

    fn unusual() -> Settings {
        let mut keys = Keymap::default();
        keys.bind(Action::Randomize, keymap::pressed(Key::J, Modifiers::COMMAND)).expect("it is free");
        keys.clear(Action::Verify);
        Settings {
            theme: ThemeChoice::Light,
            scale: 1.3,
            recents: ["/models/a b.glb", "/presets/\"x\".toml"].iter().collect(),
            keys,
            window: WindowPlace { size: [900.0, 600.0], is_maximized: true },
            open: OpenPanels { left: false, log: true, ..OpenPanels::default() },
            widths: [Some(212.0), None],
            browsing: Browsing { tab: Tab::Effects, layout: Layout::Grid, sort: Sort::FavoritesFirst },
            film: FilmSettings {
                format: Format::Video(Container::Webm),
                size: Some([640, 360]),
                fps: 23.976,
                scale: Some(RenderScale::Double),
                range_s: Some(("walk".into(), [0.5, 2.25])),
            },
        }
    }

    #[test]
    fn settings_are_read_back_as_they_were_written() {
        for settings in [Settings::default(), unusual()] {
            let text = round_trip(&settings, "");
            let (read, _, remarks) = read(&text, "settings.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!((read, remarks), (settings, vec![]), "{text}");
        }
    }

    #[test]
    fn comments_and_unknown_keys_stay() {
        let text = "# mine\ntheme = \"dark\" # at night\nfuture = 7\n[keys]\n# no verify\nverify = []\n";
        let (settings, ..) = read(text, "settings.toml").expect("TOML");
        let written = round_trip(&settings, text);
        for kept in ["# mine", "theme = \"dark\" # at night", "future = 7", "# no verify", "verify = []"] {
            assert!(written.contains(kept), "{kept}: {written}");
        }
        let written = round_trip(&Settings::default(), text);
        assert!(!written.contains("verify = []"), "{written}");
    }

    #[test]
    fn each_bad_field_is_named_and_keeps_its_default() {
        let text = "theme = \"blue\"\nscale = 9\nrecent = [1]\nwindow = 3\n[panels]\nleft = \"yes\"\nlog = true\nleft_width = -1\norder = \"size\"\n\
            [film]\nformat = \"avi\"\nsize = [0, 5]\nfps = 1000\nrange_s = [2, 1]\nanti_aliasing = \"8x8\"\n[keys]\nrandomize = [\"Ctrl+S\"]\nverify = [\"Nokey\"]\nfly = [\"F\"]\n";
        let (settings, _, remarks) = read(text, "settings.toml").expect("TOML");
        let expected = Settings { open: OpenPanels { log: true, ..OpenPanels::default() }, ..Settings::default() };
        assert_eq!(settings, expected);
        let named = [
            "theme",
            "scale",
            "recent",
            "window",
            "panels.left",
            "left_width",
            "panels.order",
            "film.format",
            "film.size",
            "film.fps",
            "film.range_s",
            "film.anti_aliasing",
            "keys.verify",
            "keys.fly",
            "keys.randomize",
        ];
        for key in named {
            assert_eq!(
                remarks.iter().filter(|remark| remark.starts_with(&format!("settings.toml: {key}"))).count(),
                1,
                "{key}: {remarks:#?}"
            );
        }
        assert_eq!(remarks.len(), named.len(), "{remarks:#?}");
    }

    #[test]
    fn two_actions_can_exchange_their_keys() {
        let (settings, _, remarks) = read("[keys]\nrandomize = [\"V\"]\nverify = [\"R\"]\n", "settings.toml").expect("TOML");
        assert_eq!(remarks, [""; 0]);
        assert_eq!(settings.keys.action_of(Key::V, Modifiers::NONE, |_| true), Some(Action::Randomize));
        assert_eq!(settings.keys.action_of(Key::R, Modifiers::NONE, |_| true), Some(Action::Verify));
    }

    #[test]
    fn a_broken_file_is_one_line_with_its_place() {
        let error = read("theme = \"dark\"\nscale = = 2\n", "settings.toml").expect_err("it is broken");
        assert!(error.starts_with("settings.toml, line 2: ") && error.lines().count() == 1, "{error}");
    }
}
