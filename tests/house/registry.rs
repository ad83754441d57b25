//! Promise: every effect has its file, a preset and a golden, every preset loads
//! strictly, and no snapshot is orphaned.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use rasterlab::{
    cli::gallery,
    effect_files::check_name,
    effects::EFFECTS,
    preset::{
        SceneSource,
        settings::{SECTIONS, settings},
    },
    preset_file::{self, BUILTIN_DIR, MODEL_FORMATS, PresetFile},
};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Stems of the files in `folder` that end in `.extension`.
fn stems(folder: &str, extension: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join(folder)).unwrap_or_else(|e| panic!("{folder}: {e}"));
    let paths = entries.map(|entry| entry.expect("a folder can be read").path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect()
}

fn preset_files() -> Vec<PresetFile> {
    let path = |stem: &String| -> PathBuf { root().join("presets").join(format!("{stem}.toml")) };
    stems("presets", "toml")
        .iter()
        .map(|stem| preset_file::load(&path(stem)).unwrap_or_else(|e| panic!("{e}")))
        .collect()
}

fn effects() -> BTreeSet<String> {
    EFFECTS
        .iter()
        .map(|effect| effect.name.to_owned())
        .collect()
}

/// The effects that have a side in Rust.
fn in_rust() -> BTreeSet<String> {
    const CATALOG: [&str; 9] = [
        "mod",
        "conflict",
        "effect",
        "given",
        "image_file",
        "list",
        "one_sun",
        "stack",
        "words",
    ];
    let mut files = stems("crates/model/src/effects", "rs");
    for stem in CATALOG {
        assert!(
            files.remove(stem),
            "crates/model/src/effects/{stem}.rs is gone"
        );
    }
    files
}

#[test]
fn every_effect_has_its_file_and_no_file_lacks_its_effect() {
    assert!(
        in_rust().is_subset(&effects()),
        "crates/model/src/effects against the list of effects"
    );
    assert_eq!(
        stems("shaders/effects", "wgsl"),
        effects(),
        "shaders/effects against the list of effects"
    );
}

#[test]
fn every_effect_has_a_canonical_preset_that_enables_it() {
    let preset_files = preset_files();
    for effect in effects() {
        let preset_file = preset_files
            .iter()
            .find(|preset_file| preset_file.id == effect)
            .unwrap_or_else(|| {
                panic!("presets/{effect}.toml is missing; rasterlab bless {effect}")
            });
        assert!(
            preset_file.preset.stack.get(&effect).is_some(),
            "presets/{effect}.toml does not enable {effect}"
        );
    }
}

#[test]
fn every_preset_loads_strictly_and_has_a_name_a_sentence_tags_and_a_test() {
    for preset_file in preset_files() {
        assert_eq!(
            preset_file.warnings,
            Vec::<String>::new(),
            "{}",
            preset_file.id
        );
        let preset = &preset_file.preset;
        assert!(
            !preset.name.is_empty() && !preset.about.is_empty() && !preset.tags.is_empty(),
            "{} lacks name, about or tags",
            preset_file.id
        );
        assert!(
            preset.test.is_some(),
            "{} has no [test] table",
            preset_file.id
        );
        let [width, height] = preset.output.size;
        assert!(
            width <= 320 && height <= 240,
            "{}: a golden is at most 320x240",
            preset_file.id
        );
    }
}

/// The gallery leads with pictures that move, on characters and scenes rather than on single
/// shapes, and no model wears out.
#[test]
fn heroes_move_and_no_builtin_fills_more_than_a_fifth_of_the_gallery() {
    let preset_files = preset_files();
    let heroes: Vec<&PresetFile> = preset_files
        .iter()
        .filter(|file| file.preset.tags.iter().any(|tag| tag == gallery::HERO))
        .collect();
    assert!(heroes.len() >= 10, "{} hero presets", heroes.len());
    assert_eq!(heroes.len(), gallery::heroes().len());
    let mut share = std::collections::BTreeMap::<String, usize>::new();
    for preset_file in &preset_files {
        if let SceneSource::Builtin(query) = &preset_file.preset.scene {
            *share
                .entry(query.split('?').next().expect("a name").to_owned())
                .or_default() += 1;
        }
    }
    for (builtin, presets) in &share {
        assert!(
            5 * presets <= preset_files.len(),
            "{builtin} appears in {presets} of {} presets",
            preset_files.len()
        );
    }
    for hero in heroes {
        assert!(hero.preset.is_moving(), "{} does not move", hero.id);
        let SceneSource::Builtin(query) = &hero.preset.scene else {
            panic!("{} needs a file", hero.id)
        };
        assert!(
            ["walker", "town", "still-life"].contains(&query.split('?').next().expect("a name")),
            "{}: {query}",
            hero.id
        );
    }
}

#[test]
fn every_preset_finds_its_scene() {
    for preset_file in preset_files() {
        let scene = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
            .unwrap_or_else(|e| panic!("{}: {e}", preset_file.id));
        assert!(
            scene.triangle_count() > 0,
            "{} shows nothing",
            preset_file.id
        );
    }
}

