//! Promise: the browser finds presets by name, tag and effect, remembers favorites, follows the
//! open preset, and renames, duplicates and deletes files without losing any.

use std::path::{Path, PathBuf};

use egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::preset_file::Folders;

use crate::harness::*;

const TEXT: &str = "schema = 2\n# mine\nname = \"First\"\ntags = [\"own\"]\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.facet]\namount = 0.5\n[effects.lambert]\n";

/// A folder of the user with the preset `first`, and a window that shows it.
fn own(folder: &Path) -> Option<Lab> {
    std::fs::create_dir_all(folder.join("presets")).expect("a folder");
    std::fs::write(first(folder), TEXT).expect("a file");
    lab_with(
        "first",
        Folders {
            user: Some(folder.to_owned()),
            ..Folders::default()
        },
    )
}

fn first(folder: &Path) -> PathBuf {
    folder.join("presets/first.toml")
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Chooses an entry of the menu of a preset.
fn choose(lab: &mut Lab, preset: &str, entry: &str) {
    open_menu(lab, preset);
    lab.get_by_role_and_label(Role::Button, entry).click();
    lab.run_steps(4);
    settle(lab);
}

fn open_menu(lab: &mut Lab, preset: &str) {
    let name = format!("Preset {preset}");
    lab.get_by_role_and_label(Role::Button, &name)
        .scroll_to_me();
    lab.run_steps(20);
    lab.get_by_role_and_label(Role::Button, &name)
        .click_secondary();
    lab.run_steps(4);
}

/// Replaces the text of the field `label`.
fn type_into(lab: &mut Lab, label: &str, text: &str) {
    lab.get_by_role_and_label(Role::TextInput, label).click();
    lab.run_steps(2);
    lab.key_press_modifiers(Modifiers::COMMAND, Key::A);
    lab.event(Event::Text(text.into()));
    lab.run_steps(4);
}

/// The names of the presets that are listed.
fn listed(lab: &Lab) -> Vec<String> {
    let labels = lab
        .query_all_by_role(Role::Button)
        .filter_map(|node| node.accesskit_node().label());
    labels
        .filter_map(|label| label.strip_prefix("Preset ").map(str::to_owned))
        .collect()
}

#[test]
fn search_tags_and_favorites_choose_what_is_listed_and_brackets_walk_through_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    let all = listed(&lab).len();
    type_into(&mut lab, "Search presets", "hatch");
    let found = listed(&lab);
    assert!(
        !found.is_empty() && found.len() < all / 4 && found.contains(&"Engraving".to_owned()),
        "by effect: {found:?}"
    );
    type_into(&mut lab, "Search presets", "own");
    assert!(listed(&lab).contains(&"First".to_owned()), "by tag");
    click(&mut lab, Role::Button, "Clear: Search presets");
    assert_eq!(listed(&lab).len(), all);

    for name in ["Comic", "Engraving"] {
        let star = format!("Favorite {name}");
        click(&mut lab, Role::CheckBox, &star);
    }
    click(&mut lab, Role::CheckBox, "Favorites only");
    assert_eq!(listed(&lab), ["Comic", "Engraving"]);
    lab.key_press(Key::CloseBracket);
    settle(&mut lab);
    assert_eq!(
        lab.state().preset_file().id,
        "comic",
        "the first of the list, since the open one is not listed"
    );
    lab.key_press(Key::CloseBracket);
    settle(&mut lab);
    assert_eq!(lab.state().preset_file().id, "engraving");
    lab.key_press(Key::CloseBracket);
    settle(&mut lab);
    assert_eq!(lab.state().preset_file().id, "comic", "it wraps round");
    click(&mut lab, Role::Button, "Show all");
    click(&mut lab, Role::Button, "Tag facet");
    let tagged = listed(&lab);
    assert!(tagged.len() > 1 && tagged.len() < all, "{tagged:?}");
    click(&mut lab, Role::Button, "Tag facet");
    assert_eq!(listed(&lab).len(), all);

    // Another window has the stars of this one, and its order.
    drop(lab);
    assert_eq!(
        text(&folder.path().join("favorites.toml")),
        "presets = [\"comic\", \"engraving\"]\n"
    );
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    click(&mut lab, Role::ComboBox, "Order of the presets");
    click(&mut lab, Role::Button, "Favorites first");
    assert_eq!(listed(&lab)[..2], ["Comic", "Engraving"]);
    click(&mut lab, Role::ComboBox, "Order of the presets");
    click(&mut lab, Role::Button, "Newest first");
    assert_eq!(
        listed(&lab)[0],
        "First",
        "the one file comes before built-in presets"
    );
}

