//! Promise: what is edited on disk appears in the window when it is saved. What is faulty leaves
//! the last good picture and says where the fault is, until it is mended.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;

use rasterlab::preset_file::Folders;

use crate::{
    common::own_shaders,
    files::{drop_files, tiny_glb},
    harness::*,
};

/// Paints everything in the color of a parameter.
pub const INK: &str = "// Ink: paints the surface.\n//@ use lib/surface\n\nstruct Ink {\n    /// How much.\n    @range(0.0, 1.0, 1.0) amount: f32,\n}\n\n\
    fn ink(surface: Surface, p: Ink) -> Surface {\n    var s = surface;\n    s.color = vec4f(p.amount, 0.0, 0.0, 1.0);\n    return s;\n}\n";

const PRESET: &str = "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.ink]\n";

pub fn write(path: &Path, text: &str) {
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    std::fs::write(path, text).expect("a file");
}

fn count(lab: &Lab, text: &str) -> usize {
    lab.state()
        .log_text()
        .lines()
        .filter(|line| line.contains(text))
        .count()
}

/// How often a message was logged.
fn times(lab: &Lab, text: &str) -> u32 {
    let log = lab.state().log_text();
    let line = log.lines().find(|line| line.contains(text));
    line.map_or(0, |line| {
        line.rsplit_once('×')
            .and_then(|(_, count)| count.parse().ok())
            .unwrap_or(1)
    })
}

fn has_badge(lab: &Lab, text: &str) -> bool {
    lab.query_all_by_label_contains(text).next().is_some()
}

fn middle_pixel(lab: &mut Lab) -> [u8; 4] {
    let seen = middle(lab);
    seen.get_pixel(seen.width() / 2, seen.height() / 2).0
}

#[test]
fn an_effect_that_is_edited_is_seen_breaks_and_heals() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("effects/ink.wgsl");
    write(&file, INK);
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    let red = middle_pixel(&mut lab);
    assert!(
        red[0] > 250 && red[1] < 5 && red[2] < 5,
        "{red:?}\n{}",
        lab.state().log_text()
    );

    let green = INK.replace("vec4f(p.amount, 0.0,", "vec4f(0.0, p.amount,");
    let saved = Instant::now();
    write(&file, &green);
    wait_for(&mut lab, "the edit is seen", |lab| {
        times(lab, "ink was reloaded") == 1
    });
    eprintln!("from save to picture: {:?}", saved.elapsed());
    let seen = middle_pixel(&mut lab);
    assert!(seen[1] > 250 && seen[0] < 5, "{seen:?}");
    assert!(
        !lab.state().preset_file().is_modified(),
        "an edit of the effect is no edit of the preset"
    );
    assert_eq!(lab.state().undo_steps(), 0);

    write(&file, &green.replace("return s;", "return t;"));
    wait_for(&mut lab, "the fault is seen", |lab| {
        has_badge(lab, "ink.wgsl is faulty; the picture")
    });
    assert!(has_badge(&lab, "ink.wgsl:12:12:"), "the badge has no place");
    assert!(has_badge(&lab, "^"), "the badge has no caret");
    assert!(has_badge(&lab, "return t;"));
    assert_eq!(
        count(&lab, "ink.wgsl:12:12:"),
        1,
        "{}",
        lab.state().log_text()
    );
    assert_eq!(
        middle_pixel(&mut lab),
        seen,
        "the last good picture went away"
    );
    lab.run_steps(400); // The badge stays until the file is mended.
    assert!(has_badge(&lab, "ink.wgsl:12:12:"));

    // By another file that takes its place, as many editors save.
    let beside = folder.path().join("effects/.ink.swp");
    write(
        &beside,
        &green.replace("0.0, p.amount, 0.0", "0.0, 0.0, p.amount"),
    );
    std::fs::rename(&beside, &file).expect("the file is replaced");
    wait_for(&mut lab, "the effect is whole again", |lab| {
        times(lab, "ink was reloaded") == 2
    });
    assert!(!has_badge(&lab, "is faulty"), "the badge stays");
    let blue = middle_pixel(&mut lab);
    assert!(blue[2] > 250 && blue[0] < 5 && blue[1] < 5, "{blue:?}");

    // A file that is removed leaves its effect in the picture.
    std::fs::remove_file(&file).expect("the file is removed");
    wait_for(&mut lab, "the loss is seen", |lab| {
        has_badge(lab, "has this file any more")
    });
    assert_eq!(middle_pixel(&mut lab), blue);
    write(&file, INK);
    wait_for(&mut lab, "the effect is back", |lab| {
        times(lab, "ink was reloaded") == 3
    });
    assert!(!has_badge(&lab, "has this file any more"));
    assert_eq!(middle_pixel(&mut lab), red);
}

