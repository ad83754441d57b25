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
        "shaders/effects"
    );
}

#[test]
fn every_effect_has_a_canonical_preset_that_enables_it() {
    let preset_files = preset_files();
    for effect in effects() {
        let preset_file = preset_files
            .iter()
            .find(|preset_file| preset_file.id == effect);
        let enables = |file: &PresetFile| file.preset.stack.get(&effect).is_some();
        assert!(
            preset_file.is_some_and(enables),
            "presets/{effect}.toml is missing or does not enable {effect}; rasterlab bless {effect}"
        );
    }
}

#[test]
fn every_preset_loads_strictly_and_has_a_name_a_sentence_tags_and_a_test() {
    for preset_file in preset_files() {
        let (id, preset) = (&preset_file.id, &preset_file.preset);
        assert_eq!(preset_file.warnings, [""; 0], "{id}");
        let is_told =
            !preset.name.is_empty() && !preset.about.is_empty() && !preset.tags.is_empty();
        assert!(is_told, "{id} lacks name, about or tags");
        assert!(preset.test.is_some(), "{id} has no [test] table");
        let [width, height] = preset.output.size;
        assert!(
            width <= 320 && height <= 240,
            "{id}: a golden is at most 320x240"
        );
    }
}

/// The gallery leads with pictures that move, on characters and scenes rather than on single
/// shapes, and no model wears out.
#[test]
fn heroes_move_and_no_builtin_fills_more_than_a_fifth_of_the_gallery() {
    let preset_files = preset_files();
    let is_hero = |file: &&PresetFile| file.preset.tags.iter().any(|tag| tag == gallery::HERO);
    let heroes: Vec<&PresetFile> = preset_files.iter().filter(is_hero).collect();
    assert!(heroes.len() >= 10, "{} hero presets", heroes.len());
    assert_eq!(heroes.len(), gallery::heroes().len());
    // The name of a built-in scene; none where it is a file.
    let builtin = |file: &PresetFile| match &file.preset.scene {
        SceneSource::Builtin(query) => query.split('?').next().map(str::to_owned),
        _ => None,
    };
    let mut share = std::collections::BTreeMap::<String, usize>::new();
    preset_files
        .iter()
        .filter_map(builtin)
        .for_each(|name| *share.entry(name).or_default() += 1);
    let most = preset_files.len() / 5;
    assert!(
        share.values().all(|presets| *presets <= most),
        "at most {most}: {share:?}"
    );
    for hero in heroes {
        assert!(hero.preset.is_moving(), "{} does not move", hero.id);
        let name = builtin(hero).unwrap_or_default();
        assert!(
            ["walker", "town", "still-life"].contains(&&*name),
            "{}: {name}",
            hero.id
        );
    }
}

#[test]
fn names_of_presets_are_unique() {
    let preset_files = preset_files();
    let names: BTreeSet<&String> = preset_files.iter().map(|file| &file.preset.name).collect();
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
        let path = file.path();
        let on_disk = fs::read(root().join("presets").join(path)).expect("the folder has it");
        assert!(
            on_disk == file.contents(),
            "{} is stale in the program",
            path.display()
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
    let tested = preset_files()
        .into_iter()
        .filter(|file| file.preset.test.is_some());
    let tested: BTreeSet<String> = tested.map(|file| file.id).collect();
    let mut pictures = stems("tests/snapshots", "png");
    pictures.retain(|stem| {
        ![".new", ".diff", ".old"]
            .iter()
            .any(|end| stem.ends_with(end))
    });
    assert_eq!(
        pictures, tested,
        "pictures; rasterlab bless --all draws what is missing"
    );
    assert_eq!(stems("tests/snapshots", "json"), tested, "sidecars");
    for stem in pictures {
        let path = root().join(format!("tests/snapshots/{stem}.png"));
        let bytes = fs::metadata(path).expect("it was just listed").len();
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
            let nests = low <= soft_low && soft_low < soft_high && soft_high <= high;
            assert!(
                nests,
                "{name}: {:?} is not inside {:?}",
                field.soft, field.hard
            );
            assert!(
                !field.log || soft_low > 0.0,
                "{name}: a slider in decades begins above 0"
            );
            let is_inside = |lane: &f64| (low..=high).contains(lane);
            assert!(
                field.get(defaults).iter().all(is_inside),
                "{name}: its default is outside"
            );
        }
    }
}

#[test]
fn no_effect_file_can_take_the_name_of_a_setting_or_a_section() {
    let tops = settings().filter(|setting| setting.section.is_empty());
    let sections = SECTIONS
        .iter()
        .map(|section| section.name)
        .filter(|name| !name.is_empty());
    let names = sections.chain(tops.map(|setting| setting.name.as_str()));
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
    let [help, guide, types] = [
        "src/cli/args.rs",
        "docs/guide.md",
        "scripts/package/rasterlab.xml",
    ]
    .map(|file| fs::read_to_string(root().join(file)).expect(file));
    for format in MODEL_FORMATS {
        let name = format!(".{}", format.extension);
        assert!(guide.contains(&name), "{name} in docs/guide.md");
        assert!(
            types.contains(&format!("\"*{name}\"")),
            "{name} of the package"
        );
        assert!(key.doc.contains(&name), "scene.path: {}", key.doc);
        // Of a model to open, and of a PRESET.
        assert_eq!(help.matches(&name).count(), 2, "{name}");
    }
}