#[test]
fn names_of_presets_are_unique() {
    let preset_files = preset_files();
    let names: BTreeSet<&str> = preset_files
        .iter()
        .map(|preset_file| preset_file.preset.name.as_str())
        .collect();
    assert_eq!(names.len(), preset_files.len());
}

#[test]
fn the_program_embeds_every_preset_of_the_folder() {
    let embedded: BTreeSet<String> = BUILTIN_DIR
        .files()
        .filter(|file| file.path().extension().is_some_and(|e| e == "toml"))
        .filter_map(|file| Some(file.path().file_stem()?.to_string_lossy().into_owned()))
        .collect();
    assert_eq!(embedded, stems("presets", "toml"));
    for file in BUILTIN_DIR.files() {
        let on_disk =
            fs::read(root().join("presets").join(file.path())).expect("the folder has it");
        assert!(
            on_disk == file.contents(),
            "{} is stale in the program",
            file.path().display()
        );
    }
}

#[test]
fn no_effect_is_named_like_a_section_or_key() {
    for effect in effects() {
        assert!(
            SECTIONS.iter().all(|section| section.name != effect),
            "{effect}"
        );
        assert!(
            settings().all(|setting| setting.path() != effect),
            "{effect}"
        );
        assert!(!["schema", "stack", "effects"].contains(&effect.as_str()));
    }
}

#[test]
fn every_golden_has_its_preset_and_sidecar_and_every_tested_preset_its_golden() {
    let tested: BTreeSet<String> = preset_files()
        .into_iter()
        .filter(|preset_file| preset_file.preset.test.is_some())
        .map(|preset_file| preset_file.id)
        .collect();
    let transient = |stem: &String| {
        [".new", ".diff", ".old"]
            .iter()
            .any(|end| stem.ends_with(end))
    };
    let pictures: BTreeSet<String> = stems("tests/snapshots", "png")
        .into_iter()
        .filter(|stem| !transient(stem))
        .collect();
    assert_eq!(
        pictures, tested,
        "tests/snapshots/*.png against looks with [test]; rasterlab bless --all draws what is missing"
    );
    assert_eq!(
        stems("tests/snapshots", "json"),
        tested,
        "tests/snapshots/*.json against looks with [test]"
    );
    for stem in pictures {
        let bytes = fs::metadata(root().join(format!("tests/snapshots/{stem}.png")))
            .expect("it was just listed")
            .len();
        assert!(
            bytes <= 64 << 10,
            "{stem}.png has {bytes} bytes; a golden is at most 64 KiB"
        );
    }
}

#[test]
fn the_gallery_of_the_readme_is_what_the_command_writes() {
    let readme = fs::read_to_string(root().join("README.md")).expect("there is a README");
    let new = gallery::replaced(&readme, &gallery::table()).expect("the README has a gallery");
    assert!(
        new == readme,
        "the gallery is stale: rasterlab gallery --into README.md"
    );
}

#[test]
fn parameters_are_documented_and_their_ranges_nest() {
    for effect in EFFECTS.iter() {
        let defaults = &effect.defaults;
        for field in &effect.fields {
            let name = format!("{}.{}", effect.name, field.name);
            assert!(
                field.doc.trim().ends_with(['.', '?']),
                "{name}: its sentence does not end"
            );
            let ([low, high], [soft_low, soft_high]) = (field.hard, field.soft);
            assert!(
                low <= soft_low && soft_low < soft_high && soft_high <= high,
                "{name}: soft {:?} is not inside hard {:?}",
                field.soft,
                field.hard
            );
            assert!(
                !field.log || soft_low > 0.0,
                "{name}: a slider in decades begins above 0"
            );
            assert!(
                field
                    .get(defaults)
                    .iter()
                    .all(|lane| (low..=high).contains(lane)),
                "{name}: its default is outside its hard range"
            );
        }
    }
}

#[test]
fn no_effect_file_can_take_the_name_of_a_setting_or_a_section() {
    let tops = settings()
        .filter(|setting| setting.section.is_empty())
        .map(|setting| setting.name.as_str());
    let names = SECTIONS
        .iter()
        .map(|section| section.name)
        .filter(|name| !name.is_empty())
        .chain(tops);
    let free: Vec<&str> = names.filter(|name| check_name(name).is_ok()).collect();
    assert!(
        free.is_empty(),
        "{free:?} would hide an effect file of that name from --set"
    );
}

#[test]
fn help_texts_the_guide_and_the_package_name_every_format_of_models() {
    let key = settings()
        .find(|setting| setting.path() == "scene.path")
        .expect("a key");
    let help =
        fs::read_to_string(root().join("src/cli/args.rs")).expect("the help of the command line");
    let [guide, types] = ["docs/guide.md", "scripts/package/rasterlab.xml"]
        .map(|file| fs::read_to_string(root().join(file)).expect(file));
    for format in MODEL_FORMATS {
        let name = format!(".{}", format.extension);
        assert!(guide.contains(&name), "{name} in docs/guide.md");
        assert!(
            types.contains(&format!("\"*{name}\"")),
            "{name} of the package"
        );
        assert!(key.doc.contains(&name), "scene.path: {}", key.doc);
        assert_eq!(
            help.matches(&name).count(),
            2,
            "{name} of a model to open, and of a PRESET"
        );
    }
}