#[test]
fn values_are_kept_by_name_when_parameters_come_and_go() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("effects/ink.wgsl");
    let members = |members: &str| {
        INK.replace(
            "    /// How much.\n    @range(0.0, 1.0, 1.0) amount: f32,\n",
            members,
        )
        .replace("p.amount", "0.5")
    };
    write(
        &file,
        &members(
            "    /// A.\n    @range(0, 1, 0.5) a: f32,\n    /// B.\n    @range(0, 8, 2) b: f32,\n    /// C.\n    @range(0, 8, 1) c: f32,\n",
        ),
    );
    let preset = format!(
        "{PRESET}a = 0.25\nb = 7.0\nc = 6.0\n[animation.ink]\na = [{{ time_s = 0.0, value = 0.25 }}, {{ time_s = 1.0, value = 1.0 }}]\n"
    );
    let Some(mut lab) = lab_of(folder.path(), &preset) else {
        return;
    };
    assert_eq!(
        [
            value(&lab, "ink", "a"),
            value(&lab, "ink", "b"),
            value(&lab, "ink", "c")
        ],
        [[0.25], [7.0], [6.0]]
    );

    // `b` is gone, `d` is new and stands first, `c` has a smaller range, and the keys of `a` no
    // longer all fit.
    write(
        &file,
        &members(
            "    /// D.\n    @range(0, 9, 3) d: f32,\n    /// C.\n    @range(0, 4, 2) c: f32,\n    /// A.\n    @range(0, 0.5, 0.5) a: f32,\n",
        ),
    );
    wait_for(&mut lab, "the edit is seen", |lab| {
        times(lab, "ink was reloaded") == 1
    });
    assert_eq!(
        [
            value(&lab, "ink", "d"),
            value(&lab, "ink", "c"),
            value(&lab, "ink", "a")
        ],
        [[3.0], [2.0], [0.25]]
    );
    assert!(
        lab.state()
            .preset_file()
            .preset
            .stack
            .get("ink")
            .is_some_and(|ink| ink.effect.field("b").is_none())
    );
    assert_eq!(key_times(&lab, "ink", "a"), [0.0]);
    assert!(has_slider(&lab, "ink.d") && !has_slider(&lab, "ink.b"));
    assert_eq!((lab.state().undo_steps(), error_lines(&lab)), (0, vec![]));

    // Undo crosses an edit of the file.
    let rail = slider(&lab, "ink.d").rect();
    drag(
        &mut lab,
        rail.left_center() + egui::vec2(8.0, 0.0),
        rail.right_center(),
    );
    assert!(value(&lab, "ink", "d")[0] > 6.0);
    write(
        &file,
        &members(
            "    /// E.\n    @range(0, 1, 0.75) e: f32,\n    /// D.\n    @range(0, 9, 3) d: f32,\n",
        ),
    );
    wait_for(&mut lab, "the edit is seen", |lab| {
        times(lab, "ink was reloaded") == 2
    });
    assert!(value(&lab, "ink", "d")[0] > 6.0);
    undo(&mut lab);
    assert_eq!(
        [value(&lab, "ink", "e"), value(&lab, "ink", "d")],
        [[0.75], [3.0]]
    );
    assert_eq!(error_lines(&lab), [""; 0]);
}