#[test]
fn the_list_and_the_grid_scroll_to_the_open_preset() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let is_seen = |lab: &Lab, name: &str| {
        let rect = lab.get_by_role_and_label(Role::Button, name).rect();
        rect.top() > 60.0 && rect.bottom() < 720.0
    };
    // The open preset is the one that is marked.
    let is_marked = |lab: &Lab| {
        let marked: Vec<String> = lab
            .query_all_by_role(Role::Button)
            .filter(is_on)
            .filter_map(|node| node.accesskit_node().label())
            .collect();
        marked
            .iter()
            .filter(|label| label.starts_with("Preset "))
            .eq([&format!("Preset {}", lab.state().preset_file().title())])
    };
    for layout in ["List", "Large pictures"] {
        click(&mut lab, Role::CheckBox, layout);
        assert!(is_marked(&lab), "{layout}: at the start");
        press(&mut lab, Modifiers::NONE, Key::OpenBracket);
        lab.run_steps(30);
        assert!(is_marked(&lab), "{layout}: after a key");
        press(&mut lab, Modifiers::COMMAND, Key::K);
        lab.event(Event::Text("open wobble".into()));
        lab.run_steps(3);
        press(&mut lab, Modifiers::NONE, Key::Enter);
        lab.run_steps(30);
        let open = format!("Preset {}", lab.state().preset_file().title());
        assert!(
            lab.state().preset_file().id.starts_with("wobble")
                && is_seen(&lab, &open)
                && is_marked(&lab),
            "{layout}: {open}"
        );
        undo(&mut lab);
        lab.run_steps(30);
        let back = format!("Preset {}", lab.state().preset_file().title());
        assert!(
            back != open && is_seen(&lab, &back) && is_marked(&lab),
            "{layout}: {back}"
        );
    }
}

