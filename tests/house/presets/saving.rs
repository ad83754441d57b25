//! Promise: saving replaces a file as a whole or not at all, and never writes what it could not
//! read.

use std::path::Path;

use rasterlab::{
    preset::{Preset, SceneSource},
    preset_file::{self, PresetError, PresetFile},
};

use super::*;

#[test]
fn a_newer_schema_opens_read_only_and_is_never_written() {
    let mut preset_file = parse("schema = 99\nname = \"new\"\n");
    assert!(preset_file.read_only && preset_file.warnings[0].contains("schema 99 is newer"));
    preset_file.preset.name = "changed".into();
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("copy.toml");
    assert!(matches!(
        preset_file::save(&mut preset_file, &target),
        Err(PresetError::ReadOnly { .. })
    ));
    assert!(!target.exists());
}

#[test]
fn saving_is_atomic_and_leaves_an_unmodified_file_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let mut preset_file = PresetFile::new("new", Preset::default());
    preset_file::save(&mut preset_file, &path).unwrap();
    assert_eq!(
        (preset_file.id.as_str(), preset_file.path.as_deref()),
        ("mine", Some(path.as_path()))
    );
    let stamp = |path: &Path| std::fs::metadata(path).unwrap().modified().unwrap();
    let before = stamp(&path);
    // Sleeps: a file that is written again gets a later time than the clock of files can tell apart.
    std::thread::sleep(std::time::Duration::from_millis(20));
    preset_file::save(&mut preset_file, &path).unwrap();
    assert_eq!(stamp(&path), before, "an unmodified preset was rewritten");
    preset_file::set(&mut preset_file, "name", "Changed").unwrap();
    preset_file::save(&mut preset_file, &path).unwrap();
    assert_eq!(preset_file::load(&path).unwrap().preset.name, "Changed");
    let names: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names, ["mine.toml"], "no temporary file is left behind");
}

#[test]
fn a_failed_save_keeps_the_old_file_and_the_unsaved_state() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.toml");
    let mut preset_file = PresetFile::new(
        "new",
        Preset {
            name: "old".into(),
            ..Preset::default()
        },
    );
    preset_file::save(&mut preset_file, &path).unwrap();
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    preset_file.preset.name = "new".into();
    assert!(matches!(
        preset_file::save(&mut preset_file, &path),
        Err(PresetError::Write { .. })
    ));
    assert!(preset_file.is_modified());
    assert_eq!(preset_file::load(&path).unwrap().preset.name, "old");
    assert!(matches!(
        preset_file::save(&mut preset_file, &folder.path().join("no/such/folder.toml")),
        Err(PresetError::Write { .. })
    ));
}

#[test]
fn saving_elsewhere_keeps_the_way_to_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let (preset_files, deeper) = (
        folder.path().join("presets"),
        folder.path().join("presets/a/b"),
    );
    std::fs::create_dir_all(&deeper).unwrap();
    let model = folder.path().join("scenes/fox.glb");
    let mut preset_file = PresetFile::of_scene("fox", SceneSource::File(model));
    preset_file::save(&mut preset_file, &preset_files.join("fox.toml")).unwrap();
    assert_eq!(
        preset_file.preset.scene,
        SceneSource::File("../scenes/fox.glb".into())
    );
    preset_file::save(&mut preset_file, &deeper.join("fox.toml")).unwrap();
    assert_eq!(
        preset_file.preset.scene,
        SceneSource::File("../../../scenes/fox.glb".into())
    );
    let absent = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
        .unwrap_err()
        .to_string();
    assert!(absent.contains("fox.glb does not exist"), "{absent}");
}