#[test]
fn a_preset_that_is_edited_on_disk_is_reloaded_and_unsaved_changes_are_asked_about() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mine.toml");
    let text = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    let amount = |lab: &Lab| value(lab, "facet", "amount")[0];
    write(&file, &text.replace("0.25", "0.5"));
    wait_for(&mut lab, "the file is read again", |lab| {
        times(lab, "Mine was reloaded") == 1
    });
    assert_eq!(amount(&lab), 0.5);
    assert!(!lab.state().preset_file().is_modified());
    undo(&mut lab); // The reload is a step.
    assert_eq!(amount(&lab), 0.25);

    // Now the preset differs from its file, so a change of the file is asked about.
    write(&file, &text.replace("0.25", "0.75"));
    wait_for(&mut lab, "the question is asked", |lab| {
        lab.query_by_label("Take theirs").is_some()
    });
    assert_eq!(amount(&lab), 0.25);
    click(&mut lab, Role::Button, "Keep mine");
    assert_eq!(amount(&lab), 0.25);
    write(&file, &text.replace("0.25", "0.875"));
    wait_for(&mut lab, "the question is asked again", |lab| {
        lab.query_by_label("Take theirs").is_some()
    });
    click(&mut lab, Role::Button, "Take theirs");
    assert_eq!(amount(&lab), 0.875);
    assert!(!lab.state().preset_file().is_modified());

    // A faulty file keeps the preset.
    write(&file, "schema = 2\n[effects.facet]\namount = 9\n");
    wait_for(&mut lab, "the fault is seen", |lab| {
        has_badge(lab, "The preset's file is faulty")
    });
    assert!(has_badge(&lab, "mine.toml:3") && amount(&lab) == 0.875);
    write(&file, &text.replace("0.25", "0.125"));
    wait_for(&mut lab, "the file is read again", |lab| {
        amount(lab) == 0.125
    });
    assert!(!has_badge(&lab, "is faulty"));

    // Saving is no change from outside.
    let reloads = times(&lab, "Mine was reloaded");
    let rail = slider(&lab, "facet.amount").rect();
    drag(
        &mut lab,
        rail.left_center() + egui::vec2(8.0, 0.0),
        rail.center(),
    );
    press(&mut lab, egui::Modifiers::COMMAND, egui::Key::S);
    for _ in 0..100 {
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        times(&lab, "Mine was reloaded") == reloads && lab.query_by_label("Take theirs").is_none()
    );
    assert!(!lab.state().preset_file().is_modified());
}

#[test]
fn saving_never_overwrites_what_another_program_wrote_unasked_and_both_can_be_merged() {
    use egui::{Key, Modifiers};
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mine.toml");
    let text = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n[effects.lambert]\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    let change = |lab: &mut Lab, to: f32| {
        let rail = slider(lab, "facet.amount").rect();
        drag(
            lab,
            rail.left_center() + egui::vec2(8.0, 0.0),
            rail.left_center() + egui::vec2(to * rail.width(), 0.0),
        );
    };
    let read = || std::fs::read_to_string(&file).expect("the preset");
    // Saved in the same moment: the watcher has not seen the change yet.
    change(&mut lab, 0.5);
    let mine = value(&lab, "facet", "amount")[0];
    let theirs = text.replace(
        "builtin = \"teapot\"",
        "builtin = \"teapot\"\nspin_deg_per_s = 30.0",
    );
    write(&file, &theirs);
    press(&mut lab, Modifiers::COMMAND, Key::S);
    assert_eq!(
        read(),
        theirs,
        "the change of the other program is overwritten"
    );
    if lab
        .query_by_role_and_label(Role::Button, "Merge and save")
        .is_some()
    {
        click(&mut lab, Role::Button, "Merge and save");
    } else {
        // On a slow machine the watcher was faster than the key.
        click(&mut lab, Role::Button, "Merge");
        press(&mut lab, Modifiers::COMMAND, Key::S);
    }
    let merged = rasterlab::preset_file::load(&file)
        .expect("a preset")
        .preset;
    assert_eq!(
        (
            value(&lab, "facet", "amount")[0],
            lab.state().preset_file().preset.spin_deg_per_s
        ),
        (mine, 30.0)
    );
    assert_eq!(merged, lab.state().preset_file().preset);
    assert!(!lab.state().preset_file().is_modified(), "{}", read());

    // Mine, once it was decided, is saved without another question.
    change(&mut lab, 0.75);
    let theirs = read().replace("spin_deg_per_s = 30.0", "spin_deg_per_s = 60.0");
    write(&file, &theirs);
    wait_for(&mut lab, "the question is asked", |lab| {
        lab.query_by_label("Take theirs").is_some()
    });
    click(&mut lab, Role::Button, "Keep mine");
    assert_eq!(read(), theirs);
    press(&mut lab, Modifiers::COMMAND, Key::S);
    assert!(
        lab.query_by_label("Take theirs").is_none() && read().contains("spin_deg_per_s = 30.0")
    );

    // Merged without saving, the file stays until it is saved.
    change(&mut lab, 0.25);
    let theirs = read().replace("spin_deg_per_s = 30.0", "spin_deg_per_s = 90.0");
    write(&file, &theirs);
    wait_for(&mut lab, "the question is asked", |lab| {
        lab.query_by_label("Merge").is_some()
    });
    click(&mut lab, Role::Button, "Merge");
    assert_eq!(
        (lab.state().preset_file().preset.spin_deg_per_s, read()),
        (90.0, theirs)
    );
    assert!(lab.state().preset_file().is_modified());
    undo(&mut lab);
    assert_eq!(
        lab.state().preset_file().preset.spin_deg_per_s,
        30.0,
        "the merge is one step of undo"
    );

    // A file that is faulty just now is not overwritten either.
    write(&file, "schema = 2\n[effects.facet]\namount = 9\n");
    press(&mut lab, Modifiers::COMMAND, Key::S);
    assert!(read().contains("amount = 9"));
    assert!(
        error_lines(&lab)
            .iter()
            .any(|line| line.contains("Save as… keeps both")),
        "{:?}",
        error_lines(&lab)
    );
}