#[test]
fn renaming_moves_the_file_and_the_open_preset_with_its_edits_and_undo_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    click(&mut lab, Role::CheckBox, "Favorite First");
    lab.state_mut().preset_mut().spin_deg_per_s = 20.0;
    settle(&mut lab);
    lab.run_steps(60);
    choose(&mut lab, "First", "Rename…");
    lab.event(Event::Text("Second try".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    let to = folder.path().join("presets/second-try.toml");
    assert_eq!(
        text(&to),
        TEXT.replace("First", "Second try"),
        "the file has its comments, and not the unsaved edit"
    );
    assert!(!first(folder.path()).exists());
    let open = lab.state().preset_file();
    assert_eq!(
        (open.path.as_ref(), open.title(), open.preset.spin_deg_per_s),
        (Some(&to), "Second try", 20.0)
    );
    assert!(text(&folder.path().join("favorites.toml")).contains("second-try"));
    undo(&mut lab);
    let open = lab.state().preset_file();
    assert_eq!(
        (open.path.as_ref(), open.title(), open.preset.spin_deg_per_s),
        (Some(&to), "Second try", 0.0)
    );
    assert_eq!(error_lines(&lab), Vec::<String>::new());
}

#[test]
fn a_preset_that_has_landed_on_a_model_is_followed_when_its_file_is_renamed_or_deleted() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    let model = folder.path().join("tri.glb");
    std::fs::write(&model, crate::files::tiny_glb()).expect("a file");
    crate::files::drop_files(&mut lab, &[&model]);
    click(&mut lab, Role::Button, "Preset First");
    let is_open = |lab: &Lab, name: &str| {
        let label = format!("Preset {name}");
        is_on(&lab.get_by_role_and_label(Role::Button, &label))
    };
    assert!(is_open(&lab, "First") && lab.state().preset_file().title() == "First on tri");
    choose(&mut lab, "First", "Rename…");
    lab.event(Event::Text("Second".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert!(
        is_open(&lab, "Second"),
        "the list marks what the look comes from"
    );
    press(&mut lab, Modifiers::NONE, Key::CloseBracket);
    press(&mut lab, Modifiers::NONE, Key::OpenBracket);
    assert!(is_open(&lab, "Second"), "the keys walk from there");
    let before = lab.state().preset_file().preset.clone();
    choose(&mut lab, "Second", "Delete");
    assert!(
        !listed(&lab).contains(&"Second".to_owned()) && lab.state().preset_file().preset == before,
        "the picture stays"
    );
    click(&mut lab, Role::Button, "Undo the deletion");
    assert!(
        is_open(&lab, "Second") && error_lines(&lab).is_empty(),
        "{:?}",
        error_lines(&lab)
    );
    remove_from_trash(&folder.path().join("presets"));
}

#[test]
fn what_the_panel_shows_and_how_is_there_at_the_next_start_and_a_renamed_file_stays_recent() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("config");
    std::fs::create_dir_all(folder.path().join("presets")).expect("a folder");
    std::fs::write(first(folder.path()), TEXT).expect("a file");
    let start = || {
        let folders = Folders {
            user: Some(folder.path().to_owned()),
            ..Folders::default()
        };
        let mut lab = created(Some("first"), folders, Some(config.clone()), SIZE)?;
        settle(&mut lab);
        Some(lab)
    };
    let Some(mut lab) = start() else { return };
    click(&mut lab, Role::Button, "Preset First");
    click(&mut lab, Role::CheckBox, "Large pictures");
    click(&mut lab, Role::ComboBox, "Order of the presets");
    click(&mut lab, Role::Button, "Newest first");
    choose(&mut lab, "First", "Rename…");
    lab.event(Event::Text("Second".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    drop(lab);
    let settings = text(&config.join("settings.toml"));
    assert!(
        settings.contains("second.toml") && !settings.contains("first.toml"),
        "{settings}"
    );

    std::fs::write(first(folder.path()), TEXT).expect("a file");
    let Some(mut lab) = start() else { return };
    let is_chosen = |lab: &Lab, name: &str| is_on(&lab.get_by_role_and_label(Role::CheckBox, name));
    assert!(is_chosen(&lab, "Large pictures") && !is_chosen(&lab, "List"));
    assert_eq!(
        listed(&lab)[..2],
        ["First", "Second"],
        "the newest file first"
    );
    click(&mut lab, Role::Button, "Effects");
    drop(lab);
    let Some(lab) = start() else { return };
    assert!(
        lab.query_by_role_and_label(Role::Button, "Effect toon")
            .is_some(),
        "the tab is the same"
    );
}

#[test]
fn a_taken_name_is_refused_in_the_dialog_and_a_built_in_preset_has_no_name_to_change() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir_all(folder.path().join("presets")).expect("a folder");
    std::fs::write(folder.path().join("presets/other.toml"), "schema = 2\n").expect("a file");
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    choose(&mut lab, "First", "Rename…");
    lab.event(Event::Text("other".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert!(
        lab.query_by_label_contains("other.toml exists already")
            .is_some(),
        "the dialog says why"
    );
    assert_eq!(
        (
            text(&first(folder.path())).as_str(),
            text(&folder.path().join("presets/other.toml")).as_str()
        ),
        (TEXT, "schema = 2\n")
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);

    open_menu(&mut lab, "Comic");
    for entry in ["Rename…", "Delete"] {
        let node = lab.get_by_role_and_label(Role::Button, entry);
        assert!(
            node.accesskit_node().is_disabled(),
            "{entry} of a built-in preset"
        );
    }
    lab.get_by_role_and_label(Role::Button, "Duplicate").click();
    lab.run_steps(4);
    settle(&mut lab);
    let copy = text(&folder.path().join("presets/comic-copy.toml"));
    assert!(
        copy.contains("name = \"Comic copy\"") && copy.contains("[effects.toon]"),
        "{copy}"
    );
    assert!(listed(&lab).contains(&"Comic copy".to_owned()));
}

#[test]
fn a_deleted_preset_comes_back_and_what_took_its_place_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    choose(&mut lab, "First", "Delete");
    assert!(!first(folder.path()).exists() && !listed(&lab).contains(&"First".to_owned()));
    let open = lab.state().preset_file();
    assert!(
        open.path.is_none() && open.title() == "First",
        "the window keeps showing it"
    );
    click(&mut lab, Role::Button, "Undo the deletion");
    assert_eq!(text(&first(folder.path())), TEXT);
    assert_eq!(lab.state().preset_file().path, Some(first(folder.path())));
    assert!(listed(&lab).contains(&"First".to_owned()));

    choose(&mut lab, "First", "Delete");
    std::fs::write(first(folder.path()), "schema = 2\nname = \"Newer\"\n").expect("a file");
    click(&mut lab, Role::Button, "Undo the deletion");
    assert_eq!(
        text(&first(folder.path())),
        "schema = 2\nname = \"Newer\"\n"
    );
    assert_eq!(text(&folder.path().join("presets/first-2.toml")), TEXT);
    assert_eq!(error_lines(&lab), Vec::<String>::new());
    remove_from_trash(&folder.path().join("presets"));
}

#[test]
fn a_preset_that_another_program_has_changed_is_not_lost_by_deleting_or_renaming() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path()) else {
        return;
    };
    // Another preset is open, so nobody watches the file.
    press(&mut lab, Modifiers::NONE, Key::CloseBracket);
    let changed = TEXT.replace("0.5", "0.75");
    std::fs::write(first(folder.path()), &changed).expect("a file");
    choose(&mut lab, "First", "Rename…");
    lab.event(Event::Text("Renamed".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    let to = folder.path().join("presets/renamed.toml");
    assert_eq!(text(&to), changed.replace("First", "Renamed"));
    std::fs::write(
        &to,
        "schema = 2\nname = \"Renamed\"\n# by another program\n",
    )
    .expect("a file");
    choose(&mut lab, "Renamed", "Delete");
    click(&mut lab, Role::Button, "Undo the deletion");
    assert_eq!(
        text(&to),
        "schema = 2\nname = \"Renamed\"\n# by another program\n"
    );
    remove_from_trash(&folder.path().join("presets"));
}

#[test]
fn the_star_over_a_picture_shows_on_any_color() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir_all(folder.path().join("presets")).expect("a folder");
    let white = TEXT.replace(
        "[effects.facet]",
        "[output]\nbackground = [1.0, 1.0, 1.0, 1.0]\n[effects.facet]",
    );
    std::fs::write(first(folder.path()), white).expect("a file");
    let Some(mut lab) = lab_with(
        "first",
        Folders {
            user: Some(folder.path().to_owned()),
            ..Folders::default()
        },
    ) else {
        return;
    };
    click(&mut lab, Role::CheckBox, "Large pictures");
    click(&mut lab, Role::CheckBox, "Favorite First");
    lab.remove_cursor();
    lab.run_steps(20);
    settle(&mut lab);
    let star = lab
        .get_by_role_and_label(Role::CheckBox, "Favorite First")
        .rect();
    let window = lab.screenshot();
    let light = |x: f32, y: f32| window.get_pixel(x.round() as u32, y.round() as u32).0[0];
    // Left of the star is the picture, and round it a ground of its own.
    let (picture, ground) = (
        light(star.left() - 6.0, star.center().y),
        light(star.center().x, star.bottom() - 2.5),
    );
    assert!(
        picture > 240 && ground < 128,
        "the star lies on {ground} in a picture of {picture}"
    );
}