#[test]
fn a_new_effect_is_written_beside_the_preset_and_enabled() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), "schema = 2\n[scene]\nbuiltin = \"teapot\"\n") else {
        return;
    };
    press(&mut lab, Modifiers::SHIFT, Key::A);
    click(&mut lab, Role::Button, "Write a new effect");
    let field = lab.get_by_role_and_label(Role::TextInput, "Name");
    field.focus();
    lab.step();
    lab.event(egui::Event::Text("fog".into()));
    lab.run_steps(3);
    click(&mut lab, Role::Button, "Create");
    assert!(has_badge(&lab, "There is an effect fog already."));
    lab.event(egui::Event::Text("gy".into()));
    lab.run_steps(3);
    lab.get_by_role_and_label(Role::TextInput, "Name").focus();
    lab.step();
    lab.event(egui::Event::Text("gy".into()));
    lab.run_steps(3);
    click(&mut lab, Role::Button, "Create");
    let written: Vec<_> = std::fs::read_dir(folder.path().join("effects"))
        .expect("the folder of effects")
        .flatten()
        .collect();
    let [written] = &written[..] else {
        panic!("{written:?}")
    };
    let name = written
        .path()
        .file_stem()
        .expect("a name")
        .to_string_lossy()
        .into_owned();
    wait_for(&mut lab, "the effect is enabled", |lab| {
        lab.state().preset_file().preset.stack.get(&name).is_some()
    });
    assert_eq!(error_lines(&lab), [""; 0]);
}

#[test]
fn a_new_effect_stays_out_of_the_folder_of_presets() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [presets, own] = ["presets", "own"].map(|name| folder.path().join(name));
    let (path, folders) = (
        presets.join("mine.toml"),
        Folders {
            presets: Some(presets),
            effect_folders: vec![own.clone()],
            ..Folders::default()
        },
    );
    write(&path, "schema = 2\n");
    std::fs::create_dir(&own).expect("a folder");
    let Some(mut lab) = lab_with(&path.to_string_lossy(), folders) else {
        return;
    };
    press(&mut lab, Modifiers::SHIFT, Key::A);
    click(&mut lab, Role::Button, "Write a new effect");
    lab.get_by_role_and_label(Role::TextInput, "Name").focus();
    lab.step();
    lab.event(egui::Event::Text("foggy".into()));
    lab.run_steps(3);
    assert!(has_badge(&lab, "own/foggy.wgsl"));
}

#[test]
fn a_dropped_effect_is_enabled_and_a_model_that_changes_is_loaded_again() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (model, ink) = (
        folder.path().join("tri.glb"),
        folder.path().join("elsewhere/ink.wgsl"),
    );
    write(&ink, INK);
    std::fs::write(&model, tiny_glb()).expect("a file");
    // Without a ground, which would be red, too.
    let text = "schema = 2\n[scene]\npath = \"tri.glb\"\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    drop_files(&mut lab, &[&ink]);
    wait_for(&mut lab, "the effect is enabled", |lab| {
        lab.state().preset_file().preset.stack.get("ink").is_some()
    });
    // Width over height of what is red; the camera follows the size.
    let aspect = |lab: &mut Lab| {
        let picture = middle(lab);
        let red: Vec<(u32, u32)> = picture
            .enumerate_pixels()
            .filter(|(_, _, pixel)| pixel.0[0] > 250 && pixel.0[1] < 5)
            .map(|(x, y, _)| (x, y))
            .collect();
        assert!(red.len() > 1_000, "{}", red.len());
        let side = |of: fn(&(u32, u32)) -> u32| {
            let (from, to) = (red.iter().map(of).min(), red.iter().map(of).max());
            f64::from(to.unwrap_or(0) - from.unwrap_or(0) + 1)
        };
        side(|at| at.0) / side(|at| at.1)
    };
    let before = aspect(&mut lab);
    std::fs::write(&model, b"no model").expect("a file");
    wait_for(&mut lab, "the fault is seen", |lab| {
        has_badge(lab, "The model's file is faulty")
    });
    // The model of one triangle with its top at half the height.
    let mut other = tiny_glb();
    let at = other.len() - 8;
    other[at..at + 4].copy_from_slice(&0.5f32.to_le_bytes());
    std::fs::write(&model, other).expect("a file");
    wait_for(&mut lab, "the model is loaded again", |lab| {
        times(lab, "The model was reloaded") == 1
    });
    assert!(!has_badge(&lab, "is faulty"));
    settle(&mut lab);
    // The top has come down to half its height; seen aslant, the base has a height, too.
    let wider = aspect(&mut lab) / before;
    assert!((1.2..2.3).contains(&wider), "wider by a factor of {wider}");
}

/// Run by the next test in a separate process, whose environment names the folder of shaders.
#[test]
#[ignore = "run by shaders_of_a_folder_are_reloaded"]
fn child_whose_shaders_change() {
    draw_pictures();
    let folder = rasterlab::host::shaders::choose(None).expect("the parent's folder");
    let file = folder.join("effects/lambert.wgsl");
    let text = std::fs::read_to_string(&file).expect("a shader");
    let mut lab = lab("lambert").expect("the parent has an adapter");
    // An effect that the folder has more is in the list of effects.
    click(&mut lab, Role::Button, "Effects");
    assert!(lab.query_by_label("Effect plasma").is_some());
    click(&mut lab, Role::Button, "Presets");
    write(
        &file,
        &text.replace(
            "return s;",
            "s.color = vec4f(0.0, 0.0, 1.0, 1.0);\n    return s;",
        ),
    );
    wait_for(&mut lab, "the edit is seen", |lab| {
        times(lab, "The shaders were reloaded") == 1
    });
    let blue = middle_pixel(&mut lab);
    assert!(blue[2] > 250 && blue[0] < 5, "{blue:?}");
    write(&file, &text.replace("return s;", "return t;"));
    wait_for(&mut lab, "the fault is seen", |lab| {
        has_badge(lab, "The shaders are faulty")
    });
    assert_eq!(
        middle_pixel(&mut lab),
        blue,
        "the last good picture went away"
    );
    write(&file, &text);
    wait_for(&mut lab, "the shaders are whole again", |lab| {
        times(lab, "The shaders were reloaded") == 2
    });
    assert!(!has_badge(&lab, "is faulty") && middle_pixel(&mut lab) != blue);
}

#[test]
fn shaders_of_a_folder_are_reloaded() {
    if crate::common::gpu().is_none() {
        return;
    }
    let copied = own_shaders();
    std::fs::copy(
        "tests/picture/ported/plasma.wgsl",
        copied.folder().join("effects/plasma.wgsl"),
    )
    .expect("one effect more");
    let child = std::process::Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "live::child_whose_shaders_change", "--ignored"])
        .env("RASTERLAB_SHADERS", copied.folder())
        .output()
        .expect("the child starts");
    let said = String::from_utf8_lossy(&child.stdout).into_owned()
        + &String::from_utf8_lossy(&child.stderr);
    assert!(child.status.success(), "{said}");
}

#[test]
fn of_two_windows_on_one_preset_the_second_to_save_asks() {
    use egui::{Key, Modifiers, vec2};
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mine.toml");
    let text = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n[effects.lambert]\n";
    let Some(mut first) = lab_of(folder.path(), text) else {
        return;
    };
    let mut second =
        lab_in(&file.to_string_lossy(), Some(folder.path())).expect("the first has an adapter");
    let change = |lab: &mut Lab, to: f32| {
        let rail = slider(lab, "facet.amount").rect();
        drag(
            lab,
            rail.left_center() + vec2(8.0, 0.0),
            rail.left_center() + vec2(to * rail.width(), 0.0),
        );
        value(lab, "facet", "amount")[0]
    };
    let amount_in_file = || {
        let saved = rasterlab::preset_file::load(&file)
            .expect("a preset")
            .preset;
        let facet = saved
            .stack
            .get("facet")
            .expect("the effect is enabled")
            .clone();
        facet
            .effect
            .field("amount")
            .expect("a parameter")
            .get(&facet.words)[0]
    };
    let (ours, theirs) = (change(&mut first, 0.5), change(&mut second, 0.75));
    assert_ne!(ours, theirs);
    press(&mut first, Modifiers::COMMAND, Key::S);
    assert_eq!(amount_in_file(), ours);
    press(&mut second, Modifiers::COMMAND, Key::S);
    wait_for(&mut second, "the question is asked", |lab| {
        lab.query_by_label("Take theirs").is_some()
    });
    assert_eq!(
        amount_in_file(),
        ours,
        "the second window overwrites what the first has saved"
    );
    click(&mut second, Role::Button, "Take theirs");
    assert_eq!(value(&second, "facet", "amount")[0], ours);
    // The first window, which is not asked, saves on.
    let ours = change(&mut first, 0.125);
    press(&mut first, Modifiers::COMMAND, Key::S);
    assert_eq!(amount_in_file(), ours);
}

/// What a program writes after the clock was set back seems older than what was read, and may be as
/// long.
#[test]
fn an_edit_that_seems_older_than_what_is_shown_is_seen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mine.toml");
    let text = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    for (number, (amount, hours)) in [("0.50", 1), ("0.75", 48), ("0.25", 2)]
        .into_iter()
        .enumerate()
    {
        let other = folder.path().join("other.tmp");
        write(&other, &text.replace("0.25", amount));
        let then = std::time::SystemTime::now() - Duration::from_secs(3600 * hours);
        std::fs::File::options()
            .write(true)
            .open(&other)
            .expect("a file")
            .set_modified(then)
            .expect("a time");
        std::fs::rename(&other, &file).expect("the same folder");
        wait_for(&mut lab, "the file is read again", |lab| {
            times(lab, "Mine was reloaded") == number as u32 + 1
        });
        assert_eq!(
            value(&lab, "facet", "amount")[0],
            amount.parse::<f64>().expect("a number")
        );
    }
}

/// Some editors delete a file before they write it again, and version control removes whole
/// folders.
#[test]
fn a_preset_whose_file_or_folder_is_gone_stays_open_and_is_read_again_when_it_returns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let presets = folder.path().join("presets");
    // With a folder of effects nothing is missing at first, so that the system alone reports
    // changes.
    std::fs::create_dir_all(presets.join("effects")).expect("a folder");
    let file = presets.join("mine.toml");
    let text = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n";
    let Some(mut lab) = lab_of(&presets, text) else {
        return;
    };
    let amount = |lab: &Lab| value(lab, "facet", "amount")[0];
    // Long enough for the thread that watches to see that something is gone.
    let look = |lab: &mut Lab| {
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(2) {
            lab.step();
            std::thread::sleep(Duration::from_millis(10));
        }
    };
    std::fs::remove_file(&file).expect("a file");
    look(&mut lab);
    assert!(
        amount(&lab) == 0.25 && !has_badge(&lab, "is faulty"),
        "{}",
        lab.state().log_text()
    );
    write(&file, &text.replace("0.25", "0.5"));
    wait_for(&mut lab, "the file that has returned is read", |lab| {
        amount(lab) == 0.5
    });

    std::fs::remove_dir_all(&presets).expect("a folder");
    look(&mut lab);
    assert!(
        amount(&lab) == 0.5 && !has_badge(&lab, "is faulty"),
        "{}",
        lab.state().log_text()
    );
    write(&file, &text.replace("0.25", "0.75"));
    wait_for(&mut lab, "the folder that has returned is read", |lab| {
        amount(lab) == 0.75
    });
    // It is watched as before.
    look(&mut lab);
    write(&file, &text.replace("0.25", "0.125"));
    wait_for(&mut lab, "the folder that has returned is watched", |lab| {
        amount(lab) == 0.125
    });
    assert_eq!(error_lines(&lab), [""; 0]);
}
